//! A channel that was read more slowly than the others: it comes every few rows, and between these it is held or joined
//! by straight lines.

use super::Gate;
use super::column::Column;
use std::ops::Range;

/// Fewest rows between two readings of the slower channel, and most.
const EVERY: [usize; 2] = [3, 100];
/// Fewest readings of it.
const READINGS: usize = 8;
/// Fraction of the rows at which it changes, or its slope does, that must lie a multiple of that number apart.
const REGULAR: f64 = 0.9;
/// Fraction of the rows between that may do otherwise: gaps and pauses shift the count.
const EXCEPTIONS: f64 = 0.02;
/// Smallest change at its readings, in quantisation steps: a slow ramp of a coarse sensor changes by one.
const JUMPS: f64 = 3.0;
/// Largest change of another channel from one reading to the row before, over its usual change from row to row. Where a
/// test goes from step to step, all channels jump with it.
const TOGETHER: f64 = 3.0;

/// The number of rows from one reading to the next, and the rows between.
pub(super) struct Slower {
    pub(super) every: usize,
    pub(super) rows: Vec<usize>,
}

/// Rows of a channel that were filled in between the readings of a slower one.
pub(super) fn rows(gate: &Gate, column: &Column<'_>, tolerance: f64) -> Option<Slower> {
    let values = column.values;
    let jumps = |row: usize| (values[row] - values[row - 1]).abs();
    let bends = |row: usize| (values[row - 1] - 2.0 * values[row] + values[row + 1]).abs();
    let held = || {
        let found = every(1..values.len(), |row| jumps(row) > 0.0)?;
        let own = found.readings.iter().map(|row| jumps(*row));
        (mean(own) > JUMPS * column.resolution.step).then_some(found)
    };
    let drawn = || {
        let found = every(1..values.len().saturating_sub(1), |row| bends(row) > tolerance)?;
        // A drive that turns at the ends of its stroke bends there alone. No drive is a force.
        let goes_on =
            |row: &&usize| (values[**row] - values[**row - 1]) * (values[**row + 1] - values[**row]) > 0.0;
        let steady = found.readings.iter().filter(goes_on).count();
        (column.name == "force" || 2 * steady > found.readings.len()).then_some(found)
    };
    let Readings { every, readings } = held().or_else(drawn)?;
    let (at, between): (Vec<usize>, Vec<usize>) =
        (1..values.len()).partition(|row| readings.binary_search(row).is_ok());
    let is_alone = gate.columns.iter().filter(|other| other.name != column.name).any(|other| {
        let change = |row: &usize| (other.values[*row] - other.values[*row - 1]).abs();
        let [at, between] = [&at, &between].map(|rows| mean(rows.iter().map(change)));
        between > other.resolution.step && at <= TOGETHER * between
    });
    is_alone.then_some(Slower { every, rows: between })
}

/// Rows at which something happens, a constant number apart.
struct Readings {
    every: usize,
    readings: Vec<usize>,
}

/// The number of rows from one change to the next, if that is the same nearly everywhere.
fn every(rows: Range<usize>, changes: impl Fn(usize) -> bool) -> Option<Readings> {
    let count = rows.len();
    let readings: Vec<usize> = rows.filter(|row| changes(*row)).collect();
    if readings.len() < READINGS {
        return None;
    }
    let mut apart: Vec<usize> = readings.windows(2).map(|pair| pair[1] - pair[0]).collect();
    apart.sort_unstable();
    let every = apart[apart.len() / 2];
    if !(EVERY[0]..=EVERY[1]).contains(&every) {
        return None;
    }
    // Two readings may be equal by chance.
    let regular = apart.iter().filter(|apart| apart.is_multiple_of(every)).count();
    let is_regular = regular as f64 >= REGULAR * apart.len() as f64;
    let most = count as f64 * (1.0 / every as f64 + EXCEPTIONS);
    (is_regular && readings.len() as f64 <= most).then_some(Readings { every, readings })
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}
