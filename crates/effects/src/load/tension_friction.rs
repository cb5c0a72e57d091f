//! Tension friction: fibres rub where they are bent, in proportion to their tension (catalogue F5, variant
//! for the PPAM).

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `dF = -s eta N`, where N = F + p A(r) is the force along the fibres.
#[derive(Debug)]
pub(crate) struct TensionFriction;

impl Effect for TensionFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "tension-friction",
            family: "force-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction in proportion to the fibre tension",
            about: "The fibres of a pleated muscle are bent over the rim of the fitting and rub there. What presses them on is their tension, \
                    not the force of the muscle: the loss stays where the force has gone to zero.",
            equation: "dF = -s eta N,   N = F + p A(r) at mid-length, the tension of all fibres together",
            source: "rope friction, Euler 1769 and Eytelwein 1808, with the tension of the fibres",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: PLEATED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Odd,
                shape: "as the fibre tension: nearly constant at large contractions",
            },
            twins: &[
                Twin { name: "pressure-friction", how: "0.98" },
                Twin { name: "coulomb-friction", how: "0.93" },
            ],
            separate: "loops around the contraction at which the force vanishes: force-friction vanishes there, this one doesn't",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "lost part of the tension";
        vec![
            ParameterCard::new("share", PERCENT, (0.0, 50.0), 0.5, about)
                .prior(0.0, 1.0)
                .plausible(0.0, 10.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for TensionFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.tension * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn a_part_of_the_tension_is_lost_or_added() {
        // 2 % of 800 N.
        let [up, down, rest] =
            [1.0, -1.0, 0.0].map(|s| load(&TensionFriction, &[0.02], |moment| moment.direction = s));
        assert!((up + 16.0).abs() < 1e-12 && (down - 16.0).abs() < 1e-12 && rest == 0.0);
    }
}
