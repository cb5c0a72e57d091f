//! All rows of a comparison as bytes, for the plots of rows: a JSON header, then the columns one after the
//! other as 32-bit floating-point numbers.
//!
//! The format is little endian: the length of the header (u32); the header, padded with blanks so that the
//! data begin at a multiple of 4; then for each column of the header one `f32` per row. A missing value is
//! NaN. [`bytes`] is what the page of the workbench requests. A report contains the same with the force of
//! each rung.

use bulge_inference::Rows;
use bulge_measurements::SweepKind;
use serde::Serialize;
use std::borrow::Cow;

/// Most rows in a report, about a megabyte.
const MOST_ROWS: usize = 10_000;

#[derive(Debug, Serialize)]
struct Header<'a> {
    schema: &'static str,
    revision: u64,
    rows: usize,
    columns: Vec<Column>,
    files: &'a [String],
    specimens: &'a [String],
    sweeps: &'a [String],
    kind: &'a [SweepKind],
    #[serde(skip_serializing_if = "Option::is_none")]
    report: Option<ForReport<'a>>,
}

#[derive(Debug, Clone, Serialize)]
struct Column {
    name: Cow<'static, str>,
    unit: &'static str,
}

/// What the header of a report contains besides the rows, since a report has no server to ask.
#[derive(Debug, Serialize)]
struct ForReport<'a> {
    /// Total number of rows. The report contains the first of every `every` rows.
    all: usize,
    every: usize,
    is_path: bool,
    noise_floor_n: Option<f64>,
    rungs: Vec<Rung<'a>>,
}

#[derive(Debug, Serialize)]
struct Rung<'a> {
    added: Option<&'a str>,
    /// Name of the column of its force.
    column: Cow<'static, str>,
    /// RMS error over all rows that count.
    rmse_n: f64,
}

/// All rows, with the forces of base and model.
///
/// # Errors
/// The header can't be written.
pub fn bytes(rows: &Rows, revision: u64) -> Result<Vec<u8>, serde_json::Error> {
    written(rows, revision, 1, None)
}

/// The rows of a report, with the force of each rung: all rows, or every n-th.
///
/// # Errors
/// The header can't be written.
pub(crate) fn of_report(rows: &Rows, noise_floor_n: Option<f64>) -> Result<Vec<u8>, serde_json::Error> {
    let every = rows.len().div_ceil(MOST_ROWS).max(1);
    let added = std::iter::once(None).chain(rows.effects.iter().map(|effect| Some(effect.as_str())));
    let rungs = added.zip(forces(rows)).map(|(added, (column, force))| Rung {
        added,
        column,
        rmse_n: rmse(rows, force),
    });
    let report =
        ForReport { all: rows.len(), every, is_path: rows.is_path, noise_floor_n, rungs: rungs.collect() };
    written(rows, 0, every, Some(report))
}

/// The force of each rung from the base to the model, if it was requested, with the name of its column.
fn forces(rows: &Rows) -> impl Iterator<Item = (Cow<'static, str>, &[f64])> {
    let between = rows.between_n.iter().enumerate();
    let between = between.map(|(i, force)| (Cow::Owned(format!("rung {}", i + 1)), force.as_slice()));
    let last = (!rows.effects.is_empty()).then_some((Cow::Borrowed("model"), rows.model_n.as_slice()));
    std::iter::once((Cow::Borrowed("base"), rows.base_n.as_slice())).chain(between).chain(last)
}

/// RMS error over the rows that count and have a state.
fn rmse(rows: &Rows, force: &[f64]) -> f64 {
    let errors = rows.measured_n.iter().zip(force).zip(&rows.counts).filter(|(_, counts)| **counts);
    let errors = errors.map(|((measured, force), _)| measured - force).filter(|error| error.is_finite());
    let (sum, count) = errors.fold((0.0, 0.0), |(sum, count), error| (sum + error * error, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

fn written(
    rows: &Rows,
    revision: u64,
    every: usize,
    report: Option<ForReport<'_>>,
) -> Result<Vec<u8>, serde_json::Error> {
    let columns = columns(rows, every);
    let kept = rows.len().div_ceil(every);
    let header = Header {
        schema: "bulge.rows/1",
        revision,
        rows: kept,
        columns: columns.iter().map(|(column, _)| column.clone()).collect(),
        files: &rows.files,
        specimens: &rows.specimens,
        sweeps: &rows.sweeps,
        kind: &rows.sweep_kinds,
        report,
    };
    let mut header = serde_json::to_vec(&header)?;
    header.resize(header.len().next_multiple_of(4), b' ');
    let mut bytes = Vec::with_capacity(4 + header.len() + 4 * columns.len() * kept);
    bytes.extend(u32::try_from(header.len()).unwrap_or(u32::MAX).to_le_bytes());
    bytes.extend(header);
    for (_, values) in &columns {
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(bytes)
}

/// All columns with their values at every n-th row.
#[expect(clippy::cast_possible_truncation, reason = "as exact as a plot needs")]
fn columns(rows: &Rows, every: usize) -> Vec<(Column, Vec<f32>)> {
    let kept = || (0..rows.len()).step_by(every);
    let column = |name: &'static str, unit| Column { name: name.into(), unit };
    let state = |row: usize| match (rows.excluded[row], rows.counts[row]) {
        (true, _) => -1.0,
        (false, counts) => f32::from(u8::from(counts)),
    };
    let places = |places: &[u32]| kept().map(|row| places[row] as f32).collect::<Vec<_>>();
    let mut columns = vec![
        (column("line", ""), places(&rows.line)),
        (column("file", ""), places(&rows.file)),
        (column("sweep", ""), places(&rows.sweep)),
        (column("specimen", ""), places(&rows.specimen)),
        (column("state", ""), kept().map(state).collect()),
    ];
    let values = |values: &[f64], scale: f64| kept().map(|row| (values[row] * scale) as f32).collect();
    if let Some(time) = &rows.time_s {
        columns.push((column("time", "s"), values(time, 1.0)));
    }
    columns.extend([
        (column("pressure", "bar"), values(&rows.pressure_pa, 1e-5)),
        (column("contraction", "%"), values(&rows.contraction, 100.0)),
        (column("rate", "%/s"), values(&rows.rate, 100.0)),
        (column("direction", ""), values(&rows.direction, 1.0)),
    ]);
    if let Some(temperature) = &rows.temperature_k {
        let celsius: Vec<f64> = temperature.iter().map(|kelvin| kelvin - 273.15).collect();
        columns.push((column("temperature", "degC"), values(&celsius, 1.0)));
    }
    columns.push((column("measured", "N"), values(&rows.measured_n, 1.0)));
    let forces = forces(rows).map(|(name, force)| (Column { name, unit: "N" }, values(force, 1.0)));
    columns.extend(forces);
    if rows.effects.is_empty() {
        columns.push((column("model", "N"), values(&rows.model_n, 1.0)));
    }
    columns
}
