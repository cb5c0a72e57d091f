//! Something happened during the test: the rows before a jump and those after it are diagnosed each on their
//! own. An effect that acts on the muscle acts on both sides of the jump; what only one of them names, or only
//! both together, stands in for the event (a fitting that slipped, a sensor that was knocked).

use bulge_measurements::Data;
use std::collections::BTreeSet;

use crate::comparison::rows::lines;
use crate::diagnosis::diagnose::DiagnoseOptions;
use crate::diagnosis::document::{Diagnosis, Verdict};
use crate::error::InferenceError;
use crate::progress::Progress;

/// The diagnoses of the rows before an event and of those after it.
pub(crate) struct Sides {
    /// Line numbers in the files: up to the event, and from it on.
    lines: [String; 2],
    /// None where there is no answer.
    found: [Option<Diagnosis>; 2],
}

impl Sides {
    /// Diagnoses the rows of the event's specimen before `row` and those from it on, each beside the rows of
    /// all other specimens.
    pub(crate) fn of(
        data: &Data,
        options: &DiagnoseOptions,
        row: usize,
        ask: impl Fn(&DiagnoseOptions) -> Result<Diagnosis, InferenceError>,
    ) -> Self {
        let own = |other: &usize| data.specimen_of(*other) == data.specimen_of(row);
        let [before, after]: [Vec<usize>; 2] =
            [(0..row).filter(own).collect(), (row..data.len()).filter(own).collect()];
        let without = |rows: &[usize]| {
            let mut base = options.base.clone();
            base.excluded.extend_from_slice(rows);
            ask(&DiagnoseOptions { base, progress: Progress::default(), ..options.clone() }).ok()
        };
        Self {
            lines: [lines(data, &before), lines(data, &after)],
            found: [without(&after), without(&before)],
        }
    }

    /// Whether there are families, and each of them is named on both sides, or on one of them if the other
    /// can't tell.
    pub(crate) fn name_each(&self, families: &[&str]) -> bool {
        let is_named = |family: &&str| {
            let side = |place: usize| self.found[place].as_ref();
            let on = |place| {
                side(place).is_some_and(|found| found.missing.iter().any(|one| one.family == *family))
            };
            let silent = |place| side(place).is_none_or(|found| found.verdict == Verdict::CannotTell);
            on(0) && (on(1) || silent(1)) || on(1) && silent(0)
        };
        !families.is_empty() && families.iter().all(is_named)
    }

    /// What each side says, in a sentence.
    pub(crate) fn says(&self, jump: &str) -> String {
        let [before, after] = [0, 1].map(|place| said(self.found[place].as_ref()));
        format!(
            "{jump}, as if a fitting had slipped or a sensor was knocked. Before it (line {}) {before}; after it (line {}) {after}. See what happened there, \
             and diagnose the rows of one state of the rig",
            self.lines[0], self.lines[1],
        )
    }
}

/// A verdict in a few words.
fn said(found: Option<&Diagnosis>) -> String {
    let Some(found) = found else { return "the rows don't tell".to_owned() };
    let names: BTreeSet<&str> = found.missing.iter().map(|missing| missing.effect.as_str()).collect();
    match found.verdict {
        Verdict::Adequate => "nothing is missing".to_owned(),
        Verdict::Missing => names.into_iter().collect::<Vec<_>>().join(" and ") + " would be missing",
        Verdict::Unknown => "no effect of the catalogue explains the rows".to_owned(),
        Verdict::CannotTell => "the rows don't tell".to_owned(),
    }
}
