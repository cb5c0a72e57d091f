//! `bulge next`: the next experiment, which best separates the effects that measurements leave open.

use bulge_effects::{Catalogue, known};
use bulge_inference::{
    CandidateResult, DiagnoseOptions, Diagnosis, Missing, NextExperiment, NextLimits, Options, Verdict,
    diagnose,
};
use bulge_measurements::Data;
use bulge_muscles::units::Quantity;
use bulge_muscles::{Pressure, Ratio};
use bulge_report::diagnosis::{further, headlines, others_in_class};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments;
use crate::diagnose::paragraph::{paragraph, quoted};
use crate::diagnose::progress::Bar;
use crate::diagnose::text::untested;
use crate::diagnose::untested::reasons;
use crate::failure::Failure;
use crate::text::significant;

const PRESSURE: &str = "--pressure";
const CONTRACTION: &str = "--contraction";
/// Highest gauge pressure \[Pa\], and contractions that a bench can set, as for a protocol.
const MOST_PRESSURE: f64 = 1e8;
const CONTRACTIONS: [f64; 2] = [-1.0, 0.6];
/// Hints that are shown.
const MOST_HINTS: usize = 4;
/// A compensation from which other numbers, and not the noise, set a detection limit.
const MUCH: f64 = 0.5;
/// What stands before the effects that could not be looked for.
const UNTESTED: &str = "  could not be looked for ";

/// The next experiment: the test within your limits that best separates the effects that these data leave open.
#[derive(Debug, Args)]
pub(crate) struct NextCommand {
    /// Measured rows: CSV (or Parquet) with columns such as `pressure [bar]`, `contraction [%]`, `force [N]`; several files make one analysis
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects that the model has already: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    /// Your own effects, as expressions in a TOML file: they are looked for too
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Gauge pressures that the next test may use: "1 bar..6 bar" [default: those of the data]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Contractions that it may use: "0 %..20 %" [default: those of the data]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    contraction: Option<String>,
    /// Seed of the random numbers: the same seed gives the same answer
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

/// Said where no test separates, and nobody has stated what can be tested.
const WIDER: &str = "these limits are those of the data; --pressure and --contraction allow for others";

/// An effect that is missing, in the JSON document.
#[derive(Debug, Serialize)]
struct Named<'a> {
    effect: &'a str,
    class: &'a [String],
    confidence: f64,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    schema: &'static str,
    muscle: &'a str,
    verdict: Verdict,
    missing: Vec<Named<'a>>,
    next_experiment: Option<&'a NextExperiment>,
    says: String,
}

impl NextCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let limits = self.limits()?;
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = Data::read(&self.data)?;
        let known = known(&muscle, &catalogue)?;
        let bar = Bar::new(self.json);
        let progress = bar.progress();
        let base = Options { known, ..Options::new(catalogue.clone(), effects) };
        let options = DiagnoseOptions { seed: self.seed, limits, progress, ..DiagnoseOptions::new(base) };
        let found = diagnose(&data, &muscle, &options)?;
        drop(bar);
        let answer = answer(&found, &catalogue, limits);
        if self.json { document(&found, &answer) } else { Ok(self.text(&found, &answer)) }
    }

    /// What the next test may use.
    fn limits(&self) -> Result<NextLimits, Failure> {
        let pressure_pa = self
            .pressure
            .as_deref()
            .map(|text| rising::<Pressure>(PRESSURE, text, "1 bar..6 bar"))
            .transpose()?;
        if let Some([low, high]) = pressure_pa.filter(|[low, high]| !(*low > 0.0 && *high <= MOST_PRESSURE)) {
            let what = format!(
                "{low} to {high} Pa is not possible: gauge pressures lie above 0 and up to 1000 bar; write such as \"1 bar..6 bar\""
            );
            return Err(Failure::Value { option: PRESSURE, what });
        }
        let contraction = self
            .contraction
            .as_deref()
            .map(|text| rising::<Ratio>(CONTRACTION, text, "0 %..20 %"))
            .transpose()?;
        let [least, most] = CONTRACTIONS;
        if let Some([low, high]) = contraction.filter(|[low, high]| *low < least || *high > most) {
            let what = format!(
                "{} to {} % is not possible: contractions lie within -100 % and 60 %; write such as \"0 %..20 %\"",
                significant(100.0 * low, 4),
                significant(100.0 * high, 4)
            );
            return Err(Failure::Value { option: CONTRACTION, what });
        }
        Ok(NextLimits { pressure_pa, contraction })
    }

    /// The answer for people.
    fn text(&self, diagnosis: &Diagnosis, answer: &Answer<'_>) -> String {
        let data: Vec<String> = self.data.iter().map(|path| path.display().to_string()).collect();
        let mut out = format!("{}, after {}\n\n", diagnosis.muscle, data.join(", "));
        paragraph(&mut out, "  ", &verdict(diagnosis));
        if let Some(open) = answer.open {
            let others: Vec<&str> = others_in_class(open).collect();
            paragraph(
                &mut out,
                "  ",
                &format!("open: these data cannot tell {} from {}", open.effect, others.join(", ")),
            );
        }
        out.push('\n');
        for sentence in &answer.sentences {
            paragraph(&mut out, "  ", sentence);
        }
        if answer.next.is_some_and(|next| next.repeats > 0) {
            let _ = writeln!(
                out,
                "\n  and then, with both:\n    bulge diagnose {} NEW.csv {}",
                self.files(),
                self.rest()
            );
        }
        if answer.open.is_none() {
            for line in reasons(&untested(diagnosis), UNTESTED.len()) {
                let _ = writeln!(out, "{UNTESTED}{line}");
            }
        }
        out
    }

    fn files(&self) -> String {
        self.data.iter().map(|path| quoted(&path.display().to_string())).collect::<Vec<_>>().join(" ")
    }

    /// The options that the next call takes over.
    fn rest(&self) -> String {
        let mut rest = format!("--muscle {}", quoted(&self.muscle));
        if let Some(file) = &self.effects {
            let _ = write!(rest, " --effects {}", quoted(&file.display().to_string()));
        }
        if !self.with.is_empty() {
            let with: Vec<&str> = self.with.iter().map(|name| name.trim()).collect();
            let _ = write!(rest, " --with {}", quoted(&with.join(",")));
        }
        rest
    }
}

