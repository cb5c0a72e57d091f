//! The table of a plan: builds it from the family of the plan, and describes it.

use bulge_table::{Table, TableError};
use serde::Serialize;
use serde_json::{Value, json};

use super::{BuildError, Built, MuscleField, Requirements, build};
use crate::family_error::FamilyError;
use crate::output::Output;
use crate::plan::{Plan, TableRequirements};

/// Format of the description in a table.
pub(crate) const SCHEMA: &str = "bulge.table/1";

/// Why a plan has no table.
#[derive(Debug, thiserror::Error)]
pub enum TabulateError {
    /// The family can't be made.
    #[error("no table: {0}")]
    Family(#[from] FamilyError),
    /// The table can't be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The description can't be written as JSON.
    #[error("the table's description can't be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Builds the table that a plan requests. `told` receives messages on the progress.
///
/// # Errors
/// [`TabulateError`].
pub fn tabulate(plan: &Plan, wish: &TableRequirements, told: &dyn Fn(&str)) -> Result<Built, TabulateError> {
    let field = MuscleField::new(plan, wish)?;
    Ok(build(&field, &wish.with_text(table_text(plan, wish)?), told)?)
}

/// The description stored in the table of a plan. Tables with the same text are the same.
///
/// # Errors
/// If a number of the plan has no JSON.
pub fn table_text(plan: &Plan, wish: &TableRequirements) -> Result<String, serde_json::Error> {
    let mut document = json!({
        "schema": SCHEMA,
        "version": env!("CARGO_PKG_VERSION"),
        "name": plan.name,
        "muscle": bulge_muscles::to_toml(&plan.muscle),
        "pressure_pa": plan.pressure_pa,
        "method": format!("{:?}", plan.approach),
        "axes": plan.axes,
        "outputs": wish.outputs,
        "tolerance": wish.tolerance,
        "gradient": wish.gradient,
        "max_bytes": wish.max_bytes,
        "form": wish.form,
        "checks": wish.checks,
    });
    if let (Some(contraction), Some(entries)) = (plan.contraction, document.as_object_mut()) {
        entries.insert("contraction".to_owned(), contraction.into());
    }
    let meanings: Vec<&str> = wish.outputs.iter().filter_map(|output| meaning(*output)).collect();
    if let (false, Some(entries)) = (meanings.is_empty(), document.as_object_mut()) {
        entries.insert("meaning".to_owned(), meanings.into());
    }
    serde_json::to_string(&document)
}

fn meaning(output: Output) -> Option<&'static str> {
    match output {
        Output::ForceF => Some("F = p l0^2 a f; pleated with n fibres: a = (n/2 pi) sin(2 pi/n), else a = 1"),
        Output::VolumeV => Some("V = l0^3 v, circular sections"),
        _ => None,
    }
}

impl TableRequirements {
    /// The requirements together with the description that the table is to store.
    #[must_use]
    pub fn with_text(&self, text: String) -> Requirements {
        Requirements {
            tolerance: self.tolerance,
            gradient: self.gradient,
            max_bytes: usize::try_from(self.max_bytes).unwrap_or(usize::MAX),
            form: self.form,
            checks: self.checks,
            text,
        }
    }
}

/// Description of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableDescription {
    /// Format of the description: `bulge.table/1`.
    pub schema: &'static str,
    /// Form in which the outputs are stored.
    pub form: &'static str,
    /// Size of the table in bytes.
    pub bytes: usize,
    /// Bytes of a coefficient.
    pub coefficient_bytes: usize,
    /// Its axes.
    pub axes: Vec<AxisDescription>,
    /// Its outputs with their errors.
    pub outputs: Vec<OutputDescription>,
    /// Number of points at which the errors were measured.
    pub checks: u64,
    /// Largest error of the fitted upper end of the first axis, in its unit.
    pub edge_error: f64,
    /// Origin of the table.
    pub from: Value,
}

/// An axis of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisDescription {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Lower end.
    pub low: f64,
    /// Upper end; the largest one where it depends on the other axes.
    pub high: f64,
    /// Whether the upper end depends on the other axes.
    pub is_fitted: bool,
    /// Number of coefficients along it.
    pub coefficients: usize,
}

/// An output of a table, with errors as `bulge_table::Certificate` defines them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputDescription {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Largest relative error of the value.
    pub error: f64,
    /// Root mean square of the relative error of the value.
    pub error_rms: f64,
    /// Largest relative error of the gradient.
    pub gradient_error: f64,
    /// Root mean square of the relative error of the gradient.
    pub gradient_error_rms: f64,
    /// Bound of the relative error of the value, by subdivision.
    pub bound: f64,
}

impl TableDescription {
    /// Describes a table.
    ///
    /// # Errors
    /// If a record of the table can't be read.
    pub fn of(table: &Table<'_>) -> Result<Self, TableError> {
        let axis = |i: usize| {
            let axis = table.axis(i).ok_or(TableError::Malformed { field: "range of an axis" })?;
            Ok(AxisDescription {
                name: axis.name.to_owned(),
                unit: axis.unit.to_owned(),
                low: axis.low,
                high: axis.high,
                is_fitted: i == 0 && table.is_fitted(),
                coefficients: axis.nodes,
            })
        };
        let output = |o: usize| {
            let output = table.output(o).ok_or(TableError::Malformed { field: "name of an output" })?;
            let errors = output.certificate;
            Ok(OutputDescription {
                name: output.name.to_owned(),
                unit: output.unit.to_owned(),
                error: errors.value_max,
                error_rms: errors.value_rms,
                gradient_error: errors.gradient_max,
                gradient_error_rms: errors.gradient_rms,
                bound: errors.bound,
            })
        };
        Ok(Self {
            schema: SCHEMA,
            form: table.form().name(),
            bytes: table.bytes().len(),
            coefficient_bytes: table.precision(),
            axes: (0..table.axes()).map(axis).collect::<Result<_, TableError>>()?,
            outputs: (0..table.outputs()).map(output).collect::<Result<_, TableError>>()?,
            checks: table.checks()[0],
            edge_error: table.edge_error(),
            from: serde_json::from_str(table.text()).unwrap_or_else(|_| Value::from(table.text())),
        })
    }
}
