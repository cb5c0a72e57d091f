//! Interpolation and integration between Chebyshev's points (L. N. Trefethen, *Approximation Theory and
//! Approximation Practice*, SIAM 2013, chapters 2 to 8).

use arrayvec::ArrayVec;
use bulge_numerics::{Real, gauss};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Intervals between Chebyshev's points. The first number that is enough is used.
pub(super) const INTERVALS: [usize; 4] = [8, 16, 32, 64];
/// Points for the most intervals.
pub(super) const MOST: usize = 65;
/// Size of the last two Chebyshev coefficients, relative to the function, below which the function counts as
/// resolved. The integrals then err by about the square root of the ratio of two coefficients less.
pub(super) const RESOLVED: f64 = 3e-12;

/// Chebyshev's points between 0 (mid-length) and 1 (fitting), with the weights for interpolation and
/// integration between them.
pub(super) struct Grid {
    pub(super) places: Vec<f64>,
    /// Barycentric weights.
    weights: Vec<f64>,
    /// Row i: weights of the values in the integral of (1 - t) f(t x_i) over t from 0 to 1.
    pub(super) doubly: Vec<Vec<f64>>,
    /// Weights of the values in the integral from 0 to 1.
    pub(super) singly: Vec<f64>,
    /// Weights of the values in the last two Chebyshev coefficients.
    last: [Vec<f64>; 2],
    /// Row k: weights of the values in coefficient k of the Chebyshev series of the integrals of `doubly`.
    pub(super) series: Vec<Vec<f64>>,
}

impl Grid {
    fn new(intervals: usize) -> Self {
        let angle = |i: usize| PI * i as f64 / intervals as f64;
        let half = |i: usize| if i == 0 || i == intervals { 0.5 } else { 1.0 };
        let weight = |i: usize| if i.is_multiple_of(2) { half(i) } else { -half(i) };
        let of_all = |f: &dyn Fn(usize) -> f64| (0..=intervals).map(f).collect::<Vec<_>>();
        let mut grid = Self {
            places: of_all(&|i| (0.5 * angle(i)).sin().powi(2)),
            weights: of_all(&weight),
            doubly: Vec::new(),
            singly: Vec::new(),
            last: [
                of_all(&|i| weight(i) / intervals as f64),
                of_all(&|i| 2.0 * weight(i) * angle(i).cos() / intervals as f64),
            ],
            series: Vec::new(),
        };
        grid.doubly = (0..=intervals).map(|i| grid.integrated(i, |t| 1.0 - t)).collect();
        grid.singly = grid.integrated(intervals, |_| 1.0);
        // Coefficient k of values at the points: the sum of (2/n) cos(k (pi - angle)) f, halved at both ends.
        let coefficient = |k: usize| {
            let of_value =
                of_all(&|i| 2.0 * half(k) * half(i) / intervals as f64 * (k as f64 * (PI - angle(i))).cos());
            let mut row = vec![0.0; intervals + 1];
            for (weight, doubly) in of_value.iter().zip(&grid.doubly) {
                row.iter_mut().zip(doubly).for_each(|(sum, value)| *sum += weight * value);
            }
            row
        };
        grid.series = (0..=intervals).map(coefficient).collect();
        grid
    }

    /// Weights of the values in the integral of a factor of t times f(t x) over t from 0 to 1, where x is the
    /// point number `last`.
    ///
    /// In the angle of `x = sin^2(angle/2)` the polynomials change no faster at the ends than in between. On
    /// one interval the highest one passes through half a period. The rule of six points integrates that to
    /// 1e-9 (at half the degree to 1e-12).
    fn integrated(&self, last: usize, factor: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.places.len()];
        if last == 0 {
            // All of the way lies at the first place; both factors are positive and linear.
            weights[0] = factor(0.5);
            return weights;
        }
        let end = self.places[last];
        let angle = PI / (self.places.len() - 1) as f64;
        for piece in 0..last {
            for (node, weight) in gauss::SIX {
                let at = angle * (piece as f64 + node);
                let t = (0.5 * at).sin().powi(2) / end;
                let factor = weight * angle * 0.5 * at.sin() / end * factor(t);
                for (sum, share) in weights.iter_mut().zip(self.shares(t * end)) {
                    *sum += factor * share;
                }
            }
        }
        weights
    }

    /// The weights of the values in the interpolated value at `x` (barycentric formula).
    pub(super) fn shares(&self, x: f64) -> ArrayVec<f64, MOST> {
        let pairs = self.places.iter().zip(&self.weights);
        let mut shares: ArrayVec<f64, MOST> = pairs.map(|(place, weight)| weight / (x - place)).collect();
        let sum: f64 = shares.iter().sum();
        if sum.is_finite() {
            let per_sum = 1.0 / sum;
            shares.iter_mut().for_each(|share| *share *= per_sum);
        } else {
            // `x` is one of the points.
            shares.iter_mut().for_each(|share| *share = f64::from(u8::from(share.is_infinite())));
        }
        shares
    }

    /// Whether the points resolve the function with these values. Its size is at least `floor` in this test.
    pub(super) fn resolves(&self, values: &(impl Iterator<Item = f64> + Clone), floor: f64) -> bool {
        let sum = |weights: &[f64]| weights.iter().zip(values.clone()).map(|(w, v)| w * v).sum::<f64>().abs();
        let largest = values.clone().fold(floor.abs(), |largest: f64, value| largest.max(value.abs()));
        sum(&self.last[0]) + sum(&self.last[1]) <= RESOLVED * largest
    }
}

