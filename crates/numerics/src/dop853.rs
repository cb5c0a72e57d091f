//! Adaptive Runge-Kutta integration of order 8 with error estimates of order 5 and 3 (DOP853), for autonomous systems of fixed size.
//!
//! E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer 1993, section II.10.
//!
//! The state is an array, so that a solve allocates nothing; the scalar is [`Real`], so that the same steps carry exact
//! derivatives. Step sizes are chosen from the values alone. The caller owns the loop: it decides what follows a step
//! (an event, an output point, the end), and passes a step size that may itself have derivatives.

use crate::Real;
use crate::dop853_coefficients::{A, B, E3, E5};

/// Limits of the factor between two step sizes, and the safety factor of the controller (the book's values).
const SHRINK: f64 = 0.333;
const GROW: f64 = 6.0;
const SAFETY: f64 = 0.9;
/// A step smaller than this fraction of the remaining interval is given up, because rounding would absorb it.
const SMALLEST: f64 = 1e-14;

/// The adaptive step of the integrator: the size to try next, and counters.
#[derive(Debug, Clone)]
pub struct Dop853 {
    /// Size of the next step to try.
    pub step: f64,
    /// Tolerance relative to the scale that the caller gives for each component.
    pub tolerance: f64,
    /// Accepted steps.
    pub accepted: u32,
    /// Evaluations of the right-hand side.
    pub evaluations: u32,
}

/// No step size, however small, met the tolerance: the right-hand side is singular or not finite.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the integration stalled at step size {step:e}: the right-hand side is singular or not finite")]
pub struct Stalled {
    /// The last step size tried.
    pub step: f64,
}

#[inline]
fn combine<D: Real, const N: usize, const M: usize>(y: &[D; N], h: D, terms: [(f64, &[D; N]); M]) -> [D; N] {
    std::array::from_fn(|n| {
        let sum = terms.iter().fold(D::from(0.0), |sum, (a, k)| k[n].scale_add(*a, sum));
        y[n] + h * sum
    })
}

/// One step of size `h` without error estimate: the new state. `k1` is the right-hand side at `y`.
pub fn step<D: Real, const N: usize>(
    f: &mut impl FnMut(&[D; N]) -> [D; N],
    y: &[D; N],
    k1: &[D; N],
    h: D,
) -> [D; N] {
    step_with_errors(f, y, k1, h).0
}

/// The new state and the two error estimates divided by `h`.
#[inline]
fn step_with_errors<D: Real, const N: usize>(
    f: &mut impl FnMut(&[D; N]) -> [D; N],
    y: &[D; N],
    k1: &[D; N],
    h: D,
) -> ([D; N], [f64; N], [f64; N]) {
    let k2 = f(&combine(y, h, [(A[1][0], k1)]));
    let k3 = f(&combine(y, h, [(A[2][0], k1), (A[2][1], &k2)]));
    let k4 = f(&combine(y, h, [(A[3][0], k1), (A[3][2], &k3)]));
    let k5 = f(&combine(y, h, [(A[4][0], k1), (A[4][2], &k3), (A[4][3], &k4)]));
    let k6 = f(&combine(y, h, [(A[5][0], k1), (A[5][3], &k4), (A[5][4], &k5)]));
    let k7 = f(&combine(y, h, [(A[6][0], k1), (A[6][3], &k4), (A[6][4], &k5), (A[6][5], &k6)]));
    let k8 =
        f(&combine(y, h, [(A[7][0], k1), (A[7][3], &k4), (A[7][4], &k5), (A[7][5], &k6), (A[7][6], &k7)]));
    let a = &A[8];
    let k9 = f(&combine(y, h, [(a[0], k1), (a[3], &k4), (a[4], &k5), (a[5], &k6), (a[6], &k7), (a[7], &k8)]));
    let a = &A[9];
    let k10 = f(&combine(
        y,
        h,
        [(a[0], k1), (a[3], &k4), (a[4], &k5), (a[5], &k6), (a[6], &k7), (a[7], &k8), (a[8], &k9)],
    ));
    let a = &A[10];
    let k11 = f(&combine(
        y,
        h,
        [
            (a[0], k1),
            (a[3], &k4),
            (a[4], &k5),
            (a[5], &k6),
            (a[6], &k7),
            (a[7], &k8),
            (a[8], &k9),
            (a[9], &k10),
        ],
    ));
    let a = &A[11];
    let k12 = f(&combine(
        y,
        h,
        [
            (a[0], k1),
            (a[3], &k4),
            (a[4], &k5),
            (a[5], &k6),
            (a[6], &k7),
            (a[7], &k8),
            (a[8], &k9),
            (a[9], &k10),
            (a[10], &k11),
        ],
    ));
    // Stages 2 to 5 have no weight in the solution and in both error estimates.
    let used = [(0, k1), (5, &k6), (6, &k7), (7, &k8), (8, &k9), (9, &k10), (10, &k11), (11, &k12)];
    let new = combine(y, h, used.map(|(i, k)| (B[i], k)));
    let estimate = |weights: &[f64; 12]| -> [f64; N] {
        std::array::from_fn(|n| used.iter().map(|(i, k)| weights[*i] * k[n].value()).sum())
    };
    (new, estimate(&E5), estimate(&E3))
}

