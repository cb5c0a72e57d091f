//! Spikes: one to three readings off the path on which their neighbours on both sides agree; at the ends of a path, beyond
//! zero and all other readings by far more than any reading moves.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::data::Data;
use crate::resolution::Resolution;
use bulge_muscles::shown::listed;
use std::ops::Range;

/// Longest spike in rows.
const LONGEST: usize = 3;
/// Readings on each side that determine the expected value.
const SIDE: usize = 3;
/// A spike lies beyond the predictions of both sides by this many standard deviations of the noise,
const NOISE: f64 = 8.0;
/// quantisation steps,
const STEPS: f64 = 4.0;
/// second differences of the neighbours,
const BENDS: f64 = 2.0;
/// and by this fraction of the range.
const RANGE: f64 = 5e-3;
/// Rows further apart than this many usual time steps have a pause between them.
const PAUSE: f64 = 3.0;
/// Readings that a message quotes.
const MOST_SHOWN: usize = 3;
/// Number of passes: neighbouring spikes hide each other, so found ones are bridged and the search is
/// repeated.
const PASSES: usize = 3;
/// Steps towards a tip are at most this many times the ones before: a curve that bends as a square root does has 2.4.
const GROWS: f64 = 3.0;
/// If more than one turning point in this many has a spike, it is the shape of the curve.
const COMES_BACK: usize = 5;
/// Where one side is missing: times the largest step between other neighbours of the path. What settles with a time constant of
/// two rows has steps that fall by 1.6 from row to row; one of half a row would be needed for ten.
const END_STEPS: f64 = 10.0;
/// And fraction of the range of all other readings, by which it lies beyond them.
const END_RANGE: f64 = 0.2;
/// If more than one row in this many is a spike, the quantity scatters in this way.
const MOST: usize = 20;

/// Spikes of the force.
pub(super) fn of_force(gate: &Gate) -> Vec<usize> {
    let [(_, rows), ..] = in_columns(gate);
    rows
}

fn paths(data: &Data) -> Vec<Range<usize>> {
    data.paths().map(|(sweep, _)| sweep.rows.clone()).collect()
}

