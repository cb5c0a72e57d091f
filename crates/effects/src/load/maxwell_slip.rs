//! Maxwell slip: parallel springs, each of which slips at its own limit (Vo-Minh et al. 2011; catalogue F7).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT};

/// The distances at which the four elements begin to slip, relative to the last one.
const SLIPS_AT: [f64; 4] = [0.1, 0.25, 0.5, 1.0];

/// `z_i -> clamp(z_i + d eps/delta_i, -1, 1)`, `dF = -(w/4) (z_1 + z_2 + z_3 + z_4)`, with delta_i = delta
/// (0.1, 0.25, 0.5, 1).
///
/// The clamp is the stop operator of Prandtl and Ishlinskii. It is exact for a step of any length between two
/// rows, because the contraction moves in one direction between them.
#[derive(Debug)]
pub(crate) struct MaxwellSlip;

impl Effect for MaxwellSlip {
    fn card(&self) -> Card<'_> {
        Card {
            name: "maxwell-slip",
            family: "presliding-hysteresis",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction of elements that slip one after the other",
            about: "Contacts between strands and rubber stick, give elastically and let go, one sort after the other. After a reversal the \
                    friction goes over in straight pieces, and an inner loop that closes leaves no trace.",
            equation: "z_i -> clamp(z_i + d eps/delta_i, -1, 1),   dF = -(w/4) sum z_i,   delta_i = delta (0.1, 0.25, 0.5, 1)",
            source: "Iwan 1966; for fluidic muscles Vo-Minh et al. 2011 (four elements)",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "constant far from reversals, with a transition of straight pieces within 2 delta after each",
            },
            twins: &[
                Twin { name: "bouc-wen", how: "0.994" },
                Twin { name: "presliding-hysteresis", how: "same family; the shape of the transition" },
                Twin { name: "viscous-damping", how: "0.94 at one speed" },
                Twin { name: "standard-linear-solid", how: "0.92 at one speed" },
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
            ParameterCard::new(
                "distance",
                PERCENT,
                (0.02, 20.0),
                2.0,
                "contraction at which the last element slips",
            )
            .off_at(2.0)
            .logarithmic(),
        ]
    }

    fn memory(&self) -> usize {
        SLIPS_AT.len()
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for MaxwellSlip {
    fn act(&self, Row { theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let mut sum = Jet::from(0.0);
        for (z, part) in memory.iter_mut().zip(SLIPS_AT) {
            let moved = *z + balance.turn / part / theta[1];
            *z = if moved.value().abs() > 1.0 { Jet::from(moved.value().signum()) } else { moved };
            sum += *z;
        }
        *force = *force - theta[0] * sum / 4.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::path;

    #[test]
    fn elements_slip_one_after_the_other() {
        // With a reach of 2 % the elements slip at 0.2, 0.5, 1 and 2 %. At 0.5 % the force is (1 + 1 + 0.5 +
        // 0.25)/4 of the full one. Back by 0.4 % from full slip it is (-1 + 0.2 + 0.6 + 0.8)/4.
        let out = path(&MaxwellSlip, &[10.0, 0.02], &[0.0, 0.005, 0.05, 0.046]);
        for (found, expected) in out.iter().zip([0.0, -6.875, -10.0, -1.5]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn many_small_steps_are_one_large_step() {
        let fine: Vec<f64> = (0..=200).map(|i| 6e-5 * f64::from(i)).collect();
        let fine = path(&MaxwellSlip, &[10.0, 0.02], &fine);
        let coarse = path(&MaxwellSlip, &[10.0, 0.02], &[0.0, 0.012]);
        assert!((coarse[1] - fine[200]).abs() < 1e-11);
    }

    #[test]
    fn a_closed_inner_loop_is_wiped_out() {
        let direct = path(&MaxwellSlip, &[10.0, 0.02], &[0.0, 0.05, 0.04, 0.06]);
        let detour = path(&MaxwellSlip, &[10.0, 0.02], &[0.0, 0.05, 0.04, 0.045, 0.04, 0.06]);
        assert!((direct[3] - detour[5]).abs() < 1e-12 && (direct[2] - detour[4]).abs() < 1e-12);
    }
}
