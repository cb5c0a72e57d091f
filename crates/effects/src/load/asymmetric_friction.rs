//! Asymmetric friction: constant friction that differs between the directions (catalogue F12).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `dF = -F_up` while shortening, `+F_down` while lengthening.
#[derive(Debug)]
pub(crate) struct AsymmetricFriction;

impl Effect for AsymmetricFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "asymmetric-friction",
            family: "coulomb-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Constant friction that differs with the direction",
            about: "Friction takes one force while the muscle shortens and gives another while it lengthens: a guide that tilts, strands that \
                    open more easily than they close. Half the sum widens the loop, half the difference shifts it like a wrong zero.",
            equation: "dF = -F_up while shortening, +F_down while lengthening, 0 at rest",
            source: "Coulomb's law with one constant for each direction; asymmetric loops of fluidic muscles in Liu et al. 2017",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Mixed, shape: "constant on each branch" },
            twins: &[
                Twin { name: "coulomb-friction", how: "0.978; with a force-offset identical" },
                Twin { name: "valve-hysteresis", how: "0.90" },
            ],
            separate: "the force at rest (its mean is the shift of a force-offset, but not of friction); tare the load cell",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let number = |name, about| {
            ParameterCard::new(name, NEWTON, (0.0, 200.0), 12.0, about).prior(0.0, 20.0).plausible(0.0, 100.0)
        };
        vec![
            number("shortening", "force lost while shortening"),
            number("lengthening", "force added while lengthening"),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for AsymmetricFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, force: &mut Jet) {
        let (up, down) = (moment.direction.max(0.0), (-moment.direction).max(0.0));
        *force = *force - theta[0] * up + theta[1] * down;
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "sums of 0 and the parameter are exact")]

    use super::*;
    use crate::probe::load;

    #[test]
    fn each_direction_has_its_own() {
        let [up, down, rest] =
            [1.0, -1.0, 0.0].map(|s| load(&AsymmetricFriction, &[12.0, 7.0], |moment| moment.direction = s));
        assert_eq!([up, down, rest], [-12.0, 7.0, 0.0]);
    }
}
