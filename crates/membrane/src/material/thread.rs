//! Threads: fibres and cables that carry tension only.
//!
//! Energy per unit unstretched length at the stretch l, with a tension T0 at l = 1. T0 is zero for an elastic
//! thread; for an inextensible one it is the multiplier of an augmented Lagrangian, updated until l = 1:
//!
//! ```text
//! T(l) = max(0, T0 + EA (l - 1)),   phi = (T^2 - T0^2)/(2 EA)
//! ```

use serde::Serialize;

/// A thread, or several combined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Thread {
    /// EA in N.
    Elastic {
        /// EA, N.
        stiffness: f64,
    },
    /// Its length never changes while it is taut.
    Inextensible,
}

/// Energy per unit length, with its derivatives by the stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pull {
    pub(crate) energy: f64,
    pub(crate) tension: f64,
    pub(crate) stiffness: f64,
}

/// The tension of a thread of stiffness EA with multiplier T0.
#[inline]
pub(crate) fn pull(stiffness: f64, t0: f64, stretch: f64) -> Pull {
    let tension = t0 + stiffness * (stretch - 1.0);
    if tension <= 0.0 {
        return Pull { energy: -0.5 * t0 * t0 / stiffness, tension: 0.0, stiffness: 0.0 };
    }
    // (T^2 - T0^2)/(2 EA) without cancellation.
    let energy = 0.5 * (tension + t0) * (stretch - 1.0);
    Pull { energy, tension, stiffness }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tension_is_the_derivative_of_the_energy() {
        for t0 in [0.0, 2.0] {
            for l in [0.7, 0.98, 1.0 + 1e-7, 1.02, 1.3] {
                let h = 1e-6;
                let [a, b] = [pull(7.0, t0, l + h), pull(7.0, t0, l - h)];
                let now = pull(7.0, t0, l);
                assert!(((a.energy - b.energy) / (2.0 * h) - now.tension).abs() < 1e-5, "{t0} {l}");
                if (l - 1.0).abs() > h {
                    assert!(((a.tension - b.tension) / (2.0 * h) - now.stiffness).abs() < 1e-7, "{t0} {l}");
                }
            }
        }
    }
}
