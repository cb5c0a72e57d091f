//! Displacement gain: the scale of the displacement sensor is wrong (catalogue M9).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `true contraction = measured x (1 + g)`.
#[derive(Debug)]
pub(crate) struct DisplacementGain;

impl Effect for DisplacementGain {
    fn card(&self) -> Card<'_> {
        Card {
            name: "displacement-gain",
            family: "displacement-gain",
            mechanism: Mechanism::LengthChain,
            form: Form::Exact,
            title: "Gain of the displacement sensor",
            about: "The displacement sensor, or the rope and drum before it, counts a fixed part too little or too much of every way. At \
                    contraction 0 nothing is wrong; the error grows from there.",
            equation: "true contraction = measured (1 + g)",
            source: "data sheets of displacement sensors: 0.05 to 1 %",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "eps dF/d eps" },
            twins: &[
                Twin { name: "end-factor", how: "identical" },
                Twin { name: "length-zero-error", how: "1.000 on a calibrated cylinder" },
                Twin { name: "end-taper", how: "0.983 (braid)" },
                Twin { name: "wall-thickness", how: "-0.96 (braid)" },
                Twin { name: "end-radius", how: "0.997 (PPAM)" },
                Twin { name: "fibre-misalignment", how: "0.98 (PPAM)" },
            ],
            separate: "a gauge block under the sensor",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how much more the muscle has moved than the reading says";
        vec![
            ParameterCard::new("gain", PERCENT, (-30.0, 30.0), 0.0, about)
                .prior(0.0, 1.0)
                .plausible(-5.0, 5.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for DisplacementGain {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.contraction = input.contraction * (theta[0] + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_way_is_scaled() {
        assert!((input(&DisplacementGain, &[0.02], |_| ()).contraction.value() - 0.102).abs() < 1e-15);
    }
}
