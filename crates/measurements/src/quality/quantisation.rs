//! Coarse sensors: few levels over the range of the readings, or up to the largest reading if that range is
//! small.

use super::{Finding, FindingKind, Gate, Severity};
use crate::resolution::{Resolution, bounds};

/// Fewer levels give a note, much fewer a warning.
const NOTE: f64 = 1000.0;
const WARNING: f64 = 50.0;
/// Fewer rows don't show the sensor's grid.
const ROWS: usize = 20;
/// A column that changes in a smaller fraction of the rows is a list of set points.
const CHANGES: f64 = 0.05;
/// A quantity whose range is below this fraction of the largest reading was held, like a regulated pressure
/// or a weight.
const HELD: f64 = 0.5;
/// A motion over less of the muscle was held as well; its zero is arbitrary, so there is no largest value for
/// comparison.
const TRAVEL: f64 = 2e-3;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let data = gate.data;
    let motion_unit = if gate.motion_name() == "contraction" { ("%", 100.0) } else { ("mm", 1e3) };
    let columns = [
        ("force", data.force(), &gate.force, ("N", 1.0)),
        (gate.motion_name(), gate.motion, gate.motion_resolution(), motion_unit),
        ("pressure", data.pressure(), &gate.pressure, ("kPa", 1e-3)),
    ];
    let of_column = |(name, values, resolution, unit): (&str, &[f64], &Resolution, (&str, f64))| {
        let (unit, factor) = unit;
        let is_motion = name == gate.motion_name();
        if is_motion && resolution.range <= TRAVEL * data.structure.scale {
            return None;
        }
        let largest = bounds(values).1.abs().max(bounds(values).0.abs());
        let is_held = !is_motion && resolution.range < HELD * largest;
        let over_range = resolution.levels()?;
        let levels = if is_held { (largest / resolution.step).round() + 1.0 } else { over_range };
        let span = if is_held { ("up to", largest) } else { ("over its range of", resolution.range) };
        if levels >= NOTE {
            return None;
        }
        // Set points of a static map, or of each sweep, aren't readings.
        let is_reading = name == "force" || (data.is_path() && share_of_changes(gate, values) > CHANGES);
        if data.len() < ROWS || !is_reading {
            return None;
        }
        let severity = if levels < WARNING { Severity::Warning } else { Severity::Note };
        let says = format!(
            "the {name} is read in steps of {} {unit}: {levels} levels {} {}",
            four(factor * resolution.step),
            span.0,
            four(factor * span.1)
        );
        let instead =
            "use a finer range of the sensor or write more digits; differences below one step mean nothing";
        Some(gate.finding(FindingKind::Quantised, severity, &[], says, instead))
    };
    columns.into_iter().filter_map(of_column).collect()
}

/// Fraction of the rows whose value differs from that of the row before in the sweep.
#[expect(clippy::float_cmp, reason = "a set point that is held is the same number")]
fn share_of_changes(gate: &Gate, values: &[f64]) -> f64 {
    let changes =
        |rows: &std::ops::Range<usize>| values[rows.clone()].windows(2).filter(|w| w[0] != w[1]).count();
    let count: usize = gate.data.sweeps().iter().map(|sweep| changes(&sweep.rows)).sum();
    count as f64 / values.len().max(1) as f64
}

/// Four significant digits in plain notation.
pub(super) fn four(value: f64) -> String {
    let rounded = bulge_muscles::units::rounded(value, 4);
    if rounded == 0.0 || (1e-5..1e7).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}
