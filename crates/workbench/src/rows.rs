//! All rows as bytes: a header of JSON, then one column after the other as 32-bit numbers.
//!
//! Little endian: the length of the header (u32); the header, padded with blanks so that what follows begins at a multiple of 4; then for each of
//! the header's columns one `f32` for each row. What a row doesn't have is NaN.

use bulge_inference::Rows;
use serde::Serialize;

use crate::inputs::Inputs;

#[derive(Debug, Serialize)]
struct Header<'a> {
    schema: &'static str,
    revision: u64,
    rows: usize,
    columns: Vec<Column>,
    files: Vec<&'a str>,
    specimens: &'a [String],
    sweeps: Vec<&'a str>,
    kind: Vec<bulge_measurements::SweepKind>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Column {
    name: &'static str,
    unit: &'static str,
}

/// The rows of a comparison.
pub(crate) fn bytes(inputs: &Inputs, rows: &Rows, revision: u64) -> Result<Vec<u8>, serde_json::Error> {
    let columns = columns(inputs, rows);
    let data = &inputs.data;
    let header = Header {
        schema: "bulge.rows/1",
        revision,
        rows: data.len(),
        columns: columns.iter().map(|(column, _)| *column).collect(),
        files: data.files().iter().map(|file| file.name.as_str()).collect(),
        specimens: data.specimens(),
        sweeps: data.sweeps().iter().map(|sweep| sweep.name.as_str()).collect(),
        kind: data.sweeps().iter().map(|sweep| sweep.kind).collect(),
    };
    let mut header = serde_json::to_vec(&header)?;
    header.resize(header.len().next_multiple_of(4), b' ');
    let mut bytes = Vec::with_capacity(4 + header.len() + 4 * columns.len() * data.len());
    bytes.extend(u32::try_from(header.len()).unwrap_or(u32::MAX).to_le_bytes());
    bytes.extend(header);
    for (_, values) in &columns {
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(bytes)
}

/// Every column with its values.
#[expect(clippy::cast_possible_truncation, reason = "as exact as a plot needs")]
fn columns(inputs: &Inputs, rows: &Rows) -> Vec<(Column, Vec<f32>)> {
    let data = &inputs.data;
    let history = data.history(bulge_muscles::Quantity::si(inputs.muscle.length()));
    let mut sweep = vec![f32::NAN; data.len()];
    for (number, found) in data.sweeps().iter().enumerate() {
        sweep[found.rows.clone()].fill(number as f32);
    }
    let state = |row: usize| match (inputs.is_excluded(row), rows.counts[row]) {
        (true, _) => -1.0,
        (false, counts) => f32::from(u8::from(counts)),
    };
    let all = 0..data.len();
    let mut columns = vec![
        (Column { name: "line", unit: "" }, all.clone().map(|row| data.line(row).1 as f32).collect()),
        (Column { name: "file", unit: "" }, all.clone().map(|row| data.line(row).0 as f32).collect()),
        (Column { name: "sweep", unit: "" }, sweep),
        (
            Column { name: "specimen", unit: "" },
            all.clone().map(|row| data.specimen_of(row) as f32).collect(),
        ),
        (Column { name: "state", unit: "" }, all.map(state).collect()),
    ];
    let mut add = |name: &'static str, unit: &'static str, values: &[f64], scale: f64| {
        columns.push((Column { name, unit }, values.iter().map(|value| (value * scale) as f32).collect()));
    };
    if let Some(time) = data.time() {
        add("time", "s", time, 1.0);
    }
    add("pressure", "bar", data.pressure(), 1e-5);
    add("contraction", "%", &rows.contraction, 100.0);
    add("rate", "%/s", &history.rate, 100.0);
    add("direction", "", &history.direction, 1.0);
    if let Some(temperature) = data.temperature() {
        add("temperature", "degC", temperature, 1.0);
    }
    add("measured", "N", data.force(), 1.0);
    add("base", "N", &rows.base_n, 1.0);
    add("model", "N", &rows.model_n, 1.0);
    columns
}
