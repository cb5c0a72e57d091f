//! Pressure hysteresis: after a reversal of the pressure the sensor lags by a fixed pressure difference.

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Jet, Row};
use crate::load::dragged::dragged;
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::KILOPASCAL;

/// `z -> s + (z - s) exp(-|dp|/delta)`, `p = reading + h z`, where s is the sign of dp.
#[derive(Debug)]
pub(crate) struct PressureHysteresis;

impl Effect for PressureHysteresis {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-hysteresis",
            family: "pressure-hysteresis",
            mechanism: Mechanism::PressureChain,
            form: Form::Loose,
            title: "Hysteresis of the pressure reading",
            about: "While the pressure rises the sensor reads a little less than there is, while it falls a little more. Filling and venting at \
                    held length, the muscle then seems to pull more while it is filled, by the same few hundredths of a bar at any pressure.",
            equation: "z -> s + (z - s) exp(-|dp|/delta),   p = reading + h z,   s = sign(dp)",
            source: "data sheets of pressure sensors: hysteresis of 0.1 to 0.5 % of full scale",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "dF/dp: largest at rest length, flat in the pressure",
            },
            twins: &[
                Twin { name: "pressure-lag", how: "at one speed" },
                Twin { name: "valve-hysteresis", how: "with the other sign" },
                Twin { name: "pressure-presliding", how: "with the other sign" },
            ],
            separate: "a second pressure sensor; a rigid vessel instead of the muscle; +-0.5 % of length at each pressure wipes the friction out and \
                       leaves this",
            needs: Needs::PressurePath,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "pressure",
                KILOPASCAL,
                (0.0, 30.0),
                2.0,
                "half the width of the loop of the reading",
            )
            .prior(0.0, 3.0)
            .plausible(0.0, 10.0),
            ParameterCard::new(
                "distance",
                KILOPASCAL,
                (0.1, 300.0),
                10.0,
                "pressure over which it turns over",
            )
            .plausible(0.5, 100.0)
            .off_at(10.0)
            .logarithmic(),
        ]
    }

    fn memory(&self) -> usize {
        1
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for PressureHysteresis {
    fn act(&self, Row { moment, theta, memory, .. }: Row<'_>, input: &mut Input) {
        memory[0] = dragged(memory[0], Jet::from(moment.pressure_step), theta[1], Jet::from(1.0));
        input.pressure = lowered(input.pressure, -(theta[0] * memory[0]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::probe::SETTING;
    use bulge_numerics::Real;

    #[test]
    fn the_reading_follows_late() {
        let mut memory = [Jet::from(0.0)];
        let mut run = |step: f64| {
            let moment = Moment { pressure_step: step, ..Moment::at_rest(2e5, 0.1) };
            let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
            let theta = [2e3, 1e4].map(Jet::from);
            PressureHysteresis.act(
                Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut memory },
                &mut input,
            );
            input.pressure.value() - 2e5
        };
        // One distance up gives 2 kPa (1 - 1/e), far up gives 2 kPa, and down by two distances gives -2 kPa
        // (1 - 2 exp(-2)).
        let found = [run(1e4), run(1e6), run(-2e4), run(0.0)];
        let down = -2e3 * (1.0 - 2.0 * (-2.0_f64).exp());
        for (found, expected) in found.into_iter().zip([2e3 * (1.0 - (-1.0_f64).exp()), 2e3, down, down]) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