/// The value at `x` of a Chebyshev series between 0 and 1 (Clenshaw's recurrence).
#[inline]
pub(super) fn value<D: Real>(series: &[D], x: f64) -> D {
    let Some((first, rest)) = series.split_first() else { return D::from(0.0) };
    let (t, zero) = (2.0 * x - 1.0, D::from(0.0));
    let (one, two) = rest
        .iter()
        .rev()
        .fold((zero, zero), |(one, two), coefficient| (one.scale_add(2.0 * t, *coefficient - two), one));
    one.scale_add(t, *first - two)
}

/// The grids of [`INTERVALS`].
pub(super) static GRIDS: LazyLock<[Grid; INTERVALS.len()]> = LazyLock::new(|| INTERVALS.map(Grid::new));

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights against the integrals of Chebyshev's polynomials of every degree that a grid resolves:
    /// T_k(2 x - 1) by differences of its antiderivatives, and twice by those of these.
    #[test]
    fn polynomials_are_integrated_to_the_highest_degree() {
        let polynomial = |k: i32, x: f64| (f64::from(k) * (2.0 * x - 1.0).acos()).cos();
        // By x; k = 0 and 1 are asked for at larger k only.
        let once = |k: i32, x: f64| {
            0.25 * (polynomial(k + 1, x) / f64::from(k + 1) - polynomial(k - 1, x) / f64::from(k - 1))
        };
        let twice =
            |k: i32, x: f64| 0.25 * (once(k + 1, x) / f64::from(k + 1) - once(k - 1, x) / f64::from(k - 1));
        for (grid, intervals) in GRIDS.iter().zip(INTERVALS) {
            let sum = |weights: &[f64], k: i32| -> f64 {
                weights.iter().zip(&grid.places).map(|(weight, x)| weight * polynomial(k, *x)).sum()
            };
            let degrees = i32::try_from(intervals).unwrap();
            for k in 3..=degrees {
                // The highest coefficients are nearly nothing.
                let most = if 2 * k <= degrees { 1e-12 } else { 1e-8 };
                let whole = once(k, 1.0) - once(k, 0.0);
                let off = (sum(&grid.singly, k) - whole).abs();
                assert!(off < most, "T_{k} of {intervals} intervals: {off:e}");
                for (weights, x) in grid.doubly.iter().zip(&grid.places).skip(intervals / 2) {
                    let exact = (twice(k, *x) - twice(k, 0.0)) / (x * x) - once(k, 0.0) / x;
                    let off = (sum(weights, k) - exact).abs();
                    assert!(off < most, "T_{k} of {intervals} intervals, up to {x}: {off:e}");
                }
            }
            // The series of the doubly integrated values passes through them.
            let values: Vec<f64> = grid.places.iter().map(|x| (2.0 * x).exp()).collect();
            let of_values = |row: &Vec<f64>| row.iter().zip(&values).map(|(w, v)| w * v).sum::<f64>();
            let series: Vec<f64> = grid.series.iter().map(of_values).collect();
            for (row, x) in grid.doubly.iter().zip(&grid.places) {
                assert!((value(&series, *x) - of_values(row)).abs() < 1e-13 * of_values(row));
            }
            // Near the first place the values are one.
            assert!((sum(&grid.doubly[0], 0) - 0.5).abs() < 1e-15);
            assert!((sum(&grid.doubly[1], 0) - 0.5).abs() < 1e-14);
        }
    }
}
