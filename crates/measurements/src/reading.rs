//! How a file was read: what its columns were taken for, and which rows were set apart.

use crate::column_map::ColumnMap;
use serde::Serialize;

/// Options for reading files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Assignment of columns by the user.
    pub columns: ColumnMap,
    /// Length of the unpressurised muscle \[m\], > 0, from which displacements are measured.
    pub l0_m: Option<f64>,
    /// Force over gauge pressure of the muscle as stated \[m^2\], at contractions in ascending order. It
    /// decides the unit of a pressure whose heading has none. Empty if unknown.
    pub pull: Vec<[f64; 2]>,
    /// Whether a file may lack a force column: its forces are then 0, and [`crate::Data::has_force`] is
    /// false. Without forces, sweeps are found from time, labels and held pressures alone.
    pub force_may_lack: bool,
}

/// What a column of a file was taken for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnUse {
    /// The file.
    pub file: String,
    /// The heading as written.
    pub column: String,
    /// The quantity; none if the column isn't read.
    pub quantity: Option<String>,
    /// The unit in which it was read.
    pub unit: Option<String>,
    /// The first values as written, at most three.
    pub first: Vec<String>,
    /// Whether it was guessed, that is, neither written as `name [unit]` nor stated by the user.
    pub guessed: bool,
    /// Further remarks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub says: Option<String>,
}

impl ColumnUse {
    /// Appends a remark.
    pub(crate) fn add(&mut self, says: &str) {
        let before = self.says.take().map_or_else(String::new, |before| format!("{before}; "));
        self.says = Some(before + says);
    }
}

/// An unusable row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SetApart {
    /// The file.
    pub file: String,
    /// Its line, or its row in a file without lines, counted from 1.
    pub row: usize,
    /// The reason.
    pub reason: String,
}

/// How files were read.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Reading {
    /// What each column was taken for.
    pub columns: Vec<ColumnUse>,
    /// Unusable rows with their reasons: the first [`Reading::MOST_LISTED`].
    pub set_apart: Vec<SetApart>,
    /// Number of all unusable rows.
    pub set_apart_rows: usize,
    /// Further observations: the encoding, metadata before the table, the order of the rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl Reading {
    /// Most rows that are listed.
    pub const MOST_LISTED: usize = 1000;

    /// Adds an unusable row.
    pub fn add(&mut self, file: &str, row: usize, reason: String) {
        self.set_apart_rows += 1;
        if self.set_apart.len() < Self::MOST_LISTED {
            self.set_apart.push(SetApart { file: file.to_owned(), row, reason });
        }
    }

    /// Appends the report of another file.
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
