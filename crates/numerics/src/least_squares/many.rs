//! Searches from several starts: the best result, the result of each start, and the distinct minima.

use super::linear::values;
use super::minimum::{Minimum, Reason};
use super::residuals::{Bounds, Residuals};
use super::search::{failed_start, minimise};
use super::triangle::norm;
use super::{LeastSquaresError, Options};
use rayon::prelude::*;

/// Two results are the same minimum if their residuals differ, to first order, by at most this fraction of
/// their norm,
const SAME: f64 = 1e-5;
/// or their scaled parameters by at most this fraction if the residuals vanish.
const SAME_PARAMETERS: f64 = 1e-8;

/// The end of the search from one start.
#[derive(Debug, Clone, PartialEq)]
pub struct StartEnd {
    /// The parameters.
    pub theta: Vec<f64>,
    /// The sum of squares.
    pub cost: f64,
    /// Why it ended.
    pub reason: Reason,
    /// Evaluations of all residuals, with and without derivatives.
    pub evaluations: usize,
}

/// A minimum that some of the starts lead to.
#[derive(Debug, Clone, PartialEq)]
pub struct DistinctMinimum {
    /// The parameters, from the start with the lowest end.
    pub theta: Vec<f64>,
    /// The sum of squares.
    pub cost: f64,
    /// Indices of the starts (from 0) that lead here.
    pub starts: Vec<usize>,
}

/// The results of several starts.
#[derive(Debug, Clone, PartialEq)]
pub struct ManyStarts<E> {
    /// The end with the least sum of squares. Among equal ones (to nine digits) a converged one is preferred,
    /// then the first.
    pub best: Minimum,
    /// The ends in the order of the starts.
    pub ends: Vec<Result<StartEnd, LeastSquaresError<E>>>,
    /// The distinct minima among the converged searches, lowest first.
    pub minima: Vec<DistinctMinimum>,
}

/// Searches from every start, in parallel. The result doesn't depend on the number of threads.
///
/// # Errors
/// [`LeastSquaresError::NoStart`], or the error of the first start if none can be used.
pub fn minimise_from_many<P: Residuals>(
    problem: &P,
    starts: &[Vec<f64>],
    bounds: &Bounds,
    options: &Options,
) -> Result<ManyStarts<P::Error>, LeastSquaresError<P::Error>> {
    let mut found: Vec<_> = starts
        .par_iter()
        .map(|start| {
            let mut minimum = minimise(problem, start, bounds, options)?;
            // Many long residual vectors would need too much memory; those of the best result are computed
            // again.
            minimum.residuals = Vec::new();
            Ok(minimum)
        })
        .collect();
    let ends = found.iter_mut().map(|result| match result {
        Ok(minimum) => Ok(StartEnd {
            theta: minimum.theta.clone(),
            cost: minimum.cost,
            reason: minimum.certificate.reason,
            evaluations: minimum.evaluations + minimum.linearisations,
        }),
        Err(error) => Err(std::mem::replace(error, LeastSquaresError::NoStart)),
    });
    let mut ends: Vec<_> = ends.collect();
    let minima: Vec<(usize, &Minimum)> =
        found.iter().enumerate().filter_map(|(i, result)| Some((i, result.as_ref().ok()?))).collect();
    let Some(least) = minima.iter().map(|(_, m)| m.cost).min_by(f64::total_cmp) else {
        return Err(if ends.is_empty() {
            LeastSquaresError::NoStart
        } else {
            ends.swap_remove(0).err().unwrap_or(LeastSquaresError::NoStart)
        });
    };
    let as_low = || minima.iter().filter(|(_, m)| m.cost <= least * (1.0 + 1e-9));
    let chosen = as_low().find(|(_, m)| m.certificate.converged).or_else(|| as_low().next());
    let mut best = chosen.map(|(_, m)| (*m).clone()).ok_or(LeastSquaresError::NoStart)?;
    best.residuals = vec![0.0; problem.rows()];
    values(problem, &best.theta, &mut best.residuals).map_err(failed_start)?;
    Ok(ManyStarts { minima: distinct(&minima), best, ends })
}

/// Groups the converged ends by minimum, lowest first.
fn distinct(ends: &[(usize, &Minimum)]) -> Vec<DistinctMinimum> {
    let mut converged: Vec<_> = ends.iter().filter(|(_, m)| m.certificate.converged).collect();
    converged.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost).then(a.0.cmp(&b.0)));
    let mut groups: Vec<(&Minimum, Vec<usize>)> = Vec::new();
    for (start, minimum) in converged {
        match groups.iter_mut().find(|(first, _)| is_same(first, minimum)) {
            Some((_, starts)) => starts.push(*start),
            None => groups.push((minimum, vec![*start])),
        }
    }
    let finished = |(minimum, mut starts): (&Minimum, Vec<usize>)| {
        starts.sort_unstable();
        DistinctMinimum { theta: minimum.theta.clone(), cost: minimum.cost, starts }
    };
    groups.into_iter().map(finished).collect()
}

/// Whether an end is the minimum `first`, which is at least as low. Differences along flat directions are
/// ignored.
fn is_same(first: &Minimum, other: &Minimum) -> bool {
    let k = first.theta.len();
    let changes = |x: &[f64]| {
        let row = |i: usize| first.r[i * k..(i + 1) * k].iter().zip(x).map(|(r, x)| r * x).sum::<f64>();
        norm(&(0..k).map(row).collect::<Vec<_>>())
    };
    let difference: Vec<f64> = first.theta.iter().zip(&other.theta).map(|(a, b)| b - a).collect();
    let slack = SAME * first.cost.sqrt() + SAME_PARAMETERS * changes(&first.theta);
    changes(&difference) <= slack && other.cost.sqrt() - first.cost.sqrt() <= slack
}
