//! Diagnosis: the noise first, then what is missing, step by step, with an honest word on how sure that is.

use bulge_measurements::Data;
use bulge_model::{Model, Record, Wanted, Warm};
use bulge_muscles::{Muscle, Quantity};
use std::sync::Arc;

use crate::comparison::analysis::{Analysis, Climbed, Options};
use crate::comparison::compare::{compare, compare_near};
use crate::comparison::document::Comparison;
use crate::diagnosis::averaged::Averaged;
use crate::diagnosis::classes::Class;
use crate::diagnosis::confidence::{Confidence, confidence};
use crate::diagnosis::document::Diagnosis;
use crate::diagnosis::next::{Judged, Limits, NextLimits, next_experiment};
use crate::diagnosis::noise::Source;
use crate::diagnosis::scene::Given;
use crate::diagnosis::search::{Search, Stage};
use crate::diagnosis::write::{Findings, cannot_tell, document, unanswered};
use crate::error::InferenceError;
use crate::noise::law::NoiseLaw;
use crate::noise::whitening::Whitening;
use crate::progress::Progress;

/// Means of rows on which models are tried.
const MOST_ROWS: usize = 2500;

/// Times that an accepted effect gives way to a better one.
const MOST_SWAPS: usize = 3;

/// What is diagnosed, besides muscle and data.
#[derive(Debug, Clone)]
pub struct DiagnoseOptions {
    /// Effects that the base has (`--with`), known ones, catalogue and law.
    pub base: Options,
    /// RMS misfit that doesn't matter \[N\].
    pub tolerance_n: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What the next experiment may use; what these data used, where nothing is stated.
    pub limits: NextLimits,
    /// Who is told how far it is.
    pub progress: Progress,
}

impl DiagnoseOptions {
    /// No tolerance, seed 1, nobody to tell.
    #[must_use]
    pub fn new(base: Options) -> Self {
        Self {
            base,
            tolerance_n: None,
            seed: 1,
            limits: NextLimits::default(),
            progress: Progress::default(),
        }
    }
}

/// Which physical effect is missing in the model of a muscle, by the data.
///
/// Data that are too few are no error: the verdict is then [`crate::Verdict::CannotTell`], with the reason.
///
/// # Errors
/// See [`InferenceError`]: no rows at all, a muscle that doesn't match, an effect that doesn't fit the muscle or the data.
pub fn diagnose(
    data: &Data,
    muscle: &Muscle,
    options: &DiagnoseOptions,
) -> Result<Diagnosis, InferenceError> {
    // On a thread of the pool: small evaluations aren't handed over to it one by one.
    rayon::scope(|_| match diagnosed(data, muscle, options) {
        Err(error @ (InferenceError::TooFewRows { .. } | InferenceError::Identical { .. })) => {
            Ok(cannot_tell(data, muscle, &error.to_string()))
        }
        found => found,
    })
}

/// Means of rows that models are tried on, and what is known of their noise.
struct Ground {
    averaged: Averaged,
    record: Record,
    input_variances: Vec<f64>,
    /// Mean variance of a single row from noise of the inputs that data sheets state \[N^2\].
    stated: f64,
    law: Option<NoiseLaw>,
}

