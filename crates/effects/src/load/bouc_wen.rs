//! Bouc-Wen: a smooth transition after each reversal, in closed form for n = 2 and beta = gamma (Bouc 1967,
//! Wen 1976; catalogue F8).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT};

/// `dz/d eps = (1 - z^2 (1 + sign(z d eps))/2)/delta`, `dF = -w z`.
///
/// In the family dz = A d eps - beta |d eps| |z|^(n-1) z - gamma d eps |z|^n this is n = 2 and beta = gamma =
/// A/2, with A = 1/delta. It is the common choice, with unloading in a straight line. n isn't fitted, because
/// data with ordinary noise don't determine it. Let u = z s with the direction s. While u is negative it
/// grows at the rate 1, and while it is positive at the rate 1 - u^2. A step of x = |d eps|/delta then has
/// the exact solution used here, and the force doesn't depend on the spacing of the rows:
///
/// ```text
/// u < 0:   u + x  up to 0, the rest of x from there
/// u >= 0:  tanh(artanh u + x) = (u + tanh x)/(1 + u tanh x)
/// ```
#[derive(Debug)]
pub(crate) struct BoucWen;

impl Effect for BoucWen {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bouc-wen",
            family: "presliding-hysteresis",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Hysteresis after Bouc and Wen",
            about: "Contacts give before they slide. After a reversal the friction first falls in a straight line, elastically, and then bends \
                    over smoothly into its value of the other sign.",
            equation: "dz/d eps = (1 - z^2 (1 + sign(z d eps))/2)/delta,   dF = -w z   (n = 2, beta = gamma = A/2)",
            source: "Bouc 1967, Wen 1976; solved in closed form between two rows",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "constant far from reversals, with a smooth transition within 3 delta after each",
            },
            twins: &[
                Twin { name: "maxwell-slip", how: "0.994" },
                Twin { name: "presliding-hysteresis", how: "same family; the shape of the transition" },
                Twin { name: "viscous-damping", how: "0.92 at one speed" },
            ],
            separate: "inner loops away from the middle: here they drift, with maxwell-slip they close",
            needs: Needs::Motion,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("force", NEWTON, (0.0, 200.0), 12.0, "friction far from a reversal")
                .prior(0.0, 20.0),
            ParameterCard::new("distance", PERCENT, (0.02, 10.0), 1.0, "contraction over which it unloads")
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

impl LoadEffect for BoucWen {
    fn act(&self, Row { theta, memory, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let turn = balance.turn;
        if turn.value() != 0.0 {
            let s = turn.value().signum();
            memory[0] = moved(memory[0] * s, turn * s / theta[1]) * s;
        }
        *force = *force - theta[0] * memory[0];
    }
}

/// The state u after a distance x >= 0 in the direction in which u grows.
fn moved(u: Jet, x: Jet) -> Jet {
    let straight = u + x;
    if straight.value() <= 0.0 {
        straight
    } else if u.value() < 0.0 {
        straight.tanh()
    } else {
        let t = x.tanh();
        (u + t) / (u * t + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::path;

    #[test]
    fn loading_bends_over_and_unloading_is_straight() {
        // tanh 1 = 0.761594 after one distance, and 1 far away. Back from +1 by half a distance: 1 - 0.5.
        // Back by two distances: 0 after one, then -tanh 1.
        let out = path(&BoucWen, &[10.0, 0.01], &[0.0, 0.01, 0.5, 0.495, 0.48]);
        for (found, expected) in out.iter().zip([0.0, -7.615_941_56, -10.0, -5.0, 7.615_941_56]) {
            assert!((found - expected).abs() < 1e-7, "{found} {expected}");
        }
    }

    #[test]
    fn the_rows_may_lie_at_any_distance() {
        let way = |n: u32, from: f64, to: f64| {
            (1..=n).map(move |i| from + (to - from) * f64::from(i) / f64::from(n))
        };
        let run = |n: u32| {
            let there: Vec<f64> =
                [0.0].into_iter().chain(way(n, 0.0, 0.013)).chain(way(n, 0.013, -0.004)).collect();
            path(&BoucWen, &[10.0, 0.01], &there).pop().unwrap()
        };
        assert!((run(1) - run(400)).abs() < 1e-11);
    }

    #[test]
    fn it_solves_its_differential_equation() {
        // 40000 steps of the midpoint rule along the same path.
        let out = path(&BoucWen, &[10.0, 0.01], &[0.0, 0.013, -0.004, 0.002]);
        let mut z = 0.0_f64;
        for (from, to) in [(0.0, 0.013), (0.013, -0.004), (-0.004, 0.002)] {
            let h: f64 = (to - from) / 40_000.0;
            let slope = |z: f64| (1.0 - z * z * (1.0 + (z * h).signum()) / 2.0) / 0.01;
            for _ in 0..40_000 {
                z += h * slope(z + 0.5 * h * slope(z));
            }
        }
        assert!((out[3] + 10.0 * z).abs() < 1e-6, "{} {z}", out[3]);
    }
}
