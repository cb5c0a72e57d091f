//! Regulator lag: gas has to pass a line, so the pressure in a moving muscle differs from that of the
//! regulator (catalogue P3).

use bulge_fibre::AMBIENT_PRESSURE;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::load::relaxed::relaxed;
use crate::mechanism::{Form, Mechanism};
use crate::rig::ideal_volume::IdealVolume;
use crate::rig::lowered_pressure::lowered;
use crate::unit::SECOND;

/// `d(reading - p)/dt = q - (reading - p)/tau`, `q = (p + p_a) (V'/V) d eps/dt + d reading/dt`.
///
/// The gas balance at constant temperature is d((p + p_a) V)/dt = C (reading - p), with the conductance C of
/// the line and tau = V/C. Between two rows it is exact for a constant demand q ([`relaxed`]). A sweep begins
/// in the steady lag `tau q` of a motion that is under way. The pressure in q is the reading, which neglects
/// terms of second order in the lag. V'/V is that of a muscle of inextensible fibres ([`IdealVolume`]: a
/// cylinder, or a barrel with circular meridians), because the equilibrium isn't known yet. Its error is 1 %
/// up to 20 % contraction for a PPAM, and 7 % at 10 % for a braid of 250 mm. tau = V/C is taken as constant,
/// although V grows.
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
                    takes in gas and has less pressure than the sensor says, while it lengthens more. The faster, the more; after a turn it takes \
                    a few tau until it is.",
            equation: "d = reading - p,   dd/dt = q - d/tau,   q = (p + p_a) (V'/V) d eps/dt + d reading/dt,   p_a = 1.01325 bar,   V of inextensible fibres",
            source: "gas balance of muscle and line at constant temperature",
            evidence: Evidence::Derived,
            group: Group::Rig,
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

    fn memory(&self) -> usize {
        1
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for RegulatorLag {
    fn act(&self, Row { moment, setting, theta, memory }: Row<'_>, input: &mut Input) {
        let growth = IdealVolume::at(input.contraction, setting).growth;
        let demand = (input.pressure + AMBIENT_PRESSURE) * growth * moment.rate + moment.pressure_rate;
        memory[0] = if moment.begins {
            theta[0] * demand
        } else {
            relaxed(memory[0], demand * moment.since, moment.since, theta[0])
        };
        input.pressure = lowered(input.pressure, memory[0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Jet, Moment};
    use crate::probe::{SETTING, input};
    use bulge_numerics::Real;

    #[test]
    fn a_shortening_muscle_has_less_pressure() {
        // V'/V = 3.306687 at 25 deg and 10 %. With (2 + 1.01325) bar, 1 % per second and 0.2 s this gives
        // 1992.77 Pa.
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

    #[test]
    fn after_a_stop_the_pressure_comes_to_the_readings() {
        // From rest, a ramp of 0.1 bar/s for 0.9 s and then a hold: d = tau s (1 - exp(-t/tau)), followed by
        // a decay with exp(-t/tau).
        let (tau, slope) = (0.4_f64, 1e4);
        let mut memory = [Jet::from(0.0)];
        let mut behind = |since: f64, rate: f64, begins: bool| {
            let moment = Moment { since, begins, pressure_rate: rate, ..Moment::at_rest(2e5, 0.1) };
            let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
            RegulatorLag.act(
                Row { moment: &moment, setting: &SETTING, theta: &[Jet::from(tau)], memory: &mut memory },
                &mut input,
            );
            2e5 - input.pressure.value()
        };
        assert!(behind(0.0, 0.0, true).abs() < 1e-12);
        for since in [0.2, 0.3] {
            behind(since, slope, false);
        }
        let at_stop = behind(0.4, slope, false);
        assert!((at_stop - tau * slope * (1.0 - (-0.9 / tau).exp())).abs() < 1e-9, "{at_stop}");
        let later = behind(0.7, 0.0, false);
        assert!((later - at_stop * (-0.7 / tau).exp()).abs() < 1e-9, "{later}");
    }
}
