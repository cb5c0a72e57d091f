//! A table as CSV: values and derivatives on a regular grid that follows the fitted edge.

use bulge_table::Table;
use std::fmt::Write as _;

use super::{ExportError, MOST_ROWS, axes, outputs};

/// Fraction of the width of axis 0 by which the grid stays away from a fitted edge and from a singular lower
/// end, where the lookup has no value.
const INSIDE: f64 = 1e-9;

/// Rows on a grid of `points_per_axis` equally spaced points on each axis; the last axis varies fastest. A
/// row holds the coordinates, the outputs, and the derivatives of the outputs by each axis. A fitted axis 0
/// ends at its edge, which depends on the other coordinates. Numbers have as many digits as are needed to
/// read them back exactly; cells without a value are empty.
///
/// # Errors
/// [`ExportError::Input`] for a grid of less than 2 points per axis, or with too many rows.
pub fn csv(table: &Table<'_>, points_per_axis: usize) -> Result<String, ExportError> {
    let (axes, outputs) = (axes(table), outputs(table));
    if points_per_axis < 2 {
        return Err(ExportError::Input(format!(
            "a grid of {points_per_axis} points per axis is not possible: it needs at least 2"
        )));
    }
    let count = u32::try_from(axes.len()).ok().and_then(|n| points_per_axis.checked_pow(n));
    let Some(count) = count.filter(|count| *count <= MOST_ROWS) else {
        let axes = axes.len();
        return Err(ExportError::Input(format!(
            "a grid of {points_per_axis} points on each of {axes} axes has more than {MOST_ROWS} rows: use fewer points"
        )));
    };

    let mut header: Vec<String> =
        axes.iter().map(|axis| quoted(&format!("{} [{}]", axis.name, axis.unit))).collect();
    header.extend(outputs.iter().map(|output| quoted(&format!("{} [{}]", output.name, output.unit))));
    for output in &outputs {
        for axis in &axes {
            let unit = if axis.unit == "1" {
                output.unit.to_owned()
            } else {
                format!("{}/({})", output.unit, axis.unit)
            };
            header.push(quoted(&format!("d({})/d({}) [{unit}]", output.name, axis.name)));
        }
    }
    let mut text = header.join(",");
    text.push('\n');

    let is_singular = outputs.iter().any(|output| output.is_singular) || table.is_root();
    let (mut point, mut values) = (vec![0.0; axes.len()], vec![0.0; outputs.len()]);
    let mut gradients = vec![0.0; outputs.len() * axes.len()];
    for row in 0..count {
        let mut rest = row;
        for i in (0..axes.len()).rev() {
            let part = (rest % points_per_axis) as f64 / (points_per_axis - 1) as f64;
            rest /= points_per_axis;
            let (low, mut high) = (axes[i].low, axes[i].high);
            let mut part = part;
            if i == 0 {
                // The other coordinates are set already, because axis 0 is the last of this loop.
                high = table.upper_end(&point).unwrap_or(high);
                let least = if is_singular { INSIDE } else { 0.0 };
                let most = if table.is_fitted() { 1.0 - INSIDE } else { 1.0 };
                part = part.clamp(least, most);
            }
            // Exact at both ends.
            point[i] = if part >= 1.0 { high } else { low + part * (high - low) };
        }
        let has_value = table.sample(&point, &mut values, &mut gradients).is_some();
        for (i, x) in point.iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            let _ = write!(text, "{comma}{x:?}");
        }
        for number in values.iter().chain(&gradients) {
            let _ = if has_value { write!(text, ",{number:?}") } else { write!(text, ",") };
        }
        text.push('\n');
    }
    Ok(text)
}

/// A field of the header, quoted where needed because names and units may hold any characters.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
