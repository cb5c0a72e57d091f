//! The next experiment in words: what remains to be done after the verdict of a diagnosis.

use bulge_effects::Catalogue;
use bulge_inference::{CandidateResult, Diagnosis, Missing, NextExperiment, NextLimits, Verdict};
use bulge_muscles::units::significant;
use serde::Serialize;

use crate::diagnosis::headline::{further, others_in_class};

/// Most hints shown.
const MOST_HINTS: usize = 4;
/// Above this compensation the detection limit is set by other parameters and not by the noise.
const MUCH: f64 = 0.5;
/// Sentence for the case that no test separates the effects and nobody has stated what can be tested.
const WIDER: &str =
    "these limits are those of the data: state wider ones of pressure and contraction to allow for others";

/// The next thing to do.
#[derive(Debug)]
pub struct NextStep<'a> {
    diagnosis: &'a Diagnosis,
    /// The effect that these data can't distinguish from others.
    pub open: Option<&'a Missing>,
    /// The experiment that would separate them, or the finding that there is none.
    pub next: Option<&'a NextExperiment>,
    /// The advice in words.
    pub sentences: Vec<String>,
}

/// A missing effect in the JSON document.
#[derive(Debug, Serialize)]
struct Named<'a> {
    effect: &'a str,
    class: &'a [String],
    confidence: f64,
}

/// The JSON document.
#[derive(Debug, Serialize)]
pub struct NextDocument<'a> {
    schema: &'static str,
    muscle: &'a str,
    verdict: Verdict,
    missing: Vec<Named<'a>>,
    next_experiment: Option<&'a NextExperiment>,
    says: String,
}

impl<'a> NextStep<'a> {
    /// The next step after a diagnosis made within `limits`.
    #[must_use]
    pub fn after(diagnosis: &'a Diagnosis, catalogue: &Catalogue, limits: NextLimits) -> Self {
        answer(diagnosis, catalogue, limits)
    }

    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> NextDocument<'_> {
        let named = |m: &'a Missing| Named { effect: &m.effect, class: &m.class, confidence: m.confidence };
        NextDocument {
            schema: "bulge.next/1",
            muscle: &self.diagnosis.muscle,
            verdict: self.diagnosis.verdict,
            missing: self.diagnosis.missing.iter().map(named).collect(),
            next_experiment: self.next,
            says: self.sentences.join(". "),
        }
    }
}

/// The next step, depending on the verdict.
fn answer<'a>(diagnosis: &'a Diagnosis, catalogue: &Catalogue, limits: NextLimits) -> NextStep<'a> {
    let mut sentences = Vec::new();
    let next = diagnosis.next_experiment.as_ref().filter(|_| diagnosis.verdict == Verdict::Missing);
    // The experiment is for the first class with several members.
    let several = || diagnosis.missing.iter().filter(|missing| others_in_class(missing).next().is_some());
    let is_meant = |missing: &&Missing| next.is_some_and(|next| next.separates.contains(&missing.effect));
    let open = next.and_then(|_| several().find(is_meant).or_else(|| several().next()));
    match (diagnosis.verdict, next) {
        (Verdict::Unknown, _) => {
            sentences.extend(diagnosis.remaining.hints.iter().take(MOST_HINTS).cloned());
            sentences.push(again(diagnosis));
        }
        (Verdict::CannotTell, _) => {
            sentences.push(further(diagnosis).unwrap_or("measure more rows").to_owned());
        }
        (_, Some(next)) if next.repeats > 0 => sentences.push(format!("next: {}", next.says.trim())),
        (_, Some(next)) => {
            sentences.push(next.says.trim().to_owned());
            if limits == NextLimits::default() {
                sentences.push(WIDER.to_owned());
            }
        }
        (verdict, None) => {
            let is_open = diagnosis.missing.iter().any(|missing| missing.class.len() > 1);
            let why = if verdict == Verdict::Missing && is_open {
                "what these data leave open are forms of one effect, which further tests like these hardly tell apart"
            } else if verdict == Verdict::Missing {
                "these data tell every effect that was found from all others"
            } else {
                "no effect is missing that could be taken for another one"
            };
            sentences.push(format!("nothing to separate: {why}"));
            sentences.extend(lower(diagnosis, catalogue));
        }
    }
    if diagnosis.verdict == Verdict::Missing && diagnosis.remaining.structured {
        sentences.push(again(diagnosis));
    }
    NextStep { diagnosis, open, next, sentences }
}

/// The measure that would lower the largest detection limit.
fn lower(diagnosis: &Diagnosis, catalogue: &Catalogue) -> Option<String> {
    let limited =
        diagnosis.candidates.iter().filter(|c| c.status == "rejected" && c.detection_limit.is_some());
    let force = |c: &CandidateResult| c.detection_limit_n.filter(|n| n.is_finite());
    let (least, force_n) = limited.filter_map(|c| Some((c, force(c)?))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let unit = if least.unit == "1" { "" } else { &least.unit };
    let limit = format!("{} {unit}", significant(least.detection_limit?, 3));
    let cure = if least.compensation > MUCH {
        let separate = catalogue.find(&least.effect).ok().map(|effect| effect.card().separate);
        format!(
            "other numbers can make up for {:.0} % of it; {}",
            100.0 * least.compensation,
            separate
                .filter(|separate| !separate.is_empty())
                .unwrap_or("state their widths, or measure over a wider range")
        )
    } else {
        "four times the rows, or a quarter of the variance of the noise, halve it".to_owned()
    };
    Some(format!(
        "the largest detection limit is that of `{}`: {} ({} N). What lowers it: {cure}",
        least.effect,
        limit.trim_end(),
        significant(force_n, 3)
    ))
}

/// Where to measure again if a misfit remains that no effect explains.
fn again(diagnosis: &Diagnosis) -> String {
    let points = diagnosis.remaining.surface.iter().flat_map(|curve| {
        curve
            .at
            .contraction
            .iter()
            .zip(&curve.misfit_n)
            .map(|(e, misfit)| (misfit.abs(), *e, curve.at.pressure_pa))
    });
    let largest = points.max_by(|a, b| a.0.total_cmp(&b.0));
    let place = largest.map_or_else(
        || "where the misfit is largest".to_owned(),
        |(misfit, contraction, pressure)| {
            format!(
                "where the misfit is largest, around contraction {} % at {} bar ({} N)",
                significant(100.0 * contraction, 2),
                significant(pressure / 1e5, 2),
                significant(misfit, 2)
            )
        },
    );
    format!(
        "next: repeat the test {place}: what is there again is the muscle's or the rig's, and an effect of your own may describe it; what is not was an event"
    )
}
