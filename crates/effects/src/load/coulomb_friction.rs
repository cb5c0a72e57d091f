//! Coulomb friction: a constant force against the motion (Chou and Hannaford 1996; catalogue F1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `dF = -s F_c`, s = +1 while shortening, -1 while lengthening.
#[derive(Debug)]
pub(crate) struct CoulombFriction;

impl Effect for CoulombFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "coulomb-friction",
            family: "coulomb-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Constant friction",
            about: "A force against the motion that doesn't depend on pressure, contraction or speed: guides of the rig, rubber that loses a \
                    constant part of its work. It shifts the two branches of a loop apart by twice its size.",
            equation: "dF = -s F_c,   s = +1 while shortening, -1 while lengthening, 0 at rest",
            source: "Chou and Hannaford 1996 (2.5 N); half-widths of 11 to 14 N in S2, tables 3 to 6",
            evidence: Evidence::Paper,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Odd, shape: "constant" },
            twins: &[
                Twin { name: "presliding-hysteresis", how: "0.88: differs only after reversals" },
                Twin { name: "viscous-damping", how: "0.90 at one speed" },
                Twin { name: "asymmetric-friction", how: "0.978" },
                Twin { name: "stribeck-friction", how: "identical at one speed" },
            ],
            separate: "loops with inner reversals; the same loop at a twenty times different speed",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("force", NEWTON, (0.0, 200.0), 12.0, "half the distance between the branches")
                .prior(0.0, 20.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for CoulombFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "a product with 1 is exact")]

    use super::*;
    use crate::probe::load;

    #[test]
    fn branches_are_two_forces_apart() {
        let up = load(&CoulombFriction, &[12.0], |moment| moment.direction = 1.0);
        let down = load(&CoulombFriction, &[12.0], |moment| moment.direction = -1.0);
        let rest = load(&CoulombFriction, &[12.0], |moment| moment.direction = 0.0);
        assert_eq!([up, down, rest], [-12.0, 12.0, 0.0]);
    }
}
