//! Diagnosis: the noise first, then what is missing, step by step, with an honest word on how sure that is.

use bulge_effects::Effect;
use bulge_measurements::Data;
use bulge_model::{ModelError, Wanted, Warm};
use bulge_muscles::{Muscle, Quantity};
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::averaged::Averaged;
use crate::classes::{Class, Rival};
use crate::confidence::{Confidence, confidence};
use crate::compare::{Analysis, Options, compare};
use crate::diagnosis::{
    CandidateResult, DiagnosedData, DiagnosedNoise, Diagnosis, LadderStep, Missing, ParameterResult,
    Remaining, RivalResult, Verdict,
};
use crate::diagnosis::ExplainedStep;
use crate::error::InferenceError;
use crate::explained::{explained, surface};
use crate::hints::hints;
use crate::law_of_record::Source;
use crate::misfit::{located, misfit};
use crate::noise_law::NoiseLaw;
use crate::scene::Given;
use crate::search::{Search, Stage, Tried};
use crate::whitening::Whitening;

/// Means of rows on which models are tried.
const MOST_ROWS: usize = 2500;

/// What is diagnosed, besides muscle and data.
#[derive(Debug, Clone)]
pub struct DiagnoseOptions {
    /// Effects that the base has (`--with`), known ones, catalogue and law.
    pub base: Options,
    /// RMS misfit that doesn't matter \[N\].
    pub tolerance_n: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Diagnoses.
///
/// # Errors
/// See [`InferenceError`].
pub fn diagnose(
    data: &Data,
    muscle: &Muscle,
    options: &DiagnoseOptions,
) -> Result<Diagnosis, InferenceError> {
    rayon::scope(|_| diagnosed(data, muscle, options))
}

fn diagnosed(data: &Data, muscle: &Muscle, options: &DiagnoseOptions) -> Result<Diagnosis, InferenceError> {
    let mut analysis = Analysis::new(data, muscle, &options.base)?;
    let first = analysis.climb(0, None)?;
    analysis.check_match(&first)?;
    analysis.measure_noise(&first);
    let base = analysis.climb(options.base.effects.len(), Some(&first))?;
    let about = |error: ModelError| analysis.about(error);
    let averaged = Averaged::of(&analysis.record, &analysis.used.mask, &analysis.levels, MOST_ROWS)
        .ok_or_else(|| InferenceError::NoRows { left_out: "none counts".to_owned() })?;
    let readings = Wanted { parameters: Vec::new(), readings: true };
    let at_means = base
        .prepared
        .model
        .evaluate_warm(&averaged.record, &base.theta, &readings, &Warm::new())
        .map_err(about)?;
    let forces = averaged.forces(&analysis.record, &base.force, &at_means.force);
    let record = averaged.record.clone().with_force(forces);
    let noise = analysis.noise;
    let input_variances: Vec<f64> = averaged
        .counts()
        .enumerate()
        .map(|(i, count)| {
            let p = at_means.by_pressure[i] * noise.pressure_pa;
            let e = at_means.by_contraction[i] * noise.contraction;
            (p * p + e * e) / count
        })
        .collect();
    let source = Source {
        catalogue: &options.base.catalogue,
        muscle,
        record: &record,
        input_variances: &input_variances,
        pure_error: data.repeats(muscle.length().si()).pure_error(),
    };
    let law = source.law(&base.prepared, &base.theta).map_err(about)?;
    let Some(law) = law else {
        return Err(InferenceError::NoRows { left_out: "too few for a noise law".to_owned() });
    };
    let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &input_variances)
        .map_err(|error| InferenceError::NoRows { left_out: error.to_string() })?;
    let given = Given {
        catalogue: &options.base.catalogue,
        record: &record,
        whitening: &whitening,
        law: &law,
        seed: options.seed,
    };
    let model = analysis.base_with_effects().map_err(about)?;
    let search = given.search(&model).map_err(about)?;
    let mut classes: Vec<(Class, Confidence)> = Vec::new();
    let last = &search.stages[search.stages.len() - 1];
    for place in 0..last.added.len() {
        let (class, without) = given.class(&model, last, place).map_err(about)?;
        let confidence = confidence(&given, &without.scene, &without.adequacy.null, &class);
        classes.push((class, confidence));
    }
    let mut compared = options.base.clone();
    compared.effects.extend(last.added.iter().map(Arc::clone));
    let comparison = compare(data, muscle, &compared)?;
    let residual: Vec<f64> =
        analysis.record.force().iter().zip(&base.force).map(|(measured, force)| measured - force).collect();
    let sd = row_sd(&law, &averaged, &residual);
    let verdict = verdict(&search);
    let (misfit_n, misfit_interval_n) = misfit(&last.scene, options.seed);
    let steps = comparison.ladder.len();
    let ladder = comparison
        .ladder
        .iter()
        .enumerate()
        .skip(options.base.effects.len())
        .map(|(i, rung)| LadderStep {
            added: if i == options.base.effects.len() { None } else { rung.added.clone() },
            rmse_n: rung.rmse_n,
            held_out_rmse_n: rung.held_out_rmse_n,
            adequate: i + 1 == steps && last.adequate,
        })
        .collect();
    Ok(Diagnosis {
        schema: "bulge.diagnosis/1",
        muscle: muscle.name().to_owned(),
        data: DiagnosedData {
            rows: comparison.data.rows,
            used: comparison.data.used,
            effective_rows: whitening.effective_rows(),
            sha256: comparison.data.sha256.clone(),
            sweeps: comparison.data.sweeps,
            specimens: comparison.data.specimens.len(),
        },
        noise: DiagnosedNoise {
            sd_n: sd,
            correlated: !law.is_white(),
            source: format!("{:?}", law.source).to_lowercase(),
            law: law.clone(),
        },
        verdict,
        says: format!(
            "{:?} chance {:?}",
            verdict,
            search.stages.iter().map(|s| s.adequacy.chance).collect::<Vec<_>>()
        ),
        missing: classes.iter().map(|(class, confidence)| missing(class, *confidence, last)).collect(),
        candidates: candidates(&search, &classes),
        ladder,
        noise_floor_n: sd,
        r#where: located(&search.stages[0].scene),
        explained: steps_explained(&record, &search),
        remaining: Remaining {
            structured: !last.adequate,
            misfit_n,
            misfit_interval_n,
            hints: if last.adequate { Vec::new() } else { hints(&record, &last.scene, &located(&last.scene)) },
            surface: surface(&record, &last.scene),
        },
        next_experiment: None,
        warnings: comparison.warnings.clone(),
        comparison,
    })
}