fn diagnosed(data: &Data, muscle: &Muscle, options: &DiagnoseOptions) -> Result<Diagnosis, InferenceError> {
    let progress = &options.progress;
    let mut analysis = Analysis::new(data, muscle, &options.base)?;
    analysis.ask()?;
    if analysis.findings.iter().any(|finding| finding.decided) {
        return Ok(unanswered(data, muscle, compared_as_stated(data, muscle, options)?));
    }
    let first = analysis.climb(0, None)?;
    analysis.measure_noise(&first);
    let base = analysis.climb(options.base.effects.len(), Some(&first))?;
    progress.at(0.1, "the noise");
    let ground = ground(&analysis, &base, options)?;
    let Some(law) = &ground.law else {
        let rows = ground.record.len();
        return Ok(cannot_tell(data, muscle, &format!("{rows} rows are too few to know their noise")));
    };
    let used = vec![true; ground.record.len()];
    let whitening = Whitening::new(law, &ground.record, &used, &ground.input_variances)?;
    let residual: Vec<f64> =
        analysis.record.force().iter().zip(&base.force).map(|(measured, force)| measured - force).collect();
    let given = Given {
        catalogue: &options.base.catalogue,
        record: &ground.record,
        whitening: &whitening,
        law,
        row_n: (white_of_row(law, &ground, &residual) - ground.stated).max(law.white_n.powi(2)).sqrt(),
        seed: options.seed,
        tolerance_n: options.tolerance_n,
        only: None,
        progress,
    };
    let model = analysis.base_with_effects().map_err(|error| analysis.about(error))?;
    progress.at(0.25, "the catalogue");
    let near = (&base.prepared.model, &base.theta[..]);
    let mut search = given.search(&model, near).map_err(|error| analysis.about(error))?;
    progress.at(0.6, "rivals");
    let mut judged = classes(&given, &model, &search);
    for _ in 0..MOST_SWAPS {
        let last = &search.stages[search.stages.len() - 1];
        let better = judged.iter().enumerate().find_map(|(place, j)| given.swapped(last, place, &j.class));
        let Some(better) = better else { break };
        search.replace_last(better);
        judged = classes(&given, &model, &search);
    }
    progress.at(0.75, "the next experiment");
    let next = next_experiment(&given, &judged, &Limits::of(&ground.record, options.limits));
    progress.at(0.85, "the ladder");
    let classes: Vec<(Class, Confidence)> =
        judged.into_iter().map(|judged| (judged.class, judged.confidence)).collect();
    let sd_n = row_sd(law, &ground, &residual);
    let found = Findings {
        given: &given,
        search: &search,
        classes: &classes,
        sd_n,
        effective_rows: effective_rows(law, &ground, &whitening, sd_n),
        known: options.base.effects.len(),
        tolerance_n: options.tolerance_n,
        next,
    };
    let mut compared = options.base.clone();
    compared.effects.extend(found.shown().iter().map(Arc::clone));
    let last = &search.stages[search.stages.len() - 1].confirmed;
    let comparison = compare_near(data, muscle, &compared, last.numbers())?;
    progress.at(1.0, "done");
    Ok(document(muscle, &found, comparison))
}

/// The comparison with the base alone.
fn compared_as_stated(
    data: &Data,
    muscle: &Muscle,
    options: &DiagnoseOptions,
) -> Result<Comparison, InferenceError> {
    compare(data, muscle, &Options { rivals: false, held_out: false, ..options.base.clone() })
}

/// Means, their forces, and their noise under the base model.
fn ground(
    analysis: &Analysis<'_>,
    base: &Climbed,
    options: &DiagnoseOptions,
) -> Result<Ground, InferenceError> {
    let none = || InferenceError::NoRows { left_out: "none counts".to_owned() };
    let averaged =
        Averaged::of(&analysis.record, &analysis.used.mask, &analysis.levels, MOST_ROWS).ok_or_else(none)?;
    let readings = Wanted { parameters: Vec::new(), readings: true };
    let model = &base.prepared.model;
    let at_means = model
        .evaluate_warm(&averaged.record, &base.theta, &readings, &Warm::new())
        .map_err(|error| analysis.about(error))?;
    let forces = averaged.forces(&analysis.record, &base.force, &at_means.force);
    let record = averaged.record.clone().with_force(forces);
    let noise = analysis.noise;
    let slopes = at_means.by_pressure.iter().zip(&at_means.by_contraction);
    let input_variances: Vec<f64> = slopes
        .zip(averaged.counts())
        .map(|((p, e), count)| ((p * noise.pressure_pa).powi(2) + (e * noise.contraction).powi(2)) / count)
        .collect();
    let counts: Vec<f64> = averaged.counts().collect();
    let stated = variance_of_rows(&input_variances, &counts);
    let residual: Vec<f64> =
        analysis.record.force().iter().zip(&base.force).map(|(measured, force)| measured - force).collect();
    let extra = unequal(&averaged, &counts, &residual, analysis.record.force_sd());
    let source = Source {
        catalogue: &options.base.catalogue,
        muscle: analysis.muscle,
        record: &record,
        input_variances: &input_variances,
        slopes: [&at_means.by_contraction, &at_means.by_pressure],
        counts: &counts,
        unequal: &extra,
        pure_error: analysis.data.repeats(analysis.muscle.length().si()).pure_error(),
    };
    let found = source.law(&base.prepared, &base.theta).map_err(|error| analysis.about(error))?;
    let (law, input_variances) = found.map_or((None, input_variances), |(law, inputs)| (Some(law), inputs));
    Ok(Ground { averaged, record, input_variances, stated, law })
}

