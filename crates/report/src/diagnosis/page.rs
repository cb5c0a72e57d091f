//! The page of a diagnosis: fills texts, tables and plots into the template.

use bulge_inference::{Diagnosis, Missing, NextExperiment, Verdict};
use minijinja::value::Value;
use serde::Serialize;

use crate::PlotError;
use crate::comparison::Plot;
use crate::comparison::data;
use crate::comparison::number::{and, count, newton, three};
use crate::comparison::page::{Figure, filled, model_and_measurement};
use crate::comparison::wording::sentence;
use crate::diagnosis::{
    bending_says, bent, candidates, chance, explained, forms_says, further, headlines, limits, located,
    noise_says, others_in_class, remaining, remains_says, rivals, steps, words,
};
use crate::explore::{Explore, policy};
use crate::interval::with_interval;

/// A missing effect as shown in the box of the verdict.
#[derive(Debug, Serialize)]
struct Found<'a> {
    effect: &'a str,
    class: String,
    forms: Vec<String>,
    /// Whether no other effect explains the data as well.
    is_alone: bool,
    detectability: String,
    /// How often the claim and its class are right; empty without a claim.
    right: String,
    /// Name, value, interval.
    numbers: Vec<[String; 3]>,
    plausible: bool,
}

/// All values of the template.
#[derive(Debug, Serialize)]
struct Page<'a> {
    muscle: &'a str,
    version: &'static str,
    schema: &'static str,
    policy: Value,
    explore: Option<Explore>,
    tone: &'static str,
    headlines: Vec<String>,
    says: &'a str,
    found: Vec<Found<'a>>,
    base: String,
    data_says: String,
    steps: Option<Figure>,
    steps_says: String,
    rungs: Vec<steps::Row>,
    explained: Vec<Figure>,
    bent: Vec<Figure>,
    explained_says: String,
    candidates: Option<Figure>,
    candidates_says: String,
    untested: Vec<(String, String)>,
    rivals: Option<Figure>,
    rivals_says: String,
    located: Option<Figure>,
    located_says: String,
    remaining: Option<Figure>,
    remaining_says: String,
    hints: &'a [String],
    noise_says: String,
    noise: Vec<(&'static str, String)>,
    limits: Vec<limits::Row>,
    limits_says: String,
    next_says: String,
    next: Vec<(&'static str, String)>,
    comparison: Vec<Figure>,
    findings: Vec<data::Row>,
    warnings: &'a [String],
    files: &'a [String],
    sha256: &'a str,
}

/// The page as HTML.
///
/// # Errors
/// A plot can't be drawn, or the template can't be filled in.
pub(super) fn render(diagnosis: &Diagnosis) -> Result<String, PlotError> {
    filled("diagnosis.html", include_str!("diagnosis.html"), &page(diagnosis)?)
}

fn page(diagnosis: &Diagnosis) -> Result<Page<'_>, PlotError> {
    let figure = |plot: Option<Plot>| plot.map(|plot| Figure::new(plot, String::new()));
    let explained = explained::with_sentences(diagnosis)?;
    let bent = bent::with_sentences(diagnosis)?;
    let remains = sentence(&remains_says(diagnosis));
    let comparison = steps::with_noise(diagnosis);
    let explore = Explore::of(&comparison, diagnosis.rows.as_ref())?;
    Ok(Page {
        muscle: &diagnosis.muscle,
        version: env!("CARGO_PKG_VERSION"),
        schema: diagnosis.schema,
        policy: Value::from_safe_string(policy(explore.is_some())),
        explore,
        tone: tone(diagnosis.verdict),
        headlines: headlines(diagnosis).iter().map(|line| sentence(line)).collect(),
        says: further(diagnosis).unwrap_or_default(),
        found: diagnosis
            .missing
            .iter()
            .map(|missing| found(missing, diagnosis.verdict))
            .chain(diagnosis.nearest.iter().map(|nearest| found(nearest, Verdict::Unknown)))
            .collect(),
        base: words::base_name(diagnosis),
        data_says: data_says(diagnosis),
        steps: figure(steps::plot(diagnosis)?),
        steps_says: steps::says(diagnosis),
        rungs: steps::rows(diagnosis),
        explained_says: explained_says(diagnosis, explained.len()),
        explained: explained.into_iter().map(|(plot, says)| Figure::new(plot, says)).collect(),
        bent: bent
            .into_iter()
            .map(|(plot, says)| Figure::new(plot, format!("{}.", sentence(&says))))
            .collect(),
        candidates: figure(candidates::plot(diagnosis)?),
        candidates_says: candidates::says(diagnosis),
        untested: candidates::untested(diagnosis),
        rivals: figure(rivals::plot(diagnosis)?),
        rivals_says: rivals::says(diagnosis),
        located: figure(located::plot(diagnosis)?),
        located_says: located::says(diagnosis),
        remaining: figure(remaining::plot(diagnosis)?),
        remaining_says: format!("{remains}."),
        hints: &diagnosis.remaining.hints,
        noise_says: format!("{}.", sentence(&noise_says(diagnosis))),
        noise: noise(diagnosis),
        limits: limits::rows(diagnosis),
        limits_says: limits::says(diagnosis),
        next_says: next_says(diagnosis.next_experiment.as_ref()),
        next: diagnosis.next_experiment.as_ref().map(next).unwrap_or_default(),
        comparison: model_and_measurement(&comparison)?,
        findings: data::findings(&diagnosis.comparison),
        warnings: &diagnosis.warnings,
        files: &diagnosis.comparison.data.files,
        sha256: &diagnosis.data.sha256,
    })
}

