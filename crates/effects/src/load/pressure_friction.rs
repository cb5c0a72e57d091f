//! Pressure friction: strands that the gas presses together rub on each other (S2, tables 3 to 6; catalogue
//! F2).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON_PER_BAR;

/// `dF = -s mu_p p`, s = +1 while shortening, -1 while lengthening.
#[derive(Debug)]
pub(crate) struct PressureFriction;

impl Effect for PressureFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-friction",
            family: "pressure-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction in proportion to the pressure",
            about: "The gas presses the strands of the braid (or the folds of the cloth) onto each other, and they rub when the muscle moves. \
                    The loop is wider at high pressure, by the same amount at every contraction.",
            equation: "dF = -s mu_p p,   s = +1 while shortening, -1 while lengthening, 0 at rest",
            source: "half-widths of 1.3 to 1.7 N/bar in S2, tables 3 to 6",
            evidence: Evidence::Paper,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Odd, shape: "constant" },
            twins: &[
                Twin { name: "crossing-friction", how: "0.995" },
                Twin { name: "contact-friction", how: "0.995" },
                Twin { name: "tension-friction", how: "0.98 (PPAM)" },
                Twin { name: "force-friction", how: "0.92" },
                Twin { name: "coulomb-friction", how: "0.90 from 1 to 5 bar" },
                Twin { name: "pressure-viscosity", how: "0.90 at one speed" },
            ],
            separate: "a wider range of pressures against constant friction; a second length against contact-friction; another speed \
                       against viscosity",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "half the distance between the branches, per pressure";
        vec![
            ParameterCard::new("coefficient", NEWTON_PER_BAR, (0.0, 100.0), 1.5, about)
                .prior(0.0, 3.0)
                .plausible(0.0, 30.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for PressureFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.pressure * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn branches_are_apart_in_proportion_to_the_pressure() {
        // 1.5 N/bar at 2 bar.
        let [up, down, rest] =
            [1.0, -1.0, 0.0].map(|s| load(&PressureFriction, &[1.5e-5], |moment| moment.direction = s));
        assert!((up + 3.0).abs() < 1e-12 && (down - 3.0).abs() < 1e-12 && rest == 0.0);
    }
}
