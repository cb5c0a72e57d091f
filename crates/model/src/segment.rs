//! Evaluates consecutive rows with the memory that is carried along them.

use bulge_effects::Jet;
use bulge_fibre::Start;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::evaluate::Run;
use crate::failure::RowError;
use crate::pass::Pass;
use crate::prediction::Part;
use crate::record::Record;
use crate::row::Place;
use crate::warm::Answered;

/// The work that is the same for every segment.
pub(crate) struct Task<'a> {
    pub(crate) record: &'a Record,
    pub(crate) passes: Vec<Pass>,
    pub(crate) columns: usize,
    pub(crate) counts: &'a (dyn Fn(usize) -> bool + Sync),
    /// Whether each row keeps its equilibrium for the next evaluation in its own slot. Otherwise a segment
    /// has one slot.
    pub(crate) keeps: bool,
    /// Whether each row keeps its answer for the next pass. Otherwise a segment has room for one.
    pub(crate) answers: bool,
}

/// Fills the part of one segment. Returns the rows that count and have no force, with the reasons, and what the
/// rows were answered.
pub(crate) fn segment(
    runs: &[Run<'_>],
    task: &Task<'_>,
    rows: Range<usize>,
    mut part: Part<'_>,
    slots: &mut [Option<Start>],
) -> (Vec<(usize, RowError)>, Vec<Answered>) {
    let mut failed = BTreeMap::new();
    let mut answered: Vec<Answered> = vec![None; if task.answers { rows.len() } else { 1 }];
    // Rows that don't count matter only through the memory that they pass to rows that do.
    let remembers = runs[0].remembers();
    let Some(last) = rows.clone().rev().find(|row| (task.counts)(*row)) else {
        return (Vec::new(), answered);
    };
    let rows = rows.start..last + 1;
    for (number, pass) in task.passes.iter().enumerate() {
        let mut memory = runs[0].memory();
        let (mut before, mut give): (Option<(usize, usize)>, f64) = (None, 0.0);
        for (i, row) in rows.clone().enumerate() {
            let (moment, counts) = (&task.record.moments()[row], (task.counts)(row));
            let run = &runs[runs[0].model.body_of(moment.specimen)];
            if moment.begins {
                memory.iter_mut().flatten().for_each(|m| *m = Jet::from(0.0));
            }
            if !(counts || remembers) {
                continue;
            }
            let slot = if task.keeps { i } else { 0 };
            // An empty slot may be filled from the previous row of the same muscle.
            let same = before.filter(|(_, body)| *body == run.body && run.walks());
            if !task.keeps && same.is_none() {
                slots[slot] = None;
            }
            if slots[slot].is_none() {
                slots[slot] = same.and_then(|(before, _)| slots[before].clone());
            }
            before = Some((slot, run.body));
            if !task.answers {
                // The row before may be one of another muscle.
                answered[0] = None;
            }
            let own = if task.answers { i } else { 0 };
            let mut place =
                Place { row, start: &mut slots[slot], answered: &mut answered[own], give: &mut give };
            match run.row(moment, pass, &mut memory, &mut place) {
                Ok(row) if counts => part.fill(i, number, pass, task.columns, row.reading),
                Err(error) if counts => {
                    failed.entry(row).or_insert(error);
                    if run.all_or_none {
                        return (failed.into_iter().collect(), answered);
                    }
                }
                Ok(_) | Err(_) => {}
            }
        }
    }
    (failed.into_iter().collect(), answered)
}
