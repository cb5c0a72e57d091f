//! `bulge next`: the next experiment, which best separates the effects that measurements leave open.

use bulge_inference::{DiagnoseOptions, Diagnosis, NextLimits, Verdict, diagnose};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Pressure, Ratio};
use bulge_report::diagnosis::{NextStep, headlines, others_in_class};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{self, Json};
use crate::data::{DataArguments, told};
use crate::diagnose::paragraph::paragraph;
use crate::diagnose::progress::Bar;
use crate::diagnose::text::untested;
use crate::diagnose::untested::reasons;
use crate::failure::Failure;
use crate::files;
use crate::restricted::RestrictedArguments;

const PRESSURE: &str = "--pressure";
const CONTRACTION: &str = "--contraction";
/// Words before the effects that could not be tested.
const UNTESTED: &str = "  could not be looked for ";

/// The next experiment: the test within your limits that best separates the effects that these data leave open.
#[derive(Debug, Args)]
pub(crate) struct NextCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects that the model has already: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    #[command(flatten)]
    restricted: RestrictedArguments,
    /// Your own effects, as expressions in a TOML file: they are looked for too
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Gauge pressures that the next test may use: "1 bar..6 bar" [default: those of the data]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Contractions that it may use: "0 %..20 %" [default: those of the data]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    contraction: Option<String>,
    /// Writes the test as a protocol file, for `bulge plan` and `bulge simulate`
    #[arg(long, value_name = "PROTOCOL.toml")]
    out: Option<PathBuf>,
    /// Seed of the random numbers: the same seed gives the same answer
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: Json,
}

impl NextCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let limits = self.limits()?;
        if let Some(out) = &self.out {
            self.data.can_write(("--out", out), &self.muscle, self.effects.as_deref())?;
        }
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = self.data.read(&muscle)?;
        let base = self.data.options(&data, &muscle, catalogue.clone(), effects)?;
        // Usual widths, as in a diagnosis.
        let base = self.restricted.apply(base, &data, &muscle.clone().with_usual_widths().0)?;
        let bar = Bar::new(self.json.wanted);
        let progress = bar.progress();
        let options = DiagnoseOptions { seed: self.seed, limits, progress, ..DiagnoseOptions::new(base) };
        let found = diagnose(&data, &muscle, &options)?;
        drop(bar);
        let step = NextStep::after(&found, &catalogue, limits);
        let wrote = self.write(&step)?;
        self.json.or(&step.document(), || self.text(&found, &step) + &wrote)
    }

    /// Writes the protocol, if a file was requested and there is a test.
    fn write(&self, step: &NextStep<'_>) -> Result<String, Failure> {
        let Some(path) = &self.out else { return Ok(String::new()) };
        let Some(protocol) = step.next.and_then(|next| next.protocol.as_deref()) else {
            return Ok(format!("  nothing is written to {}: there is no test to make\n", path.display()));
        };
        files::write(path, protocol.to_toml().as_bytes())?;
        Ok(format!("  wrote {}\n", path.display()))
    }

    /// Limits of the next test.
    fn limits(&self) -> Result<NextLimits, Failure> {
        let pressure_pa = self
            .pressure
            .as_deref()
            .map(|text| rising::<Pressure>(PRESSURE, text, "1 bar..6 bar"))
            .transpose()?;
        let contraction = self
            .contraction
            .as_deref()
            .map(|text| rising::<Ratio>(CONTRACTION, text, "0 %..20 %"))
            .transpose()?;
        let limits = NextLimits { pressure_pa, contraction };
        let wrong = |(name, what)| Failure::Value {
            option: if name == "pressure" { PRESSURE } else { CONTRACTION },
            what,
        };
        limits.check().map_err(wrong)?;
        Ok(limits)
    }

    /// The answer as text.
    fn text(&self, diagnosis: &Diagnosis, step: &NextStep<'_>) -> String {
        let mut out = format!("{}, after {}\n\n", diagnosis.muscle, self.data.names().join(", "));
        out.push_str(&told(&diagnosis.data.reading));
        paragraph(&mut out, "  ", &verdict(diagnosis));
        if let Some(open) = step.open {
            let others: Vec<&str> = others_in_class(open).collect();
            paragraph(
                &mut out,
                "  ",
                &format!("open: these data cannot tell {} from {}", open.effect, others.join(", ")),
            );
        }
        out.push('\n');
        for sentence in &step.sentences {
            paragraph(&mut out, "  ", sentence);
        }
        if step.next.is_some_and(|next| next.repeats == 0)
            && self.pressure.is_none()
            && self.contraction.is_none()
        {
            paragraph(&mut out, "  ", "(--pressure and --contraction state them)");
        }
        if step.next.is_some_and(|next| next.repeats > 0) {
            let mut call = self.data.call(&self.muscle, &self.with, self.effects.as_deref(), &["NEW.csv"]);
            call.restrictions = self.restricted.stated();
            let _ = writeln!(out, "\n  and then, with both:\n    bulge diagnose {}", call.arguments());
        }
        if step.open.is_none() {
            for line in reasons(&untested(diagnosis), UNTESTED.len()) {
                let _ = writeln!(out, "{UNTESTED}{line}");
            }
        }
        out
    }
}

/// A range with units, smaller end first.
fn rising<Q: Quantity>(option: &'static str, text: &str, example: &str) -> Result<[f64; 2], Failure> {
    let [low, high] = arguments::range::<Q>(option, text)?;
    if low < high {
        return Ok([low, high]);
    }
    let what =
        format!("the range \"{}\" is empty: write the smaller end first, as in \"{example}\"", text.trim());
    Err(Failure::Value { option, what })
}

/// The verdict in one line.
fn verdict(diagnosis: &Diagnosis) -> String {
    if diagnosis.verdict == Verdict::Missing {
        let names: Vec<&str> = diagnosis.missing.iter().map(|missing| missing.effect.as_str()).collect();
        let left = if diagnosis.remaining.structured { "; something remains beyond" } else { "" };
        return format!("missing: {}{left}", names.join(", "));
    }
    headlines(diagnosis).first().cloned().unwrap_or_default()
}
