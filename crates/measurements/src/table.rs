//! A table read from any kind of file: unusable rows are set apart, one motion is left, and the rows are in
//! order.

use crate::cell_error::CellError;
use crate::columns::{Columns, Labels};
use crate::error::MeasurementError;
use crate::heading::Field;
use crate::magnitude;
use crate::motion;
use crate::order;
use crate::reading::{ColumnUse, ReadOptions, Reading};
use crate::slot::{Slot, columns};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A table with the line in the file of each row.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) columns: Columns,
    pub(crate) lines: Vec<u32>,
    pub(crate) reading: Reading,
    /// Unpressurised length \[m\] from which its displacements count; none if it has lengths or contractions.
    pub(crate) displaced_from_m: Option<f64>,
}

/// The file is refused if more than one row in this many is unusable.
const MOST_UNUSABLE: usize = 5;
/// Most kinds of reasons in a message.
const MOST_KINDS: usize = 8;
/// Number of first lines listed for each kind.
const FIRST_LINES: usize = 3;

/// Bytes that a row of so many columns takes while it is read: its values, its line, and what the check of its
/// order and of its motion takes.
pub(crate) fn bytes_per_row(columns: usize) -> usize {
    8 * columns + 4 + 16
}

/// Columns during reading, and the problems of their rows.
pub(crate) struct Draft {
    pub(crate) slots: Vec<Slot>,
    pub(crate) uses: Vec<ColumnUse>,
    pub(crate) lines: Vec<u32>,
    pub(crate) notes: Vec<String>,
    problems: Vec<Problems>,
    /// What the file calls its rows.
    unit: &'static str,
}

/// Problems of one column, or of rows as a whole.
#[derive(Debug, Default)]
struct Problems {
    /// In ascending order.
    rows: Vec<u32>,
    kinds: BTreeMap<String, (usize, Vec<u32>)>,
    listed: Vec<(u32, String)>,
}

impl Problems {
    fn push(&mut self, row: u32, kind: &str, reason: impl FnOnce() -> String) {
        if self.rows.last() == Some(&row) {
            return;
        }
        self.rows.push(row);
        let (count, first) = self.kinds.entry(kind.to_owned()).or_default();
        *count += 1;
        if first.len() < FIRST_LINES {
            first.push(row);
        }
        if self.listed.len() < Reading::MOST_LISTED {
            self.listed.push((row, reason()));
        }
    }
}

impl Draft {
    /// An empty draft. `unit` is what the file calls its rows: "line" or "row".
    pub(crate) fn new(slots: Vec<Slot>, uses: Vec<ColumnUse>, unit: &'static str) -> Self {
        // One more entry, for rows as a whole.
        let problems = (0..=slots.len()).map(|_| Problems::default()).collect();
        Self { slots, uses, lines: Vec::new(), notes: Vec::new(), problems, unit }
    }

    /// Marks a field of a row as unusable.
    #[cold]
    pub(crate) fn spoilt(&mut self, slot: usize, row: usize, problem: &CellError) {
        let column = self.slots[slot].heading.text.clone();
        let CellError { kind, text } = problem;
        let says = format!("`{column}` is {kind}");
        let reason =
            || if text.is_empty() { says.clone() } else { format!("`{column}`: `{text}` is {kind}") };
        self.problems[slot].push(index(row), &says, reason);
    }

    /// Marks a whole row as unusable; its fields are gaps.
    #[cold]
    pub(crate) fn broken(&mut self, row: usize, kind: &str, reason: String) {
        self.slots.iter_mut().for_each(Slot::push_gap);
        let last = self.problems.len() - 1;
        self.problems[last].push(index(row), kind, || reason);
    }

