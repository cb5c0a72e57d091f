//! Evaluation in blocks: the residuals, their triangular linearisation `|J p + r|^2 = |R p + q|^2 + rest^2`, and the gradient `J^T r`.
//!
//! Blocks are combined in a fixed binary tree, so that the sums are the same bytes for any number of threads.

use super::LeastSquaresError;
use super::residuals::Residuals;
use super::singular::right_singular;
use super::triangle::Triangle;
use crate::vector::{dot, norm};
use std::ops::Range;

/// Residuals at a point, linearised.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// Triangular factor of the Jacobian, `k x k`.
    pub(super) r: Triangle,
    /// The residuals transformed by the same reflections: the first `k` entries.
    pub(super) q: Vec<f64>,
    /// Sum of squares.
    pub(super) cost: f64,
    /// Norms of the Jacobian's columns.
    pub(super) norms: Vec<f64>,
    /// Singular values and right vectors of the Jacobian with columns divided by their norms.
    singular: Vec<(f64, Vec<f64>)>,
}

/// A problem at a point: its residuals and their derivatives, as a triangle.
#[derive(Debug, Clone)]
pub struct Linearisation {
    pub(super) theta: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    pub(super) linear: Linear,
}

impl Linearisation {
    /// Evaluates a problem.
    ///
    /// # Errors
    /// If the number of parameters is wrong, the problem has no value there, or residuals or derivatives aren't finite.
    pub fn at<P: Residuals>(problem: &P, theta: &[f64]) -> Result<Self, LeastSquaresError<P::Error>> {
        if theta.len() != problem.parameters() {
            let what =
                format!("a point has {} numbers; the problem has {}", theta.len(), problem.parameters());
            return Err(LeastSquaresError::Request(what));
        }
        let mut residuals = vec![0.0; problem.rows()];
        let linear = linearise(problem, theta, &mut residuals)?;
        Ok(Self { theta: theta.to_vec(), residuals, linear })
    }

    /// The sum of squares.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.linear.cost
    }
}

/// Weight of the rows that pin flat directions: far above rounding errors, but small enough not to disturb a
/// step along a bound, which may need a component in a flat direction.
const PIN: f64 = 1e-5;

/// Rows of a block that are triangularised at once, so that the workspace fits into the cache.
const ROWS: usize = 4096;

impl Linear {
    /// `J^T r`, half the gradient of the sum of squares.
    pub(super) fn gradient(&self) -> Vec<f64> {
        self.r.transposed_times(&self.q)
    }

    /// The triangle with columns divided by their norms, and a right-hand side for it, for steps without a
    /// component in flat directions. Those directions are removed from both and pinned, because rounding
    /// errors dominate the triangle there.
    pub(super) fn regular(&self, rhs: &[f64], tolerance: f64) -> (Triangle, Vec<f64>) {
        let k = self.norms.len();
        let inverse: Vec<f64> = self.norms.iter().map(|n| if *n > 0.0 { 1.0 / n } else { 0.0 }).collect();
        let scaled = self.r.scaled(&inverse);
        let largest = self.singular.first().map_or(0.0, |pair| pair.0);
        let is_flat = |sigma: f64| sigma <= tolerance * largest;
        if !self.singular.iter().any(|(sigma, _)| is_flat(*sigma)) {
            return (scaled, rhs.to_vec());
        }
        let mut columns = vec![0.0; k * (k + 1)];
        for (i, (sigma, v)) in self.singular.iter().enumerate() {
            let flat = is_flat(*sigma);
            let weight = if flat { PIN * largest } else { *sigma };
            for j in 0..k {
                columns[j * k + i] = weight * v[j];
            }
            columns[k * k + i] = if flat { 0.0 } else { dot(&scaled.times(v), rhs) / sigma };
        }
        let whole = Triangle::of_columns(&mut columns, k, k + 1);
        (whole.leading(k), whole.column(k)[..k].to_vec())
    }
}

