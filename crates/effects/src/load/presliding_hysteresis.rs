//! Presliding hysteresis: friction that builds up over a distance after each reversal (Dahl 1968; catalogue
//! F11).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::dragged::dragged;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT};

/// Dahl's law with exponent 1, exact between two rows: `z -> s + (z - s) exp(-|d eps|/delta)`, `dF = -w z`.
#[derive(Debug)]
pub(crate) struct PreslidingHysteresis;

impl Effect for PreslidingHysteresis {
    fn card(&self) -> Card<'_> {
        Card {
            name: "presliding-hysteresis",
            family: "presliding-hysteresis",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction that builds up after a reversal",
            about: "Fibres stick and give before they slide: after a reversal the friction goes over from one sign to the other within a \
                    distance delta instead of at once, and inner loops are thinner than the outer one.",
            equation: "dz/d eps = (1 - z sign(d eps))/delta,   over a step z -> s + (z - s) exp(-|d eps|/delta),   dF = -w z",
            source: "Dahl 1968, exponent 1",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "constant far from reversals, with a transition of length delta after each",
            },
            twins: &[
                Twin { name: "maxwell-slip", how: "same family; the shape of the transition" },
                Twin { name: "bouc-wen", how: "same family; the shape of the transition" },
                Twin { name: "coulomb-friction", how: "0.88 without inner loops" },
            ],
            separate: "loops with inner reversals (first-order reversal curves)",
            needs: Needs::Motion,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("force", NEWTON, (0.0, 200.0), 12.0, "friction far from a reversal")
                .prior(0.0, 20.0),
            ParameterCard::new("distance", PERCENT, (0.02, 10.0), 1.0, "contraction over which it builds up")
                .off_at(1.0)
                .logarithmic(),
        ]
    }

    fn memory(&self) -> usize {
        1
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for PreslidingHysteresis {
    fn act(&self, Row { theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        memory[0] = dragged(memory[0], balance.turn, theta[1], Jet::from(1.0));
        *force = *force - theta[0] * memory[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::path;

    #[test]
    fn it_builds_up_over_the_distance() {
        // One distance after the start the force is 1 - 1/e of the full one, and far away it is the full one.
        // Back by two distances from +1: s + (1 - s) exp(-2) = 2/e^2 - 1.
        let out = path(&PreslidingHysteresis, &[10.0, 0.01], &[0.0, 0.01, 0.5, 0.48]);
        let expected = [0.0, -10.0 * (1.0 - (-1.0_f64).exp()), -10.0, 10.0 - 20.0 * (-2.0_f64).exp()];
        for (found, expected) in out.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn many_small_steps_are_one_large_step() {
        let coarse = path(&PreslidingHysteresis, &[10.0, 0.01], &[0.0, 0.02]);
        let fine: Vec<f64> = (0..=200).map(|i| 1e-4 * f64::from(i)).collect();
        let fine = path(&PreslidingHysteresis, &[10.0, 0.01], &fine);
        assert!((coarse[1] - fine[200]).abs() < 1e-9);
    }
}