/// Each named effect with its rivals, and how often such a claim is right.
fn classes(given: &Given<'_>, model: &Model, search: &Search) -> Vec<Judged> {
    let last = &search.stages[search.stages.len() - 1];
    let of = |place: usize| {
        if let Some((class, without)) = given.class(model, last, place) {
            let confidence = confidence(given, &without.scene, &without.adequacy.null, &class);
            return Judged { class, confidence, models: Some((last.confirmed.clone(), without.confirmed)) };
        }
        let name = last.added[place].card().name;
        let holds = |stage: &&Stage| stage.added.iter().any(|effect| effect.card().name == name);
        let before = search.stages.iter().take_while(|stage| !holds(stage)).last().unwrap_or(last);
        let confidence = Confidence::of_tried(&before.tried, name, &before.scene.showings.effects);
        Judged { class: Class::alone(last, place, before), confidence, models: None }
    };
    (0..last.added.len()).map(of).collect()
}

/// Variances by which the means differ, on top of what they share \[N^2\]: a mean of fewer rows knows less, and a file may state a scatter for each row.
fn unequal(averaged: &Averaged, counts: &[f64], residual: &[f64], stated: Option<&[f64]>) -> Vec<f64> {
    let (sum, freedom) = averaged.within(residual);
    let within = if freedom > 0.0 { sum / freedom } else { 0.0 };
    let most = counts.iter().copied().fold(1.0, f64::max);
    let squares = stated.map(|sd| averaged.means(&sd.iter().map(|sd| sd * sd).collect::<Vec<_>>()));
    let least = squares.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let of = |(place, count): (usize, &f64)| {
        let own = squares.as_ref().map_or(0.0, |squares| (squares[place] - least) / count);
        within * (1.0 / count - 1.0 / most) + own
    };
    counts.iter().enumerate().map(of).collect()
}

/// Rows that count as independent: as many single rows as would know a constant as well as the means do.
fn effective_rows(law: &NoiseLaw, ground: &Ground, whitening: &Whitening, sd_n: f64) -> f64 {
    let inputs = variance_of_rows(&ground.input_variances, &vec![1.0; ground.input_variances.len()]);
    let of_mean = law.white_n.powi(2) + law.correlated_n.powi(2) + law.offset_n.powi(2) + inputs;
    let rows: f64 = ground.averaged.counts().sum();
    if of_mean > 0.0 { (whitening.effective_rows() * sd_n * sd_n / of_mean).min(rows) } else { rows }
}

/// Standard deviation of a single row: the law of the means, what the means have averaged, and what noise of pressure and contraction makes of it.
fn row_sd(law: &NoiseLaw, ground: &Ground, residual: &[f64]) -> f64 {
    (white_of_row(law, ground, residual) + law.correlated_n.powi(2) + law.offset_n.powi(2)).sqrt()
}

/// Variance of a single row without what it shares with its neighbours \[N^2\].
fn white_of_row(law: &NoiseLaw, ground: &Ground, residual: &[f64]) -> f64 {
    let counts: Vec<f64> = ground.averaged.counts().collect();
    let (sum, freedom) = ground.averaged.within(residual);
    let own = law.white_n.powi(2) + variance_of_rows(&ground.input_variances, &counts);
    if freedom > 0.0 { (sum / freedom).max(own) } else { own }
}

/// Median variance of single rows from those of means: that of rows in doubt is not the rule.
fn variance_of_rows(variances: &[f64], counts: &[f64]) -> f64 {
    let mut all: Vec<f64> = variances.iter().zip(counts).map(|(variance, count)| variance * count).collect();
    all.sort_unstable_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}