/// Evaluates blocks of rows and merges their results in a tree that only depends on the numbers of rows.
fn in_blocks<T: Send, E: Send>(
    residuals: &mut [f64],
    first: usize,
    block: usize,
    leaf: &(impl Fn(Range<usize>, &mut [f64]) -> Result<T, E> + Sync),
    merge: &(impl Fn(T, T) -> T + Sync),
) -> Result<T, E> {
    let blocks = residuals.len().div_ceil(block);
    if blocks <= 1 {
        return leaf(first..first + residuals.len(), residuals);
    }
    let split = blocks / 2 * block;
    let (left, right) = residuals.split_at_mut(split);
    let (left, right) = rayon::join(
        || in_blocks(left, first, block, leaf, merge),
        || in_blocks(right, first + split, block, leaf, merge),
    );
    Ok(merge(left?, right?))
}

fn finite<E>(rows: &Range<usize>, residuals: &[f64]) -> Result<(), LeastSquaresError<E>> {
    match residuals.iter().position(|r| !r.is_finite()) {
        Some(i) => Err(LeastSquaresError::NotFinite(format!(
            "residual {} is {} at the start; choose a start where all residuals are finite",
            rows.start + i,
            residuals[i]
        ))),
        None => Ok(()),
    }
}

/// Writes the residuals and returns their sum of squares.
pub(super) fn values<P: Residuals>(
    problem: &P,
    theta: &[f64],
    residuals: &mut [f64],
) -> Result<f64, LeastSquaresError<P::Error>> {
    let leaf = |rows: Range<usize>, residuals: &mut [f64]| {
        problem.evaluate(theta, rows.clone(), residuals, None).map_err(LeastSquaresError::Start)?;
        finite(&rows, residuals)?;
        Ok(dot(residuals, residuals))
    };
    let cost = in_blocks(residuals, 0, problem.block().max(1), &leaf, &|a, b| a + b)?;
    if cost.is_finite() { Ok(cost) } else { Err(LeastSquaresError::overflow()) }
}

/// `Q^T w` for the reflections `Q` that triangularise the Jacobian at `theta`: the first `k` entries.
pub(super) fn turned<P: Residuals>(
    problem: &P,
    theta: &[f64],
    w: &[f64],
) -> Result<Vec<f64>, LeastSquaresError<P::Error>> {
    let mut residuals = vec![0.0; w.len()];
    let (whole, _) = triangle(problem, theta, &mut residuals, Some(w))?;
    Ok(whole.column(theta.len())[..theta.len()].to_vec())
}

/// Residuals and Jacobian of a block, both finite.
fn derivatives<P: Residuals>(
    problem: &P,
    theta: &[f64],
    rows: &Range<usize>,
    residuals: &mut [f64],
) -> Result<Vec<f64>, LeastSquaresError<P::Error>> {
    let k = theta.len();
    let mut jacobian = vec![0.0; rows.len() * k];
    problem
        .evaluate(theta, rows.clone(), residuals, Some(&mut jacobian))
        .map_err(LeastSquaresError::Start)?;
    finite(rows, residuals)?;
    match jacobian.iter().position(|x| !x.is_finite()) {
        Some(i) => Err(LeastSquaresError::NotFinite(format!(
            "the derivative of residual {} by parameter {} is {} at the start; choose a start where all derivatives are finite",
            rows.start + i / k,
            i % k,
            jacobian[i]
        ))),
        None => Ok(jacobian),
    }
}

