//! Model against measurement: the ladder of errors, rung by rung, and where the error lies.

use bulge_measurements::{Data, QualityOptions};
use bulge_model::{Model, ModelError};
use bulge_muscles::{Muscle, Quantity};
use rayon::prelude::*;

use crate::comparison::analysis::{Analysis, Climbed, Options};
use crate::comparison::document::{Comparison, DataSummary, NoiseFloor};
use crate::comparison::specimens::{note, of_specimens};
use crate::comparison::warnings::without_state;
use crate::comparison::{isotonic, loops, residuals, rivals, stack};
use crate::error::InferenceError;
use crate::fit::document::{Convergence, Fit};

/// Compares.
///
/// # Errors
/// See [`InferenceError`]: too few rows, a muscle that doesn't match, an effect that doesn't fit the muscle or the data.
pub fn compare(data: &Data, muscle: &Muscle, options: &Options) -> Result<Comparison, InferenceError> {
    // On a thread of the pool: small evaluations aren't handed over to it one by one.
    let data = of_specimens(data, muscle)?;
    rayon::scope(|_| compared(Analysis::new(&data, muscle, options)?))
}

/// The same with the numbers of the last rung about known, of a model with the same effects, and the record that another analysis has.
pub(crate) fn compare_near(
    other: &Analysis<'_>,
    options: &Options,
    near: (&Model, &[f64]),
) -> Result<Comparison, InferenceError> {
    compared(other.with_options(options, near)?)
}

fn compared(mut analysis: Analysis<'_>) -> Result<Comparison, InferenceError> {
    let Analysis { data, muscle, options, .. } = analysis;
    analysis.ask()?;
    let first = analysis.climb(0, None)?;
    let floor = analysis.measure_noise(&first);
    analysis.bound_tails(&first);
    // Weights follow from the noise: the first rung again if it fits anything.
    let first = if first.fit.is_some() { analysis.climb(0, Some(&first))? } else { first };
    let mut rungs = vec![first];
    for count in 1..=options.effects.len() {
        let next = analysis.climb(count, rungs.last())?;
        rungs.push(next);
    }
    let ladder = rungs
        .par_iter()
        .enumerate()
        .map(|(number, climbed)| analysis.rung(number, climbed))
        .collect::<Vec<_>>();
    let says_something = |climbed: &Climbed| analysis.with_state(&[&climbed.force]).next().is_some();
    let place = rungs.iter().rposition(says_something).unwrap_or(0);
    for (number, rung) in rungs.iter_mut().enumerate() {
        if number != 0 && number != place {
            // Of many rows forces are large, and what these said is in the ladder.
            rung.force = Vec::new();
        }
    }
    let last = &rungs[place];
    // A surface follows the residuals of a better model better: then less of them is taken for noise.
    let again = analysis.noise_floor(last);
    let floor = match (floor, again) {
        (Some(first), Some(again)) if again.sd_n < first.sd_n => Some(again),
        (first, _) => first,
    };
    let forces = [&rungs[0].force, &last.force];
    let mut warnings = analysis.warnings(&ladder);
    for (rung, climbed) in ladder.iter().zip(&rungs) {
        let name = rung.added.as_deref().unwrap_or("base");
        warnings.extend(climbed.failed.as_ref().map(|error| not_fitted(name, error)));
    }
    // With the last fit's numbers the muscle may not even pull before all effects are in.
    let contributions = stack::contributions(&analysis, last).unwrap_or_else(|error| {
        warnings.push(format!("what each effect contributes can't be shown one by one: {error}"));
        Vec::new()
    });
    if contributions.is_empty() && !options.effects.is_empty() && warnings.is_empty() {
        let why = "with the numbers of the last fit the muscle has no state before all effects are in";
        warnings.push(format!("what each effect contributes can't be shown one by one: {why}"));
    }
    Ok(Comparison {
        schema: "bulge.comparison/1",
        muscle: muscle.name().to_owned(),
        base: options.law.as_ref().map_or("equilibrium", |(law, _, _)| law.name).to_owned(),
        data: analysis.summary(),
        quality: data
            .quality(&QualityOptions { l0_m: Some(muscle.length().si()), ..QualityOptions::default() })
            .findings,
        noise_floor: floor,
        by: residuals::breakdowns(&analysis, forces),
        loops: loops::gaps(&analysis, forces),
        isotonic: isotonic::held_loads(&analysis, [&rungs[0], last]),
        maps: residuals::maps(&analysis, forces),
        curves: residuals::curves(&analysis, forces),
        contributions,
        scatter: residuals::scatter(&analysis, forces),
        rivals: if options.rivals { rivals::laws(&analysis) } else { Vec::new() },
        warnings,
        ladder,
    })
}

