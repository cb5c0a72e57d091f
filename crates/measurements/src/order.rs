//! The order of the rows in time, and duplicated rows.

use crate::columns::Columns;
use crate::error::MeasurementError;
use crate::reading::Reading;
use crate::table::keep_rows;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

/// A time that goes back to within this fraction of its range begins another run.
const BEGINS_AGAIN: f64 = 0.2;
/// Sorting is accepted if it reduces the changes from row to row to this fraction.
const SMOOTHER: f64 = 0.9;
/// Runs that begin again have at least so many rows, on average.
const ROWS_PER_RUN: usize = 8;

/// Sorts rows by their times if this is clearly the order of the measurement, and sets copies apart.
pub(crate) fn put_in_order(
    file: &str,
    columns: &mut Columns,
    lines: &mut Vec<u32>,
    reading: &mut Reading,
) -> Result<(), MeasurementError> {
    let Some(time) = &columns.time_s else { return Ok(()) };
    if time.windows(2).all(|pair| pair[0] < pair[1]) {
        return Ok(());
    }
    let copies = copies(columns);
    if !copies.is_empty() {
        let is_copy: HashMap<usize, usize> = copies.iter().copied().collect();
        for (row, first) in &copies {
            reading.add(
                file,
                lines[*row] as usize,
                format!("equal to row {} in every column", lines[*first]),
            );
        }
        let keep: Vec<usize> = (0..lines.len()).filter(|row| !is_copy.contains_key(row)).collect();
        keep_rows(columns, lines, &keep);
    }
    let mut order: Vec<usize> = (0..lines.len()).collect();
    let mut sorted = 0;
    for rows in segments(columns) {
        if is_out_of_order(columns, &rows) {
            sorted += sort(file, columns, lines, &mut order[rows])?;
        }
    }
    if sorted > 0 {
        keep_rows(columns, lines, &order);
        reading.notes.push(format!("{file}: {sorted} rows were not in the order of their times: sorted"));
    }
    Ok(())
}

/// Ranges of rows that belong together according to their labels.
fn segments(columns: &Columns) -> Vec<Range<usize>> {
    let label = |row: usize| {
        let of = |labels: &Option<crate::columns::Labels>| labels.as_ref().map(|labels| labels.rows()[row]);
        (of(&columns.sweep), of(&columns.specimen), columns.cycle.as_ref().map(|cycle| cycle[row]))
    };
    let rows: Vec<usize> = (0..columns.len()).collect();
    rows.chunk_by(|a, b| label(*a) == label(*b)).map(|part| part[0]..part[part.len() - 1] + 1).collect()
}

fn times(columns: &Columns) -> &[f64] {
    columns.time_s.as_deref().unwrap_or_default()
}

/// Whether the times of some rows go back other than at the beginning of a run.
fn is_out_of_order(columns: &Columns, rows: &Range<usize>) -> bool {
    let time = &times(columns)[rows.clone()];
    let (low, high) = crate::resolution::bounds(time);
    let again = low + BEGINS_AGAIN * (high - low);
    let mut backward = time.windows(2).filter(|pair| pair[1] < pair[0]).peekable();
    backward.peek().is_some()
        && !(backward.all(|pair| pair[1] <= again) && (are_runs(time) || begin_alike(time)))
}

/// Whether times increase over several rows before they go back.
fn are_runs(time: &[f64]) -> bool {
    let backward = time.windows(2).filter(|pair| pair[1] < pair[0]).count();
    (backward + 1) * ROWS_PER_RUN <= time.len()
}

/// Whether short runs have about the same length, and each begins where the first did.
fn begin_alike(time: &[f64]) -> bool {
    let runs: Vec<&[f64]> = time.chunk_by(|a, b| a <= b).collect();
    let longest = runs.iter().map(|run| run.len()).max().unwrap_or(0);
    let span = runs.iter().map(|run| run[run.len() - 1] - run[0]).fold(0.0, f64::max);
    let is_alike =
        |run: &&[f64]| 2 * run.len() >= longest && (run[0] - runs[0][0]).abs() <= BEGINS_AGAIN * span;
    longest > 1 && runs.iter().all(is_alike)
}

