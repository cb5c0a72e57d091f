//! Interpolation and integration between Chebyshev's points (L. N. Trefethen, *Approximation Theory and Approximation Practice*, SIAM 2013, chapters 2 to 8).

use arrayvec::ArrayVec;
use bulge_numerics::gauss;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Intervals between Chebyshev's points: the first that is enough.
pub(super) const INTERVALS: [usize; 4] = [8, 16, 32, 64];
/// Points for the most intervals.
pub(super) const MOST: usize = 65;
/// Size of the last two Chebyshev coefficients, relative to the function, from which on it counts as resolved: the integrals then err by about the square root of the ratio of
/// two coefficients less.
const RESOLVED: f64 = 3e-12;

/// Chebyshev's points between 0 (mid-length) and 1 (fitting), with what interpolates and integrates between them.
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
        };
        grid.doubly = grid.places.iter().map(|x| grid.integrated(*x, |t| 1.0 - t)).collect();
        grid.singly = grid.integrated(1.0, |_| 1.0);
        grid
    }

    /// Weights of the values in the integral of a factor of t times f(t x) over t from 0 to 1.
    fn integrated(&self, x: f64, factor: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.places.len()];
        // Pieces on which the rule of six points is exact for polynomials of this degree, up to rounding.
        let pieces = self.places.len().div_ceil(4);
        for piece in 0..pieces {
            for (node, weight) in gauss::SIX {
                let t = (piece as f64 + node) / pieces as f64;
                let factor = weight / pieces as f64 * factor(t);
                for (sum, share) in weights.iter_mut().zip(self.shares(t * x)) {
                    *sum += factor * share;
                }
            }
        }
        weights
    }

    /// The weights of the values in the interpolated one at `x`: the barycentric formula.
    pub(super) fn shares(&self, x: f64) -> ArrayVec<f64, MOST> {
        let pairs = self.places.iter().zip(&self.weights);
        let mut shares: ArrayVec<f64, MOST> = pairs.map(|(place, weight)| weight / (x - place)).collect();
        let sum: f64 = shares.iter().sum();
        if sum.is_finite() {
            let per_sum = 1.0 / sum;
            shares.iter_mut().for_each(|share| *share *= per_sum);
        } else {
            // One of the points.
            shares.iter_mut().for_each(|share| *share = f64::from(u8::from(share.is_infinite())));
        }
        shares
    }

    /// Whether values at the points are those of a function that they resolve, where it counts against a `floor` too.
    pub(super) fn resolves(&self, values: &(impl Iterator<Item = f64> + Clone), floor: f64) -> bool {
        let sum = |weights: &[f64]| weights.iter().zip(values.clone()).map(|(w, v)| w * v).sum::<f64>().abs();
        let largest = values.clone().fold(floor.abs(), |largest: f64, value| largest.max(value.abs()));
        sum(&self.last[0]) + sum(&self.last[1]) <= RESOLVED * largest
    }
}

/// The grids of [`INTERVALS`].
pub(super) static GRIDS: LazyLock<[Grid; INTERVALS.len()]> = LazyLock::new(|| INTERVALS.map(Grid::new));
