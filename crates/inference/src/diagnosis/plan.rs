//! Planning before measuring: what a test would show, and which effects it could not distinguish. No data are
//! needed: the scores of the screen are evaluated without a misfit.
//!
//! ```text
//! detection limit A_min = 3.3/|s_e|,    confusability rho = |cos angle(s_e, s_e')|,    s_e = P K^-1/2 dF/dA_e
//! ```

use bulge_effects::{Catalogue, Effect};
use bulge_model::{Model, Record};
use bulge_muscles::{Muscle, Quantity};
use serde::Serialize;
use std::sync::Arc;

use crate::diagnosis::candidates::Candidate;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::linearised_model::{Context, LinearisedModel};
use crate::diagnosis::sensitivity::Sign;
use crate::error::InferenceError;
use crate::fit::nuisance::{known_model, with_nuisances};
use crate::fit::weights::Noise;
use crate::noise::law::{CorrelationTime, NoiseLaw, NoiseSource};
use crate::noise::whitening::Whitening;
use crate::protocol::bench::Protocol;
use crate::vector::{range, rms};
use bulge_model::Wanted;
use bulge_numerics::vector::{dot, norm};

/// Sigmas at which an effect is detected: one error in a thousand.
pub(crate) const SEEN: f64 = 3.3;
/// Cosine from which two effects are reported as similar.
const ALIKE: f64 = 0.9;
/// Signals below this many sigmas are rounding errors.
const NOTHING: f64 = 1e-3;
/// Most pairs that are listed.
const MOST_PAIRS: usize = 40;

/// What a test would show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Name and version of the document: `bulge.plan/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// Rows of the test, as far as the muscle pulls.
    pub rows: usize,
    /// Sweeps of the test.
    pub sweeps: usize,
    /// Least and largest pressure \[Pa\].
    pub pressure_pa: [f64; 2],
    /// Least and largest contraction.
    pub contraction: [f64; 2],
    /// The assumed noise.
    pub noise: NoiseLaw,
    /// All effects, the most visible first.
    pub effects: Vec<PlannedEffect>,
    /// Pairs that this test can hardly distinguish, the most similar first.
    pub confused: Vec<ConfusedPair>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

/// What a test would show of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedEffect {
    /// Its name.
    pub effect: String,
    /// The family that it belongs to.
    pub family: String,
    /// Name of the parameter that measures its size.
    pub parameter: String,
    /// Smallest deviation of that parameter that is detected (3.3 sigma), in `unit`; none if the test can't
    /// show the effect.
    pub detection_limit: Option<f64>,
    /// Unit of the limit.
    pub unit: String,
    /// RMS change of the force at that limit \[N\].
    pub detection_limit_n: Option<f64>,
    /// Signal of a deviation of the usual size, in sigmas.
    pub usual_sigma: f64,
    /// Fraction of the effect that uncertainties of the rig and the muscle can compensate.
    pub compensation: f64,
    /// Why the test can't show it, if so.
    pub why: Option<String>,
}

/// Two effects that look similar in a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfusedPair {
    /// Names of the two effects.
    pub effects: [String; 2],
    /// Cosine of the angle between them.
    pub cosine: f64,
    /// Sigmas between the two, each at its usual size: the smaller value of both directions.
    pub sigma: f64,
    /// Number of repeats that separates them (3.29 sigma); none if no number does.
    pub repeats: Option<f64>,
    /// The experiment that separates them, from the catalogue.
    pub separate: String,
}

/// A planned record with its whitening.
pub(crate) struct Planned {
    pub(crate) record: Record,
    pub(crate) law: NoiseLaw,
    pub(crate) whitening: Whitening,
}

