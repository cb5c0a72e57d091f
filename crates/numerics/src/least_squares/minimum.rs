//! The result of a search: the parameters, why the search ended there, and how well the residuals determine
//! them.

use super::linear::Linear;
use super::residuals::{Bounds, Side};
use super::singular::right_singular;
use super::step::Step;
use crate::vector::norm;

/// Directions in which the residuals change by less than this fraction of the largest change are flat, with
/// parameters scaled by the norms of their columns. No step is made along them, and they are reported.
pub(super) const RANK_TOLERANCE: f64 = 1e-10;
/// A parameter isn't determined by the residuals if its component of a flat direction (a unit vector) exceeds
/// this.
const PART_OF_FLAT: f64 = 1e-6;

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The residuals are orthogonal to the tangent space of the free parameters, within
    /// [`super::Options::tolerance`].
    Orthogonal,
    /// The step to the linearised minimum changes the residuals by less than rounding the parameters does;
    /// the residuals are near zero.
    StepBelowRounding,
    /// The linearised minimum is lower by less than the rounding error of the sum of squares or
    /// [`super::Options::least_decrease`], and the step to it was rejected; or the gradient is zero as exactly
    /// as sums of squares tell, and a nearly singular Jacobian promises a decrease that isn't there.
    DecreaseTooSmall,
    /// All residuals are zero.
    ExactFit,
    /// Nothing to vary: no parameters, or all of them fixed.
    NothingFree,
    /// [`super::Options::max_evaluations`] was reached. Not converged.
    Budget,
    /// Steps were shortened until they promised less than [`super::Options::least_decrease`], and none
    /// lowered the sum of squares. The minimum is at a kink of the residuals, where no derivative vanishes.
    /// It isn't a stationary point, so the search hasn't converged.
    Kink,
    /// No step, however short, lowers the sum of squares although the derivatives promise it. They are wrong
    /// or too inaccurate, or the residuals jump or can't be evaluated beyond. Not converged.
    Stagnated,
    /// A stationary point with a direction of descent that the search couldn't leave. Not converged.
    Saddle,
}

impl Reason {
    /// Whether the search ended at a minimum.
    #[must_use]
    pub fn is_converged(self) -> bool {
        !matches!(self, Self::Budget | Self::Kink | Self::Stagnated | Self::Saddle)
    }
}

/// Properties of the end of a search. "Scaled" parameters are multiplied by the norms of their columns of the
/// Jacobian.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Whether this is a minimum; without [`super::Options::check_curvature`] a stationary point.
    pub converged: bool,
    /// Why the search ended.
    pub reason: Reason,
    /// Largest `|cos|` of the angle between the residuals and a column of the Jacobian, over the free parameters.
    pub gradient_cosine: f64,
    /// Length of the step to the linearised minimum within the bounds relative to the norm of the parameters, both scaled; the
    /// step wasn't made.
    pub relative_step: f64,
    /// Decrease of the sum of squares that this step promises, relative to the sum of squares.
    pub relative_decrease: f64,
    /// Number of directions among the free parameters that aren't flat.
    pub rank: usize,
    /// Ratio of the largest to the smallest singular value of the scaled Jacobian of the free parameters;
    /// infinite if the smallest is 0, and 1 without free parameters.
    pub condition: f64,
    /// Least second derivative of half the sum of squares along a unit direction of the scaled free
    /// parameters, from differences of gradients (1 for a linear problem with orthogonal columns). `None` if
    /// it wasn't requested or couldn't be computed.
    pub least_curvature: Option<f64>,
    /// The bound that holds each parameter: the parameter is at this bound, and the sum of squares doesn't
    /// decrease inwards. Fixed parameters are at their lower bound.
    pub at_bound: Vec<Option<Side>>,
    /// Flat directions as unit vectors of scaled parameters: the residuals don't determine the parameters
    /// along them. A parameter without any influence isn't scaled.
    pub flat: Vec<Vec<f64>>,
}

