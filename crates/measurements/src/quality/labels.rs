//! Labels that contradict the rows: stated directions, interrupted runs, duplicated rows.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::data::Data;
use crate::stretch;
use crate::sweep::{self, Contradiction, SweepKind};
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let mut found: Vec<Finding> =
        [directions(gate), interrupted(gate), duplicates(gate)].into_iter().flatten().collect();
    found.extend(contradicted(gate));
    found.extend(drifting(gate));
    found
}

fn directions(gate: &Gate) -> Option<Finding> {
    let Stated { against, moving } = Stated::of(gate.data)?;
    let all = if 2 * against.len() > moving {
        "turn the labels over (`up` and `+1` mean shortening, at held length a rising pressure), or check the unit and sign of the motion"
    } else {
        "correct the labels, or leave the column out: the direction of a path is found from its motion"
    };
    gate.finding_if_any(
        FindingKind::DirectionContradicted,
        Severity::Warning,
        &against,
        |count| {
            format!("{}, of {moving} that move, with a direction against the motion", rows_in_words(count))
        },
        all,
    )
}

/// Stated directions beside the motion.
struct Stated {
    against: Vec<usize>,
    /// Number of rows that move.
    moving: usize,
}

impl Stated {
    fn of(data: &Data) -> Option<Self> {
        let stated = data.columns().direction.as_deref()?;
        let mut found = Self { against: Vec::new(), moving: 0 };
        for (sweep, driven) in data.driven() {
            for stretch in driven.stretches.iter().filter(|stretch| stretch.direction != 0) {
                let rows = stretch::inner(stretch, &sweep.rows);
                found.moving += rows.len();
                found.against.extend(rows.filter(|row| stated[*row] == -stretch.direction));
            }
        }
        Some(found)
    }
}

/// Isometric sweeps whose length changes by more than that of a clamped muscle.
fn drifting(gate: &Gate) -> Option<Finding> {
    let scale = gate.data.structure.scale;
    let (mut rows, mut most) = (Vec::new(), 0.0_f64);
    for sweep in gate.data.sweeps().iter().filter(|sweep| sweep.kind == SweepKind::Isometric) {
        if let Some(way) = sweep::drift(&gate.motion[sweep.rows.clone()], scale) {
            rows.extend(sweep.rows.clone());
            most = most.max(way);
        }
    }
    let says = |count| {
        format!(
            "{} of sweeps at held length, whose length changes by up to {:.2} %: it is used as read, but counts as held",
            rows_in_words(count),
            100.0 * most
        )
    };
    let instead = "measure the length at the fittings, not at the drive; clamp the frame; include `frame-compliance` if the reading is the drive's";
    gate.finding_if_any(FindingKind::HeldLengthDrifts, Severity::Warning, &rows, says, instead)
}

/// Rows at which a label returns after others.
fn interrupted(gate: &Gate) -> Option<Finding> {
    let labels = gate.data.columns().sweep.as_ref()?;
    let mut seen = HashSet::new();
    let returns = |row: usize| {
        let is_new = seen.insert((gate.data.line(row).0, gate.data.specimen_of(row), labels.rows()[row]));
        (!is_new).then_some(row)
    };
    let within = |row: &usize| gate.data.contradictions.binary_search_by_key(row, |(row, _)| *row).is_ok();
    let starts = gate.data.sweeps().iter().map(|sweep| sweep.rows.start);
    let rows: Vec<usize> = starts.filter_map(returns).filter(|row| !within(row)).collect();
    gate.finding_if_any(
        FindingKind::SweepInterrupted,
        Severity::Warning,
        &rows,
        |count| {
            format!(
                "a sweep label returns after others (times: {count}): each part is taken as a run of its own"
            )
        },
        "keep the rows of a run together and in the order in which they were measured",
    )
}

impl Data {
    /// Rows with a stated direction against the motion, if those are more than half of the rows that move.
    #[must_use]
    pub fn against_the_motion(&self) -> Vec<usize> {
        let found = Stated::of(self).filter(|stated| 2 * stated.against.len() > stated.moving);
        found.map(|stated| stated.against).unwrap_or_default()
    }

