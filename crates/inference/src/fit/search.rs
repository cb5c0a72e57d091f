//! The fit: many starts on a thinned record, the best ones refined on all rows; then intervals and warnings.

use bulge_model::{Model, ModelError, Record, Wanted, Warm};
use bulge_numerics::least_squares::{Bounds, LeastSquaresError, Minimum, Options, Reason, starts_in_box};

use rayon::prelude::*;

use crate::fit::document::{Convergence, Fit};
use crate::fit::frozen::{NEAR, minimise_frozen};
use crate::fit::loss::Loss;
use crate::fit::nuisance::Prepared;
use crate::fit::problem::{FitProblem, free};
use crate::fit::report::report;
use crate::fit::states::{Minimised, is_of_rows, minimise_partly, of_start};
use crate::fit::weights::Noise;
use crate::median::robust_sd;

/// Rows of the thinned record on which starts are tried.
const FEW_ROWS: usize = 400;
/// Refinement of the lattice during the trials; their minima are followed on the usual lattice.
const COARSE: f64 = 0.5;
/// Most starts: the given one, one nearly without effects, 2 n - 1 scattered ones for n unknown parameters; and two where
/// nothing is known if a smaller fit found some.
const STARTS: usize = 8;
/// Fraction of the plausible box at either end in which no start lies.
const EDGE: f64 = 0.1;
/// Number of minima of the thinned record that are followed further.
const POLISHED: usize = 2;
/// Rows on which minima are followed first if the record is much longer.
const MORE_ROWS: usize = 4000;
/// Record lengths from which that saves time: with several minima, and with one.
const MANY_ROWS: [usize; 2] = [8000, 20_000];
/// Longer records are thinned: parameters are then known to a hundredth of the formulas' own error.
const LONG: usize = 60_000;
/// Rows of a thinned long record.
const OF_LONG: usize = 40_000;
/// Fewest rows per cycle in a thinned long record, so that the path keeps its shape.
const OF_CYCLE: f64 = 40.0;
/// Minima within this fraction above the least cost are still followed on all rows.
const RIVAL: f64 = 0.05;
/// Costs that differ by less than this fraction belong to the same minimum.
const SAME: f64 = 1e-3;
/// Most times that the noise of a robust fit is taken anew, and the fall below which it is not.
const RESCALED: usize = 4;
const STEADY: f64 = 0.95;

/// What a fit needs besides the model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) record: &'a Record,
    pub(crate) used: &'a [bool],
    pub(crate) noise: Noise,
    pub(crate) loss: Loss,
    /// For each parameter, whether a smaller fit found it, so that most starts keep it; empty if none.
    pub(crate) known: &'a [bool],
    /// Tries only the given start, which is known to be near the minimum.
    pub(crate) is_near: bool,
    /// Skips intervals and warnings: for held-out errors.
    pub(crate) quick: bool,
}

/// Fits the free parameters of a model.
pub(crate) fn fit(prepared: &Prepared, start: &[f64], task: &Task<'_>) -> Result<Fit, ModelError> {
    fit_and_force(prepared, start, task).map(|(fit, _)| fit)
}

/// The fit, and its force \[N\]: 0 in rows that don't count, NaN in rows without a state.
///
/// A noise that was estimated from readings with spikes in them is too large for a loss that is to see the
/// spikes: other losses than squares take that of the residuals' median if it is smaller, again and again
/// until it no longer falls.
pub(crate) fn fit_and_force(
    prepared: &Prepared,
    start: &[f64],
    task: &Task<'_>,
) -> Result<(Fit, Vec<f64>), ModelError> {
    let (mut fit, mut force) = fit_with_noise(prepared, start, task)?;
    if task.loss == Loss::Squares {
        return Ok((fit, force));
    }
    for _ in 0..RESCALED {
        let scale =
            scatter(task, &force).max(prepared.model.muscle().instruments().force.map_or(0.0, |f| f.noise()));
        if !(scale > 0.0 && scale < STEADY * fit.sd_n) {
            break;
        }
        let noise = Noise { force_n: scale, ..task.noise };
        let start = fit.theta.clone();
        (fit, force) = fit_with_noise(prepared, &start, &Task { noise, is_near: true, ..*task })?;
    }
    Ok((fit, force))
}

/// Standard deviation of normal residuals that has their median absolute value \[N\].
fn scatter(task: &Task<'_>, force: &[f64]) -> f64 {
    let rows = (0..force.len()).filter(|row| task.used[*row] && force[*row].is_finite());
    robust_sd(&rows.map(|row| task.record.force()[row] - force[row]).collect::<Vec<_>>())
}

