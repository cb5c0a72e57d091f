//! Sweeps: uninterrupted runs, from labels or found in time, pressure and motion.

use crate::columns::Columns;
use crate::isobars;
use crate::resolution::{bounds, median};
use crate::stretch::Stretch;
use serde::Serialize;
use std::ops::Range;

/// Kind of a sweep.
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
    /// It moves under a held load while the pressure changes.
    Isotonic,
    /// Rows without order in time.
    Static,
}

/// An uninterrupted run, or a static map.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sweep {
    /// Its label, or its number in the file; preceded by the name of the file if there are several.
    pub name: String,
    /// Its rows.
    pub rows: Range<usize>,
    /// Index of its specimen in the list of specimens.
    pub specimen: u32,
    /// Its kind.
    pub kind: SweepKind,
}

/// A pause this many times as long as the median time between rows begins a new sweep.
pub(crate) const GAP: f64 = 20.0;
/// Rows of a pressure step between isobaric runs form a run of their own if they are more than this fraction
/// of the shorter run.
const LONG_STEP: f64 = 0.2;
/// A sweep with a smaller change of contraction is isometric while the pressure changes: the rig has some
/// compliance.
const ISOMETRIC_TRAVEL: f64 = 2e-3;
/// So is one with a change below this that doesn't turn more often than the pressure: a compliant frame, or a
/// clamp that creeps. A length that is driven to and fro at each pressure turns more often.
const DRIFTING_TRAVEL: f64 = 1e-2;
/// A force was held, by a weight, if its standard deviation is a smaller fraction of its mean.
const HELD_FORCE: f64 = 0.1;
/// A pressure that changes by more than this fraction of the largest isn't constant.
const PRESSURE_CHANGE: f64 = 0.05;

/// The sweeps of a data set without their kind, and further results from finding their starts.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub(crate) sweeps: Vec<Sweep>,
    /// Rows of pressure steps between isobaric runs, in ascending order.
    pub(crate) between: Vec<usize>,
    /// First rows of the parts into which a stated sweep is split, with the contradiction.
    pub(crate) contradictions: Vec<(usize, Contradiction)>,
}

/// How a sweep label contradicts its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Contradiction {
    /// The time goes back.
    Time,
    /// The specimen changes.
    Specimen,
    /// The pressure steps from one level to another.
    Pressure,
}

/// Finds the sweeps. `files` has the rows of each file and the prefix of its sweeps' names; rows that are no path are one.
pub(crate) fn find(columns: &Columns, files: &[(Range<usize>, String)], is_path: bool) -> Found {
    let mut found = Found::default();
    for (file, prefix) in files {
        let first = found.sweeps.len();
        let mut label_before = None;
        for (specimen, part) in specimens(columns, file) {
            for rows in if is_path { runs(columns, &part, &mut found) } else { vec![part.clone()] } {
                let number = found.sweeps.len() - first + 1;
                let labels = columns.sweep.as_ref();
                let label = labels.and_then(|labels| labels.rows().get(rows.start).copied());
                if label.is_some() && label == label_before && rows.start == part.start {
                    found.contradictions.push((rows.start, Contradiction::Specimen));
                }
                label_before = label;
                let label = label.and_then(|label| labels?.names().get(label as usize).cloned());
                let name = format!("{prefix}{}", label.unwrap_or_else(|| number.to_string()));
                found.sweeps.push(Sweep { name, rows, specimen, kind: SweepKind::Static });
            }
        }
    }
    found.contradictions.sort_by_key(|(row, _)| *row);
    found
}

/// The specimens of a file one after the other, with their rows.
fn specimens(columns: &Columns, file: &Range<usize>) -> Vec<(u32, Range<usize>)> {
    let Some(of_rows) = columns.specimen.as_ref().and_then(|labels| labels.rows().get(file.clone())) else {
        return vec![(0, file.clone())];
    };
    let mut start = file.start;
    let part = |part: &[u32]| {
        let rows = start..start + part.len();
        start = rows.end;
        (part[0], rows)
    };
    of_rows.chunk_by(|a, b| a == b).map(part).collect()
}

