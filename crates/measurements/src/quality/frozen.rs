//! Frozen recordings: consecutive rows with the same pressure, motion and force although the readings are
//! noisy; and channels that are filled in while the others move on, with the last reading or with a straight
//! line to the next.

use super::clipping::expected;
use super::column::Column;
use super::slower;
use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::{bounds, median};
use crate::sweep::SweepKind;
use std::ops::Range;

/// Fewer consecutive equal rows may be chance.
const RUN: usize = 8;
/// The limit of [`RUN`] if one channel is filled in while the rest moves on.
const RUN_ALONE: usize = 4;
/// Probability that a run occurs by chance in a file of this length.
const CHANCE: f64 = 1e-6;
/// Rows on each side that show how often a row does the same there.
const AROUND: usize = 20;
/// Expected change of the force relative to its resolution: its noise, its steps, and the next fraction of
/// its range.
const MOVES: f64 = 10.0;
const LEAST_SEEN: f64 = 1e-3;
/// Change of another channel while a reading repeats, over its range in the sweep, and leap of the reading after that, over its usual
/// step, from which it was held.
const GOES_ON: f64 = 0.2;
const LEAP: f64 = 4.0;
/// A force below this fraction of the largest may be that of a slack muscle, which is constant.
const SLACK: f64 = 0.01;
/// If a channel is filled in in more than this fraction of the rows, the test was made that way.
const MOST: f64 = 0.3;
/// Second differences of a straight line in quantisation steps: the three readings are rounded by up to half a
/// step each, the middle one twice.
const LINE: f64 = 2.01;
/// Rise of a straight line in these tolerances.
const RISES: f64 = 5.0;

/// Rows whose readings aren't those of their time.
pub(super) struct Frozen {
    /// Rows that repeat the one before in all readings.
    pub(super) all: Vec<usize>,
    /// Name of a channel, whether it repeats the last reading or lies on a straight line, and its rows.
    pub(super) alone: Vec<(&'static str, Filled, Vec<usize>)>,
}

/// How a channel is filled in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filled {
    /// With the last reading.
    Held,
    /// With a straight line to the next.
    Drawn,
    /// With either, because it was read only every so many rows.
    Slower(usize),
}

impl Filled {
    pub(super) fn says(self) -> String {
        match self {
            Self::Held => "repeats the row before to the last digit while the rest moved on".to_owned(),
            Self::Drawn => {
                "lies on a straight line to the last digit, as if a gap was interpolated".to_owned()
            }
            Self::Slower(every) => {
                format!("comes late: it was read every {every} rows only, and filled in between")
            }
        }
    }
}

pub(super) fn rows(gate: &Gate) -> Frozen {
    let all = if Column::rows_for_one(&gate.columns) <= 1.0 {
        let is_equal = |row: usize| gate.columns.iter().all(|column| repeats(column.values, row));
        runs(gate, is_equal).into_iter().filter(|run| run.len() >= RUN - 1).collect()
    } else {
        Vec::new()
    };
    let mut alone = Vec::new();
    for column in &gate.columns {
        let (Column { name, values, resolution, .. }, is_noisy) = (*column, column.is_noisy());
        let is_force = name == "force";
        let tolerance = (LINE * resolution.step).max(column.rounding());
        if let Some(slower) = slower::rows(gate, column, tolerance) {
            alone.push((name, Filled::Slower(slower.every), slower.rows));
            continue;
        }
        let mut held = filled(gate, is_force, |row| repeats(values, row));
        held.retain(|run| !all.contains(run));
        if !is_noisy {
            let usual = usual_step(gate, values);
            held.retain(|run| {
                is_force && is_stuck(gate, run)
                    || usual.is_some_and(|usual| catches_up(gate, column, run, usual))
            });
        }
        let mut drawn = Vec::new();
        if is_noisy {
            drawn = filled(gate, is_force, |row| is_between(gate, values, row, tolerance));
            // A level line is a reading that is held, or coarse.
            let rises = |line: &Range<usize>| (values[line.end] - values[line.start - 1]).abs();
            drawn.retain(|line| rises(line) > RISES * tolerance);
            drawn.retain(|line| ![&all, &held].iter().any(|runs| runs.iter().any(|run| meets(run, line))));
        }
        for (how, runs) in [(Filled::Held, held), (Filled::Drawn, drawn)] {
            let count = runs.iter().map(Range::len).sum::<usize>();
            if count > 0 && count as f64 <= MOST * values.len() as f64 {
                alone.push((name, how, runs.into_iter().flatten().collect()));
            }
        }
    }
    Frozen { all: all.into_iter().flatten().collect(), alone }
}

/// Whether a force that repeats should have changed by more than its resolution.
fn is_stuck(gate: &Gate, run: &Range<usize>) -> bool {
    let seen = (3.0 * gate.force.noise).max(gate.force.step).max(LEAST_SEEN * gate.force.range);
    // The first row of a run is a genuine reading.
    expected(gate, &(run.start - 1..run.end)) > MOVES * seen
}

/// The usual change of a reading from row to row where it changes; none if it mostly leaps from one rest to the next.
fn usual_step(gate: &Gate, values: &[f64]) -> Option<f64> {
    let step = |row: usize| (values[row] - values[row - 1]).abs();
    let inner = || gate.data.sweeps().iter().flat_map(|sweep| sweep.rows.start + 1..sweep.rows.end);
    let way: f64 = inner().map(step).sum();
    let rests = runs(gate, |row| repeats(values, row));
    let ends =
        rests.iter().filter(|run| run.len() + 1 >= RUN && ends_in_sweep(gate, run)).map(|run| step(run.end));
    let mut steps: Vec<f64> = inner().map(step).filter(|step| *step > 0.0).collect();
    (ends.sum::<f64>() <= MOST * way && !steps.is_empty()).then(|| median(&mut steps))
}

