//! Spikes: one to three readings beyond all their neighbours in time.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::Resolution;

/// Longest spike in rows.
const LONGEST: usize = 3;
/// Readings on each side that it has to stand out from.
const SIDE: usize = 2;
/// By how many standard deviations of the noise,
const NOISE: f64 = 8.0;
/// quantisation steps,
const STEPS: f64 = 4.0;
/// changes between its neighbours,
const CHANGES: f64 = 3.0;
/// and which share of the range.
const RANGE: f64 = 5e-3;
/// At a turning point of the motion the force has a tip of its own: so many times more is needed.
const AT_TURN: f64 = 10.0;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let columns = [
        ("force", gate.data.force(), &gate.force, true),
        (gate.motion_name(), gate.motion, gate.motion_resolution(), false),
        ("pressure", gate.data.pressure(), &gate.pressure, false),
    ];
    let of_column = |(name, values, resolution, has_tips): (&str, &[f64], &Resolution, bool)| {
        let rows = rows(gate, values, resolution, has_tips);
        gate.finding_if_any(
            FindingKind::Spike,
            Severity::Warning,
            &rows,
            |count| {
                let value = rows.first().map_or(0.0, |row| values[*row]);
                format!(
                    "the {name} of {} lies far from the rows around, the first at {value:.6} (SI)",
                    rows_in_words(count)
                )
            },
            "remove these rows if the reading was disturbed",
        )
    };
    columns.into_iter().filter_map(of_column).collect()
}

fn rows(gate: &Gate, values: &[f64], resolution: &Resolution, has_tips: bool) -> Vec<usize> {
    let least = (NOISE * resolution.noise).max(STEPS * resolution.step).max(RANGE * resolution.range);
    let mut found = Vec::new();
    if least == 0.0 {
        return found;
    }
    for (sweep, stretches) in gate.data.paths() {
        let x = &values[sweep.rows.clone()];
        let turns: Vec<usize> =
            stretches.iter().map(|stretch| stretch.rows.end - 1 - sweep.rows.start).collect();
        let is_turn = |first: usize, end: usize| {
            let next = turns.partition_point(|turn| turn + 1 < first);
            turns.get(next).is_some_and(|turn| *turn <= end)
        };
        let mut row = SIDE;
        while row + SIDE < x.len() {
            let length = (1..=LONGEST).find(|length| {
                let Some(excess) = excess(x, row, *length).filter(|(height, _)| *height > least) else {
                    return false;
                };
                let factor = if has_tips && is_turn(row, row + length) { AT_TURN } else { 1.0 };
                excess.0 > factor * least.max(CHANGES * excess.1)
            });
            if let Some(length) = length {
                found.extend((row..row + length).map(|row| sweep.rows.start + row));
            }
            row += length.unwrap_or(1);
        }
    }
    found
}

/// By how much `length` readings from `first` stand out from all their neighbours, and the largest change between these; none at the ends.
fn excess(x: &[f64], first: usize, length: usize) -> Option<(f64, f64)> {
    let before = x.get(first.checked_sub(SIDE)?..first)?;
    let (spike, after) = (x.get(first..first + length)?, x.get(first + length..first + length + SIDE)?);
    let around = before.iter().chain(after);
    let (low, high) =
        around.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    let (lowest, highest) = crate::resolution::bounds(spike);
    let height = (lowest - high).max(low - highest);
    let across = (after[0] - before[SIDE - 1]).abs() / (length + 1) as f64;
    let change = (before[1] - before[0]).abs().max((after[1] - after[0]).abs()).max(across);
    (height > 0.0).then_some((height, change))
}