impl Dop853 {
    /// An integrator that will try `step` first and keeps the local error of each component below `tolerance` times its scale.
    #[must_use]
    pub const fn new(step: f64, tolerance: f64) -> Self {
        Self { step, tolerance, accepted: 0, evaluations: 0 }
    }

    /// Advances `y` by one accepted step of at most `limit` and returns its size; `scale(y_old, y_new)` gives the size of
    /// each component against which its error counts.
    ///
    /// `k1` is the right-hand side at `y`; on success both are moved to the new point.
    ///
    /// # Errors
    /// [`Stalled`] if no step size meets the tolerance; `y` and `k1` are then unchanged.
    pub fn advance<D: Real, const N: usize>(
        &mut self,
        f: &mut impl FnMut(&[D; N]) -> [D; N],
        scale: impl Fn(&[D; N], &[D; N]) -> [f64; N],
        y: &mut [D; N],
        k1: &mut [D; N],
        limit: D,
    ) -> Result<D, Stalled> {
        let sign = if limit.value() < 0.0 { -1.0 } else { 1.0 };
        let mut rejected = false;
        while self.step > SMALLEST * limit.value().abs() {
            let whole = self.step >= limit.value().abs();
            let h = if whole { limit } else { D::from(sign * self.step) };
            let (new, e5, e3) = step_with_errors(f, y, k1, h);
            let slope = f(&new);
            self.evaluations += 12;
            let error = h.value().abs() * norm(&e5, &e3, &scale(y, &new)) / self.tolerance;
            let is_finite = new.iter().chain(&slope).all(|v| v.value().is_finite());
            if error <= 1.0 && is_finite {
                *y = new;
                *k1 = slope;
                self.accepted += 1;
                let grow = if rejected { 1.0 } else { GROW };
                // A step cut short by the limit doesn't tell how large a step the error would have allowed.
                let next = h.value().abs() * (SAFETY * error.powf(-0.125)).clamp(SHRINK, grow);
                if !whole || next < self.step {
                    self.step = next;
                }
                return Ok(h);
            }
            rejected = true;
            // If the end point itself isn't finite, a small error estimate means nothing; without this the
            // step would never get shorter.
            let says_something = error.is_finite() && is_finite;
            let factor = if says_something { (SAFETY * error.powf(-0.125)).max(SHRINK) } else { SHRINK };
            self.step = h.value().abs() * factor;
        }
        Err(Stalled { step: self.step })
    }
}

