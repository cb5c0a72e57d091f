//! The minimum of a fit in rounds: equilibria are solved at the start of a round and are linear in the numbers of the shape within it.
//!
//! Shooting for equilibria is nearly all that a fit costs, and its numbers of the shape (a radius within its tolerance, a modulus) change little from one evaluation to
//! the next. When a round ends where it began, the equilibria of its end are those that were solved: the minimum is that of the model itself. A round that leads
//! nowhere is made good by a fit without short cuts.

use bulge_model::ModelError;
use bulge_numerics::least_squares::{Bounds, LeastSquaresError, Minimum, Options, Residuals, minimise};

use crate::fit::problem::FitProblem;

/// Rounds at most.
const ROUNDS: usize = 6;
/// A difference of the sum of squares that doesn't matter: evidence counts in halves of it.
const NEAR: f64 = 0.01;
/// The same as a part of the sum of squares.
const NEAR_PART: f64 = 1e-6;
/// Part of a standard deviation that is no way.
const STILL: f64 = 0.05;

/// The minimum that a start leads to; as [`minimise`], and its errors.
pub(crate) fn settled(
    problem: &FitProblem<'_>,
    start: &[f64],
    bounds: &Bounds,
    options: &Options,
) -> Result<Minimum, LeastSquaresError<ModelError>> {
    let mut at = start.to_vec();
    let mut began = f64::INFINITY;
    for _ in 0..ROUNDS {
        problem.hold();
        // No equilibrium where the linear ones led, or none at all; nothing to hold; or further from the data than before.
        let Ok(here) = cost(problem, &at) else { break };
        if !problem.is_held() || here > began + near(began) {
            break;
        }
        let minimum = minimise(problem, &at, bounds, options)?;
        if minimum.cost >= here - near(here) && (is_still(&at, &minimum) || is_exact(problem, &minimum)) {
            problem.release();
            return Ok(minimum);
        }
        at = minimum.theta;
        began = here;
    }
    problem.release();
    minimise(problem, start, bounds, options)
}

/// Whether no number has moved by more than a small part of its standard deviation.
fn is_still(from: &[f64], minimum: &Minimum) -> bool {
    let k = from.len();
    let column = |j: usize| (0..k).map(|i| minimum.r[i * k + j].powi(2)).sum::<f64>().sqrt();
    from.iter().zip(&minimum.theta).enumerate().all(|(j, (from, to))| (to - from).abs() * column(j) < STILL)
}

/// Whether the equilibria at the minimum give it the same sum of squares.
fn is_exact(problem: &FitProblem<'_>, minimum: &Minimum) -> bool {
    problem.hold();
    cost(problem, &minimum.theta).is_ok_and(|cost| (cost - minimum.cost).abs() <= near(cost))
}

fn near(cost: f64) -> f64 {
    NEAR + NEAR_PART * cost
}

fn cost(problem: &FitProblem<'_>, at: &[f64]) -> Result<f64, ModelError> {
    let (rows, numbers) = (problem.rows(), problem.parameters());
    let (mut residuals, mut jacobian) = (vec![0.0; rows], vec![0.0; rows * numbers]);
    problem.evaluate(at, 0..rows, &mut residuals, Some(&mut jacobian))?;
    Ok(residuals.iter().map(|r| r * r).sum())
}