/// What a protocol would show of a muscle with its known effects.
///
/// # Errors
/// If a number of the protocol is impossible, or if the muscle has no equilibrium there.
pub fn plan(
    muscle: &Muscle,
    known: &[(Arc<dyn Effect>, Vec<f64>)],
    catalogue: &Catalogue,
    protocol: &Protocol,
) -> Result<Plan, InferenceError> {
    // Usual widths, as in a diagnosis of these data.
    let (muscle, doubtful) = &muscle.clone().with_usual_widths();
    let (muscle, specimens) = &protocol.specimens_of(muscle)?;
    let model = known_model(muscle, known, specimens)?;
    let prepared = with_nuisances(&model, catalogue)?;
    let theta = prepared.start();
    let planned = Planned::of(&prepared.model, &theta, protocol)?;
    let context = planned.context(catalogue);
    let linear = context.linearised(&prepared, &theta)?;
    let moments = planned.record.moments();
    let mut warnings = Vec::new();
    if planned.law.source == NoiseSource::Instruments && planned.law.degrees_of_freedom == 0.0 {
        warnings.push(
            "no noise is stated by the protocol or `[instruments]`: 1 % of full scale is assumed".to_owned(),
        );
    }
    if !doubtful.is_empty() {
        let names: Vec<&str> = doubtful.iter().map(|(parameter, _)| parameter.name()).collect();
        warnings.push(format!(
            "the usual widths of geometry count for {}, of which the muscle file states none: write such as `+- 0.2 mm`, or `+- 0` if exact",
            names.join(", ")
        ));
    }
    let mut effects = effects(&linear, muscle);
    effects.sort_by(|a, b| b.usual_sigma.total_cmp(&a.usual_sigma).then(a.effect.cmp(&b.effect)));
    Ok(Plan {
        schema: "bulge.plan/1",
        muscle: muscle.name().to_owned(),
        rows: planned.record.len(),
        sweeps: planned.record.sweeps().len(),
        pressure_pa: range(moments.iter().map(|m| m.pressure)),
        contraction: range(moments.iter().map(|m| m.contraction)),
        noise: planned.law.clone(),
        effects,
        confused: confused(&linear),
        warnings,
    })
}

impl Planned {
    /// The rows of a protocol with the forces of a model, and the noise that the protocol (or else the
    /// muscle's instruments) states.
    pub(crate) fn of(model: &Model, theta: &[f64], protocol: &Protocol) -> Result<Self, InferenceError> {
        let record = protocol.moments_within(model, theta)?;
        let readings = Wanted { parameters: Vec::new(), readings: true };
        let prediction = model.evaluate(&record, theta, &readings)?;
        let law = law_of(protocol, model.muscle(), &prediction.force);
        let stated = Noise::of(model.muscle(), law.white_n);
        let length = model.muscle().length().si();
        let or = |own: f64, other: f64| if own > 0.0 { own } else { other };
        let pressure = or(protocol.noise.pressure_pa, stated.pressure_pa);
        let contraction = or(protocol.noise.length_m / length, stated.contraction);
        let variances: Vec<f64> = prediction
            .by_pressure
            .iter()
            .zip(&prediction.by_contraction)
            .map(|(p, e)| (p * pressure).powi(2) + (e * contraction).powi(2))
            .collect();
        let record = record.with_force(prediction.force);
        let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &variances)?;
        Ok(Self { record, law, whitening })
    }

    pub(crate) fn context<'a>(&'a self, catalogue: &'a Catalogue) -> Context<'a> {
        Context::new(catalogue, &self.record, &self.whitening, &self.law)
    }
}

/// The noise of a protocol; if it states none, that of the load cell; if that is missing too, 1 % of full
/// scale.
fn law_of(protocol: &Protocol, muscle: &Muscle, force: &[f64]) -> NoiseLaw {
    let noise = &protocol.noise;
    let stated = muscle.instruments().force.map_or(0.0, |force| force.noise());
    let step = protocol.steps.force_n / 12.0_f64.sqrt();
    let said = noise.force_n.hypot(step);
    let (white_n, says, freedom) = if said > 0.0 || noise.correlated_n > 0.0 {
        (said.max(1e-3 * noise.correlated_n), "the protocol", 1e6)
    } else if stated > 0.0 {
        (stated, "the data sheet of the load cell", 1e6)
    } else {
        let full = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        (0.01 * full.max(1.0), "assumed: 1 % of full scale", 0.0)
    };
    let timed = noise.correlated_n > 0.0 && !protocol.is_static();
    NoiseLaw {
        correlated_n: if timed { noise.correlated_n } else { 0.0 },
        time: timed.then_some(CorrelationTime::Seconds(noise.correlation_time_s)),
        offset_n: if protocol.is_static() { 0.0 } else { noise.offset_n },
        ..NoiseLaw::white(white_n, NoiseSource::Instruments, freedom, says.to_owned())
    }
}

