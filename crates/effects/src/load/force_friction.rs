//! Force friction: losses in proportion to the force, like those of a rope over a pulley (catalogue F5).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `dF = -s eta F`, s = +1 while shortening, -1 while lengthening.
#[derive(Debug)]
pub(crate) struct ForceFriction;

impl Effect for ForceFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-friction",
            family: "force-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction in proportion to the force",
            about: "Something rubs in the path of the force: a pulley, a hinge, fibres that slide over the rim of the fitting. A fixed part \
                    of the force is lost while shortening and added while lengthening.",
            equation: "dF = -s eta F,   s = +1 while shortening, -1 while lengthening, 0 at rest",
            source: "rope friction, Euler 1769 and Eytelwein 1808: exp(mu angle) - 1 for small angles; 1 to 2 % in rigs",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Odd, shape: "as the force" },
            twins: &[
                Twin { name: "force-lag", how: "0.99 (PPAM)" },
                Twin { name: "crossing-friction", how: "0.956" },
                Twin { name: "pressure-friction", how: "0.92" },
                Twin { name: "valve-hysteresis", how: "0.90" },
                Twin { name: "regulator-lag", how: "0.91 (braid)" },
            ],
            separate: "a known weight lifted and lowered instead of the muscle; another speed against force-lag",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "lost part of the force";
        vec![
            ParameterCard::new("share", PERCENT, (0.0, 50.0), 1.0, about)
                .prior(0.0, 2.0)
                .plausible(0.0, 15.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for ForceFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.force * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn a_part_of_the_force_is_lost_or_added() {
        // 2 % of 500 N.
        let [up, down, rest] =
            [1.0, -1.0, 0.0].map(|s| load(&ForceFriction, &[0.02], |moment| moment.direction = s));
        assert!((up + 10.0).abs() < 1e-12 && (down - 10.0).abs() < 1e-12 && rest == 0.0);
    }
}
