//! Standard linear solid: a spring that relaxes in series with a dashpot (Zener; catalogue R3).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::relaxed::relaxed;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, SECOND};

/// `q' = k eps' - q/tau`, `dF = -q`, with q = 0 at the beginning of a sweep.
///
/// This is exact between two rows if the contraction is linear in time ([`relaxed`]).
#[derive(Debug)]
pub(crate) struct StandardLinearSolid;

impl Effect for StandardLinearSolid {
    fn card(&self) -> Card<'_> {
        Card {
            name: "standard-linear-solid",
            family: "creep",
            mechanism: Mechanism::Relaxation,
            form: Form::Loose,
            title: "Rubber that relaxes",
            about: "Rubber answers a quick motion stiffly and then yields within a time tau. Slow loops don't show it, fast ones see a \
                    spring, and in between the loop opens; in a hold the force comes back by itself.",
            equation: "dq/dt = k d eps/dt - q/tau,   dF = -q,   q = 0 when a sweep begins",
            source: "Zener 1948; exact for a contraction that runs straight between two rows",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Mixed,
                shape: "follows the contraction and forgets it within tau",
            },
            twins: &[
                Twin { name: "viscous-damping", how: "0.94 at one speed (tau 30 s)" },
                Twin { name: "maxwell-slip", how: "0.92 at one speed" },
                Twin { name: "membrane-axial", how: "0.9 where the sweep is much shorter than tau" },
                Twin { name: "creep", how: "similar in a hold" },
                Twin { name: "generalised-maxwell", how: "0.95 to 0.998: one time in the middle of its two" },
            ],
            separate: "a second speed (0.14 at twenty times the speed); a hold after a quick step",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "stiffness",
                NEWTON,
                (0.0, 1e4),
                150.0,
                "force per contraction of a quick motion",
            )
            .prior(0.0, 300.0)
            .plausible(0.0, 3e3),
            ParameterCard::new("time", SECOND, (0.1, 1e4), 30.0, "time within which it relaxes")
                .plausible(1.0, 1e3)
                .off_at(30.0)
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

impl LoadEffect for StandardLinearSolid {
    fn act(&self, Row { moment, theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        // The memory omits the factor k, so that the derivative by k exists at k = 0.
        memory[0] = relaxed(memory[0], balance.turn, moment.since, theta[1]);
        *force = *force - theta[0] * memory[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::probe::path;
    use bulge_numerics::Real;

    #[test]
    fn it_builds_up_and_is_forgotten() {
        // 1 % in 1 s with tau = 2 s gives 150 N 0.01 2 (1 - exp(-1/2)), followed at rest by a factor of
        // exp(-1/2) per second.
        let out = path(&StandardLinearSolid, &[150.0, 2.0], &[0.0, 0.01, 0.01, 0.01]);
        let first = 3.0 * (1.0 - (-0.5_f64).exp());
        for (found, expected) in
            out.iter().zip([0.0, -first, -first * (-0.5_f64).exp(), -first * (-1.0_f64).exp()])
        {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn quick_motion_meets_a_spring_and_slow_motion_a_dashpot() {
        // tau = 1e6 s gives k d, and tau = 1 ms gives k tau d/t.
        let out = path(&StandardLinearSolid, &[150.0, 1e6], &[0.0, 0.01, 0.02]);
        assert!((out[2] + 3.0).abs() < 1e-5);
        let out = path(&StandardLinearSolid, &[150.0, 1e-3], &[0.0, 0.01, 0.02]);
        assert!((out[2] + 150.0 * 1e-3 * 0.01).abs() < 1e-12);
    }

    #[test]
    fn many_small_steps_are_one_large_step() {
        let run = |n: u32| {
            let mut memory = [Jet::from(0.0)];
            let mut force = Jet::from(0.0);
            for _ in 0..n {
                let mut moment = Moment::at_rest(2e5, 0.1);
                moment.since = 60.0 / f64::from(n);
                force = Jet::from(0.0);
                let balance = Balance { turn: Jet::from(0.05 / f64::from(n)), ..crate::probe::balance(0.1) };
                StandardLinearSolid.act(
                    Row {
                        moment: &moment,
                        setting: &crate::probe::SETTING,
                        theta: &[150.0, 30.0].map(Jet::from),
                        memory: &mut memory,
                    },
                    &balance,
                    &mut force,
                );
            }
            force.value()
        };
        assert!((run(1) - run(777)).abs() < 1e-11);
        assert!((run(1) + 150.0 * 0.05 * (1.0 - (-2.0_f64).exp()) / 2.0).abs() < 1e-12);
    }
}