/// Spikes of each column.
pub(super) fn in_columns(gate: &Gate) -> [(&'static str, Vec<usize>); 3] {
    let paths = paths(gate.data);
    let found = gate.columns.map(|column| {
        let inner = along(gate.data, column.values, &column.resolution, RANGE, &paths);
        let mut bridged = column.values.to_vec();
        for row in &inner {
            bridged[*row] = bridged[row - 1];
        }
        let least = least(&column.resolution, RANGE);
        let at_ends = |path: &Range<usize>| {
            let backwards: Vec<f64> = bridged[path.clone()].iter().rev().copied().collect();
            let [first, last] = [at_start(&bridged[path.clone()], least), at_start(&backwards, least)];
            [path.start + first.start..path.start + first.end, path.end - last.end..path.end - last.start]
        };
        let ends: Vec<[Range<usize>; 2]> = paths.iter().map(at_ends).collect();
        // What comes back at the starts, or at the ends, is the shape of the curve.
        let rare = [0, 1].map(|side| {
            let count = ends.iter().filter(|sides| !sides[side].is_empty()).count();
            count == 1 || COMES_BACK * count <= paths.len()
        });
        let candidates = ends.into_iter().flat_map(|sides| sides.into_iter().zip(rare));
        let rows: Vec<usize> =
            candidates.filter(|(_, is_rare)| *is_rare).flat_map(|(rows, _)| rows).collect();
        (column.name, inner, beyond_others(gate, &bridged, column.name, rows))
    });
    // A row that stands out in several columns was recorded before, or after, all of them moved on.
    let is_alone =
        |row: &usize| found.iter().filter(|(_, _, ends)| ends.binary_search(row).is_ok()).count() == 1;
    found.each_ref().map(|(name, inner, ends)| {
        let mut rows: Vec<usize> =
            inner.iter().chain(ends.iter().filter(|row| is_alone(row))).copied().collect();
        rows.sort_unstable();
        rows.dedup();
        (*name, rows)
    })
}

/// Those of the rows, in ascending order, whose values lie beyond zero and all others. No muscle has a length of zero: there, beyond
/// all others.
fn beyond_others(gate: &Gate, values: &[f64], name: &str, mut rows: Vec<usize>) -> Vec<usize> {
    rows.sort_unstable();
    let is_length = name == gate.motion_name() && matches!(gate.data.motion(), crate::Trace::Length(_));
    let start = if is_length { [f64::INFINITY, f64::NEG_INFINITY] } else { [0.0, 0.0] };
    let others = values.iter().enumerate().filter(|(row, _)| rows.binary_search(row).is_err());
    let [low, high] = others.fold(start, |[low, high], (_, value)| [low.min(*value), high.max(*value)]);
    let far = END_RANGE * (high - low);
    rows.retain(|row| values[*row] > high + far || values[*row] < low - far);
    rows
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let of_column = |(name, rows): (&str, Vec<usize>)| {
        gate.finding_if_any(
            FindingKind::Spike,
            Severity::Warning,
            &rows,
            |count| {
                let read = |row: &usize| {
                    format!("row {}: {name} {}", gate.data.line(*row).1, gate.reading(name, *row))
                };
                format!(
                    "the {name} of {} lies far from the rows around ({})",
                    rows_in_words(count),
                    listed(MOST_SHOWN, "", rows.iter().map(read))
                )
            },
            "nothing: these rows don't count; remove them if the reading was disturbed",
        )
    };
    in_columns(gate).into_iter().filter_map(of_column).collect()
}

impl Data {
    /// Rows at which `values` (one per row, such as measured less computed forces) have spikes: one to three
    /// values beyond the predictions of the three on either side, by 8 standard deviations of their noise and
    /// twice the second difference of the neighbours. A step, a tip, and a reversal of friction are no
    /// spikes, because each of their values agrees with the prediction of one side. Sweeps that were recorded
    /// without a pause are treated as one. None in a static map.
    #[must_use]
    pub fn spikes(&self, values: &[f64]) -> Vec<usize> {
        self.spikes_where(values, |_| true)
    }

    /// The same if some rows don't count: sweeps without any counting row are left out of the noise estimate.
    #[must_use]
    pub fn spikes_where(&self, values: &[f64], counts: impl Fn(usize) -> bool) -> Vec<usize> {
        if values.len() != self.len() {
            return Vec::new();
        }
        let sweeps = self.sweeps().iter().map(|sweep| sweep.rows.clone());
        let sweeps: Vec<Range<usize>> = sweeps.filter(|rows| rows.clone().any(&counts)).collect();
        let whole = recordings(self);
        along(self, values, &Resolution::of(values, &sweeps), 0.0, &whole)
    }
}

/// Ranges of rows that were recorded without a pause. Where paths are cut at steps of the set points,
/// residuals of a model go on.
fn recordings(data: &Data) -> Vec<Range<usize>> {
    let steps = |rows: &Range<usize>| -> Vec<f64> {
        data.time().map_or(Vec::new(), |time| time[rows.clone()].windows(2).map(|w| w[1] - w[0]).collect())
    };
    let mut found: Vec<Range<usize>> = Vec::new();
    for (sweep, _) in data.paths() {
        let mut usual = steps(&sweep.rows);
        usual.sort_unstable_by(f64::total_cmp);
        let usual = usual.get(usual.len() / 2).copied();
        let goes_on = |before: &Range<usize>| {
            let since = data.time().map(|time| time[sweep.rows.start] - time[before.end - 1]);
            before.end == sweep.rows.start
                && since.zip(usual).is_some_and(|(since, usual)| since > 0.0 && since <= PAUSE * usual)
        };
        match found.last_mut() {
            Some(before) if goes_on(before) => before.end = sweep.rows.end,
            _ => found.push(sweep.rows.clone()),
        }
    }
    found
}

/// Rows of spikes of a quantity with this resolution; deviations below `share` of its range are ignored.
fn along(
    data: &Data,
    values: &[f64],
    resolution: &Resolution,
    share: f64,
    runs: &[Range<usize>],
) -> Vec<usize> {
    let least = least(resolution, share);
    let mut found = Vec::new();
    if least > 0.0 {
        for run in runs {
            found.extend(in_run(&values[run.clone()], least).iter().map(|row| run.start + row));
        }
    }
    leave_tips(data, values, &mut found);
    if MOST * found.len() > values.len() { Vec::new() } else { found }
}

/// Least deviation of a spike from what its neighbours lead to.
fn least(resolution: &Resolution, share: f64) -> f64 {
    (NOISE * resolution.noise).max(STEPS * resolution.step).max(share * resolution.range)
}

/// A spike that recurs at the turning points is a tip of the curve, both sides of which are seen in few rows
/// only. So is one to which the steps of both sides grow.
fn leave_tips(data: &Data, values: &[f64], found: &mut Vec<usize>) {
    let turning = data.direction_in_doubt();
    let turns = |row: &usize| turning.binary_search(row).is_ok();
    let grows = |[far, near, tip]: [f64; 3]| {
        let [before, last] = [near - far, tip - near];
        last * before > 0.0 && last.abs() <= GROWS * before.abs()
    };
    found.retain(|row| {
        let sides = [[row.wrapping_sub(2), row.wrapping_sub(1), *row], [row + 2, row + 1, *row]];
        let at = |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        !(turns(row) && sides.into_iter().all(|side| grows(side.map(at))))
    });
    let at_turns = found.iter().filter(|row| turns(row)).count();
    if at_turns > 1 && COMES_BACK * at_turns > turning.len() {
        found.retain(|row| !turns(row));
    }
}

/// Spikes of one run, in ascending order.
fn in_run(values: &[f64], least: f64) -> Vec<usize> {
    let mut x = values.to_vec();
    let mut found: Vec<usize> = Vec::new();
    for _ in 0..PASSES {
        let before = found.len();
        let mut row = SIDE;
        while row + SIDE < x.len() {
            // Take the shortest length after which the path continues: the rows next to a spike look like a
            // part of it.
            let length = (1..=LONGEST).find(|length| is_spike(&x, row, *length, least));
            for place in row..row + length.unwrap_or(0) {
                found.push(place);
            }
            if let Some(length) = length {
                bridge(&mut x, row, length);
            }
            row += length.unwrap_or(1);
        }
        if found.len() == before {
            break;
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Whether each of `length` readings from `first` lies beyond the predictions from both sides.
fn is_spike(x: &[f64], first: usize, length: usize, least: f64) -> bool {
    let end = first + length;
    let (Some(before), Some(after)) = (x.get(first - SIDE..first), x.get(end..end + SIDE)) else {
        return false;
    };
    let bend = |side: &[f64]| (side[0] - 2.0 * side[1] + side[2]).abs();
    // Linear extrapolation over k rows is off by k (k + 1)/2 second differences; its noise grows like k.
    let reach = length as f64;
    let bends = BENDS * bend(before).max(bend(after)) * 0.5 * reach * (reach + 1.0);
    // The predictions from both sides have to agree; otherwise nothing determines the expected value.
    let needed = (least * reach).max(bends);
    let excess = |row: usize| {
        let (k, back) = ((row - first + 1) as f64, (end - row) as f64);
        let leads = [
            before[2] + k * (before[2] - before[1]),
            after[0] + back * (after[0] - after[1]),
            before[2],
            after[0],
        ];
        let [low, high] =
            leads.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
        [x[row] - high, low - x[row]]
    };
    (first..end).all(|row| excess(row).into_iter().any(|beyond| beyond > needed))
}

/// A spike among the first rows of a path: one to three readings next to each other, the first of which has fewer than three before it.
fn at_start(values: &[f64], least: f64) -> Range<usize> {
    let is_spike = |spike: &Range<usize>| {
        let Some(after) = values.get(spike.end..).filter(|after| after.len() >= 2 * SIDE) else {
            return false;
        };
        let before = spike.start.checked_sub(1).map(|row| values[row]);
        let leaves = |row: usize, needed: f64| {
            let next = after[0] + (spike.end - row) as f64 * (after[0] - after[1]);
            let leads = [Some(next), Some(after[0]), before];
            leads.into_iter().flatten().all(|lead| (values[row] - lead).abs() > needed)
        };
        let all_leave = |needed: f64| spike.clone().all(|row| leaves(row, needed));
        // The last rows may have a spike of their own. The largest step is only looked for where there is something.
        let others = || values[..spike.start].iter().chain(&after[..after.len() - LONGEST]);
        let step = || others().zip(others().skip(1)).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
        all_leave(least) && all_leave(END_STEPS * step())
    };
    let mut starts = (0..SIDE).flat_map(|first| (first + 1..=first + LONGEST).map(move |end| first..end));
    starts.find(is_spike).unwrap_or_default()
}

/// Replaces spiked readings by linear interpolation between their neighbours.
fn bridge(x: &mut [f64], first: usize, length: usize) {
    let (from, to) = (x[first - 1], x[first + length]);
    for k in 0..length {
        let part = (k + 1) as f64 / (length + 1) as f64;
        x[first + k] = from + part * (to - from);
    }
}
