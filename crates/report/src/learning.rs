//! The result of a fit: the muscle file that contains it, with the origin of its parameters, and the JSON
//! document.

use bulge_inference::{
    DataSummary, DrawnForms, Extension, Fit, Fitting, HeldNumber, NoiseFloor, Posterior, extended,
};
use bulge_model::ModelError;
use bulge_muscles::{Fault, to_toml, units::significant};
use serde::Serialize;
use std::fmt::Write;

use crate::interval::with_interval;

/// Why the result of a fit can't be used.
#[derive(Debug, thiserror::Error)]
pub enum LearningError {
    /// The fit did not converge.
    #[error(
        "the fit did not converge: {reason}, after {iterations} iterations from {starts} starts; fit fewer effects at once, or measure more"
    )]
    NotConverged {
        /// Why it stopped.
        reason: String,
        /// Iterations of all starts.
        iterations: usize,
        /// Number of starts.
        starts: usize,
    },
    /// The muscle can't have an effect with these parameters.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl LearningError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::NotConverged { .. } => Fault::NotConverged,
            Self::Model(error) => error.fault(),
        }
    }
}

/// A fit, and the muscle extended by its result.
#[derive(Debug, Clone)]
pub struct Learnt {
    /// The fit.
    pub fitting: Fitting,
    /// The muscle with the fitted effects.
    pub extension: Extension,
    /// Its file, with the errors and the fitted parameters as comments at the head.
    pub model: String,
}

/// The JSON document of a fit.
#[derive(Debug, Serialize)]
pub struct LearntDocument<'a> {
    schema: &'static str,
    muscle: &'a str,
    data: &'a DataSummary,
    before_rmse_n: f64,
    rmse_n: f64,
    rmse_percent: f64,
    noise_floor: &'a Option<NoiseFloor>,
    fit: &'a Fit,
    held: &'a [HeldNumber],
    written: &'a [String],
    left_out: &'a [(String, &'static str)],
    model: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn: Option<&'a DrawnForms>,
    #[serde(skip_serializing_if = "Option::is_none")]
    posterior: Option<&'a Posterior>,
}

impl<'a> LearntDocument<'a> {
    /// Adds the forms that the data suggest, as `drawn`; nothing is added if none were requested.
    #[must_use]
    pub fn with_drawn(self, drawn: Option<&'a DrawnForms>) -> Self {
        Self { drawn, ..self }
    }

    /// Adds the posterior of the parameters, as `posterior`; nothing is added if none was requested.
    #[must_use]
    pub fn with_posterior(self, posterior: Option<&'a Posterior>) -> Self {
        Self { posterior, ..self }
    }
}

impl Learnt {
    /// The result of a fit.
    ///
    /// # Errors
    /// The fit has not converged, or the muscle can't have the effects that it found.
    pub fn of(fitting: Fitting) -> Result<Self, LearningError> {
        let convergence = &fitting.fit.convergence;
        if !convergence.converged {
            return Err(LearningError::NotConverged {
                reason: convergence.reason.clone(),
                iterations: convergence.iterations,
                starts: convergence.starts,
            });
        }
        let extension = extended(&fitting.model, &fitting.fit)?;
        let model = provenance(&fitting) + &to_toml(&extension.muscle);
        Ok(Self { fitting, extension, model })
    }

    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> LearntDocument<'_> {
        let Self { fitting, extension, model } = self;
        LearntDocument {
            schema: "bulge.fit/1",
            muscle: fitting.model.muscle().name(),
            data: &fitting.data,
            before_rmse_n: fitting.before_rmse_n,
            rmse_n: fitting.rmse_n,
            rmse_percent: percent(fitting, fitting.rmse_n),
            noise_floor: &fitting.noise_floor,
            fit: &fitting.fit,
            held: &fitting.held,
            written: &extension.written,
            left_out: &extension.left_out,
            model,
            drawn: None,
            posterior: None,
        }
    }

    /// The error before and after, and the noise floor, one line each.
    #[must_use]
    pub fn errors(&self) -> Vec<String> {
        errors(&self.fitting)
    }
}

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
fn percent(fitting: &Fitting, error: f64) -> f64 {
    100.0 * error / fitting.data.full_scale_n.max(f64::MIN_POSITIVE)
}

/// Comments at the head of the file: the origin of its parameters.
fn provenance(fitting: &Fitting) -> String {
    let mut text = String::new();
    let data = &fitting.data;
    // File names come from the user: a line break in one would end the comment.
    let names: Vec<_> = data.files.iter().map(|name| bulge_muscles::shown::one_line(name)).collect();
    let _ = writeln!(text, "# Fitted to {} ({} rows, sha256 {}).", names.join(", "), data.used, data.sha256);
    for line in errors(fitting) {
        let _ = writeln!(text, "# {line}");
    }
    for p in &fitting.fit.parameters {
        let flag = if p.plausible || p.nuisance { "" } else { "; IMPLAUSIBLE: a wrong cure" };
        let [value, low, high] = shown(p.value, p.low, p.high);
        let unit = if p.unit.is_empty() || p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
        let _ = writeln!(text, "# {} {} = {value}{unit} (95 %: {low} to {high}){flag}", p.effect, p.name);
    }
    for number in &fitting.held {
        let _ = writeln!(text, "# {number}");
    }
    text + "# Widths of effects (+-) are one standard deviation, for the reader: later fits take the numbers as known.\n\n"
}

/// A value and its interval, with enough decimals to show the interval.
fn shown(value: f64, low: f64, high: f64) -> [String; 3] {
    with_interval(value, [low, high]).unwrap_or_else(|| [value, low, high].map(|x| significant(x, 3)))
}