fn fit_with_noise(
    prepared: &Prepared,
    start: &[f64],
    task: &Task<'_>,
) -> Result<(Fit, Vec<f64>), ModelError> {
    if !task.quick
        && let Some(some) = some_of_long(task.record)
    {
        return of_long(prepared, start, task, &some);
    }
    let model = &prepared.model;
    let mut best = vec![start.to_vec()];
    let mut minima = 1;
    let mut agreeing = 1;
    let mut tried = 1;
    let all_narrow = free(model).into_iter().all(|index| prepared.nuisance[index]);
    if !(task.is_near || all_narrow) {
        let searched = search(prepared, start, task)?;
        (best, minima, agreeing, tried) = (searched.best, searched.minima, searched.agreeing, searched.tried);
    }
    if task.record.len() > MANY_ROWS[usize::from(best.len() == 1)] && !task.quick {
        best = followed(prepared, best, task)?;
    }
    let mut found: Option<Minimised<'_>> = None;
    let mut error = None;
    for theta in &best {
        match polished(prepared, theta, task) {
            Ok(end) if found.as_ref().is_none_or(|other| end.charged < other.charged) => found = Some(end),
            Ok(_) => {}
            Err(failed) if is_of_rows(&failed) => error = error.or(Some(failed)),
            Err(failed) => return Err(failed),
        }
    }
    let Some(Minimised { minimum, problem, used, .. }) = found else {
        return Err(error.unwrap_or(ModelError::Values { given: 0, expected: 1 }));
    };
    let mut force = problem.force(&minimum.residuals);
    for (row, force) in force.iter_mut().enumerate() {
        if task.used[row] && !used[row] {
            *force = f64::NAN;
        }
    }
    let task = &Task { used: &used, ..*task };
    let fit = report(
        prepared,
        &minimum,
        &problem,
        task,
        Convergence {
            converged: minimum.certificate.converged,
            reason: reason(minimum.certificate.reason).to_owned(),
            gradient_cosine: minimum.certificate.gradient_cosine,
            iterations: minimum.iterations,
            starts: tried,
            agreeing,
            minima,
            rank: minimum.certificate.rank,
        },
    );
    Ok((fit, force))
}

/// The thinned record and its rows if a record is long; none if the fit takes all rows.
pub(crate) fn some_of_long(record: &Record) -> Option<(Record, Vec<usize>)> {
    (record.len() > LONG && keeps_cycles(record)).then(|| record.thinned(OF_LONG))
}

/// Whether the thinned record still resolves each cycle.
fn keeps_cycles(record: &Record) -> bool {
    let of_sweep = |sweep: &std::ops::Range<usize>| {
        let cycles = record.moments()[sweep.clone()].iter().map(|m| m.cycle);
        let [low, high] = cycles.fold([f64::INFINITY, 0.0], |[l, h]: [f64; 2], c| [l.min(c), h.max(c)]);
        (high - low).max(0.0).floor() + 1.0
    };
    let cycles: f64 = record.sweeps().iter().map(of_sweep).sum();
    OF_LONG as f64 >= OF_CYCLE * cycles
}

/// The fit of a thinned long record, and the force at all its rows.
fn of_long(
    prepared: &Prepared,
    start: &[f64],
    task: &Task<'_>,
    (thin, kept): &(Record, Vec<usize>),
) -> Result<(Fit, Vec<f64>), ModelError> {
    let used: Vec<bool> = kept.iter().map(|row| task.used[*row]).collect();
    let some = Task { record: thin, used: &used, ..*task };
    let (mut fit, _) = fit_with_noise(prepared, start, &some)?;
    let counting = Warm::of_rows(task.used);
    let found = prepared.model.evaluate_partly(task.record, &fit.theta, &Wanted::default(), &counting)?;
    let force = found.prediction.force;
    let rows = (0..force.len()).filter(|row| task.used[*row] && force[*row].is_finite());
    let (square, count) = rows.fold((0.0, 0.0), |(square, count): (f64, f64), row| {
        (square + (task.record.force()[row] - force[row]).powi(2), count + 1.0)
    });
    fit.rmse_n = (square / count.max(1.0)).sqrt();
    Ok((fit, force))
}