/// Each step of the search with what it explained.
fn steps_explained(record: &bulge_model::Record, search: &Search) -> Vec<ExplainedStep> {
    let step = |pair: &[Stage]| {
        let new = &pair[1].added[pair[0].added.len().min(pair[1].added.len())..];
        let names: Vec<&str> = new.iter().map(|effect| effect.card().name).collect();
        explained(&names.join(" + "), record, &pair[0].scene.force, &pair[1].scene.force)
    };
    search.stages.windows(2).map(step).collect()
}

/// Standard deviation of a single row: the law of the means, and what the means have averaged.
fn row_sd(law: &NoiseLaw, averaged: &Averaged, residual: &[f64]) -> f64 {
    let (sum, freedom) = averaged.within(residual);
    let white = if freedom > 0.0 { (sum / freedom).max(law.white_n.powi(2)) } else { law.white_n.powi(2) };
    (white + law.correlated_n.powi(2) + law.offset_n.powi(2)).sqrt()
}

fn verdict(search: &Search) -> Verdict {
    let last = &search.stages[search.stages.len() - 1];
    if last.adequate {
        return if last.added.is_empty() { Verdict::Adequate } else { Verdict::Missing };
    }
    Verdict::Unknown
}

fn family_name(effect: &Arc<dyn Effect>) -> String {
    effect.card().family.to_owned()
}

fn missing(class: &Class, confidence: Confidence, last: &Stage) -> Missing {
    let name = class.effect.card().name.to_owned();
    let own = family_name(&class.effect);
    let mut names = vec![name.clone()];
    for rival in class.rivals.iter().filter(|rival| rival.in_class) {
        let family = family_name(&rival.effect);
        if family != own && !names.contains(&family) {
            names.push(family);
        }
    }
    Missing {
        effect: name.clone(),
        class: names,
        confidence: confidence.named,
        simulated: confidence,
        parameters: parameters(last, &name),
        plausible: plausible(last, &name),
        detectability: class.detectability,
        rivals: class.rivals.iter().map(|rival| rival_result(rival, class)).collect(),
    }
}

