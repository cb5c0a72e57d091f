//! `bulge fit`: effects fitted to measurements, and the muscle file that holds them.

use bulge_effects::{Catalogue, Effect, known};
use bulge_inference::{Options, fit_effects};
use bulge_measurements::Data;
use bulge_muscles::Muscle;
use bulge_report::Learnt;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use crate::arguments;
use crate::compare::parameters;
use crate::data::{DataArguments, told};
use crate::failure::Failure;
use crate::files;

/// Fits the named effects, and writes the muscle with what was learnt: a file for `shape`, `curve` and the next `compare`.
#[derive(Debug, Args)]
pub(crate) struct FitCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects to fit: `--with end-taper,bladder-elasticity`
    #[arg(long, required = true, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// The muscle file to write [default: on standard output]
    #[arg(long, value_name = "MODEL.toml")]
    out: Option<PathBuf>,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

impl FitCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = self.data.read(&muscle)?;
        let learnt = learn(&data, &muscle, effects, catalogue)?;
        if let Some(path) = &self.out {
            files::write(path, learnt.model.as_bytes())?;
        }
        if self.json {
            return Ok(serde_json::to_string_pretty(&learnt.document())? + "\n");
        }
        if self.out.is_none() {
            // A file as it is, so that it can be piped into one; the numbers are in its comments.
            eprint!("{}", told(data.reading()));
            return Ok(learnt.model);
        }
        let mut text = format!("{} fitted to {}\n\n", muscle.name(), learnt.fitting.data.files.join(", "));
        text.push_str(&told(data.reading()));
        text.push_str(&lines(&learnt));
        for (name, why) in &learnt.extension.left_out {
            let _ = writeln!(text, "  {name} is not in the file: {why}");
        }
        if let Some(path) = &self.out {
            let _ = writeln!(text, "\n  wrote {}", path.display());
        }
        Ok(text)
    }
}

/// Fits effects to data.
pub(crate) fn learn(
    data: &Data,
    muscle: &Muscle,
    effects: Vec<Arc<dyn Effect>>,
    catalogue: Catalogue,
) -> Result<Learnt, Failure> {
    let known = known(muscle, &catalogue)?;
    let options = Options { known, ..Options::new(catalogue, effects) };
    Ok(Learnt::of(fit_effects(data, muscle, &options)?)?)
}

/// What was learnt, in lines: the error before and after, the numbers, and what to mind.
pub(crate) fn lines(learnt: &Learnt) -> String {
    let mut text = String::new();
    for line in learnt.errors() {
        // Writing to a String can't fail.
        let _ = writeln!(text, "  {line}");
    }
    let fit = &learnt.fitting.fit;
    parameters(&mut text, fit);
    for warning in &fit.warnings {
        let _ = writeln!(text, "  ! {warning}");
    }
    text
}
