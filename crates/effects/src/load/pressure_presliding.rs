//! Pressure presliding: strands stick and give before they slide, pressed together by the gas (the limit is
//! from Tondu and Lopez 2000, the transition from Dahl 1968).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::dragged::dragged;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON_PER_BAR, PERCENT};

/// `h -> clamp(s w + (h - s w) exp(-|dx|/delta), -w, w)`, `w = mu p`, `dF = -h`, where x is the turn of the
/// strands.
///
/// The memory holds the traction h itself, not its ratio to the limit. Contacts that stick keep their
/// traction while the pressure rises. While it falls they lose the traction that exceeds the limit.
#[derive(Debug)]
pub(crate) struct PressurePresliding;

impl Effect for PressurePresliding {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-presliding",
            family: "pressure-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction in proportion to the pressure that builds up after a reversal",
            about: "The gas presses the strands onto each other. They stick, give within a distance delta and then slide, at a friction in \
                    proportion to the pressure. In a test at held length the strands turn only as far as fibres and bladder give: the loop is \
                    narrower there than at held pressure, and the force is smaller while filling than while venting.",
            equation: "h -> clamp(s w + (h - s w) exp(-|dx|/delta), -w, w),   w = mu p,   dF = -h,   dx = d eps + what the pressure turns, s = sign(dx)",
            source: "limit in proportion to the pressure: Chou and Hannaford 1996, Tondu and Lopez 2000; way there: Dahl 1968; no source states \
                     a law for presliding that the pressure drives",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Odd,
                shape: "constant far from reversals, with a transition of length delta after each",
            },
            twins: &[
                Twin { name: "pressure-friction", how: "where delta is much shorter than the stroke" },
                Twin { name: "presliding-hysteresis", how: "0.90 from 1 to 5 bar" },
                Twin { name: "bladder-hysteresis", how: "in filling and venting from 0 bar at one length" },
                Twin { name: "pressure-viscosity", how: "0.90 at one speed" },
            ],
            separate: "the same loop ten times slower against viscosity; filling and venting at three lengths, from 0 and from 2 bar, against the \
                       bladder: its loop is gone from 2 bar on and vanishes at rest length, this one doesn't",
            needs: Needs::Motion,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "coefficient",
                NEWTON_PER_BAR,
                (0.0, 100.0),
                1.5,
                "friction far from a reversal, per pressure",
            )
            .prior(0.0, 3.0)
            .plausible(0.0, 30.0),
            // At held length the strands of a clamped braid turn by some 0.06 %/bar, so that 0.2 bar of
            // presliding is 0.012 %.
            ParameterCard::new("distance", PERCENT, (0.01, 10.0), 0.3, "contraction over which it builds up")
                .plausible(0.01, 3.0)
                .off_at(0.3)
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

impl LoadEffect for PressurePresliding {
    fn act(&self, Row { theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        // Traction and limit are stored per coefficient \[Pa\], so that the derivative by the coefficient
        // exists where it is 0.
        let limit = balance.pressure;
        memory[0] = dragged(memory[0], balance.turn, theta[1], limit);
        if memory[0].value().abs() > limit.value() {
            memory[0] = limit * memory[0].value().signum();
        }
        *force = *force - theta[0] * memory[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::probe::{balance, path};

    #[test]
    fn it_builds_up_to_a_limit_in_proportion_to_the_pressure() {
        // 1.5 N/bar at 2 bar over one distance gives 3 N (1 - 1/e), and far away 3 N. Back by two distances:
        // 3 - 6 exp(-2)... with the other sign.
        let out = path(&PressurePresliding, &[1.5e-5, 0.01], &[0.0, 0.01, 0.5, 0.48]);
        let expected = [0.0, -3.0 * (1.0 - (-1.0_f64).exp()), -3.0, 3.0 - 6.0 * (-2.0_f64).exp()];
        for (found, expected) in out.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn stuck_contacts_keep_their_traction_up_to_the_limit() {
        // The strands slide at 6 bar, are vented to 1 bar without a turn and filled again. The traction
        // follows the limit down and doesn't come back.
        let mut memory = [Jet::from(0.0)];
        let mut run = |bar: f64, turn: f64| {
            let balance = Balance { pressure: Jet::from(bar * 1e5), turn: Jet::from(turn), ..balance(0.1) };
            let mut force = Jet::from(0.0);
            let moment = Moment::at_rest(bar * 1e5, 0.1);
            let theta = [1e-5, 0.001].map(Jet::from);
            PressurePresliding.act(
                Row { moment: &moment, setting: &crate::probe::SETTING, theta: &theta, memory: &mut memory },
                &balance,
                &mut force,
            );
            force.value()
        };
        let found = [run(6.0, 0.1), run(3.0, 0.0), run(1.0, 0.0), run(6.0, 0.0)];
        for (found, expected) in found.into_iter().zip([-6.0, -3.0, -1.0, -1.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn many_small_steps_are_one_large_step() {
        let fine: Vec<f64> = (0..=200).map(|i| 1e-4 * f64::from(i)).collect();
        let fine = path(&PressurePresliding, &[1.5e-5, 0.01], &fine);
        let coarse = path(&PressurePresliding, &[1.5e-5, 0.01], &[0.0, 0.02]);
        assert!((coarse[1] - fine[200]).abs() < 1e-11);
    }
}