/// The usual form of an effect: the middle one.
fn usual(linear: &LinearisedModel, effect: usize) -> Option<&Candidate> {
    let forms: Vec<&Candidate> = linear.candidates.iter().filter(|c| c.effect == effect).collect();
    forms.get(forms.len() / 2).copied()
}

fn effects(linear: &LinearisedModel, muscle: &Muscle) -> Vec<PlannedEffect> {
    let of = |(place, screened): (usize, &crate::diagnosis::sensitivity::Screened)| {
        let card = screened.effect.card();
        let cards = screened.effect.parameters();
        let candidate = usual(linear, place);
        let size = candidate.and_then(|c| c.sizes.first());
        let number = cards.get(size.map_or(0, |s| s.place));
        let unit = number.map_or(("", 1.0), |n| (n.unit, n.factor));
        let per_size = candidate.map_or(0.0, |c| c.detectability(1.0));
        let range = number.map(|n| n.of(muscle)).map_or(f64::INFINITY, |n| n.high - n.low);
        // A limit beyond the bounds of the parameter means that the test can't show the effect.
        let limit = (per_size > 0.0).then(|| SEEN / per_size).filter(|limit| *limit <= range);
        let column =
            candidate.and_then(|c| linear.sensitivities.sensitivities[c.sensitivity].columns.first());
        let rms = column.map_or(0.0, |c| rms(c));
        PlannedEffect {
            effect: card.name.to_owned(),
            family: card.family.to_owned(),
            parameter: number.map_or(String::new(), |n| n.name.to_owned()),
            detection_limit: limit.filter(|_| candidate.is_some_and(|c| !c.whole)).map(|l| l / unit.1),
            unit: unit.0.to_owned(),
            detection_limit_n: limit.map(|l| l * rms),
            usual_sigma: size.map_or(0.0, |s| s.scale * per_size),
            compensation: candidate.map_or(1.0, |c| c.compensated),
            why: screened.untestable.clone().or_else(|| {
                candidate.is_none().then(|| {
                    "can't be told from what the rig's and the muscle's widths leave open".to_owned()
                })
            }),
        }
    };
    linear.sensitivities.effects.iter().enumerate().map(of).collect()
}

/// Similar effects of different families.
fn confused(linear: &LinearisedModel) -> Vec<ConfusedPair> {
    let all: Vec<&Candidate> =
        (0..linear.sensitivities.effects.len()).filter_map(|effect| usual(linear, effect)).collect();
    let mut found = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            let [x, y] = [a, b].map(|c| &linear.sensitivities.effects[c.effect].effect);
            if x.card().family == y.card().family {
                continue;
            }
            let Some(cosine) = cosine(a, b).filter(|cosine| *cosine >= ALIKE) else { continue };
            let usual = |c: &Candidate| c.sizes.first().map_or(0.0, |size| c.detectability(size.scale));
            let sigma = usual(a).min(usual(b)) * (1.0 - cosine * cosine).max(0.0).sqrt();
            found.push(ConfusedPair {
                effects: [x.card().name.to_owned(), y.card().name.to_owned()],
                cosine,
                sigma,
                repeats: (sigma > NOTHING).then(|| (RULE.separation / sigma).powi(2).ceil().max(1.0)),
                separate: x.card().separate.to_owned(),
            });
        }
    }
    // Pairs that are equally alike, but for last digits, stay in the catalogue's order.
    let rounded = |pair: &ConfusedPair| (1e9 * pair.cosine).round();
    found.sort_by(|a, b| rounded(b).total_cmp(&rounded(a)));
    found.truncate(MOST_PAIRS);
    found
}

/// The cosine between the first columns of two effects; none if their signs can't agree.
fn cosine(a: &Candidate, b: &Candidate) -> Option<f64> {
    let (x, y) = (a.columns.first()?, b.columns.first()?);
    let value = dot(x, y) / (norm(x) * norm(y)).max(f64::MIN_POSITIVE);
    let signs = [a, b].map(|c| c.sizes.first().map_or(Sign::Any, |size| size.sign));
    let may = match signs {
        [Sign::Any, _] | [_, Sign::Any] => true,
        [x, y] if x == y => value > 0.0,
        _ => value < 0.0,
    };
    may.then_some(value.abs().min(1.0))
}