/// The uninterrupted runs among rows of one specimen in one file.
fn runs(columns: &Columns, rows: &Range<usize>, found: &mut Found) -> Vec<Range<usize>> {
    let labels = columns.sweep.as_ref().map(crate::columns::Labels::rows);
    let time = columns.time_s.as_deref();
    let mut starts = vec![rows.start];
    if let Some(labels) = labels {
        let is_new = |i: usize| labels[i] != labels[i - 1];
        // A clock that goes back to where the run began, or further, was restarted; otherwise the rows are
        // out of order and begin no run.
        let mut began = rows.start;
        let mut restarts = Vec::new();
        for i in rows.start + 1..rows.end {
            let is_back = time.is_some_and(|time| time[i] < time[i - 1] && time[i] <= time[began]);
            if is_back && !is_new(i) {
                restarts.push(i);
            }
            if is_back || is_new(i) {
                began = i;
            }
        }
        found.contradictions.extend(restarts.iter().map(|row| (*row, Contradiction::Time)));
        starts.extend((rows.start + 1..rows.end).filter(|i| is_new(*i)));
        starts.extend(restarts);
        starts.sort_unstable();
    } else if let Some(time) = time {
        let mut forward: Vec<f64> =
            time[rows.clone()].windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0).collect();
        let pause = GAP * median(&mut forward);
        let breaks = |i: &usize| time[*i] < time[i - 1] || time[*i] - time[i - 1] > pause;
        starts.extend((rows.start + 1..rows.end).filter(breaks));
    }
    let ends = starts.iter().skip(1).copied().chain([rows.end]);
    let mut split = Vec::new();
    for recording in starts.iter().zip(ends).map(|(start, end)| *start..end) {
        let parts = isobaric(columns, &recording, &mut found.between);
        if labels.is_some() {
            let inner = parts.iter().skip(1);
            found.contradictions.extend(inner.map(|part| (part.start, Contradiction::Pressure)));
        }
        split.extend(parts);
    }
    split
}

/// Cuts a recording between its isobaric runs. Rows of a short step belong to the next run; those of a long
/// one are a run of their own.
fn isobaric(columns: &Columns, recording: &Range<usize>, between: &mut Vec<usize>) -> Vec<Range<usize>> {
    let readings = isobars::Readings {
        pressure: &columns.pressure_pa,
        motion: columns.motion.values(),
        force: &columns.force_n,
    };
    let isobars = isobars::find(readings, recording);
    let mut parts = Vec::new();
    let mut start = recording.start;
    for pair in isobars.windows(2) {
        let [before, after] = [&pair[0].rows, &pair[1].rows];
        let step = before.end..after.start;
        let most = LONG_STEP * before.len().min(after.len()) as f64;
        if step.len() as f64 > most {
            parts.extend([start..step.start, step.clone()]);
            start = step.end;
        } else {
            parts.push(start..step.start);
            start = step.start;
        }
        between.extend(step);
    }
    parts.push(start..recording.end);
    parts
}

/// Whether a sweep is at constant pressure; `largest` is the largest pressure in the data.
pub(crate) fn is_held(pressure: &[f64], largest: f64) -> bool {
    let (low, high) = bounds(pressure);
    high - low <= PRESSURE_CHANGE * largest
}

/// Whether a force was held, as by a weight: its standard deviation is less than a tenth of its mean.
pub fn is_weight(force: impl Iterator<Item = f64> + Clone) -> bool {
    let count = force.clone().count().max(1) as f64;
    let mean = force.clone().sum::<f64>() / count;
    let variance = force.map(|force| (force - mean).powi(2)).sum::<f64>() / count;
    variance.sqrt() < HELD_FORCE * mean.abs()
}

/// Travel of the length as a fraction of `scale`, if it exceeds the compliance of a clamped rig.
pub(crate) fn drift(motion: &[f64], scale: f64) -> Option<f64> {
    let (low, high) = bounds(motion);
    (high - low > ISOMETRIC_TRAVEL * scale).then_some((high - low) / scale)
}

/// The readings of a sweep, and the stretches of its length and of its pressure; the latter are empty if the
/// pressure is held.
pub(crate) struct Path<'a> {
    pub(crate) motion: &'a [f64],
    pub(crate) force: &'a [f64],
    pub(crate) stretches: &'a [Stretch],
    pub(crate) pressure_stretches: &'a [Stretch],
}

/// The kind of a path. `scale` is 1 for contractions and the longest length for lengths.
pub(crate) fn kind(path: &Path<'_>, scale: f64) -> SweepKind {
    let does = |direction| path.stretches.iter().any(|stretch| stretch.direction == direction);
    let moves = |stretches: &[Stretch]| stretches.iter().filter(|stretch| stretch.direction != 0).count();
    if !path.pressure_stretches.is_empty() {
        match drift(path.motion, scale) {
            None => return SweepKind::Isometric,
            Some(_) if is_weight(path.force.iter().copied()) => return SweepKind::Isotonic,
            Some(way)
                if way <= DRIFTING_TRAVEL && moves(path.stretches) <= moves(path.pressure_stretches) =>
            {
                return SweepKind::Isometric;
            }
            Some(_) => {}
        }
    }
    match (does(1), does(-1)) {
        (true, true) => SweepKind::Loop,
        (true, false) => SweepKind::Shortening,
        (false, true) => SweepKind::Lengthening,
        (false, false) => SweepKind::Hold,
    }
}
