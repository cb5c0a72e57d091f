//! Fits of models that have no state at some rows. A missing state is a statement about the trial parameters,
//! not the end of the fit.
//!
//! Within a search, a trial point at which a row has no state shortens the step. At the start of a search,
//! rows without a state wait: the other rows are fitted, and waiting rows that have a state at that minimum
//! come back in. A row that has no state in the end is charged with its measured force: a model without a
//! state there predicts none, and no model may gain by having no state.

use bulge_model::{Model, ModelError, Record, Wanted, Warm};
use bulge_numerics::least_squares::{LeastSquaresError, Minimum};

use crate::fit::problem::FitProblem;

/// Most times that rows may come back in.
const ROUNDS: usize = 5;

/// A minimum over the rows that have a state.
pub(crate) struct Minimised<'a> {
    pub(crate) minimum: Minimum,
    pub(crate) problem: FitProblem<'a>,
    /// Rows that count and have a state.
    pub(crate) used: Vec<bool>,
    /// The sum of squares plus the charge for rows without a state.
    pub(crate) charged: f64,
}

/// Whether a model failed at some rows only; it may succeed with other parameters.
pub(crate) fn is_of_rows(error: &ModelError) -> bool {
    matches!(error, ModelError::NoEquilibrium { .. } | ModelError::NotFinite { .. })
}

/// The model's error if a search can't start.
pub(crate) fn of_start(error: LeastSquaresError<ModelError>) -> ModelError {
    match error {
        LeastSquaresError::Start(error) => error,
        _ => ModelError::NotFinite {
            rows: Vec::new(),
            what: "the fit cannot start: the model has no finite derivatives there",
        },
    }
}

/// Rows that count and have a state with parameters `theta`.
pub(crate) fn with_state(
    model: &Model,
    record: &Record,
    used: &[bool],
    theta: &[f64],
) -> Result<Vec<bool>, ModelError> {
    let found = model.evaluate_partly(record, theta, &Wanted::default(), &Warm::of_rows(used))?;
    let mut with = used.to_vec();
    for row in found.without_state {
        with[row] = false;
    }
    Ok(with)
}

/// The minimum from `start` over all rows in `used` that have a state there or get one on the way.
///
/// `problem` builds the least-squares problem of some rows, `settle` finds its minimum.
///
/// # Errors
/// The error at the start if the rows with a state are not more than the parameters; all other errors of a
/// model.
pub(crate) fn minimise_partly<'a>(
    (model, record): (&'a Model, &'a Record),
    used: &[bool],
    start: &[f64],
    problem: impl Fn(&[bool], &[f64]) -> FitProblem<'a>,
    settle: impl Fn(&FitProblem<'a>, &[f64]) -> Result<Minimum, ModelError>,
) -> Result<Minimised<'a>, ModelError> {
    let whole = problem(used, start);
    let error = match settle(&whole, start) {
        Ok(minimum) => {
            let charged = minimum.cost;
            return Ok(Minimised { minimum, problem: whole, used: used.to_vec(), charged });
        }
        Err(error) if is_of_rows(&error) => error,
        Err(error) => return Err(error),
    };
    let mut best: Option<Minimised<'a>> = None;
    let mut at = start.to_vec();
    for _ in 0..ROUNDS {
        let rows = with_state(model, record, used, &at)?;
        let count = rows.iter().filter(|counts| **counts).count();
        let before = best.as_ref().map_or(0, |best| best.problem.measured());
        if count <= at.len().max(before) {
            break;
        }
        let some = problem(&rows, &at);
        let Ok(minimum) = settle(&some, &at) else { break };
        at = some.theta(&minimum.theta);
        let charged = minimum.cost + charge(record, some.sd(), used, &rows);
        best = Some(Minimised { minimum, problem: some, used: rows, charged });
    }
    best.ok_or(error)
}

/// Sum of squares of the measured forces, in standard deviations, over rows that count and have no state.
fn charge(record: &Record, sd: &[f64], used: &[bool], with: &[bool]) -> f64 {
    let is_without = |row: &usize| used[*row] && !with[*row];
    (0..record.len()).filter(is_without).map(|row| (record.force()[row] / sd[row]).powi(2)).sum()
}
