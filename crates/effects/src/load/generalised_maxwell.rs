//! Generalised Maxwell solid: rubber with two relaxation times (Wiechert 1893; the relaxing part of Burgers'
//! solid).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::relaxed::relaxed;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, NUMBER, PERCENT, SECOND};

/// `q_i' = k_i eps' - q_i/tau_i`, `dF = -q_1 - q_2`, with k_1 = (1 - w) k, k_2 = w k and tau_2 = m tau_1.
///
/// This is exact between two rows if the contraction is linear in time ([`relaxed`]). The slow time is a
/// multiple of the fast one, so that the two can't be exchanged.
#[derive(Debug)]
pub(crate) struct GeneralisedMaxwell;

impl Effect for GeneralisedMaxwell {
    fn card(&self) -> Card<'_> {
        Card {
            name: "generalised-maxwell",
            family: "creep",
            mechanism: Mechanism::Relaxation,
            form: Form::Loose,
            title: "Rubber that relaxes in two times",
            about: "Rubber yields quickly at first and then for long: a part of its stiffness relaxes within a time tau, another within a multiple \
                    of it. Loops open at slow and at quick speeds alike, and a hold looks nearly logarithmic over two decades.",
            equation: "dq_i/dt = k_i d eps/dt - q_i/tau_i,   dF = -q_1 - q_2,   k_1 = (1 - w) k, k_2 = w k, tau_2 = m tau_1,   q_i = 0 when a sweep begins",
            source: "Wiechert 1893, two elements; exact for a contraction that runs straight between two rows",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Mixed,
                shape: "follows the contraction and forgets it within two times",
            },
            twins: &[
                Twin {
                    name: "standard-linear-solid",
                    how: "0.95 to 0.998: one time in the middle of the two",
                },
                Twin { name: "creep", how: "0.95 in a hold, beside a force-offset" },
                Twin { name: "viscous-damping", how: "at one speed" },
            ],
            separate: "a hold of three decades of time after a quick step; the same loop at three speeds a factor of ten apart",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let stiffness = "force per contraction of a quick motion";
        vec![
            ParameterCard::new("stiffness", NEWTON, (0.0, 1e4), 150.0, stiffness)
                .prior(0.0, 300.0)
                .plausible(0.0, 3e3),
            ParameterCard::new("share", PERCENT, (0.0, 100.0), 50.0, "part of it that relaxes slowly")
                .plausible(5.0, 95.0)
                .off_at(50.0),
            ParameterCard::new("time", SECOND, (0.1, 1e4), 3.0, "time within which the quick part relaxes")
                .plausible(0.3, 300.0)
                .off_at(3.0)
                .logarithmic(),
            ParameterCard::new("ratio", NUMBER, (2.0, 1e4), 10.0, "slow time over quick time")
                .plausible(3.0, 300.0)
                .off_at(10.0)
                .logarithmic(),
        ]
    }

    fn memory(&self) -> usize {
        2
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for GeneralisedMaxwell {
    fn act(&self, Row { moment, theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let [stiffness, share, time, ratio] = [theta[0], theta[1], theta[2], theta[3]];
        // The memory omits the factor k, so that the derivative by k exists at k = 0.
        memory[0] = relaxed(memory[0], balance.turn, moment.since, time);
        memory[1] = relaxed(memory[1], balance.turn, moment.since, time * ratio);
        *force = *force - stiffness * (memory[0] * (-share + 1.0) + memory[1] * share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::standard_linear_solid::StandardLinearSolid;
    use crate::probe::path;

    /// 40 % of 150 N relaxes in 20 s, the rest in 2 s.
    const NUMBERS: [f64; 4] = [150.0, 0.4, 2.0, 10.0];

    #[test]
    fn a_ramp_and_the_hold_after_it() {
        // 1 %/s for 3 s, then rest: k_i tau_i v (1 - exp(-t/tau_i)), which decays with each time constant.
        let rows: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i.min(3))).collect();
        for (t, found) in path(&GeneralisedMaxwell, &NUMBERS, &rows).into_iter().enumerate() {
            let t = t as f64;
            let part = |k: f64, tau: f64| {
                let built = k * tau * 0.01 * (1.0 - (-t.min(3.0) / tau).exp());
                built * (-(t - 3.0).max(0.0) / tau).exp()
            };
            let expected = -part(90.0, 2.0) - part(60.0, 20.0);
            assert!((found - expected).abs() < 1e-12, "{t}: {found} {expected}");
        }
    }

    #[test]
    fn with_one_part_it_is_the_standard_linear_solid() {
        let rows = [0.0, 0.02, 0.05, 0.05, 0.03, 0.03, 0.03];
        for (share, time) in [(0.0, 2.0), (1.0, 20.0)] {
            let two = path(&GeneralisedMaxwell, &[150.0, share, 2.0, 10.0], &rows);
            let one = path(&StandardLinearSolid, &[150.0, time], &rows);
            for (two, one) in two.iter().zip(one) {
                assert!((two - one).abs() < 1e-12, "{share}: {two} {one}");
            }
        }
    }
}
