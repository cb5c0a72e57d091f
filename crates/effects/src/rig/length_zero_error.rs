//! Length zero error: the displacement sensor reads zero at a length that differs from the stated one
//! (catalogue M7).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `true contraction = measured + offset/l0`.
#[derive(Debug)]
pub(crate) struct LengthZeroError;

impl Effect for LengthZeroError {
    fn card(&self) -> Card<'_> {
        Card {
            name: "length-zero-error",
            family: "length-zero-error",
            mechanism: Mechanism::LengthChain,
            form: Form::Exact,
            title: "Zero of the length",
            about: "The muscle is shorter than the reading says, by the same amount everywhere: the sensor was set to zero at another \
                    length. It counts most at small contractions, where the force changes fastest.",
            equation: "true contraction = measured + offset/l0",
            source: "geometry of the measurement; 4 mm of 300 mm found in a published force map",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "dF/d eps: largest at small contractions",
            },
            twins: &[
                Twin { name: "fibre-length", how: "0.98" },
                Twin { name: "displacement-gain", how: "1.000 on a calibrated cylinder" },
                Twin { name: "end-factor", how: "1.000 on a calibrated cylinder" },
                Twin { name: "fibre-stretch", how: "0.966 (PPAM)" },
            ],
            separate: "a ruler; the length at which the vented muscle becomes slack",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how much shorter the muscle is than the reading says";
        vec![
            ParameterCard::new("offset", MILLIMETRE, (-20.0, 20.0), 0.0, about)
                .prior(0.0, 2.0)
                .plausible(-8.0, 8.0),
        ]
    }

    fn is_of_mounting(&self) -> bool {
        true
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for LengthZeroError {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, input: &mut Input) {
        input.contraction += theta[0] / setting.length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_muscle_is_shorter_by_the_offset() {
        // 4 mm on 250 mm.
        assert!((input(&LengthZeroError, &[4e-3], |_| ()).contraction.value() - 0.116).abs() < 1e-15);
    }
}
