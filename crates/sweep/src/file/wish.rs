//! The `[table]` of a sweep file.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Dimension, FileError, Parameter};

use super::axes::Placed;
use super::outputs::outputs;
use crate::output::Output;
use crate::plan::{Quantity, Range, TableForm, TableRequirements};

/// Keys of the table, each with an example; the outputs come first.
pub(super) const TABLE: Keys = &[
    ("outputs", "outputs = [\"force_f\", \"volume_v\"]"),
    ("tolerance", "tolerance = 1e-6"),
    ("gradient", "gradient = 1e-4"),
    ("max_size", "max_size = \"64 KiB\""),
    ("form", "form = \"fastest\""),
    ("checks", "checks = 131072"),
];
/// Most axes of a table.
const MOST_AXES: usize = 4;
/// Most outputs of a table.
const MOST_OUTPUTS: usize = 8;
/// Allowed ranges of the tolerance and of the gradient.
const TOLERANCE: [f64; 2] = [1e-10, 0.1];
const GRADIENT: [f64; 2] = [1e-8, 1.0];
const BYTES: [u64; 2] = [1 << 10, 64 << 20];
const CHECKS: [u64; 2] = [100_000, 1_000_000_000];
/// Units of memory with their sizes in bytes.
const UNITS: [(&str, f64); 5] = [("B", 1.0), ("kB", 1e3), ("KiB", 1024.0), ("MB", 1e6), ("MiB", 1_048_576.0)];

/// The table that a file requests over these axes. `usual` are the outputs of the sweep; `has` tells whether
/// the muscle has a parameter.
pub(super) fn wish(
    settings: &Settings<'_>,
    axes: &[Placed<'_>],
    usual: &[Output],
    has: &dyn Fn(Parameter) -> bool,
) -> Result<Option<TableRequirements>, FileError> {
    let Some(table) = settings.table("table", "`[table]`", TABLE)? else { return Ok(None) };
    table.check_keys()?;
    check_axes(&table, axes, settings)?;
    let stated = outputs(&table, has)?;
    let outputs = stated.unwrap_or_else(|| usual.to_vec());
    if outputs.len() > MOST_OUTPUTS {
        let what = format!("a table of {} outputs is not possible: at most {MOST_OUTPUTS}", outputs.len());
        let instead = "write such as `outputs = [\"force_f\", \"volume_v\"]` in `[table]`";
        return Err(table.error(table.value_span("outputs"), what, instead));
    }
    Ok(Some(TableRequirements { outputs, ..limits(&table)? }))
}

/// The table that a joint file requests. The joint file states the outputs elsewhere.
pub(crate) fn without_outputs(settings: &Settings<'_>) -> Result<Option<TableRequirements>, FileError> {
    let Some(table) = settings.table("table", "`[table]`", &TABLE[1..])? else { return Ok(None) };
    table.check_keys()?;
    limits(&table).map(Some)
}

/// Requirements on a table, without its outputs.
fn limits(table: &Settings<'_>) -> Result<TableRequirements, FileError> {
    let bytes = max_size(table)?;
    let forms = [
        ("fastest", TableForm::Fastest),
        ("smallest", TableForm::Smallest),
        ("splines", TableForm::Splines),
        ("chebyshev", TableForm::Chebyshev),
    ];
    Ok(TableRequirements {
        outputs: vec![],
        tolerance: bounded(table, "tolerance", 1e-6, TOLERANCE)?,
        gradient: bounded(table, "gradient", 1e-4, GRADIENT)?,
        max_bytes: bytes.unwrap_or(64 << 10),
        form: table.word("form", &forms)?.unwrap_or(TableForm::Fastest),
        checks: checks(table)?,
    })
}

fn check_axes(table: &Settings<'_>, axes: &[Placed<'_>], settings: &Settings<'_>) -> Result<(), FileError> {
    for placed in axes {
        let refused = |what: &str| {
            let instead = "write a `range`, or delete `[table]`";
            Err(table.error(placed.values.clone(), what, instead))
        };
        if matches!(placed.axis.range, Range::List(_)) {
            return refused("a table reaches from an end to the other, but this axis is a list");
        }
        if placed.axis.quantity == Quantity::Parameter(Parameter::Fibres) {
            let what = "a number of fibres is whole: there is nothing between two of them for a table";
            let instead = "name a muscle with the number of fibres, or delete `[table]`";
            return Err(table.error(placed.name.clone(), what, instead));
        }
    }
    if axes.len() > MOST_AXES {
        let what = format!("a table of {} axes is not possible: at most {MOST_AXES}", axes.len());
        return Err(settings.error(settings.key_span("table"), what, "leave axes out, or delete `[table]`"));
    }
    Ok(())
}

fn bounded(table: &Settings<'_>, name: &str, usual: f64, [low, high]: [f64; 2]) -> Result<f64, FileError> {
    let value = table.quantity(name, Dimension::NONE)?.unwrap_or(usual);
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    let what = format!("`{name}` is {value}, but must be between {low:e} and {high}");
    Err(table.error(table.value_span(name), what, format!("write such as `{name} = {usual:e}`")))
}

fn checks(table: &Settings<'_>) -> Result<u64, FileError> {
    let checks = table.count("checks")?.unwrap_or(131_072);
    let [low, high] = CHECKS;
    if (low..=high).contains(&checks) {
        return Ok(checks);
    }
    let what = format!("`checks` is {checks}, but must be between {low} and {high}");
    Err(table.error(table.value_span("checks"), what, "write such as `checks = 131072`"))
}

/// A number of bytes, with or without a unit.
fn max_size(table: &Settings<'_>) -> Result<Option<u64>, FileError> {
    let Some(value) = table.get("max_size") else { return Ok(None) };
    let Some(bytes) = value.whole().or_else(|| value.text().and_then(bytes)) else {
        let what = "`max_size` must be a number of bytes, or text with B, kB, KiB, MB or MiB";
        return Err(table.unreadable("max_size", value, what));
    };
    let [low, high] = BYTES;
    if (low..=high).contains(&bytes) {
        return Ok(Some(bytes));
    }
    let what =
        format!("a table of at most {bytes} bytes is not possible: the limit must be from 1 KiB to 64 MiB");
    Err(table.unreadable("max_size", value, what))
}

/// Converts such as "64 KiB" to bytes; fractions of a byte are dropped.
fn bytes(text: &str) -> Option<u64> {
    let text = text.trim();
    let (number, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic())?);
    let (_, factor) = UNITS.iter().find(|(symbol, _)| *symbol == unit)?;
    let bytes = number.trim().parse::<f64>().ok()? * factor;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative; saturates")]
    let whole = bytes as u64;
    (bytes >= 0.0).then_some(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_in_bytes() {
        for (text, wanted) in [
            ("64 KiB", Some(65_536)),
            ("64KiB", Some(65_536)),
            ("1.5 kB", Some(1500)),
            ("2 MB", Some(2_000_000)),
            (" 1 MiB ", Some(1 << 20)),
            ("70000 B", Some(70_000)),
            ("1e300 B", None),
            ("70000", None),
            ("64 kib", None),
            ("-1 KiB", None),
            ("KiB", None),
        ] {
            assert_eq!(bytes(text), wanted, "{text}");
        }
    }
}
