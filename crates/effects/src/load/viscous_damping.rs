//! Viscous damping: a force against the motion, in proportion to its speed (catalogue R1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `dF = -c d eps/dt`.
#[derive(Debug)]
pub(crate) struct ViscousDamping;

impl Effect for ViscousDamping {
    fn card(&self) -> Card<'_> {
        Card {
            name: "viscous-damping",
            family: "viscous-damping",
            mechanism: Mechanism::Rate,
            form: Form::Loose,
            title: "Damping in proportion to the speed",
            about: "Rubber and gas resist fast motion more than slow motion. The loop is widest in the middle, where the muscle moves \
                    fastest, and closed at its ends; at a tenth of the speed it is a tenth as wide.",
            equation: "dF = -c d eps/dt",
            source: "Newton's dashpot; for fluidic muscles Reynolds et al. 2003",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "as the speed: 0 at the reversals of a sine",
            },
            twins: &[
                Twin { name: "standard-linear-solid", how: "0.94 at one speed" },
                Twin { name: "maxwell-slip", how: "0.94 at one speed" },
                Twin { name: "pressure-viscosity", how: "0.90" },
                Twin { name: "coulomb-friction", how: "0.90 at one speed" },
                Twin { name: "force-lag", how: "0.90" },
            ],
            separate: "the same loop at a twenty times different speed",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force per rate of contraction";
        vec![
            ParameterCard::new("damping", ("N s", 1.0), (0.0, 1e5), 4e3, about)
                .prior(0.0, 6e3)
                .plausible(0.0, 4e4),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for ViscousDamping {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * moment.rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn the_force_follows_the_speed() {
        // 4 kN s at 0.5 % per second.
        let [up, down, rest] =
            [5e-3, -5e-3, 0.0].map(|rate| load(&ViscousDamping, &[4e3], |moment| moment.rate = rate));
        assert!((up + 20.0).abs() < 1e-12 && (down - 20.0).abs() < 1e-12 && rest == 0.0);
    }
}
