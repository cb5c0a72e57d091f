//! Frozen recordings: consecutive rows with the same pressure, motion and force although the readings are
//! noisy, or with the same force while the others move on.

use super::clipping::expected;
use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::Resolution;
use crate::sweep::SweepKind;
use std::ops::Range;

/// Fewer consecutive equal rows may be chance.
const RUN: usize = 8;
/// With noise of this many quantisation steps, neighbours differ: two normal readings are equal with a
/// probability of 1/(2 * 2 sqrt(pi)) = 14 %.
const STEPS: f64 = 2.0;
/// Noise below this fraction of the range comes from arithmetic, not from measuring.
const LEAST: f64 = 1e-7;
/// The same limit if only the force is frozen while the rest moves on.
const RUN_ALONE: usize = 4;
/// Probability that a run of equal forces occurs by chance in a file of this length.
const CHANCE: f64 = 1e-6;
/// Expected change of the force relative to its resolution: its noise, its steps, and the next fraction of
/// its range.
const MOVES: f64 = 10.0;
const LEAST_SEEN: f64 = 1e-3;
/// A force below this fraction of the largest may be that of a slack muscle, which is constant.
const SLACK: f64 = 0.01;
/// If the force is constant in more than this fraction of the rows, the test was made that way.
const MOST: f64 = 0.2;

/// Rows that repeat the one before: in all readings, and in the force alone.
pub(super) struct Frozen {
    pub(super) all: Vec<usize>,
    pub(super) force: Vec<usize>,
}

pub(super) fn rows(gate: &Gate) -> Frozen {
    let (pressure, motion, force) = (gate.data.pressure(), gate.motion, gate.data.force());
    let is_noisy = |resolution: &Resolution| {
        resolution.noise > STEPS * resolution.step && resolution.noise > LEAST * resolution.range
    };
    let resolutions = [&gate.pressure, gate.motion_resolution(), &gate.force];
    // One noisy column is enough if all columns repeat.
    let all = if resolutions.into_iter().any(is_noisy) {
        runs(gate, RUN, |row| [pressure[row].to_bits(), motion[row].to_bits(), force[row].to_bits()])
    } else {
        Vec::new()
    };
    // The force should have changed by more than its resolution.
    let seen = (3.0 * gate.force.noise).max(gate.force.step).max(LEAST_SEEN * gate.force.range);
    let moves = |rows: &Range<usize>| expected(gate, rows) > MOVES * seen;
    let repeats = runs(gate, longest_by_chance(gate), |row| force[row].to_bits());
    // Under a weight the force is constant by design.
    let sweeps = gate.data.sweeps();
    let is_weight = |row: usize| sweeps[gate.data.sweep_of(row)].kind == SweepKind::Isotonic;
    let is_alone = |rows: &Range<usize>| {
        !is_weight(rows.start)
            && moves(rows)
            && force[rows.start].abs() > SLACK * gate.largest_force
            && !all.contains(rows)
    };
    let mut alone: Vec<Range<usize>> = repeats.into_iter().filter(is_alone).collect();
    if (alone.iter().map(Range::len).sum::<usize>() as f64) > MOST * force.len() as f64 {
        alone.clear();
    }
    // The first row of a run is a genuine reading.
    let repeated = |runs: &[Range<usize>]| runs.iter().flat_map(|run| run.start + 1..run.end).collect();
    Frozen { all: repeated(&all), force: repeated(&alone) }
}

/// Runs of equal rows of at least this length, within the sweeps.
fn runs<T: PartialEq>(gate: &Gate, least: usize, bits: impl Fn(usize) -> T) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    for (sweep, _) in gate.data.paths() {
        let mut start = sweep.rows.start;
        for row in sweep.rows.start + 1..=sweep.rows.end {
            if row == sweep.rows.end || bits(row) != bits(start) {
                if row - start >= least {
                    found.push(start..row);
                }
                start = row;
            }
        }
    }
    found
}

/// The length from which a run of equal forces isn't chance: `n q^(k - 1) < CHANCE`. The probability q that
/// neighbours are equal is estimated from the rows of short runs that repeat the one before.
fn longest_by_chance(gate: &Gate) -> usize {
    let force = gate.data.force();
    let short: usize = runs(gate, 2, |row| force[row].to_bits())
        .iter()
        .filter(|run| run.len() < RUN)
        .map(|run| run.len() - 1)
        .sum();
    let rows = force.len().max(1) as f64;
    let share = ((short as f64 + 1.0) / rows).min(0.99);
    let length = 1.0 + (CHANCE / rows).ln() / share.ln();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, at most some 10^4"
    )]
    let length = length.ceil().clamp(0.0, 1e6) as usize;
    length.max(RUN_ALONE)
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let Frozen { all, force } = rows(gate);
    let instead =
        "nothing: these rows don't count; the recording stood still, or filled a gap with the last reading";
    let all_says = |count| {
        format!(
            "{} with the same pressure, {} and force as the row before, to the last digit",
            rows_in_words(count),
            gate.motion_name()
        )
    };
    let force_says = |count| {
        format!(
            "{} with the same force as the row before, to the last digit, while the rest moved on",
            rows_in_words(count)
        )
    };
    let found = [
        gate.finding_if_any(FindingKind::Frozen, Severity::Warning, &all, all_says, instead),
        gate.finding_if_any(FindingKind::Frozen, Severity::Warning, &force, force_says, instead),
    ];
    found.into_iter().flatten().collect()
}