fn not_fitted(name: &str, error: &ModelError) -> String {
    format!("`{name}` could not be fitted, its numbers are those that it starts from: {error}")
}

/// The effects fitted to the data, and the error before and after.
#[derive(Debug, Clone)]
pub struct Fitting {
    /// The model with its effects, and the rig errors that were fitted along.
    pub model: Model,
    /// The fit.
    pub fit: Fit,
    /// What the data are.
    pub data: DataSummary,
    /// RMS error of the muscle as stated \[N\].
    pub before_rmse_n: f64,
    /// RMS error with the effects \[N\].
    pub rmse_n: f64,
    /// What no model can go below, if anything is known of it.
    pub noise_floor: Option<NoiseFloor>,
}

/// Fits the effects to the data, without the ladder.
///
/// # Errors
/// As [`compare`].
pub fn fit_effects(data: &Data, muscle: &Muscle, options: &Options) -> Result<Fitting, InferenceError> {
    let data = of_specimens(data, muscle)?;
    rayon::scope(|_| fitted(&data, muscle, options))
}

fn fitted(data: &Data, muscle: &Muscle, options: &Options) -> Result<Fitting, InferenceError> {
    let mut analysis = Analysis::new(data, muscle, options)?;
    analysis.ask()?;
    let base = analysis.climb(0, None)?;
    let noise_floor = analysis.measure_noise(&base);
    analysis.bound_tails(&base);
    let climbed = analysis.climb(options.effects.len(), None)?;
    let rmse_n = residuals::summary(&analysis, &climbed.force).rmse;
    let left = analysis.without_state(&climbed);
    let Climbed { prepared, theta, fit, force, failed } = climbed;
    let mut fit = fit.unwrap_or_else(|| nothing_fitted(&analysis, theta, &force));
    fit.warnings.extend(failed.map(|error| not_fitted("the fit", &error)));
    fit.warnings.extend(left.map(|left| without_state("the fit", &left)));
    fit.warnings.extend(note(data, muscle));
    fit.warnings.splice(0..0, analysis.findings.iter().map(ToString::to_string));
    Ok(Fitting {
        model: prepared.model,
        fit,
        data: analysis.summary(),
        before_rmse_n: residuals::summary(&analysis, &base.force).rmse,
        rmse_n,
        noise_floor,
    })
}

/// The fit of a model without free numbers.
fn nothing_fitted(analysis: &Analysis<'_>, theta: Vec<f64>, force: &Vec<f64>) -> Fit {
    let error = residuals::summary(analysis, force);
    Fit {
        parameters: Vec::new(),
        theta,
        rmse_n: error.rmse,
        cost: 0.0,
        sd_n: analysis.noise.force_n,
        effective_rows: analysis.rows().count() as f64,
        correlations: Vec::new(),
        convergence: Convergence {
            converged: true,
            reason: "there was nothing to fit".to_owned(),
            gradient_cosine: 0.0,
            iterations: 0,
            starts: 0,
            agreeing: 0,
            minima: 0,
            rank: 0,
        },
        warnings: Vec::new(),
    }
}
