//! Tests whether a stationary point is a minimum, by second derivatives from differences and a search along
//! negative curvature.
//!
//! The Jacobian alone can't tell: `r = x^2 - 1` is stationary at its maximum of squares, `x = 0`.

use super::linear::{decrease, gradient, values};
use super::minimum::held_at;
use super::residuals::Residuals;
use super::search::{Search, product};
use super::singular::symmetric_eigen;
use crate::vector::norm;

/// Step of the differences of gradients, relative to the parameter: truncation and rounding errors are each
/// about 1e-5 of the curvature.
const DIFFERENCE: f64 = 1e-5;
/// Curvature is examined if it is below minus this fraction of the largest one.
const NEGATIVE: f64 = 1e-6;
/// Lengths tried along a direction, each a quarter of the one before.
const LENGTHS: i32 = 14;

/// The result of examining a stationary point.
pub(super) enum Probe {
    /// Nothing lower was found; the smallest curvature, if it could be computed.
    Minimum(Option<f64>),
    /// A lower point, its distance in the scale of the search, and the negative curvature in its direction.
    Lower { theta: Vec<f64>, length: f64, curvature: f64 },
}

/// Examines the current point of a search.
pub(super) fn probe<P: Residuals>(search: &mut Search<'_, P>) -> Probe {
    let held = held_at(search.bounds, &search.theta, &search.newton());
    let free: Vec<usize> = (0..held.len()).filter(|j| held[*j].is_none()).collect();
    let scale = scales(search);
    let Some(hessian) = hessian(search, &free, &scale) else { return Probe::Minimum(None) };
    let eigen = symmetric_eigen(hessian);
    let (Some((least, direction)), Some((most, _))) = (eigen.first(), eigen.last()) else {
        return Probe::Minimum(None);
    };
    if *least >= -NEGATIVE * most.abs().max(1.0) {
        return Probe::Minimum(Some(*least));
    }
    let mut step = vec![0.0; held.len()];
    for (j, v) in free.iter().zip(direction) {
        step[*j] = v / scale[*j];
    }
    match lower_point(search, &step, &scale, *least) {
        Some((theta, length)) => Probe::Lower { theta, length, curvature: *least },
        None => Probe::Minimum(Some(*least)),
    }
}

/// Scales of the parameters: norms of their columns, now or before. For parameters that never had any
/// influence, the scale that makes a step as long as the residuals.
fn scales<P: Residuals>(search: &Search<'_, P>) -> Vec<f64> {
    let length = search.linear.cost.sqrt();
    let scale = |j: usize| {
        let size = if search.theta[j] == 0.0 { 1.0 } else { search.theta[j].abs() };
        let fallback = if length > 0.0 { length / size } else { 1.0 / size };
        [search.linear.norms[j], search.scale[j]].into_iter().find(|s| *s > 0.0).unwrap_or(fallback)
    };
    (0..search.theta.len()).map(scale).collect()
}

/// Second derivatives of half the sum of squares by the scaled free parameters.
fn hessian<P: Residuals>(search: &mut Search<'_, P>, free: &[usize], scale: &[f64]) -> Option<Vec<Vec<f64>>> {
    let here = search.linear.gradient();
    let size = norm(&product(scale, &search.theta)).max(search.linear.cost.sqrt());
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(free.len());
    for j in free {
        let (at, lower, upper) = (search.theta[*j], search.bounds.lower[*j], search.bounds.upper[*j]);
        let wish = DIFFERENCE * if at == 0.0 { size / scale[*j] } else { at.abs() };
        // One-sided, inwards, near a bound.
        let ends = [(at + wish).min(upper), (at - wish).max(lower)];
        let end = if ends[0] - at >= at - ends[1] { ends[0] } else { ends[1] };
        let mut theta = search.theta.clone();
        theta[*j] = end;
        search.linearisations += 1;
        let there = gradient(search.problem, &theta).ok()?;
        let row = free.iter().map(|i| (there[*i] - here[*i]) / scale[*i] / ((end - at) * scale[*j]));
        rows.push(row.collect());
        if rows.last()?.iter().any(|x| !x.is_finite()) {
            return None;
        }
    }
    let n = free.len();
    let symmetric = |i: usize, j: usize| 0.5 * (rows[i][j] + rows[j][i]);
    Some((0..n).map(|i| (0..n).map(|j| symmetric(i, j)).collect()).collect())
}

/// A point along `step` or against it that is lower by a large part of the decrease that the curvature
/// predicts, and its scaled distance.
fn lower_point<P: Residuals>(
    search: &mut Search<'_, P>,
    step: &[f64],
    scale: &[f64],
    curvature: f64,
) -> Option<(Vec<f64>, f64)> {
    let size = norm(&product(scale, &search.theta)).max(search.linear.cost.sqrt());
    let mut residuals = vec![0.0; search.residuals.len()];
    for i in 0..LENGTHS {
        for sign in [1.0, -1.0] {
            let length = 0.25_f64.powi(i) * size;
            let moved = |j: usize| {
                (search.theta[j] + sign * length * step[j])
                    .clamp(search.bounds.lower[j], search.bounds.upper[j])
            };
            let theta: Vec<f64> = (0..step.len()).map(moved).collect();
            search.evaluations += 1;
            if values(search.problem, &theta, &mut residuals).is_ok()
                && decrease(&search.residuals, &residuals) > -0.1 * curvature * length * length
            {
                return Some((theta, length));
            }
        }
    }
    None
}