impl Certificate {
    /// Whether the residuals determine a parameter: it isn't held by a bound and has no component in a flat
    /// direction.
    ///
    /// # Panics
    /// If there is no such parameter.
    #[must_use]
    pub fn is_determined(&self, parameter: usize) -> bool {
        self.at_bound[parameter].is_none() && self.flat.iter().all(|v| v[parameter].abs() <= PART_OF_FLAT)
    }
}

/// The result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The parameters; those at a bound equal it exactly.
    pub theta: Vec<f64>,
    /// The residuals there.
    pub residuals: Vec<f64>,
    /// Their sum of squares.
    pub cost: f64,
    /// Number of accepted steps.
    pub iterations: usize,
    /// Evaluations of all residuals without derivatives.
    pub evaluations: usize,
    /// Evaluations of all residuals with derivatives.
    pub linearisations: usize,
    /// Triangular factor of the Jacobian (`R^T R = J^T J`), row-major, as many rows and columns as parameters.
    pub r: Vec<f64>,
    /// `J^T r`: half the gradient of the sum of squares; the multiplier of a bound that holds a parameter.
    pub gradient: Vec<f64>,
    /// Properties of this point.
    pub certificate: Certificate,
    /// `(J^T J)^-1` of the determined parameters.
    unit_covariance: Vec<f64>,
}

impl Minimum {
    /// Covariance of the parameters for residuals of a given variance, `variance (J^T J)^-1` in linear approximation; row-major,
    /// `k x k`.
    ///
    /// Rows and columns of parameters that are not [determined](Certificate::is_determined) are zero: those
    /// held by a bound count as known, and those in a flat direction have no finite variance.
    #[must_use]
    pub fn covariance(&self, variance: f64) -> Vec<f64> {
        self.unit_covariance.iter().map(|c| c * variance).collect()
    }

    /// Standard deviations for residuals of a given variance; `None` for parameters that are not [determined](Certificate::is_determined).
    #[must_use]
    pub fn standard_deviations(&self, variance: f64) -> Vec<Option<f64>> {
        let k = self.theta.len();
        (0..k)
            .map(|j| {
                self.certificate.is_determined(j).then(|| (self.unit_covariance[j * k + j] * variance).sqrt())
            })
            .collect()
    }

    /// Correlations of the parameters, row-major, `k x k`: 1 on the diagonal, 0 between parameters of which
    /// at least one isn't determined.
    #[must_use]
    pub fn correlation(&self) -> Vec<f64> {
        let k = self.theta.len();
        let c = |i: usize, j: usize| self.unit_covariance[i * k + j];
        let entry = |i, j| {
            if i == j {
                1.0
            } else if c(i, j) == 0.0 {
                0.0
            } else {
                (c(i, j) / (c(i, i).sqrt() * c(j, j).sqrt())).clamp(-1.0, 1.0)
            }
        };
        (0..k * k).map(|ij| entry(ij / k, ij % k)).collect()
    }
}

/// Final state of a search.
pub(super) struct End<'a> {
    pub(super) bounds: &'a Bounds,
    pub(super) reason: Reason,
    /// The step to the linearised minimum, scaled by the current norms.
    pub(super) newton: &'a Step,
    pub(super) least_curvature: Option<f64>,
    pub(super) iterations: usize,
    pub(super) evaluations: usize,
    pub(super) linearisations: usize,
}

/// The bound at which a step from `theta` holds each parameter.
pub(super) fn held_at(bounds: &Bounds, theta: &[f64], newton: &Step) -> Vec<Option<Side>> {
    (0..theta.len())
        .map(|j| match newton.held[j]? {
            _ if bounds.is_fixed(j) => Some(Side::Lower),
            _ if theta[j] <= bounds.lower[j] => Some(Side::Lower),
            _ if theta[j] >= bounds.upper[j] => Some(Side::Upper),
            _ => None,
        })
        .collect()
}

/// Largest `|cos|` of the angle between the residuals and a column of the Jacobian, over some parameters.
pub(super) fn gradient_cosine(linear: &Linear, of: impl Iterator<Item = usize>) -> f64 {
    let (gradient, length) = (linear.gradient(), linear.cost.sqrt());
    let cosine = |j: usize| part(gradient[j].abs(), linear.norms[j] * length);
    of.map(cosine).fold(0.0, f64::max)
}

