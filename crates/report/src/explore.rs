//! The interactive part of a report: the plots of rows. The page contains the rows and the script that draws
//! them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bulge_inference::{Comparison, Rows};
use minijinja::value::Value;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::PlotError;
use crate::comparison::check::lengths;
use crate::comparison::number::count;
use crate::rows::of_report;
use crate::scripts::BUNDLE;

/// Names of the drawings that these plots replace if scripts run.
const REPLACED: [&str; 2] = ["force", "residual-map"];

/// Values of the template.
#[derive(Debug, Serialize)]
pub(crate) struct Explore {
    says: String,
    /// Encoded as Base64, which has no character that could end an element.
    rows: Value,
    script: Value,
}

impl Explore {
    /// `None` without rows.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub(crate) fn of(comparison: &Comparison, rows: Option<&Rows>) -> Result<Option<Self>, PlotError> {
        let Some(rows) = rows.filter(|rows| !rows.is_empty()) else { return Ok(None) };
        check(rows)?;
        let floor = comparison.noise_floor.as_ref().map(|floor| floor.sd_n);
        let bytes = of_report(rows, floor).map_err(|error| PlotError::Page { reason: error.to_string() })?;
        let models = if rows.effects.is_empty() { "the base" } else { "the model of any rung of the ladder" };
        Ok(Some(Self {
            says: format!("{} against {models}.", count(rows.len(), "row")),
            rows: Value::from_safe_string(STANDARD.encode(bytes)),
            script: Value::from_safe_string(BUNDLE.to_owned()),
        }))
    }
}

/// Whether these plots replace a drawing.
pub(crate) fn replaces(name: &str) -> bool {
    REPLACED.contains(&name)
}

/// The content security policy of a report: a browser may show it and run only its own script, if it has one,
/// whatever the names in the report look like.
#[must_use]
pub fn policy(has_script: bool) -> String {
    let script = if has_script {
        format!(" script-src 'sha256-{}';", STANDARD.encode(Sha256::digest(BUNDLE)))
    } else {
        String::new()
    };
    format!("default-src 'none';{script} style-src 'unsafe-inline'; img-src data:")
}

fn check(rows: &Rows) -> Result<(), PlotError> {
    let places = [&rows.file, &rows.line, &rows.sweep, &rows.specimen].map(Vec::len);
    let values = [
        &rows.pressure_pa,
        &rows.contraction,
        &rows.rate,
        &rows.direction,
        &rows.measured_n,
        &rows.base_n,
        &rows.model_n,
    ];
    let more = rows.between_n.iter().chain(&rows.time_s).chain(&rows.temperature_k);
    let found: Vec<usize> = values.into_iter().chain(more).map(Vec::len).collect();
    lengths("values of a column of rows", rows.len(), &found)?;
    lengths("values of a column of rows", rows.len(), &places)?;
    lengths("values of a column of rows", rows.len(), &[rows.excluded.len()])?;
    let between = rows.effects.len().saturating_sub(1);
    lengths("forces of rungs between base and model", between, &[rows.between_n.len()])
}