    /// The table, or the reason why there is none.
    pub(crate) fn finish(mut self, file: &str, options: &ReadOptions) -> Result<Table, MeasurementError> {
        let rows = self.lines.len();
        if rows == 0 {
            return Err(MeasurementError::no_rows(file));
        }
        self.drop_columns(rows);
        let mut reading = Reading { columns: self.uses, notes: self.notes, ..Reading::default() };
        let mut bad: Vec<u32> =
            self.problems.iter().flat_map(|problems| problems.rows.iter().copied()).collect();
        bad.sort_unstable();
        bad.dedup();
        if bad.len() * MOST_UNUSABLE > rows {
            return Err(too_many(file, &self.problems, &self.lines, bad.len(), self.unit));
        }
        let mut reasons: Vec<(u32, String)> = self.problems.into_iter().flat_map(|p| p.listed).collect();
        reasons.sort_by_key(|(row, _)| *row);
        for (row, reason) in reasons.chunk_by(|a, b| a.0 == b.0).map(|same| {
            let all: Vec<&str> = same.iter().map(|(_, reason)| reason.as_str()).collect();
            (same[0].0, all.join("; "))
        }) {
            reading.add(file, self.lines[row as usize] as usize, reason);
        }
        reading.set_apart_rows = bad.len();
        let mut lines = self.lines;
        let is_good = good(rows, &bad);
        magnitude::settle(file, &mut self.slots, &is_good, options, &mut reading)?;
        let displaced_from_m = motion::settle(file, &mut self.slots, &is_good, options, &mut reading)?;
        let mut columns = columns(self.slots);
        if !bad.is_empty() {
            let keep: Vec<usize> = (0..rows).filter(|row| is_good[*row]).collect();
            keep_rows(&mut columns, &mut lines, &keep);
        }
        order::put_in_order(file, &mut columns, &mut lines, &mut reading)?;
        Ok(Table { columns, lines, reading, displaced_from_m })
    }

    /// Drops optional columns that contain most of the unusable fields, so that their rows are kept.
    fn drop_columns(&mut self, rows: usize) {
        for place in (0..self.slots.len()).rev() {
            let spoilt = self.problems[place].rows.len();
            let heading = &self.slots[place].heading;
            if heading.field.is_optional() && spoilt * MOST_UNUSABLE > rows {
                if let Some(used) = self.uses.iter_mut().find(|used| used.column == heading.text) {
                    used.quantity = None;
                    used.says = Some(format!("ignored: {spoilt} of {rows} values can't be used"));
                    used.guessed = true;
                }
                self.slots.remove(place);
                self.problems.remove(place);
            }
        }
    }
}

/// Marks the rows that are not among the unusable ones.
fn good(rows: usize, bad: &[u32]) -> Vec<bool> {
    let mut good = vec![true; rows];
    for row in bad {
        good[*row as usize] = false;
    }
    good
}

/// Keeps these rows, in this order, and removes labels that no row has any more.
pub(crate) fn keep_rows(columns: &mut Columns, lines: &mut Vec<u32>, keep: &[usize]) {
    columns.filter(keep);
    for labels in [&mut columns.sweep, &mut columns.specimen].into_iter().flatten() {
        *labels = labels.rows().iter().map(|row| labels.names()[*row as usize].as_str()).collect::<Labels>();
    }
    *lines = crate::columns::picked(lines, keep);
}

fn too_many(
    file: &str,
    problems: &[Problems],
    lines: &[u32],
    unusable: usize,
    unit: &str,
) -> MeasurementError {
    let mut kinds: Vec<(&str, usize, &[u32])> = problems
        .iter()
        .flat_map(|problems| problems.kinds.iter())
        .map(|(kind, (count, first))| (kind.as_str(), *count, first.as_slice()))
        .collect();
    kinds.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
    let mut reasons = String::new();
    for (kind, count, first) in kinds.iter().take(MOST_KINDS) {
        let shown: Vec<String> = first.iter().map(|row| lines[*row as usize].to_string()).collect();
        let more = if *count > first.len() { ", ..." } else { "" };
        let plural = if first.len() == 1 { "" } else { "s" };
        // Writing to a String can't fail.
        let _ = write!(reasons, "\n  {count} x {kind} ({unit}{plural} {}{more})", shown.join(", "));
    }
    if kinds.len() > MOST_KINDS {
        let _ = write!(reasons, "\n  and {} kinds more", kinds.len() - MOST_KINDS);
    }
    let is_ragged = kinds.first().is_some_and(|(kind, _, _)| kind.contains("more fields"));
    let hint =
        if is_ragged { "; if numbers have decimal commas, separate the columns with semicolons" } else { "" };
    let what = format!(
        "{unusable} of {} rows can't be used, more than a fifth:{reasons}\ncorrect these rows, or leave them out{hint}",
        lines.len()
    );
    MeasurementError::of_file(file, what)
}

fn index(row: usize) -> u32 {
    u32::try_from(row).unwrap_or(u32::MAX)
}

/// The index of the slot with a field.
pub(crate) fn place_of(slots: &[Slot], field: Field) -> Option<usize> {
    slots.iter().position(|slot| slot.heading.field == field)
}