/// The minimum near `theta`, over the rows that have a state.
fn polished<'a>(prepared: &'a Prepared, theta: &[f64], task: &Task<'a>) -> Result<Minimised<'a>, ModelError> {
    let model = &prepared.model;
    let sd = weights(model, theta, task)?;
    let problem = |used: &[bool], at: &[f64]| {
        FitProblem::new(model, task.record, used, sd.clone(), at.to_vec(), &prepared.priors)
            .with_loss(task.loss)
    };
    minimise_partly((model, task.record), task.used, theta, problem, |problem, at| {
        settle(problem, at, task.quick)
    })
}

struct Searched {
    best: Vec<Vec<f64>>,
    minima: usize,
    agreeing: usize,
    tried: usize,
}

/// Starts from all over the plausible box, each followed to its minimum on few rows.
fn search(prepared: &Prepared, start: &[f64], task: &Task<'_>) -> Result<Searched, ModelError> {
    let model = &prepared.model.clone().refined(COARSE);
    let (thin, kept) = task.record.thinned(FEW_ROWS);
    let used: Vec<bool> = kept.iter().map(|row| task.used[*row]).collect();
    let few = Task { record: &thin, used: &used, ..*task };
    let sd = weights(model, start, &few)?;
    // One problem for each start, because each keeps its own equilibria and they run in parallel.
    let problem_of = || {
        FitProblem::new(model, &thin, &used, sd.clone(), start.to_vec(), &prepared.priors)
            .with_loss(task.loss)
    };
    let problem = problem_of();
    let bounds = problem.bounds();
    let options =
        Options { check_curvature: false, tolerance: 1e-4, max_evaluations: 60, least_decrease: NEAR };
    let mut starts = vec![clamped(problem.coordinates(start), &bounds.lower, &bounds.upper)];
    starts.push(clamped(problem.coordinates(&nearly_off(model, start)), &bounds.lower, &bounds.upper));
    let is_known = |index: usize| task.known.get(index).is_some_and(|known| *known);
    let unknown =
        free(model).into_iter().filter(|index| !prepared.nuisance[*index] && !is_known(*index)).count();
    starts.extend(scattered(
        prepared,
        &problem,
        (start, &is_known),
        (2 * unknown).saturating_sub(1).min(STARTS - 2),
    ));
    if task.known.contains(&true) {
        // What a smaller fit found may have stood in for what it lacked.
        starts.push(clamped(problem.coordinates(&prepared.start()), &bounds.lower, &bounds.upper));
        starts.extend(scattered(prepared, &problem, (start, &|_| false), 1));
    }
    let tried = starts.len();
    let from = |at: &Vec<f64>| minimise_frozen(&problem_of(), at, &bounds, &options);
    let followed: Vec<_> = starts.par_iter().map(from).collect();
    let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut first_error = None;
    for end in followed {
        match end {
            Ok(minimum) => ends.push((minimum.cost, problem.theta(&minimum.theta))),
            Err(LeastSquaresError::Start(error)) => first_error = first_error.or(Some(error)),
            Err(_) => {}
        }
    }
    if ends.is_empty() {
        // At no start do all rows have a state: the rows that have one decide where to begin.
        for coordinates in &starts {
            match polished(prepared, &problem.theta(coordinates), &few) {
                Ok(end) => ends.push((end.charged, end.problem.theta(&end.minimum.theta))),
                Err(error) if is_of_rows(&error) => first_error = first_error.or(Some(error)),
                Err(error) => return Err(error),
            }
        }
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(least) = ends.first().map(|end| end.0) else {
        return Err(first_error.unwrap_or(ModelError::Values { given: 0, expected: 1 }));
    };
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * (a.abs() + b.abs()) + 1e-12;
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    for end in &ends {
        if !best.iter().any(|other| same(other.0, end.0)) {
            best.push(end.clone());
        }
    }
    let agreeing = ends.iter().filter(|end| same(end.0, least)).count();
    let minima = best.len();
    Ok(Searched {
        best: best.into_iter().take(POLISHED).map(|(_, theta)| theta).collect(),
        minima,
        agreeing,
        tried,
    })
}

/// Follows minima of few rows on more rows and drops those far above the least one.
fn followed(
    prepared: &Prepared,
    minima: Vec<Vec<f64>>,
    task: &Task<'_>,
) -> Result<Vec<Vec<f64>>, ModelError> {
    let (thin, kept) = task.record.thinned(MORE_ROWS);
    let used: Vec<bool> = kept.iter().map(|row| task.used[*row]).collect();
    let some = Task { record: &thin, used: &used, quick: true, ..*task };
    let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
    for theta in minima {
        match polished(prepared, &theta, &some) {
            Ok(end) => ends.push((end.charged, end.problem.theta(&end.minimum.theta))),
            // Keeps the old point: the minimisation over all rows starts there.
            Err(error) if is_of_rows(&error) => ends.push((f64::INFINITY, theta)),
            Err(error) => return Err(error),
        }
    }
    let least = ends.iter().map(|end| end.0).fold(f64::INFINITY, f64::min);
    ends.retain(|end| end.0 <= least * (1.0 + RIVAL));
    Ok(ends.into_iter().map(|(_, theta)| theta).collect())
}

/// Nine tenths of the way to all effects off, where most rows have an equilibrium.
fn nearly_off(model: &Model, start: &[f64]) -> Vec<f64> {
    let towards = |(value, off): (&f64, f64)| value + 0.9 * (off - value);
    start.iter().zip(model.off()).map(towards).collect()
}

/// Points of the plausible box. Nuisances stay within one sd of the prior, known parameters where they are.
fn scattered(
    prepared: &Prepared,
    problem: &FitProblem<'_>,
    (start, is_known): (&[f64], &dyn Fn(usize) -> bool),
    count: usize,
) -> Vec<Vec<f64>> {
    let model = &prepared.model;
    let (mut lowest, mut highest) = (start.to_vec(), start.to_vec());
    for index in free(model).into_iter().filter(|index| !is_known(*index)) {
        let p = &model.parameters()[index];
        let (low, high) = match prepared.priors[index] {
            Some((mean, sd)) if prepared.nuisance[index] => (mean - sd, mean + sd),
            _ => p.plausible,
        };
        let (low, high) = (low.max(p.low), high.min(p.high));
        // The user's bounds may exclude the whole plausible range.
        (lowest[index], highest[index]) = if low < high { (low, high) } else { (p.low, p.high) };
    }
    let (mut lower, mut upper) = (problem.coordinates(&lowest), problem.coordinates(&highest));
    for (low, high) in lower.iter_mut().zip(&mut upper) {
        // Not at the ends of the range, where effects may be off or absurd.
        let inset = EDGE * (*high - *low);
        (*low, *high) = (*low + inset, *high - inset);
    }
    // Without a finite box, the given start is the only one.
    starts_in_box(count, &Bounds { lower, upper }).unwrap_or_default()
}

fn clamped(mut coordinates: Vec<f64>, lower: &[f64], upper: &[f64]) -> Vec<f64> {
    for ((x, low), high) in coordinates.iter_mut().zip(lower).zip(upper) {
        *x = x.clamp(*low, *high);
    }
    coordinates
}

pub(crate) fn weights(model: &Model, theta: &[f64], task: &Task<'_>) -> Result<Vec<f64>, ModelError> {
    let readings = task.noise.pressure_pa > 0.0 || task.noise.contraction > 0.0;
    let wanted = Wanted { parameters: Vec::new(), readings };
    let prediction = if readings {
        // A row without a state has only the noise of its force.
        model.evaluate_partly(task.record, theta, &wanted, &Warm::of_rows(task.used))?.prediction
    } else {
        bulge_model::Prediction {
            force: Vec::new(),
            jacobian: Vec::new(),
            by_pressure: Vec::new(),
            by_contraction: Vec::new(),
        }
    };
    Ok(task.noise.of_rows(task.record, &prediction))
}

/// The minimum near `theta`, over all rows of the problem.
pub(crate) fn settle(problem: &FitProblem<'_>, theta: &[f64], quick: bool) -> Result<Minimum, ModelError> {
    let bounds = problem.bounds();
    let start = clamped(problem.coordinates(theta), &bounds.lower, &bounds.upper);
    // Parameters are then off by this fraction of sqrt(rows) standard deviations.
    let tolerance = if quick { 1e-4 } else { 1e-5 };
    // At a kink of the residuals: to a hundredth of a standard deviation.
    let least_decrease = if quick { NEAR } else { 1e-4 };
    let options = Options { check_curvature: false, tolerance, max_evaluations: 200, least_decrease };
    minimise_frozen(problem, &start, &bounds, &options).map_err(of_start)
}

fn reason(reason: Reason) -> &'static str {
    if reason.is_converged() {
        "residuals are orthogonal to what the numbers can change"
    } else if reason == Reason::Kink {
        "the least error lies at a kink: a little further, readings change their direction or a state"
    } else {
        "the search ended before the residuals were orthogonal to what the numbers can change"
    }
}
