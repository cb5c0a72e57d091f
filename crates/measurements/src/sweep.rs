//! Sweeps: uninterrupted runs, as labelled or as found in time, pressure and motion.

use crate::columns::{Columns, Trace};
use crate::resolution::{bounds, median};
use crate::stretch::Stretch;
use serde::Serialize;
use std::ops::Range;

/// What a sweep does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SweepKind {
    /// The muscle shortens and lengthens.
    Loop,
    /// It only shortens.
    Shortening,
    /// It only lengthens.
    Lengthening,
    /// It keeps its length and its pressure.
    Hold,
    /// It keeps its length while the pressure changes.
    Isometric,
    /// Rows without order in time.
    Static,
}

/// An uninterrupted run, or a static map.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sweep {
    /// Its label, or its number in the file; after the name of the file where there are several.
    pub name: String,
    /// Its rows.
    pub rows: Range<usize>,
    /// The place of its specimen in the list of specimens.
    pub specimen: u32,
    /// What it does.
    pub kind: SweepKind,
}

/// A pause this many times as long as the median time between rows begins a new sweep.
pub(crate) const GAP: f64 = 20.0;
/// A jump in one row to another pressure and another contraction begins a new sweep if both are more than this share of their range,
const JUMP: f64 = 0.05;
/// and more than this many times the median change between rows,
const JUMP_OF_STEPS: f64 = 20.0;
/// if the pressure is constant over so many rows on both sides,
const AROUND: usize = 5;
/// and the muscle shortens although the pressure falls, or lengthens although it rises; else if it also moves before and after, over so many rows
const MOVING_AROUND: usize = 20;
/// by this share of the jump: a muscle under a weight that follows a step of pressure stands still before and nearly still after.
const MOVING: f64 = 0.01;
/// A sweep whose contraction changes less, while the pressure changes, is isometric: the rig gives way a little.
const ISOMETRIC_TRAVEL: f64 = 2e-3;
/// A pressure that changes by more than this share of the largest is no constant pressure.
const PRESSURE_CHANGE: f64 = 0.05;

/// The sweeps of a data set without their kind. `files` are the rows of each file, with the name's beginning.
pub(crate) fn find(columns: &Columns, specimen: &[u32], files: &[(Range<usize>, String)]) -> Vec<Sweep> {
    let mut found = Vec::new();
    for (file, prefix) in files {
        let first = found.len();
        let mut start = file.start;
        for part in specimen.get(file.clone()).unwrap_or_default().chunk_by(|a, b| a == b) {
            let rows = start..start + part.len();
            start = rows.end;
            for rows in runs(columns, &rows) {
                let number = found.len() - first + 1;
                let label = columns
                    .sweep
                    .as_ref()
                    .and_then(|labels| labels.names().get(*labels.rows().get(rows.start)? as usize).cloned());
                let name = format!("{prefix}{}", label.unwrap_or_else(|| number.to_string()));
                found.push(Sweep { name, rows, specimen: part[0], kind: SweepKind::Static });
            }
        }
    }
    found
}

/// The uninterrupted runs among rows of one specimen in one file.
fn runs(columns: &Columns, rows: &Range<usize>) -> Vec<Range<usize>> {
    let mut starts = vec![rows.start];
    if let Some(labels) = &columns.sweep {
        let labels = labels.rows();
        starts.extend((rows.start + 1..rows.end).filter(|i| labels[*i] != labels[i - 1]));
    } else if let Some(time) = &columns.time_s {
        let mut forward: Vec<f64> =
            time[rows.clone()].windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0).collect();
        let pause = GAP * median(&mut forward);
        let jumps = Jumps::new(columns, rows);
        let breaks = |i: &usize| time[*i] < time[i - 1] || time[*i] - time[i - 1] > pause || jumps.is_at(*i);
        starts.extend((rows.start + 1..rows.end).filter(breaks));
    }
    let ends = starts.iter().skip(1).copied().chain([rows.end]);
    starts.iter().zip(ends).map(|(start, end)| *start..end).collect()
}

/// Jumps from the end of one isobaric run to the start of another.
struct Jumps<'a> {
    pressure: &'a [f64],
    motion: &'a [f64],
    rows: &'a Range<usize>,
    /// Smallest jumps of pressure and motion.
    least: [f64; 2],
    /// +1 where the motion is a contraction, -1 where it is a length.
    sign: f64,
}

impl<'a> Jumps<'a> {
    fn new(columns: &'a Columns, rows: &'a Range<usize>) -> Self {
        let (pressure, motion) = (columns.pressure_pa.as_slice(), columns.motion.values());
        let least = [pressure, motion].map(|values| {
            let values = &values[rows.clone()];
            let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
            let (low, high) = bounds(values);
            (JUMP * (high - low)).max(JUMP_OF_STEPS * median(&mut steps))
        });
        let sign = if matches!(columns.motion, Trace::Contraction(_)) { 1.0 } else { -1.0 };
        Self { pressure, motion, rows, least, sign }
    }

    /// Whether a new run begins at this row.
    fn is_at(&self, row: usize) -> bool {
        let [pressure, motion] = [self.pressure, self.motion].map(|values| values[row] - values[row - 1]);
        if pressure.abs() <= self.least[0] || motion.abs() <= self.least[1] {
            return false;
        }
        let sides = |rows: usize| {
            [row.saturating_sub(rows).max(self.rows.start)..row, row..(row + rows).min(self.rows.end)]
        };
        let is_isobaric = sides(AROUND).iter().all(|side| {
            let (low, high) = bounds(&self.pressure[side.clone()]);
            high - low < 0.1 * pressure.abs()
        });
        let moves = || {
            sides(MOVING_AROUND).iter().all(|side| {
                (self.motion[side.end - 1] - self.motion[side.start]).abs() > MOVING * motion.abs()
            })
        };
        is_isobaric && (pressure * motion * self.sign < 0.0 || moves())
    }
}

/// Whether a sweep keeps its pressure; `largest` is the largest pressure in the data.
pub(crate) fn is_held(pressure: &[f64], largest: f64) -> bool {
    let (low, high) = bounds(pressure);
    high - low <= PRESSURE_CHANGE * largest
}

/// What a path does. `scale` is 1 for contractions and the longest length for lengths, `largest` the largest pressure in the data.
pub(crate) fn kind(
    stretches: &[Stretch],
    pressure: &[f64],
    motion: &[f64],
    scale: f64,
    largest: f64,
) -> SweepKind {
    let (low, high) = bounds(motion);
    let does = |direction| stretches.iter().any(|stretch| stretch.direction == direction);
    if high - low <= ISOMETRIC_TRAVEL * scale && !is_held(pressure, largest) {
        return SweepKind::Isometric;
    }
    match (does(1), does(-1)) {
        (true, true) => SweepKind::Loop,
        (true, false) => SweepKind::Shortening,
        (false, true) => SweepKind::Lengthening,
        (false, false) => SweepKind::Hold,
    }
}
