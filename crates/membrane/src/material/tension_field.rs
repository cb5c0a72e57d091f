//! Tension fields: a sheet that can't carry compression, because it wrinkles first.
//!
//! The relaxed energy of Pipkin and Steigmann is the least that the sheet can reach by fine wrinkles. With l1
//! >= l2, and the natural width n(l1) at which a strip pulled to l1 has no transverse stress,
//!
//! ```text
//! slack     l1 <= 1                W = 0
//! wrinkled  l2 <= n(l1)            W = W(l1, n(l1))
//! taut      otherwise              W = W(l1, l2)
//! ```
//!
//! Its first derivatives are continuous. Sources: A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85; D. J.
//! Steigmann, Proc. R. Soc. Lond. A 429 (1990) 141.

use super::law::{Energy, Law};
use serde::Serialize;

/// State of tension of a piece of membrane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tension {
    /// No tension.
    Slack,
    /// Tension in one direction.
    Wrinkled,
    /// Tension in every direction.
    Taut,
}

/// Energy at squared principal stretches, with the state of tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Principal {
    pub(crate) energy: Energy,
    pub(crate) tension: Tension,
}

/// The relaxed energy at any pair of squared stretches.
#[inline]
pub(crate) fn relaxed(law: &Law, c1: f64, c2: f64) -> Principal {
    if c1 < c2 {
        let Principal { energy: e, tension } = relaxed(law, c2, c1);
        let energy = Energy { w: e.w, w1: e.w2, w2: e.w1, w11: e.w22, w12: e.w12, w22: e.w11 };
        return Principal { energy, tension };
    }
    if c1 <= 1.0 {
        return Principal { energy: Energy::default(), tension: Tension::Slack };
    }
    let width = law.natural_width(c1);
    if c2 > width {
        return Principal { energy: law.energy(c1, c2), tension: Tension::Taut };
    }
    Principal { energy: uniaxial(law, c1, width), tension: Tension::Wrinkled }
}

/// Energy of a strip at its natural width: with dW/dc2 = 0 there, d2W/dc1^2 = w11 - w12^2/w22.
#[inline]
fn uniaxial(law: &Law, c: f64, width: f64) -> Energy {
    let e = law.energy(c, width);
    Energy { w: e.w, w1: e.w1, w11: e.w11 - e.w12 * e.w12 / e.w22, ..Energy::default() }
}

#[cfg(test)]
mod tests {
    use super::super::law::tests::LAWS;
    use super::*;

    /// Slack, wrinkled, taut, and both sides of each border.
    fn places(law: &Law) -> Vec<(f64, f64)> {
        let n = law.natural_width(1.4);
        vec![
            (0.9, 0.7),
            (1.4, 0.5),
            (0.4, 1.3),
            (1.5, 1.2),
            (1.4, n - 1e-4),
            (1.4, n + 1e-4),
            (1.0 + 1e-4, 0.4),
        ]
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        let h = 1e-6;
        for law in LAWS {
            for (c1, c2) in places(&law) {
                let e = relaxed(&law, c1, c2).energy;
                let at = |a: f64, b: f64| relaxed(&law, c1 + a, c2 + b).energy;
                for (given, expected) in [
                    (e.w1, (at(h, 0.0).w - at(-h, 0.0).w) / (2.0 * h)),
                    (e.w2, (at(0.0, h).w - at(0.0, -h).w) / (2.0 * h)),
                    (e.w11, (at(h, 0.0).w1 - at(-h, 0.0).w1) / (2.0 * h)),
                    (e.w12, (at(0.0, h).w1 - at(0.0, -h).w1) / (2.0 * h)),
                    (e.w22, (at(0.0, h).w2 - at(0.0, -h).w2) / (2.0 * h)),
                ] {
                    assert!((given - expected).abs() < 1e-7, "{law:?} {c1} {c2}: {given} {expected}");
                }
            }
        }
    }

    #[test]
    fn first_derivatives_are_continuous_across_the_borders() {
        for law in LAWS {
            let n = law.natural_width(1.4);
            for (c1, c2) in [(1.4, n), (1.0, 0.6)] {
                let (a, b) = (relaxed(&law, c1 - 1e-9, c2 - 1e-9), relaxed(&law, c1 + 1e-9, c2 + 1e-9));
                assert_ne!(a.tension, b.tension);
                for (x, y) in
                    [(a.energy.w, b.energy.w), (a.energy.w1, b.energy.w1), (a.energy.w2, b.energy.w2)]
                {
                    assert!((x - y).abs() < 1e-7, "{law:?} {c1} {c2}");
                }
            }
        }
    }

    #[test]
    fn relaxation_never_costs_energy_and_never_pushes() {
        for law in LAWS {
            for i in 1..40 {
                for j in 1..40 {
                    let (c1, c2) = (0.06 * f64::from(i), 0.06 * f64::from(j));
                    let Principal { energy: e, .. } = relaxed(&law, c1, c2);
                    assert!(e.w <= law.energy(c1, c2).w + 1e-15 && e.w >= 0.0, "{law:?} {c1} {c2}");
                    assert!(e.w1 >= -1e-15 && e.w2 >= -1e-15, "{law:?} {c1} {c2}");
                }
            }
        }
    }
}