fn rival_result(rival: &Rival, class: &Class) -> RivalResult {
    RivalResult {
        effect: rival.effect.card().name.to_owned(),
        behind: class.log_evidence - rival.log_evidence,
        separation: rival.separation,
    }
}

fn parameters(last: &Stage, effect: &str) -> BTreeMap<String, ParameterResult> {
    let model = &last.confirmed.prepared.model;
    let places = crate::problem::free(model);
    let sds = last.confirmed.minimum.standard_deviations(1.0);
    let mut found = BTreeMap::new();
    for (place, index) in places.iter().enumerate() {
        let p = &model.parameters()[*index];
        if p.effect != effect {
            continue;
        }
        let value = last.confirmed.theta[*index];
        let sd = sds[place];
        let (low, high) = match (sd, p.logarithmic) {
            (Some(sd), true) => (value * (-1.96 * sd).exp(), value * (1.96 * sd).exp()),
            (Some(sd), false) => (value - 1.96 * sd, value + 1.96 * sd),
            (None, _) => (p.low, p.high),
        };
        let name = p.specimen.as_ref().map_or(p.name.clone(), |s| format!("{}[{s}]", p.name));
        found.insert(
            name,
            ParameterResult {
                value: p.shown(value),
                unit: p.unit.clone(),
                low: p.shown(low.max(p.low)),
                high: p.shown(high.min(p.high)),
            },
        );
    }
    found
}

fn plausible(last: &Stage, effect: &str) -> bool {
    let model = &last.confirmed.prepared.model;
    model
        .parameters()
        .iter()
        .zip(&last.confirmed.theta)
        .filter(|(p, _)| p.effect == effect)
        .all(|(p, value)| *value >= p.plausible.0 - 1e-9 && *value <= p.plausible.1 + 1e-9)
}

fn candidates(search: &Search, classes: &[(Class, Confidence)]) -> Vec<CandidateResult> {
    let stage = &search.stages[0];
    let scene = &stage.scene;
    let limit = stage.adequacy.null.score_at(0.05).sqrt();
    let singles = crate::search::singles(scene, &stage.confirmed.prepared.model);
    let mut found: Vec<CandidateResult> = Vec::new();
    for (place, screened) in scene.showings.effects.iter().enumerate() {
        let card = screened.effect.card();
        let linear = singles.iter().find(|h| h.effects == [place]);
        let tried: Option<&Tried> = stage.tried.iter().find(|t| t.hypothesis.effects == [place]);
        let named = classes.iter().any(|(c, _)| c.effect.card().name == card.name);
        let rival =
            classes.iter().any(|(c, _)| c.rivals.iter().any(|r| r.in_class && r.effect.card().name == card.name));
        let status = if named {
            "confirmed"
        } else if rival {
            "rival"
        } else if screened.untestable.is_some() || linear.is_none() {
            "not-testable"
        } else if tried.is_some_and(|t| t.confirmed.as_ref().is_none_or(|c| !c.converged)) {
            "not-converged"
        } else {
            "rejected"
        };
        let candidate = scene.candidates.iter().find(|c| c.effect == place);
        let unit = screened.effect.parameters().first().map(|p| (p.unit.to_owned(), p.factor));
        let per_size = candidate.map_or(0.0, |c| c.detectability(1.0));
        found.push(CandidateResult {
            effect: card.name.to_owned(),
            log_evidence: tried
                .filter(|t| t.log_evidence.is_finite())
                .map(|t| t.log_evidence)
                .or(linear.map(|h| h.log_evidence))
                .unwrap_or(0.0),
            score: linear.map_or(0.0, |h| h.gain),
            status,
            detection_limit: unit
                .as_ref()
                .filter(|_| per_size > 0.0)
                .map(|(_, factor)| limit / per_size / factor),
            unit: unit.map_or(String::new(), |(unit, _)| unit),
            detection_limit_n: None,
            compensation: candidate.map_or(1.0, |c| c.compensated),
            why: screened.untestable.clone(),
        });
    }
    found.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    found
}