    /// Rows at which the specimen changes within a sweep label.
    #[must_use]
    pub fn specimen_changes(&self) -> Vec<usize> {
        let changes = self.contradictions.iter().filter(|(_, what)| *what == Contradiction::Specimen);
        changes.map(|(row, _)| *row).collect()
    }
}

/// Labels that continue although their run has ended: each part is taken as a run of its own.
fn contradicted(gate: &Gate) -> impl Iterator<Item = Finding> {
    let of = |what: Contradiction, says: &str, instead: &str| {
        let found = gate.data.contradictions.iter().filter(|(_, other)| *other == what);
        let rows: Vec<usize> = found.map(|(row, _)| *row).collect();
        gate.finding_if_any(
            FindingKind::SweepContradicted,
            Severity::Warning,
            &rows,
            |count| {
                format!("{says} within a sweep label ({count} times): each part is taken as a run of its own")
            },
            instead,
        )
    };
    [
        of(
            Contradiction::Time,
            "the time runs back",
            "give each run a label of its own, or sort its rows by time",
        ),
        of(
            Contradiction::Specimen,
            "the specimen changes",
            "give the runs of each specimen labels of their own",
        ),
        of(
            Contradiction::Pressure,
            "the pressure steps from one level to another",
            "give the run at each pressure a label of its own, or leave the column `sweep` out",
        ),
    ]
    .into_iter()
    .flatten()
}

/// Rows that equal an earlier one in every column. If a static map repeats its states, some repeats are equal
/// to the last digit. Along a path without times, equal rows aren't copies, because a muscle at rest reads
/// the same again.
fn duplicates(gate: &Gate) -> Option<Finding> {
    let data = gate.data;
    if data.is_path() && data.time().is_none() {
        return None;
    }
    let columns: Vec<&[f64]> = data.columns().numbers().map(|(_, values)| values).collect();
    let marks = |row: usize| {
        (
            data.specimen_of(row),
            data.columns().cycle.as_deref().map(|cycle| cycle[row]),
            data.columns().direction.as_deref().map(|d| d[row]),
        )
    };
    let fingerprint = |row: usize| {
        let mut hasher = DefaultHasher::new();
        for values in &columns {
            values[row].to_bits().hash(&mut hasher);
        }
        marks(row).hash(&mut hasher);
        (hasher.finish(), row)
    };
    let is_same = |a: usize, b: usize| {
        marks(a) == marks(b) && columns.iter().all(|values| values[a].to_bits() == values[b].to_bits())
    };
    let mut prints: Vec<(u64, usize)> = (0..data.len()).map(fingerprint).collect();
    prints.sort_unstable();
    let equal = prints.chunk_by(|a, b| a.0 == b.0 && is_same(a.1, b.1));
    let mut rows: Vec<usize> = equal.flat_map(|same| same[1..].iter().map(|(_, row)| *row)).collect();
    rows.sort_unstable();
    if rows.is_empty() {
        return None;
    }
    let equals = |count| format!("{} equal to an earlier one in every column", rows_in_words(count));
    if !data.is_path() {
        // Rows in the state of an earlier one, whatever their force.
        let mut states = HashSet::new();
        let state = |row: usize| (data.pressure()[row].to_bits(), gate.motion[row].to_bits(), marks(row));
        let again = (0..data.len()).filter(|row| !states.insert(state(*row))).count();
        if 2 * again >= 3 * rows.len() {
            let instead =
                "nothing, if they were measured: the sensor can't tell these repeats apart; remove copies";
            return gate.finding_if_any(FindingKind::DuplicateRow, Severity::Note, &rows, equals, instead);
        }
    }
    let instead = "remove copies: they make the data look more certain than they are";
    gate.finding_if_any(FindingKind::DuplicateRow, Severity::Warning, &rows, equals, instead)
}
