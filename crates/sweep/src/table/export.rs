//! Exports of tables: Rust and C sources, CSV, JSON, and polynomials in the form printed in papers.

mod c_header;
mod csv;
mod json;
pub mod polynomial;
mod rust_source;
#[cfg(test)]
mod tests;

pub use c_header::c_header;
pub use csv::csv;
pub use json::json;
pub use polynomial::{FitError, PapersPolynomial, S1Tables, papers_polynomial, s1_tables};
pub use rust_source::rust_source;

use bulge_fibre::FibreError;
use bulge_muscles::{MuscleError, PresetError};
use bulge_table::{Axis, Output, Table};

/// Why a table can't be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A name, a grid or a range that the table has no export for: what is wrong, and what to choose instead.
    #[error("{0}")]
    Input(String),
    /// A muscle that isn't shipped.
    #[error(transparent)]
    Muscle(#[from] PresetError),
    /// A value that is impossible for the muscle.
    #[error(transparent)]
    Value(#[from] MuscleError),
    /// No equilibrium.
    #[error(transparent)]
    Fibre(#[from] FibreError),
}

/// Most rows of a CSV file.
const MOST_ROWS: usize = 10_000_000;

/// All axes of a table.
fn axes<'a>(table: &Table<'a>) -> Vec<Axis<'a>> {
    (0..table.axes()).filter_map(|i| table.axis(i)).collect()
}

/// All outputs of a table.
fn outputs<'a>(table: &Table<'a>) -> Vec<Output<'a>> {
    (0..table.outputs()).filter_map(|o| table.output(o)).collect()
}

/// Coefficients of the edge and of the outputs.
fn coefficients(table: &Table<'_>) -> [Vec<f64>; 2] {
    let double = |bytes: &[u8]| bytes.first_chunk().map_or(f64::NAN, |chunk| f64::from_le_bytes(*chunk));
    let single =
        |bytes: &[u8]| bytes.first_chunk().map_or(f64::NAN, |chunk| f64::from(f32::from_le_bytes(*chunk)));
    let [edge, data] = table.coefficients();
    let data = if table.precision() == 4 {
        data.chunks_exact(4).map(single).collect()
    } else {
        data.chunks_exact(8).map(double).collect()
    };
    [edge.chunks_exact(8).map(double).collect(), data]
}

/// Description of a table for source files: axes with ranges, outputs with certified errors, and the origin.
/// `quoted` makes text safe inside a comment.
fn described(table: &Table<'_>, quoted: &dyn Fn(&str) -> String) -> Vec<String> {
    let unit = |unit: &str| if unit == "1" { String::new() } else { format!(" {}", quoted(unit)) };
    let mut lines = vec![format!("{}, {} bytes", table.form().name(), table.bytes().len()), String::new()];
    for (i, axis) in axes(table).iter().enumerate() {
        let high = if i == 0 && table.is_fitted() { "at most " } else { "" };
        let (low, end, unit) = (axis.low, axis.high, unit(axis.unit));
        lines.push(format!("axis {i}: {}, {low} to {high}{end}{unit}", quoted(axis.name)));
    }
    for (o, output) in outputs(table).iter().enumerate() {
        let c = output.certificate;
        lines.push(format!(
            "output {o}: {}{}, largest relative error {:.2e} (bound {:.2e}), of the gradient {:.2e}",
            quoted(output.name),
            unit(output.unit),
            c.value_max,
            c.bound,
            c.gradient_max
        ));
    }
    let [checks, seed] = table.checks();
    if checks > 0 {
        lines.push(format!("errors measured at {checks} points from number {seed} on"));
    }
    if !table.text().is_empty() {
        lines.extend([String::new(), format!("from: {}", quoted(table.text()))]);
    }
    lines
}