/// Sorts rows by their times if this makes the readings smoother, and returns how many rows were sorted. Long
/// runs that it doesn't make smoother stay in sequence; anything else is refused.
fn sort(
    file: &str,
    columns: &Columns,
    lines: &[u32],
    order: &mut [usize],
) -> Result<usize, MeasurementError> {
    let time = times(columns);
    let as_read = order.to_vec();
    if order.windows(2).all(|pair| time[pair[1]] <= time[pair[0]]) {
        // If the whole table is reversed, rows with equal times are reversed too.
        order.reverse();
        return Ok(order.len());
    }
    order.sort_by(|a, b| time[*a].total_cmp(&time[*b]));
    let shares = shares(columns, &as_read, order);
    // A spreadsheet may have sorted the rows by one of the readings, which is smoothest then.
    let others = shares.iter().filter(|(_, share)| share.is_finite());
    let others: Vec<f64> = others.map(|(_, share)| *share).collect();
    let mean = others.iter().sum::<f64>() / others.len().max(1) as f64;
    if !others.is_empty() && mean <= SMOOTHER {
        return Ok(order.len());
    }
    order.copy_from_slice(&as_read);
    if are_runs(&as_read.iter().map(|row| time[*row]).collect::<Vec<f64>>()) {
        return Ok(0);
    }
    let backward: Vec<usize> = as_read.windows(2).filter(|p| time[p[1]] < time[p[0]]).map(|p| p[1]).collect();
    let why: Vec<String> = shares
        .iter()
        .filter(|(_, share)| share.is_finite())
        .map(|(name, share)| format!("{name} {share:.1} times as far"))
        .collect();
    let what = format!(
        "the time goes back at {} of {} rows, and sorted by time the readings jump ({}): sort the rows as they were measured, number the runs in a column `sweep`, or leave out the column `time` if the rows are a static map",
        backward.len(),
        as_read.len(),
        why.join(", ")
    );
    Err(MeasurementError::at(file, backward.first().map_or(0, |row| lines[*row] as usize), what))
}

/// Change of the readings from row to row in one order relative to another. Rows that are neighbours in both
/// orders don't count. Infinite for a reading by which the rows were sorted before.
fn shares(columns: &Columns, before: &[usize], after: &[usize]) -> Vec<(&'static str, f64)> {
    let start = before[0];
    let mut place = vec![0; after.len()];
    after.iter().enumerate().for_each(|(at, row)| place[row - start] = at);
    let way = |values: &[f64], order: &[usize], is_new: &dyn Fn(usize, usize) -> bool| -> f64 {
        let pairs = order.windows(2).filter(|pair| is_new(pair[0], pair[1]));
        pairs.map(|pair| (values[pair[1]] - values[pair[0]]).abs()).sum()
    };
    let readings: [(&'static str, &[f64]); 3] = [
        ("pressure", &columns.pressure_pa),
        ("motion", columns.motion.values()),
        ("force", &columns.force_n),
    ];
    let share = |(name, values): &(&'static str, &[f64])| {
        let old = way(values, before, &|a, b| place[b - start] != place[a - start] + 1);
        let new = way(values, after, &|a, b| b != a + 1);
        let is_sorted =
            |up: f64| before.windows(2).all(|pair| up * (values[pair[1]] - values[pair[0]]) >= 0.0);
        let share =
            if is_sorted(1.0) || is_sorted(-1.0) { f64::INFINITY } else { new / old.max(f64::MIN_POSITIVE) };
        (old > 0.0 || new > 0.0).then_some((*name, share))
    };
    readings.iter().filter_map(share).collect()
}

/// Rows that equal an earlier one in every column, with that one. If different readings share a time as well,
/// the clock is coarse, and equal readings are no copies.
fn copies(columns: &Columns) -> Vec<(usize, usize)> {
    let numbers: Vec<&[f64]> = columns.numbers().map(|(_, values)| values).collect();
    let marks = |row: usize| {
        let of = |labels: &Option<crate::columns::Labels>| labels.as_ref().map(|labels| labels.rows()[row]);
        let cycle = columns.cycle.as_ref().map(|cycle| cycle[row]);
        (of(&columns.sweep), of(&columns.specimen), cycle, columns.direction.as_ref().map(|d| d[row]))
    };
    let is_same = |a: usize, b: usize| {
        marks(a) == marks(b) && numbers.iter().all(|values| values[a].to_bits() == values[b].to_bits())
    };
    let time = times(columns);
    // Rows with the same time are grouped by runs: a time that begins again is another one.
    let mut at: HashMap<u64, Vec<usize>> = HashMap::with_capacity(time.len());
    let (mut found, mut is_coarse) = (Vec::new(), false);
    for (row, now) in time.iter().enumerate() {
        let mut hasher = DefaultHasher::new();
        (now.to_bits(), marks(row)).hash(&mut hasher);
        let same = at.entry(hasher.finish()).or_default();
        if let Some(first) = same.iter().find(|first| is_same(**first, row)) {
            found.push((row, *first));
        } else {
            is_coarse |= same.last().is_some_and(|last| *last + 1 == row);
            same.push(row);
        }
    }
    if is_coarse { Vec::new() } else { found }
}
