//! Clipped readings: a sensor at the end of its range repeats its extreme value while the others move on.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::{Resolution, bounds};
use std::ops::Range;

/// Number of equal readings that isn't chance: in one run, or in several runs of at least the next constant,
/// if a test has few rows at each top.
const RUN: usize = 5;
const SHORT: usize = 2;
/// Number of readings of exactly the largest force that isn't chance, wherever they are; the next constant is
/// the ratio to the number at any other force, which a noisy load cell repeats rarely. The same holds for either end
/// of a noisy pressure. (At the top of a sine,
/// the largest of coarse readings is 2.4 times as frequent as the next; at rest all readings are equal.)
const AGAIN: usize = 8;
const TIMES: usize = 3;
/// Expected change of the force, relative to its resolution, from which it counts as stuck.
const FORCE_STEPS: f64 = 10.0;
/// Change of the force, relative to its range in the sweep, from which motion or pressure count as stuck; the
/// other of the two must be constant within the next fraction.
const FORCE_SHARE: f64 = 0.1;
const STILL: f64 = 0.02;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let of_column = |(name, rows): (&str, Vec<usize>)| {
        gate.finding_if_any(
            FindingKind::Clipped,
            Severity::Warning,
            &rows,
            |count| {
                let first = rows.first().map_or_else(String::new, |row| gate.reading(name, *row));
                format!(
                    "the {name} stays at its extreme value of {first} in {} while others move",
                    rows_in_words(count)
                )
            },
            "nothing: these rows don't count; the sensor or the amplifier was at the end of its range",
        )
    };
    in_columns(gate).into_iter().filter_map(of_column).collect()
}

/// Clipped rows of each column.
pub(super) fn in_columns(gate: &Gate) -> Vec<(&'static str, Vec<usize>)> {
    let data = gate.data;
    let (force, pressure, motion) = (data.force(), data.pressure(), gate.motion);
    let range_in = |values: &[f64], rows: &Range<usize>| {
        let (low, high) = bounds(&values[rows.clone()]);
        high - low
    };
    let stuck_force = |_: &Range<usize>, run: &Range<usize>| {
        // Zero is the end of a muscle's range, not of the sensor's.
        let is_zero = force[run.start].abs() <= 1e-9 * gate.largest_force;
        let seen = (3.0 * gate.force.noise).max(gate.force.step).max(1e-3 * gate.force.range);
        !is_zero && expected(gate, run) > FORCE_STEPS * seen
    };
    let force_moves = |sweep: &Range<usize>, run: &Range<usize>| {
        range_in(force, run) > (FORCE_SHARE * range_in(force, sweep)).max(FORCE_STEPS * gate.force.noise)
    };
    let stuck_motion = |sweep: &Range<usize>, run: &Range<usize>| {
        range_in(motion, sweep) > 0.0
            && force_moves(sweep, run)
            && range_in(pressure, run) <= STILL * gate.largest_pressure
    };
    let stuck_pressure = |sweep: &Range<usize>, run: &Range<usize>| {
        range_in(pressure, sweep) > 0.0
            && force_moves(sweep, run)
            && range_in(motion, run)
                <= (STILL * gate.motion_resolution().range).max(gate.data.structure.band.width)
    };
    let mut found = vec![
        ("force", in_column(gate, force, &stuck_force)),
        (gate.motion_name(), in_column(gate, motion, &stuck_motion)),
        ("pressure", in_column(gate, pressure, &stuck_pressure)),
    ];
    found[0].1.extend(repeated_end(gate, force, 1.0));
    if gate.columns[2].is_noisy() {
        found[2].1.extend([1.0, -1.0].iter().flat_map(|side| repeated_end(gate, pressure, *side)));
    }
    for (_, rows) in &mut found {
        rows.sort_unstable();
        rows.dedup();
    }
    found
}

