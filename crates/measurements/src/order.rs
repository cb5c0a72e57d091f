//! The order of the rows in time, and duplicated rows.

use crate::columns::Columns;
use crate::error::MeasurementError;
use crate::reading::Reading;
use crate::recorded::leaping;
use crate::table::keep_rows;
use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

/// A time that goes back to within this fraction of its range begins another run.
const BEGINS_AGAIN: f64 = 0.2;
/// Sorting is accepted if it reduces the changes from row to row to this fraction.
const SMOOTHER: f64 = 0.9;
/// Parts into which the rows of a sweep fall, on average, from which the order isn't that of the measurement; rows of such a
/// part, on average, are fewer than these.
const RETURNS: usize = 4;
const ROWS_PER_PART: usize = 10;
/// Fewest rows that were sorted without labels, the fraction of them with another reading than the row before, and the fraction
/// in which another reading leaps.
const FEWEST: usize = 40;
const RISES: f64 = 0.7;
const LEAPS: f64 = 0.2;
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
    if is_sorted_by_reading(columns) {
        keep_rows(columns, lines, &by_label_and_time(columns));
        reading
            .notes
            .push(format!("{file}: the rows were sorted by a reading: put into the order of their times"));
        return Ok(());
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

/// Whether the rows were sorted by a reading: it only rises or only falls, while the labels of sweeps return after a few rows or
/// another reading leaps.
pub(crate) fn is_sorted_by_reading(columns: &Columns) -> bool {
    let readings = [&columns.pressure_pa, columns.motion.values(), &columns.force_n];
    let mut sorted = readings.into_iter().filter(|values| is_monotone(values)).peekable();
    if sorted.peek().is_none() {
        return false;
    }
    let returns = columns.sweep.as_ref().is_some_and(|labels| {
        let parts = labels.rows().chunk_by(|a, b| a == b).count();
        parts > RETURNS * labels.names().len() && columns.len() < ROWS_PER_PART * parts
    });
    // Set points in rising order are equal in many rows.
    let steps = |values: &[f64]| values.windows(2).filter(|pair| pair[0].total_cmp(&pair[1]).is_ne()).count();
    returns
        || columns.len() >= FEWEST
            && sorted.any(|values| steps(values) as f64 >= RISES * columns.len() as f64)
            && leaping(columns) > LEAPS
}

fn is_monotone(values: &[f64]) -> bool {
    let only = |up: f64| values.windows(2).all(|pair| up * (pair[1] - pair[0]) >= 0.0);
    only(1.0) || only(-1.0)
}

/// The rows by their sweeps and times. Sweeps of one clock follow each other as it says, others by their specimens and labels.
fn by_label_and_time(columns: &Columns) -> Vec<usize> {
    let time = times(columns);
    let names = columns.sweep.as_ref().map(crate::columns::Labels::names).unwrap_or_default();
    let of = |labels: &Option<crate::columns::Labels>, row: usize| {
        labels.as_ref().map_or(0, |labels| labels.rows()[row])
    };
    let key = |row: usize| (of(&columns.specimen, row), of(&columns.sweep, row));
    let mut spans: BTreeMap<(u32, u32), (f64, f64)> = BTreeMap::new();
    for (row, time) in time.iter().enumerate() {
        let (first, last) = spans.entry(key(row)).or_insert((f64::INFINITY, f64::NEG_INFINITY));
        (*first, *last) = (first.min(*time), last.max(*time));
    }
    let mut sweeps: Vec<(u32, u32)> = spans.keys().copied().collect();
    sweeps.sort_by(|a, b| spans[a].0.total_cmp(&spans[b].0));
    if sweeps.windows(2).any(|pair| spans[&pair[1]].0 < spans[&pair[0]].1) {
        let name = |sweep: &(u32, u32)| names.get(sweep.1 as usize).map_or("", String::as_str);
        let number = |sweep: &(u32, u32)| name(sweep).parse().unwrap_or(f64::INFINITY);
        sweeps.sort_by(|a, b| a.0.cmp(&b.0).then(number(a).total_cmp(&number(b))).then(name(a).cmp(name(b))));
    }
    let rank: BTreeMap<(u32, u32), usize> = sweeps.into_iter().zip(0..).collect();
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by(|a, b| rank[&key(*a)].cmp(&rank[&key(*b)]).then(time[*a].total_cmp(&time[*b])));
    order
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

#[cfg(test)]
mod tests {
    use crate::{Data, ReadOptions};
    use std::fmt::Write;

    /// Three loops of 40 rows at rising pressures, with labels and a clock that begins anew in each or goes on, sorted by force.
    fn sorted(goes_on: bool, numbered_anew: bool) -> Data {
        let mut rows: Vec<[f64; 5]> = (0..120)
            .map(|row| {
                let (sweep, at) = (row / 40, f64::from(row % 40));
                let contraction = 0.01 + 0.2 * (1.0 - (at / 20.0 - 1.0).abs());
                let bar = f64::from(1 + sweep) + 1e-3 * at;
                let time = if goes_on { 100.0 * f64::from(sweep) + at } else { at };
                [
                    time,
                    bar,
                    contraction,
                    300.0 * bar * (1.0 - 3.0 * contraction) + 0.01 * at,
                    f64::from(sweep),
                ]
            })
            .collect();
        rows.sort_by(|a, b| a[3].total_cmp(&b[3]));
        let mut text = "time [s],pressure [bar],contraction,force [N],sweep\n".to_owned();
        for (row, [time, p, c, f, sweep]) in rows.iter().enumerate() {
            let time = if numbered_anew { row as f64 } else { *time };
            let _ = writeln!(text, "{time},{p},{c},{f},{sweep}");
        }
        Data::from_bytes(text.as_bytes(), "d.csv", &ReadOptions::default()).unwrap()
    }

    #[test]
    fn rows_that_were_sorted_by_a_reading_go_back_to_their_sweeps() {
        for goes_on in [true, false] {
            let data = sorted(goes_on, false);
            let sweeps: Vec<_> =
                data.sweeps().iter().map(|sweep| (sweep.name.as_str(), sweep.rows.clone())).collect();
            assert_eq!(sweeps, [("0", 0..40), ("1", 40..80), ("2", 80..120)]);
            assert!((data.pressure()[41] - 2.001e5).abs() < 1e-6);
            assert!(data.reading().notes[0].contains("sorted by a reading"), "{:?}", data.reading().notes);
        }
    }

    #[test]
    fn rows_whose_order_is_lost_are_a_static_map() {
        let data = sorted(true, true);
        assert!(!data.is_path() && data.time().is_none() && data.sweeps().len() == 1);
        assert!(data.reading().notes[0].contains("only rises or only falls"), "{:?}", data.reading().notes);
    }

    /// Three loops at pressures that scatter by more than from row to row, without labels: sorted by pressure the motion leaps.
    #[test]
    fn rows_that_were_sorted_without_labels_are_a_static_map() {
        let mut rows: Vec<[f64; 2]> = (0..120)
            .map(|row| {
                let at = row % 40;
                let scatter = 1e-3 * f64::from(at * 17 % 40);
                [f64::from(1 + row / 40) + scatter, 0.01 + 0.2 * (1.0 - (f64::from(at) / 20.0 - 1.0).abs())]
            })
            .collect();
        let is_path = |rows: &[[f64; 2]]| {
            let mut text = "time [s],pressure [bar],contraction,force [N]\n".to_owned();
            for (row, [p, c]) in rows.iter().enumerate() {
                let _ = writeln!(text, "{row},{p},{c},{}", 300.0 * p * (1.0 - 3.0 * c));
            }
            Data::from_bytes(text.as_bytes(), "d.csv", &ReadOptions::default()).unwrap().is_path()
        };
        assert!(is_path(&rows));
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(!is_path(&rows));
    }
}
