//! What a fit says: its parameters with intervals and covariance, and its warnings.

use bulge_muscles::units::significant;
use bulge_numerics::least_squares::{Minimum, Side};

use crate::fit::document::{Convergence, Fit, Fitted};
use crate::fit::interval;
use crate::fit::loss::Loss;
use crate::fit::nuisance::Prepared;
use crate::fit::problem::{FitProblem, free};
use crate::fit::search::Task;
use crate::fit::weights::effective_rows;

/// A rig error within so many standard deviations of its data sheet counts as noise.
const SHEET: f64 = 4.0;
/// Correlations beyond this lead to a warning.
const INSEPARABLE: f64 = 0.98;

/// Parameters with intervals, and warnings.
pub(crate) fn report(
    prepared: &Prepared,
    minimum: &Minimum,
    problem: &FitProblem<'_>,
    task: &Task<'_>,
    convergence: Convergence,
) -> Fit {
    let model = &prepared.model;
    let theta = problem.theta(&minimum.theta);
    let n = problem.measured();
    let mut residuals = vec![0.0; task.record.len()];
    let rows = (0..task.record.len()).filter(|row| task.used[*row]);
    for (row, residual) in rows.zip(&minimum.residuals) {
        residuals[row] = *residual;
    }
    let newtons = residuals.iter().zip(problem.sd()).map(|(r, sd)| task.loss.straightened(*r) * sd);
    let square: f64 = newtons.map(|newtons| newtons * newtons).sum();
    let effective = if task.quick { n as f64 } else { effective_rows(task.record, &residuals, task.used) };
    let mut fit = Fit {
        theta,
        rmse_n: (square / n.max(1) as f64).sqrt(),
        cost: minimum.cost,
        sd_n: task.noise.force_n,
        effective_rows: effective,
        correlations: minimum.correlation(),
        loss: task.loss,
        convergence,
        ..Fit::default()
    };
    if task.quick {
        return fit;
    }
    let scale = interval::Scale::new(minimum, n, effective, task.loss);
    fit.covariance = covariance(problem, minimum, &scale);
    fit.downweighted = downweighted(&residuals, task.loss);
    for (place, index) in free(model).into_iter().enumerate() {
        let mut fitted = fitted(prepared, index, fit.theta[index]);
        fitted.determined = minimum.certificate.flat.iter().all(|v| v[place].abs() < 0.5);
        fitted.at_bound = minimum.certificate.at_bound[place].map(|side| match side {
            Side::Lower => "lower",
            Side::Upper => "upper",
        });
        let implausible = !fitted.plausible && !fitted.nuisance;
        let leans = interval::leans_on_a_bound(minimum, place);
        let flagged = fitted.at_bound.is_some() || implausible || !fitted.determined || leans;
        let found = interval::of(problem, minimum, place, &scale, flagged);
        fitted.interval = found.method;
        fitted.determined &= !found.is_everything;
        let factor = model.parameters()[index].factor;
        [fitted.low, fitted.high] = found.ends.map(|x| x / factor);
        fit.parameters.push(fitted);
    }
    fit.warnings = warnings(&fit);
    fit
}

/// Covariance of the fitted parameters in the units in which they are shown; NaN where one isn't determined.
fn covariance(problem: &FitProblem<'_>, minimum: &Minimum, scale: &interval::Scale) -> Vec<f64> {
    let count = minimum.theta.len();
    let slopes = problem.shown_slopes(&minimum.theta);
    let all = scale.covariance(minimum);
    let is_known = |place: usize| minimum.certificate.is_determined(place);
    (0..count * count)
        .map(|at| {
            let (i, j) = (at / count, at % count);
            if is_known(i) && is_known(j) { all[at] * slopes[i] * slopes[j] } else { f64::NAN }
        })
        .collect()
}

/// Readings that keep less than half of their influence.
fn downweighted(residuals: &[f64], loss: Loss) -> usize {
    residuals.iter().filter(|bent| loss.weight(loss.straightened(**bent)) < 0.5).count()
}

fn fitted(prepared: &Prepared, index: usize, value: f64) -> Fitted {
    let p = &prepared.model.parameters()[index];
    let tiny = 1e-9 * (p.high - p.low);
    // A nuisance parameter is plausible within its data sheet.
    let sheet = prepared.priors[index].filter(|_| prepared.nuisance[index]);
    let (low, high) = sheet.map_or(p.plausible, |(mean, sd)| (mean - SHEET * sd, mean + SHEET * sd));
    let plausible = value >= low - tiny && value <= high + tiny;
    let effect = prepared.model.effects().iter().find(|c| c.effect.card().name == p.effect);
    let cards = effect.map(|c| c.effect.parameters()).unwrap_or_default();
    let reciprocal = cards.iter().find(|card| card.name == p.name).and_then(|card| card.reciprocal);
    let also = reciprocal
        .filter(|_| value > 0.0)
        .map(|(name, unit, size)| (name.to_owned(), 1.0 / (value * size), unit.to_owned()));
    Fitted {
        effect: p.effect.clone(),
        name: p.name.clone(),
        specimen: p.specimen.clone(),
        value: p.shown(value),
        low: p.shown(value),
        high: p.shown(value),
        unit: p.unit.clone(),
        interval: "covariance",
        at_bound: None,
        plausible,
        plausible_range: [p.shown(low), p.shown(high)],
        determined: true,
        nuisance: prepared.nuisance[index],
        also,
        about: p.about.clone(),
    }
}

fn warnings(fit: &Fit) -> Vec<String> {
    let label = |p: &Fitted| format!("{} of {}", p.name, p.effect);
    let mut warnings = Vec::new();
    if !fit.convergence.converged {
        warnings.push(format!(
            "the fit did not converge ({}): its numbers are not to be relied on",
            fit.convergence.reason
        ));
    }
    for p in &fit.parameters {
        let value = format!("{} {}", significant(p.value, 3), p.unit);
        let [least, most] = p.plausible_range;
        // An interval that overlaps the data sheet is consistent with the rig's error.
        let may_be_within = p.nuisance && p.low <= most && p.high >= least;
        if !p.plausible && !may_be_within {
            let [low, high] = p.plausible_range.map(|end| significant(end, 3));
            let (label, unit) = (label(p), &p.unit);
            warnings.push(if p.nuisance {
                format!(
                    "{label} is fitted as {value}, far beyond its data sheet ({low} to {high} {unit}): it makes up for something that the model lacks"
                )
            } else {
                format!(
                    "implausible: {label} = {value}, outside {low} to {high} {unit}: a wrong cure, even if the error falls"
                )
            });
        }
        if let Some(side) = p.at_bound {
            warnings.push(format!("{} lies on the {side} bound of the search, {value}", label(p)));
        }
        if !p.determined {
            warnings.push(format!("these data do not determine {}", label(p)));
        }
    }
    let k = fit.parameters.len();
    for i in 0..k {
        for j in 0..i {
            let r = fit.correlations.get(i * k + j).copied().unwrap_or(0.0);
            if r.abs() > INSEPARABLE {
                warnings.push(format!(
                    "{} and {} cannot be told apart by these data (correlation {r:.3})",
                    label(&fit.parameters[j]),
                    label(&fit.parameters[i])
                ));
            }
        }
    }
    warnings
}