/// CSS class of the box of the verdict.
fn tone(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Adequate => "adequate",
        Verdict::Missing => "missing",
        Verdict::Unknown => "unknown",
        Verdict::CannotTell => "cannot-tell",
    }
}

fn found(missing: &Missing, verdict: Verdict) -> Found<'_> {
    let others: Vec<String> = others_in_class(missing).map(str::to_owned).collect();
    let numbers = missing.parameters.iter().map(|(name, p)| {
        let [value, low, high] = with_interval(p.value, [p.low, p.high]).map_or_else(
            || [p.value, p.low, p.high].map(three),
            |shown| shown.map(|text| text.replace('-', "−")),
        );
        let unit = if p.unit == "1" { "" } else { &p.unit };
        [name.clone(), format!("{value} {unit}").trim_end().to_owned(), format!("{low} to {high}")]
    });
    Found {
        effect: &missing.effect,
        class: and(&others),
        is_alone: others.is_empty() && missing.forms.is_empty(),
        forms: [forms_says(missing), bending_says(missing)]
            .into_iter()
            .flatten()
            .map(|says| sentence(&says))
            .collect(),
        detectability: three(missing.detectability),
        right: if verdict == Verdict::Missing { right(missing) } else { String::new() },
        numbers: numbers.collect(),
        plausible: missing.plausible,
    }
}

/// How often such a claim is right, with its interval, and how often its class contains the right effect.
fn right(missing: &Missing) -> String {
    let simulated = &missing.simulated;
    if simulated.claims == 0 {
        return format!("{} of the time", chance(missing.confidence));
    }
    // Together with other claims a claim is right less often than alone.
    let together = if missing.confidence < simulated.interval[0] {
        format!("{} of the time with all that is named together; alone ", chance(missing.confidence))
    } else {
        String::new()
    };
    let [low, high] = simulated.interval.map(|end| format!("{:.0}", 100.0 * end));
    format!(
        "{together}{} of the time ({} on simulated data like these: 95 % interval {low} to {high} %); the class holds the right effect {} of the time",
        chance(simulated.named),
        count(simulated.claims, "such claim"),
        chance(simulated.class)
    )
}

fn data_says(diagnosis: &Diagnosis) -> String {
    let data = &diagnosis.data;
    let left_out =
        if data.used < data.rows { format!(", {} of them used", data.used) } else { String::new() };
    let specimens =
        if data.specimens > 1 { format!(" on {}", count(data.specimens, "specimen")) } else { String::new() };
    format!("{}{left_out}, in {}{specimens}", count(data.rows, "row"), count(data.sweeps, "sweep"))
}

fn explained_says(diagnosis: &Diagnosis, drawn: usize) -> String {
    match (drawn, diagnosis.explained.len()) {
        (0, _) => "Nothing was added, so there is nothing that it explains.".to_owned(),
        (drawn, all) if drawn < all => {
            format!("Effects were added in {all} steps; the first {drawn} are drawn.")
        }
        (drawn, _) => format!("Effects were added in {}.", count(drawn, "step")),
    }
}

fn noise(diagnosis: &Diagnosis) -> Vec<(&'static str, String)> {
    let (noise, law) = (&diagnosis.noise, &diagnosis.noise.law);
    let mut facts = vec![
        ("single reading", newton(noise.sd_n)),
        ("independent part", newton(law.white_n)),
        ("correlated part", newton(law.correlated_n)),
        ("offsets of sweeps", newton(law.offset_n)),
        ("source", words::found_by(noise.source).to_owned()),
        ("rows that count as independent", three(diagnosis.data.effective_rows)),
    ];
    if !law.says.is_empty() {
        facts.push(("found from", law.says.clone()));
    }
    facts
}

fn next_says(next: Option<&NextExperiment>) -> String {
    match next {
        None => {
            "None is proposed: no further experiment would decide something that is open here.".to_owned()
        }
        Some(next) => format!("{}.", sentence(next.says.trim().trim_end_matches('.'))),
    }
}

/// Facts about the next experiment; empty if there is none, which the sentence says.
fn next(next: &NextExperiment) -> Vec<(&'static str, String)> {
    if next.repeats == 0 {
        return Vec::new();
    }
    vec![
        ("separates", and(&next.separates)),
        ("by", format!("{} sigma", three(next.sigma))),
        ("repeats", next.repeats.to_string()),
    ]
}