/// Whether a row of the same sweep follows.
fn ends_in_sweep(gate: &Gate, run: &Range<usize>) -> bool {
    run.end < gate.data.sweeps()[gate.data.sweep_of(run.start)].rows.end
}

/// Whether a reading that repeats leaps to where it should have been, after another one went on.
fn catches_up(gate: &Gate, column: &Column<'_>, run: &Range<usize>, usual: f64) -> bool {
    let sweep = &gate.data.sweeps()[gate.data.sweep_of(run.start)].rows;
    let goes_on = |other: &Column<'_>| {
        let width = |rows: Range<usize>| {
            let (low, high) = bounds(&other.values[rows]);
            high - low
        };
        let (here, seen) = (width(run.start - 1..run.end), other.resolution.noise.max(other.resolution.step));
        other.name != column.name && here > (GOES_ON * width(sweep.clone())).max(MOVES * seen)
    };
    run.len() + 1 >= RUN
        && ends_in_sweep(gate, run)
        && (column.values[run.end] - column.values[run.end - 1]).abs() > LEAP * usual
        && gate.columns.iter().any(goes_on)
}

fn repeats(values: &[f64], row: usize) -> bool {
    values[row].total_cmp(&values[row - 1]).is_eq()
}

/// Whether a reading lies on the line through its neighbours.
fn is_between(gate: &Gate, values: &[f64], row: usize, tolerance: f64) -> bool {
    let end = gate.data.sweeps()[gate.data.sweep_of(row)].rows.end;
    row + 1 < end && (values[row - 1] - 2.0 * values[row] + values[row + 1]).abs() <= tolerance
}

fn meets(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start <= b.end && b.start <= a.end
}

/// Runs of rows that do what a noisy channel does by chance only, and too long for it. A force is excepted where the
/// muscle is slack or hangs on a weight.
fn filled(gate: &Gate, is_force: bool, is_filled: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let found = runs(gate, is_filled);
    let short: usize = found.iter().map(Range::len).filter(|length| *length + 1 < RUN).sum();
    let everywhere = (short as f64 + 1.0) / gate.data.len().max(1) as f64;
    let sweeps = gate.data.sweeps();
    let is_measured = |run: &Range<usize>| {
        let sweep = &sweeps[gate.data.sweep_of(run.start)];
        let is_constant = sweep.kind == SweepKind::Isotonic
            || gate.data.force()[run.start].abs() <= SLACK * gate.largest_force;
        // What holds all through a sweep was set.
        !(is_force && is_constant) && run.len() + 2 < sweep.rows.len()
    };
    let is_long = |place: usize| {
        let run = &found[place];
        let sweep = &sweeps[gate.data.sweep_of(run.start)].rows;
        // A sensor may be coarser here than elsewhere.
        let sides = run.start.saturating_sub(AROUND).max(sweep.start)..(run.end + AROUND).min(sweep.end);
        let near = |other: &&Range<usize>| other.start < sides.end && sides.start < other.end;
        let (mut rows, mut others) = (sides.len() - run.len(), 0);
        for side in [
            found[..place].iter().rev().take_while(near).collect(),
            found[place + 1..].iter().take_while(near).collect::<Vec<_>>(),
        ] {
            for (order, other) in side.into_iter().enumerate() {
                let within = other.end.min(sides.end) - other.start.max(sides.start);
                let away =
                    if other.start > run.start { other.start - run.end } else { run.start - other.end };
                // Another gap that was filled in, with ordinary rows between.
                if order == 0 && away >= RUN && 2 * other.len() >= run.len() {
                    rows -= within;
                } else {
                    others += within;
                }
            }
        }
        let here = (others as f64 + 1.0) / rows.max(1) as f64;
        run.len() + 1 >= longest_by_chance(gate.data.len(), everywhere.max(here))
    };
    let long = (0..found.len()).filter(|place| is_long(*place) && is_measured(&found[*place]));
    long.map(|place| found[place].clone()).collect()
}

/// Runs of rows for which `is_filled` holds, never the first of a sweep.
fn runs(gate: &Gate, is_filled: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for sweep in gate.data.sweeps() {
        for row in (sweep.rows.start + 1..sweep.rows.end).filter(|row| is_filled(*row)) {
            match found.last_mut() {
                Some(run) if run.end == row => run.end += 1,
                _ => found.push(row..row + 1),
            }
        }
    }
    found
}

/// The length from which a run isn't chance: `n q^(k - 1) < CHANCE`, with the probability q of one such row.
fn longest_by_chance(rows: usize, probability: f64) -> usize {
    let length = 1.0 + (CHANCE / rows.max(1) as f64).ln() / probability.min(0.99).ln();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, at most some 10^4"
    )]
    let length = length.ceil().clamp(0.0, 1e6) as usize;
    length.max(RUN_ALONE)
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let Frozen { all, alone } = rows(gate);
    let instead =
        "nothing: these rows don't count; the recording stood still, or a gap was filled in afterwards";
    let all_says = |count| {
        format!(
            "{} with the same pressure, {} and force as the row before, to the last digit",
            rows_in_words(count),
            gate.motion_name()
        )
    };
    let all = gate.finding_if_any(FindingKind::Frozen, Severity::Warning, &all, all_says, instead);
    let alone = alone.iter().filter_map(|(name, how, rows)| {
        let says = |count| format!("{}: the {name} {}", rows_in_words(count), how.says());
        gate.finding_if_any(FindingKind::Frozen, Severity::Warning, rows, says, instead)
    });
    all.into_iter().chain(alone).collect()
}
