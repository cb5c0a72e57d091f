//! How a file was read: what its columns were taken for, and which rows were set apart.

use crate::column_map::ColumnMap;
use serde::Serialize;

/// What a reader of files may be told.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Which column is which quantity, where the user says so.
    pub columns: ColumnMap,
    /// Length of the unpressurised muscle \[m\], > 0: a displacement is measured from it.
    pub l0_m: Option<f64>,
    /// Force over gauge pressure \[m^2\] of the muscle as stated, at contractions in ascending order: which unit a pressure has whose heading says
    /// none. Empty where it isn't known.
    pub pull: Vec<[f64; 2]>,
    /// Whether a file may have no column of force: its forces are then 0, and [`crate::Data::has_force`] says so. Without forces sweeps are told by time,
    /// labels and held pressures alone.
    pub force_may_lack: bool,
}

/// What a column of a file was taken for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnUse {
    /// The file.
    pub file: String,
    /// The heading as it is written.
    pub column: String,
    /// The quantity; none: the column isn't read.
    pub quantity: Option<String>,
    /// The unit that it was read in.
    pub unit: Option<String>,
    /// The first values as they are written, at most three.
    pub first: Vec<String>,
    /// Whether this was guessed: neither written as `name [unit]` nor stated by the user.
    pub guessed: bool,
    /// What else is to be said of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub says: Option<String>,
}

impl ColumnUse {
    /// Says more of it.
    pub(crate) fn add(&mut self, says: &str) {
        let before = self.says.take().map_or_else(String::new, |before| format!("{before}; "));
        self.says = Some(before + says);
    }
}

/// A row that can't be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SetApart {
    /// The file.
    pub file: String,
    /// Its line there, or the row of a file that has no lines; counted from 1.
    pub row: usize,
    /// Why.
    pub reason: String,
}

/// How files were read, for people and programs.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Reading {
    /// What each column was taken for.
    pub columns: Vec<ColumnUse>,
    /// Rows that can't be used, with their reasons: the first [`Reading::MOST_LISTED`].
    pub set_apart: Vec<SetApart>,
    /// How many there are in all.
    pub set_apart_rows: usize,
    /// What else was understood of the files: their encoding, metadata before the table, the order of their rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl Reading {
    /// Rows that are listed at most.
    pub const MOST_LISTED: usize = 1000;

    /// Adds a row that can't be used.
    pub fn add(&mut self, file: &str, row: usize, reason: String) {
        self.set_apart_rows += 1;
        if self.set_apart.len() < Self::MOST_LISTED {
            self.set_apart.push(SetApart { file: file.to_owned(), row, reason });
        }
    }

    /// Adds what was read from another file.
    pub(crate) fn append(&mut self, other: Self) {
        self.columns.extend(other.columns);
        let room = Self::MOST_LISTED.saturating_sub(self.set_apart.len());
        self.set_apart.extend(other.set_apart.into_iter().take(room));
        self.set_apart_rows += other.set_apart_rows;
        self.notes.extend(other.notes);
    }

    /// Whether anything about the columns was guessed.
    #[must_use]
    pub fn is_guessed(&self) -> bool {
        self.columns.iter().any(|column| column.guessed)
    }
}
