//! Regulator lag: the gas has to pass a line, so the muscle has another pressure than the regulator while it moves (catalogue P3).

use bulge_fibre::AMBIENT_PRESSURE;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Setting};
use crate::mechanism::{Form, Mechanism};
use crate::rig::ideal_volume::IdealVolume;
use crate::rig::lowered_pressure::lowered;
use crate::unit::SECOND;

/// `p = reading - tau ((p + p_a) (V'/V) d eps/dt + dp/dt)`.
///
/// Gas balance at constant temperature: d((p + p_a) V)/dt = C (reading - p), with the line's conductance C and tau = V/C. The pressure on
/// the right is the reading, so second order in tau is left out. V'/V is that of a muscle of inextensible fibres ([`IdealVolume`]: a
/// cylinder, or a barrel of circular meridians), because the equilibrium is not known yet: 1 % off up to 20 % contraction for a PPAM, 7 % at
/// 10 % for a braid of 250 mm. tau = V/C is taken as one number, though V grows.
#[derive(Debug)]
pub(crate) struct RegulatorLag;

impl Effect for RegulatorLag {
    fn card(&self) -> Card<'_> {
        Card {
            name: "regulator-lag",
            family: "regulator-lag",
            mechanism: Mechanism::Regulator,
            form: Form::Loose,
            title: "Lag of the pressure behind the regulator",
            about: "The pressure is measured at the regulator, and the gas reaches the muscle through a line. While the muscle shortens it \
                    takes in gas and has less pressure than the sensor says, while it lengthens more. The faster, the more.",
            equation: "p = reading - tau ((p + p_a) (V'/V) d eps/dt + dp/dt),   p_a = 1.01325 bar,   V of inextensible fibres",
            source: "gas balance of muscle and line at constant temperature",
            evidence: Evidence::Derived,
            group: Group::Rig,
            stage: Stage::Input,
            kind: None,
            signature: Signature {
                pressure: "0 and 1",
                parity: Parity::Odd,
                shape: "F/p V'/V times the speed",
            },
            twins: &[
                Twin { name: "valve-hysteresis", how: "0.962 (PPAM)" },
                Twin { name: "force-friction", how: "0.91 (braid)" },
                Twin { name: "pressure-viscosity", how: "near at one speed" },
            ],
            separate: "a pressure sensor in the muscle itself; a second speed",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "time in which the line fills the muscle";
        vec![ParameterCard::new("time", SECOND, (0.0, 5.0), 0.2, about).prior(0.0, 0.5).plausible(0.0, 2.0)]
    }

    fn act(&self, moment: &Moment, setting: &Setting, theta: &[Jet], _: &mut [Jet], place: Place<'_>) {
        if let Place::Input(input) = place {
            let growth = IdealVolume::at(input.contraction, setting).growth;
            let taken = (input.pressure + AMBIENT_PRESSURE) * growth * moment.rate;
            input.pressure = lowered(input.pressure, theta[0] * (taken + moment.pressure_rate));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn a_shortening_muscle_has_less_pressure() {
        // V'/V = 3.306687 at 25 deg and 10 %; (2 + 1.01325) bar, 1 % per second, 0.2 s: 1992.77 Pa.
        let up = input(&RegulatorLag, &[0.2], |moment| moment.rate = 0.01).pressure.value();
        let down = input(&RegulatorLag, &[0.2], |moment| moment.rate = -0.01).pressure.value();
        assert!((2e5 - up - 1992.77).abs() < 0.01, "{up}");
        assert!((up + down - 4e5).abs() < 1e-9);
    }

    #[test]
    fn a_ramp_of_the_regulator_arrives_late() {
        let found = input(&RegulatorLag, &[0.2], |moment| moment.pressure_rate = 1e4).pressure.value();
        assert!((found - 1.98e5).abs() < 1e-9);
        assert!(input(&RegulatorLag, &[5.0], |moment| moment.rate = 10.0).pressure.value() > 0.0);
    }
}
