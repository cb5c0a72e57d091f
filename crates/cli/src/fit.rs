//! `bulge fit`: effects fitted to measurements, and the muscle file that holds them.

use bulge_effects::{Catalogue, Effect, known};
use bulge_inference::{DataSummary, Extension, Fit, Fitting, NoiseFloor, Options, extended, fit_effects};
use bulge_measurements::Data;
use bulge_muscles::{Muscle, to_toml};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use crate::arguments;
use crate::compare::parameters;
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_interval};

/// Fits the named effects, and writes the muscle with what was learnt: a file for `shape`, `curve` and the next `compare`.
#[derive(Debug, Args)]
pub(crate) struct FitCommand {
    /// Measured rows: CSV (or Parquet) with columns such as `pressure [bar]`, `contraction [%]`, `force [N]`; several files make one analysis
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
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

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    schema: &'static str,
    muscle: &'a str,
    data: &'a DataSummary,
    before_rmse_n: f64,
    rmse_n: f64,
    rmse_percent: f64,
    noise_floor: &'a Option<NoiseFloor>,
    fit: &'a Fit,
    written: &'a [String],
    left_out: &'a [(String, &'static str)],
    model: &'a str,
}

impl FitCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = Data::read(&self.data)?;
        let Fitted { fitting, extension, model } = fitted(&data, &muscle, effects, catalogue)?;
        if let Some(path) = &self.out {
            files::write(path, model.as_bytes())?;
        }
        if self.json {
            let document = Document {
                schema: "bulge.fit/1",
                muscle: muscle.name(),
                data: &fitting.data,
                before_rmse_n: fitting.before_rmse_n,
                rmse_n: fitting.rmse_n,
                rmse_percent: percent(&fitting, fitting.rmse_n),
                noise_floor: &fitting.noise_floor,
                fit: &fitting.fit,
                written: &extension.written,
                left_out: &extension.left_out,
                model: &model,
            };
            return Ok(serde_json::to_string_pretty(&document)? + "\n");
        }
        if self.out.is_none() {
            // A file as it is, so that it can be piped into one; the numbers are in its comments.
            return Ok(model);
        }
        let mut text = format!("{} fitted to {}\n\n", muscle.name(), fitting.data.files.join(", "));
        text.push_str(&learnt(&fitting));
        for (name, why) in &extension.left_out {
            let _ = writeln!(text, "  {name} is not in the file: {why}");
        }
        if let Some(path) = &self.out {
            let _ = writeln!(text, "\n  wrote {}", path.display());
        }
        Ok(text)
    }
}

/// Effects fitted, and the muscle file with what was learnt.
pub(crate) struct Fitted {
    pub(crate) fitting: Fitting,
    pub(crate) extension: Extension,
    pub(crate) model: String,
}

/// Fits effects to data.
pub(crate) fn fitted(
    data: &Data,
    muscle: &Muscle,
    effects: Vec<Arc<dyn Effect>>,
    catalogue: Catalogue,
) -> Result<Fitted, Failure> {
    let known = known(muscle, &catalogue)?;
    let options = Options { known, ..Options::new(catalogue, effects) };
    let fitting = fit_effects(data, muscle, &options)?;
    if !fitting.fit.convergence.converged {
        let what = format!(
            "the fit did not converge: {}, after {} iterations from {} starts; fit fewer effects at once, or measure more",
            fitting.fit.convergence.reason,
            fitting.fit.convergence.iterations,
            fitting.fit.convergence.starts
        );
        return Err(Failure::NotConverged(what));
    }
    let extension = extended(&fitting.model, &fitting.fit)?;
    let model = provenance(&fitting) + &to_toml(&extension.muscle);
    Ok(Fitted { fitting, extension, model })
}

/// What was learnt, in lines: the error before and after, the numbers, and what to mind.
pub(crate) fn learnt(fitting: &Fitting) -> String {
    let mut text = String::new();
    for line in errors(fitting) {
        // Writing to a String can't fail.
        let _ = writeln!(text, "  {line}");
    }
    parameters(&mut text, &fitting.fit);
    for warning in &fitting.fit.warnings {
        let _ = writeln!(text, "  ! {warning}");
    }
    text
}

fn percent(fitting: &Fitting, error: f64) -> f64 {
    100.0 * error / fitting.data.full_scale_n.max(f64::MIN_POSITIVE)
}

/// The error before and after.
fn errors(fitting: &Fitting) -> Vec<String> {
    let error = |name: &str, error: f64| {
        format!("{name} {} N, {:.2} % of full scale", significant(error, 3), percent(fitting, error))
    };
    let mut lines = vec![error("error before", fitting.before_rmse_n), error("error after ", fitting.rmse_n)];
    if let Some(floor) = &fitting.noise_floor {
        lines.push(error("noise floor ", floor.sd_n) + &format!(" ({})", floor.source));
    }
    lines
}

/// Comments at the head of the file: where its numbers come from.
fn provenance(fitting: &Fitting) -> String {
    let mut text = String::new();
    let data = &fitting.data;
    // File names are the user's: a line break in one would end the comment.
    let names: Vec<String> =
        data.files.iter().map(|name| name.replace(|c: char| c.is_control(), " ")).collect();
    let _ = writeln!(text, "# Fitted to {} ({} rows, sha256 {}).", names.join(", "), data.used, data.sha256);
    for line in errors(fitting) {
        let _ = writeln!(text, "# {line}");
    }
    for p in &fitting.fit.parameters {
        let flag = if p.plausible { "" } else { "; IMPLAUSIBLE: a wrong cure" };
        let [value, low, high] = with_interval(p.value, p.low, p.high);
        let unit = if p.unit.is_empty() || p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
        let _ = writeln!(text, "# {} {} = {value}{unit} (95 %: {low} to {high}){flag}", p.effect, p.name);
    }
    text + "# Widths of effects (+-) are one standard deviation, for the reader: later fits take the numbers as known.\n\n"
}