/// A range with units, the smaller end first.
fn rising<Q: Quantity>(option: &'static str, text: &str, example: &str) -> Result<[f64; 2], Failure> {
    let [low, high] = arguments::range::<Q>(option, text)?;
    if low < high {
        return Ok([low, high]);
    }
    let what =
        format!("the range \"{}\" is empty: write the smaller end first, as in \"{example}\"", text.trim());
    Err(Failure::Value { option, what })
}

/// What to do next.
struct Answer<'a> {
    /// The effect that these data can't tell from others.
    open: Option<&'a Missing>,
    /// The experiment for it, or that there is none.
    next: Option<&'a NextExperiment>,
    /// In words.
    sentences: Vec<String>,
}

/// What to do next, by the verdict.
fn answer<'a>(diagnosis: &'a Diagnosis, catalogue: &Catalogue, limits: NextLimits) -> Answer<'a> {
    let mut sentences = Vec::new();
    let next = diagnosis.next_experiment.as_ref().filter(|_| diagnosis.verdict == Verdict::Missing);
    // The experiment is for the first class that holds several.
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
            let why = if verdict == Verdict::Missing {
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
    Answer { open, next, sentences }
}

/// What would lower the largest detection limit.
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

/// Where to measure again when something is left that no effect explains.
fn again(diagnosis: &Diagnosis) -> String {
    let points = diagnosis.remaining.surface.iter().flat_map(|curve| {
        curve.contraction.iter().zip(&curve.misfit_n).map(|(e, misfit)| (misfit.abs(), *e, curve.pressure_pa))
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
        "next: repeat the test {place}: what is there again is the muscle's or the rig's, and a new effect (--effects FILE) may describe it; what is not was an event"
    )
}

/// The verdict in a line.
fn verdict(diagnosis: &Diagnosis) -> String {
    if diagnosis.verdict == Verdict::Missing {
        let names: Vec<&str> = diagnosis.missing.iter().map(|missing| missing.effect.as_str()).collect();
        let left = if diagnosis.remaining.structured { "; something remains beyond" } else { "" };
        return format!("missing: {}{left}", names.join(", "));
    }
    headlines(diagnosis).first().cloned().unwrap_or_default()
}

fn document(diagnosis: &Diagnosis, answer: &Answer<'_>) -> Result<String, Failure> {
    let missing = diagnosis
        .missing
        .iter()
        .map(|m| Named { effect: &m.effect, class: &m.class, confidence: m.confidence })
        .collect();
    let document = Document {
        schema: "bulge.next/1",
        muscle: &diagnosis.muscle,
        verdict: diagnosis.verdict,
        missing,
        next_experiment: answer.next,
        says: answer.sentences.join(". "),
    };
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}