/// Hairer's combination of the fifth- and third-order estimates, of order 8 in `h`.
fn norm<const N: usize>(e5: &[f64; N], e3: &[f64; N], scale: &[f64; N]) -> f64 {
    let mut s5 = 0.0;
    let mut s3 = 0.0;
    for n in 0..N {
        s5 += (e5[n] / scale[n]).powi(2);
        s3 += (e3[n] / scale[n]).powi(2);
    }
    if s5 == 0.0 && s3 == 0.0 {
        return 0.0;
    }
    s5 / ((s5 + 0.01 * s3) * N as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// A pendulum, whose energy v^2/2 - cos(q) is constant and whose derivatives do not vanish.
    fn pendulum<D: Real>(y: &[D; 2]) -> [D; 2] {
        [y[1], -y[0].sin_cos().0]
    }

    fn fixed_steps(n: u32) -> [f64; 2] {
        let h = 6.0 / f64::from(n);
        let mut y = [1.0, 0.5];
        for _ in 0..n {
            let k1 = pendulum(&y);
            y = step(&mut |y| pendulum(y), &y, &k1, h);
        }
        y
    }

    /// A right-hand side that ends at x = 1: the last steps are tiny, but their number is limited.
    #[test]
    fn a_slope_that_is_none_ends_the_way() {
        let mut f = |y: &[f64; 1]| [if y[0] > 1.0 { f64::NAN } else { 1.0 }];
        let mut solver = Dop853::new(0.3, 1e-10);
        let (mut y, mut k1) = ([0.0], [1.0]);
        let mut steps = 0;
        let stalled = loop {
            match solver.advance(&mut f, |_, _| [1.0], &mut y, &mut k1, 10.0) {
                Ok(_) => steps += 1,
                Err(stalled) => break stalled,
            }
            assert!(steps < 1000);
        };
        assert!(y[0] <= 1.0 && y[0] > 1.0 - 1e-6 && stalled.step < 1e-10, "{y:?} {stalled:?}");
    }

    #[test]
    fn order_is_eight() {
        let exact = fixed_steps(128);
        let error = |n| (fixed_steps(n)[0] - exact[0]).hypot(fixed_steps(n)[1] - exact[1]);
        let order = (error(8) / error(16)).log2();
        assert!((order - 8.0).abs() < 0.3, "observed order {order}, errors {:e} {:e}", error(8), error(16));
    }

    /// Row sums of `A` must equal the nodes, and sum(b c^k) = 1/(k + 1) up to order 8 (quadrature conditions).
    #[test]
    fn coefficients_satisfy_the_quadrature_conditions() {
        let c: Vec<f64> = A.iter().map(|row| row.iter().sum()).collect();
        for k in 0..8 {
            let sum: f64 = (0..12).map(|i| B[i] * c[i].powi(k)).sum();
            assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-14, "order {}", k + 1);
        }
        assert!(E3.iter().sum::<f64>().abs() < 1e-14 && E5.iter().sum::<f64>().abs() < 1e-14);
    }

    #[test]
    fn adaptive_steps_keep_the_energy() {
        let mut y = [1.0, 0.5];
        let energy = |y: &[f64; 2]| 0.5 * y[1] * y[1] - y[0].cos();
        let before = energy(&y);
        let mut f = |y: &[f64; 2]| pendulum(y);
        let mut k1 = f(&y);
        let mut run = Dop853::new(0.1, 1e-12);
        let mut time = 0.0;
        while time < 20.0 {
            time += run.advance(&mut f, |_, _| [1.0, 1.0], &mut y, &mut k1, 20.0 - time).unwrap();
        }
        let drift = (energy(&y) - before).abs();
        assert!(drift < 1e-11 && run.accepted < 160, "drift {drift:e} in {} steps", run.accepted);
    }

    #[test]
    fn derivatives_with_respect_to_start_and_end() {
        let run = |q: Dual<2>, end: Dual<2>| {
            let mut y = [q, Dual::from(0.5)];
            let mut f = |y: &[Dual<2>; 2]| pendulum(y);
            let mut k1 = f(&y);
            let mut run = Dop853::new(0.1, 1e-13);
            let mut time = Dual::from(0.0);
            while time.value() < end.value() {
                let h = run.advance(&mut f, |_, _| [1.0, 1.0], &mut y, &mut k1, end - time).unwrap();
                time += h;
            }
            y[0]
        };
        let value = |q: f64, end: f64| run(Dual::from(q), Dual::from(end)).value();
        let exact = run(Dual::variable(1.0, 0), Dual::variable(3.0, 1));
        let h = 1e-4;
        let dq = (value(1.0 + h, 3.0) - value(1.0 - h, 3.0)) / (2.0 * h);
        let de = (value(1.0, 3.0 + h) - value(1.0, 3.0 - h)) / (2.0 * h);
        // Differences: h^2/6 times a third derivative of order one.
        assert!((exact.gradient()[0] - dq).abs() < 1e-8);
        assert!((exact.gradient()[1] - de).abs() < 1e-8);
    }

    #[test]
    // y' = 1 is undefined beyond y = 1.
    fn a_singularity_stalls_with_its_step() {
        let mut y = [0.0];
        let mut f = |y: &[f64; 1]| [if y[0] < 1.0 { 1.0 } else { f64::NAN }];
        let mut k1 = f(&y);
        let mut run = Dop853::new(0.1, 1e-10);
        let mut time = 0.0;
        let stalled = loop {
            match run.advance(&mut f, |_, _| [1.0], &mut y, &mut k1, 2.0 - time) {
                Ok(h) => time += h,
                Err(stalled) => break stalled,
            }
            assert!(run.accepted < 10_000);
        };
        assert!(stalled.step < 1e-12 && (time - 1.0).abs() < 1e-12, "{stalled} at {time}");
    }

    /// Hairer's II.10.18: err = h |E5|^2 / sqrt(|E5|^2 + 0.01 |E3|^2), root mean squares over the components.
    #[test]
    fn both_estimates_are_weighed() {
        // Squares: 0.6^2 + 0.2^2 = 0.4 and 1.2^2 + 0.4^2 = 1.6.
        let error = norm(&[0.3, 0.4], &[0.6, 0.8], &[0.5, 2.0]);
        assert!((error - 0.4 / (2.0_f64 * (0.4 + 0.016)).sqrt()).abs() < 1e-15, "{error}");
        assert!(norm(&[0.0, 0.0], &[0.0, 0.0], &[1.0, 1.0]).abs() < 1e-300);
    }

    #[test]
    fn a_first_step_too_large_or_too_small_soon_has_the_size_that_the_tolerance_allows() {
        let mut calls = 0;
        let mut f = |y: &[f64; 2]| {
            calls += 1;
            assert!(calls < 1000, "no step is accepted");
            pendulum(y)
        };
        let (mut evaluations, mut sizes) = (0, vec![]);
        for first in [1e-3, 0.3, 30.0] {
            let (mut y, mut run) = ([1.0, 0.5], Dop853::new(first, 1e-10));
            let mut k1 = pendulum(&y);
            for _ in 0..6 {
                run.advance(&mut f, |_, _| [1.0, 1.0], &mut y, &mut k1, 100.0).unwrap();
            }
            assert_eq!(run.accepted, 6);
            // Each rejection divides a step by three at most, and a step after it does not grow.
            assert!(run.evaluations <= 12 * 12, "{first}: {} evaluations", run.evaluations);
            evaluations += run.evaluations;
            sizes.push(run.step);
        }
        assert_eq!(calls, evaluations);
        let [least, most] = [f64::min, f64::max].map(|of| sizes.iter().copied().reduce(of).unwrap());
        assert!(most < 2.0 * least, "{sizes:?}");
    }

    #[test]
    fn a_step_that_the_limit_cuts_leaves_the_size_unless_its_error_asks_for_less() {
        let mut f = |y: &[f64; 2]| pendulum(y);
        let after = |f: &mut dyn FnMut(&[f64; 2]) -> [f64; 2], tolerance: f64| {
            let mut y = [1.0, 0.5];
            let (mut k1, mut run) = (pendulum(&y), Dop853::new(0.5, tolerance));
            let h = run.advance(&mut |y: &[f64; 2]| f(y), |_, _| [1.0, 1.0], &mut y, &mut k1, 0.45).unwrap();
            (h, run.step)
        };
        assert_eq!(after(&mut f, 1e-6), (0.45, 0.5));
        // The least tolerance that lets this step pass: the next one is shorter.
        let just = (0..200)
            .map(|n| 1e-6 * 0.9_f64.powi(n))
            .take_while(|tolerance| after(&mut f, *tolerance).0 >= 0.45)
            .last();
        let next = after(&mut f, just.unwrap()).1;
        assert!(next < 0.43 && next > 0.4, "{next}");
    }
}