/// Rows with the column's largest or smallest value, if it is stuck there in some run.
#[expect(clippy::float_cmp, reason = "a sensor that is stuck repeats its reading bit for bit")]
fn in_column(
    gate: &Gate,
    values: &[f64],
    is_stuck: &dyn Fn(&Range<usize>, &Range<usize>) -> bool,
) -> Vec<usize> {
    let (low, high) = bounds(values);
    // Numbers of rows in stuck runs at the lowest and at the highest value.
    let mut stuck = [0_usize; 2];
    for (sweep, _) in gate.data.paths() {
        let mut start = sweep.rows.start;
        for equal in values[sweep.rows.clone()].chunk_by(|a, b| a == b) {
            let run = start..start + equal.len();
            start = run.end;
            let is_extreme = equal[0] == low || equal[0] == high;
            if equal.len() >= SHORT
                && equal.len() < sweep.rows.len()
                && is_extreme
                && is_stuck(&sweep.rows, &run)
            {
                stuck[usize::from(equal[0] == high)] += equal.len();
            }
        }
    }
    let is_end = |(end, rows): (f64, usize)| (rows >= RUN).then_some(end);
    let ends: Vec<f64> = [low, high].into_iter().zip(stuck).filter_map(is_end).collect();
    // If the range ends there for some rows, it does for all.
    let at_end = |row: &usize| ends.contains(&values[*row]);
    gate.data.paths().flat_map(|(sweep, _)| sweep.rows.clone()).filter(at_end).collect()
}

/// Rows with the largest (side 1) or smallest (side -1) reading, if it is far more frequent than any other.
fn repeated_end(gate: &Gate, values: &[f64], side: f64) -> Vec<usize> {
    let largest = bounds(values).1.abs().max(bounds(values).0.abs());
    let mut rows: Vec<usize> = gate.data.paths().flat_map(|(sweep, _)| sweep.rows.clone()).collect();
    rows.sort_by(|a, b| (side * values[*b]).total_cmp(&(side * values[*a])).then(a.cmp(b)));
    let mut equal = rows.chunk_by(|a, b| values[*a].total_cmp(&values[*b]).is_eq());
    let end = equal.next().unwrap_or_default();
    let others = equal.filter(|rows| values[rows[0]].abs() > 1e-9 * largest).map(<[usize]>::len);
    let is_clipped = end.len() >= AGAIN && others.max().is_some_and(|most| end.len() >= TIMES * most);
    // Zero is the end of what there is, not of the sensor.
    let is_zero = end.first().is_none_or(|row| values[*row].abs() <= 1e-9 * largest);
    if is_clipped && !is_zero { end.to_vec() } else { Vec::new() }
}

/// Expected change of the force in a run, from its change with motion and pressure just before and after.
pub(super) fn expected(gate: &Gate, run: &Range<usize>) -> f64 {
    /// Number of rows that determine the slope.
    const AROUND: usize = 20;
    let sweep = &gate.data.sweeps()[gate.data.sweep_of(run.start)].rows;
    let sides = [
        (run.start.saturating_sub(AROUND).max(sweep.start), run.start),
        (run.end - 1, (run.end - 1 + AROUND).min(sweep.end - 1)),
    ];
    let slope_times_way = |values: &[f64], resolution: &Resolution| {
        let noise = 6.0 * resolution.noise + resolution.step;
        let (low, high) = bounds(&values[run.clone()]);
        let way = (high - low - noise).max(0.0);
        let along = sides.iter().map(|(from, to)| {
            let change = (values[*to] - values[*from]).abs();
            let force = (gate.data.force()[*to] - gate.data.force()[*from]).abs();
            // A change within the noise gives no slope.
            if change > 2.0 * noise + 1e-3 * resolution.range { force / change * way } else { 0.0 }
        });
        along.fold(0.0, f64::max)
    };
    slope_times_way(gate.motion, gate.motion_resolution())
        .max(slope_times_way(gate.data.pressure(), &gate.pressure))
}