/// Writes the residuals and linearises them.
pub(super) fn linearise<P: Residuals>(
    problem: &P,
    theta: &[f64],
    residuals: &mut [f64],
) -> Result<Linear, LeastSquaresError<P::Error>> {
    let k = theta.len();
    let (whole, cost) = triangle(problem, theta, residuals, None)?;
    let r = whole.leading(k);
    let q = whole.column(k)[..k].to_vec();
    let norms = r.column_norms();
    if !cost.is_finite() || norms.iter().chain(&q).any(|x| !x.is_finite()) {
        return Err(LeastSquaresError::overflow());
    }
    let column = |j: usize| -> Vec<f64> {
        let inverse = if norms[j] > 0.0 { 1.0 / norms[j] } else { 0.0 };
        (0..k).map(|i| r.at(i, j) * inverse).collect()
    };
    let singular = right_singular((0..k).map(column).collect());
    Ok(Linear { r, q, cost, norms, singular })
}

/// The triangle of the Jacobian with one more column, which is the residuals or `last`; and the sum of
/// squares of the residuals.
fn triangle<P: Residuals>(
    problem: &P,
    theta: &[f64],
    residuals: &mut [f64],
    last: Option<&[f64]>,
) -> Result<(Triangle, f64), LeastSquaresError<P::Error>> {
    let k = theta.len();
    let leaf = |rows: Range<usize>, residuals: &mut [f64]| {
        let jacobian = derivatives(problem, theta, &rows, residuals)?;
        let last = last.map_or(&*residuals, |last| &last[rows]);
        Ok((factored(&jacobian, last, k), dot(residuals, residuals)))
    };
    let merge = |a: (Triangle, f64), b: (Triangle, f64)| (a.0.above(b.0), a.1 + b.1);
    in_blocks(residuals, 0, problem.block().max(1), &leaf, &merge)
}

/// The triangle of a block's Jacobian with one more column. A block of many rows is split in a tree that only
/// depends on their number.
fn factored(jacobian: &[f64], last: &[f64], k: usize) -> Triangle {
    let m = last.len();
    if m > ROWS {
        let half = m / 2;
        let (above, below) = jacobian.split_at(half * k);
        let (first, second) = last.split_at(half);
        let (above, below) = rayon::join(|| factored(above, first, k), || factored(below, second, k));
        return above.above(below);
    }
    let mut columns = vec![0.0; m * (k + 1)];
    for (i, row) in jacobian.chunks_exact(k.max(1)).enumerate() {
        for (j, x) in row.iter().enumerate() {
            columns[j * m + i] = *x;
        }
    }
    columns[k * m..].copy_from_slice(last);
    Triangle::of_columns(&mut columns, m, k + 1)
}

/// `J^T r`, half the gradient of the sum of squares.
pub(super) fn gradient<P: Residuals>(
    problem: &P,
    theta: &[f64],
) -> Result<Vec<f64>, LeastSquaresError<P::Error>> {
    let k = theta.len();
    let leaf = |rows: Range<usize>, residuals: &mut [f64]| {
        let jacobian = derivatives(problem, theta, &rows, residuals)?;
        let mut sum = vec![0.0; k];
        for (row, r) in jacobian.chunks_exact(k.max(1)).zip(residuals.iter()) {
            sum.iter_mut().zip(row).for_each(|(s, x)| *s += x * r);
        }
        Ok(sum)
    };
    let merge = |mut a: Vec<f64>, b: Vec<f64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    let mut residuals = vec![0.0; problem.rows()];
    let sum = in_blocks(&mut residuals, 0, problem.block().max(1), &leaf, &merge)?;
    if norm(&sum).is_finite() { Ok(sum) } else { Err(LeastSquaresError::overflow()) }
}

/// Decrease of the sum of squares from `old` to `new` residuals, `sum (r - r')(r + r')`. Near a minimum this
/// is far more accurate than the difference of two sums.
pub(super) fn decrease(old: &[f64], new: &[f64]) -> f64 {
    let mut parts = Vec::with_capacity(old.len().div_ceil(4096));
    for (old, new) in old.chunks(4096).zip(new.chunks(4096)) {
        parts.push(old.iter().zip(new).map(|(a, b)| (a - b) * (a + b)).sum::<f64>());
    }
    parts.iter().sum()
}