/// Ratio of two nonnegative numbers, 0 for 0/0.
fn part(x: f64, of: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x / of }
}

impl End<'_> {
    /// Assembles the result for the caller.
    pub(super) fn minimum(self, theta: Vec<f64>, residuals: Vec<f64>, linear: &Linear) -> Minimum {
        let k = theta.len();
        let at_bound = held_at(self.bounds, &theta, self.newton);
        let free: Vec<usize> = (0..k).filter(|j| at_bound[*j].is_none()).collect();
        let gradient = linear.gradient();
        let scaled: Vec<f64> = theta.iter().zip(&linear.norms).map(|(t, n)| t * n).collect();
        let spectrum = Spectrum::new(linear, &free);
        let mut certificate = Certificate {
            converged: self.reason.is_converged(),
            reason: self.reason,
            gradient_cosine: gradient_cosine(linear, free.iter().copied()),
            relative_step: part(norm(&self.newton.z), norm(&scaled)),
            relative_decrease: part(self.newton.predicted, linear.cost).min(1.0),
            rank: spectrum.rank,
            condition: spectrum.condition(),
            least_curvature: self.least_curvature,
            at_bound,
            flat: Vec::new(),
        };
        certificate.flat = spectrum.flat(k);
        let unit_covariance = spectrum.inverse_gram(&linear.norms, &certificate);
        Minimum {
            unit_covariance,
            r: (0..k * k).map(|ij| linear.r.at(ij / k, ij % k)).collect(),
            gradient,
            cost: linear.cost,
            theta,
            residuals,
            iterations: self.iterations,
            evaluations: self.evaluations,
            linearisations: self.linearisations,
            certificate,
        }
    }
}

/// Singular values and right vectors of the scaled Jacobian of the free parameters.
struct Spectrum<'a> {
    free: &'a [usize],
    pairs: Vec<(f64, Vec<f64>)>,
    rank: usize,
}

impl<'a> Spectrum<'a> {
    fn new(linear: &Linear, free: &'a [usize]) -> Self {
        let k = linear.norms.len();
        let column = |j: usize| -> Vec<f64> {
            let scale = if linear.norms[j] > 0.0 { linear.norms[j] } else { 1.0 };
            (0..k).map(|i| linear.r.at(i, j) / scale).collect()
        };
        let pairs = right_singular(free.iter().map(|j| column(*j)).collect());
        let largest = pairs.first().map_or(0.0, |p| p.0);
        let rank = pairs.iter().filter(|p| p.0 > RANK_TOLERANCE * largest).count();
        Self { free, pairs, rank }
    }

    fn condition(&self) -> f64 {
        match (self.pairs.first(), self.pairs.last()) {
            (Some((_, _)), Some((0.0, _))) => f64::INFINITY,
            (Some((largest, _)), Some((smallest, _))) => largest / smallest,
            _ => 1.0,
        }
    }

    fn flat(&self, k: usize) -> Vec<Vec<f64>> {
        let spread = |v: &Vec<f64>| {
            let mut direction = vec![0.0; k];
            for (j, x) in self.free.iter().zip(v) {
                direction[*j] = *x;
            }
            direction
        };
        self.pairs[self.rank..].iter().map(|(_, v)| spread(v)).collect()
    }

    /// `D^-1 V Sigma^-2 V^T D^-1` over the directions that aren't flat, for the determined parameters.
    fn inverse_gram(&self, norms: &[f64], certificate: &Certificate) -> Vec<f64> {
        let k = norms.len();
        let mut inverse = vec![0.0; k * k];
        for (a, i) in self.free.iter().enumerate() {
            for (b, j) in self.free.iter().enumerate() {
                if certificate.is_determined(*i) && certificate.is_determined(*j) {
                    let sum: f64 = self.pairs[..self.rank].iter().map(|(s, v)| (v[a] / s) * (v[b] / s)).sum();
                    inverse[i * k + j] = sum / norms[*i] / norms[*j];
                }
            }
        }
        inverse
    }
}
