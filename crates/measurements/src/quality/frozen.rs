//! A recording that stood still: rows in a row with the same pressure, motion and force, although the readings are noisy.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::Resolution;

/// Fewer equal rows in a row may be chance.
const RUN: usize = 8;
/// Noise of so many quantisation steps makes neighbours differ: two normal readings are then equal with a probability of 1/(2 * 2 sqrt(pi)) = 14 %.
const STEPS: f64 = 2.0;
/// Noise below this share of the range is that of the arithmetic: nothing was measured.
const LEAST: f64 = 1e-7;

/// Rows that repeat the one before.
pub(super) fn rows(gate: &Gate) -> Vec<usize> {
    let (pressure, motion, force) = (gate.data.pressure(), gate.motion, gate.data.force());
    let is_noisy = |resolution: &Resolution| {
        resolution.noise > STEPS * resolution.step && resolution.noise > LEAST * resolution.range
    };
    // One noisy column is enough; a force alone may be stuck at the end of its range, which is another finding.
    if ![&gate.pressure, gate.motion_resolution(), &gate.force].into_iter().any(is_noisy) {
        return Vec::new();
    }
    let bits = |row: usize| [pressure[row].to_bits(), motion[row].to_bits(), force[row].to_bits()];
    let mut rows = Vec::new();
    for (sweep, _) in gate.data.paths() {
        let mut start = sweep.rows.start;
        for row in sweep.rows.start + 1..=sweep.rows.end {
            if row == sweep.rows.end || bits(row) != bits(start) {
                if row - start >= RUN {
                    rows.extend(start + 1..row);
                }
                start = row;
            }
        }
    }
    rows
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let rows = rows(gate);
    let found = gate.finding_if_any(
        FindingKind::Frozen,
        Severity::Warning,
        &rows,
        |count| {
            format!(
                "{} with the same pressure, {} and force as the row before, to the last digit",
                rows_in_words(count),
                gate.motion_name()
            )
        },
        "nothing: these rows don't count; the recording stood still, or filled a gap with the last reading",
    );
    found.into_iter().collect()
}
