//! Pressure gain: the scale of the pressure sensor is wrong (catalogue M2).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `reading = p (1 + g)`, so the pressure in the muscle is `p = reading/(1 + g)`.
#[derive(Debug)]
pub(crate) struct PressureGain;

impl Effect for PressureGain {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-gain",
            family: "pressure-gain",
            mechanism: Mechanism::PressureChain,
            form: Form::Loose,
            title: "Gain of the pressure sensor",
            about: "The pressure sensor reads a fixed part too much or too little.",
            equation: "reading = p (1 + g)",
            source: "data sheets of pressure sensors: 0.1 to 1 %",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "force-gain", how: "identical where the force is proportional to the pressure" },
                Twin { name: "fibre-count", how: "identical" },
                Twin { name: "line-drop", how: "identical" },
                Twin { name: "fibre-misalignment", how: "0.999 (PPAM)" },
            ],
            separate: "calibrate the span of both sensors",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("gain", PERCENT, (-20.0, 20.0), 0.0, "relative error")
                .prior(0.0, 1.0)
                .plausible(-5.0, 5.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for PressureGain {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.pressure = input.pressure / (theta[0] + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn a_sensor_that_reads_too_much_hides_a_lower_pressure() {
        // 2 bar read with a gain of +2.5 %: 2/1.025 = 1.951220 bar.
        assert!((input(&PressureGain, &[0.025], |_| ()).pressure.value() - 195_121.951_2).abs() < 1e-3);
    }
}
