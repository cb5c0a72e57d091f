//! Errors of files and tables: one sentence each, with the place and the remedy.

use crate::csv_file::MOST_ROWS;
use crate::quote::quoted;
use crate::reading::ColumnUse;
use thiserror::Error;

/// Why a file or a table isn't a set of measurements.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeasurementError {
    /// Something in a file.
    #[error("{file}{}: {what}", line.map_or_else(String::new, |line| format!(":{line}")))]
    File {
        /// The file.
        file: String,
        /// The line (CSV) or row (Parquet), if there is one.
        line: Option<usize>,
        /// What is wrong, and what to write instead.
        what: String,
        /// The quantity whose column is at fault, if it is one.
        quantity: Option<&'static str>,
    },
    /// The file has more bytes than the limit.
    #[error(
        "{file}: has {bytes} bytes or more, but at most {limit} are read: split it, or keep fewer rows per second"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The user's statement about columns is invalid: what, where, and what to write instead.
    #[error("--columns (or `[data.columns]`): {0}")]
    ColumnMap(String),
    /// The request as a whole, or files that don't belong together.
    #[error("{0}")]
    Request(String),
    /// Several complaints at once.
    #[error("{} things keep the data from being read:{}", complaints.len() + more, bulleted(complaints, *more))]
    Several {
        /// The first of them.
        complaints: Vec<MeasurementError>,
        /// Number of complaints that are not listed.
        more: usize,
    },
    /// The columns can't be assigned.
    #[error("{complaint}")]
    NotAssigned {
        /// The complaint that prevents it.
        complaint: Box<MeasurementError>,
        /// The columns of the file, with the best guesses.
        columns: Vec<ColumnUse>,
    },
}

impl MeasurementError {
    /// Something wrong with a file as a whole.
    pub(crate) fn of_file(file: &str, what: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), line: None, what: what.into(), quantity: None }
    }

    /// Something wrong on a line, or in a row, of a file.
    pub(crate) fn at(file: &str, line: usize, what: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), line: Some(line), what: what.into(), quantity: None }
    }

    /// Something wrong with the column of a quantity, whose heading is on a line of a file.
    pub(crate) fn of_column(file: &str, line: usize, quantity: &'static str, what: String) -> Self {
        Self::File { file: file.to_owned(), line: Some(line), what, quantity: Some(quantity) }
    }

    /// The file has only comments and blank lines.
    pub(crate) fn empty(file: &str) -> Self {
        let cure = "write a header such as `pressure [bar],length [mm],force [N]` and one row per reading";
        Self::of_file(file, format!("is empty: {cure}"))
    }

    /// A header without rows.
    pub(crate) fn no_rows(file: &str) -> Self {
        Self::of_file(file, "has a header but no row: write one row per reading below the header")
    }

    /// The file has more rows than are read; `line` is the first excess one.
    pub(crate) fn too_many_rows(file: &str, line: usize) -> Self {
        Self::at(file, line, format!("there are more than {MOST_ROWS} rows: keep fewer rows per second"))
    }

    /// A header without separators.
    pub(crate) fn one_field(file: &str, line: usize, header: &str) -> Self {
        let what = format!(
            "the header `{}` is a single field: separate the names of the columns with commas, semicolons or tabs, and begin comments with `#` (known are {})",
            quoted(header),
            crate::heading::known()
        );
        Self::at(file, line, what)
    }

    /// The line (CSV) or row (Parquet) at fault, counted from 1, if there is one.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::File { line, .. } => *line,
            Self::Several { complaints, .. } => complaints.first().and_then(Self::line),
            Self::NotAssigned { complaint, .. } => complaint.line(),
            Self::TooLarge { .. } | Self::ColumnMap(_) | Self::Request(_) => None,
        }
    }

    /// The columns if they could not be assigned, so that a user can assign them.
    #[must_use]
    pub fn columns(&self) -> &[ColumnUse] {
        match self {
            Self::NotAssigned { columns, .. } => columns,
            _ => &[],
        }
    }

    /// Most complaints that are listed.
    const MOST_LISTED: usize = 20;

    /// Combines complaints, at least one, into an error.
    pub(crate) fn of(mut complaints: Vec<Self>) -> Self {
        let (mut all, mut columns) = (Vec::new(), Vec::new());
        let mut more = 0;
        for complaint in complaints.drain(..) {
            let complaint = match complaint {
                Self::NotAssigned { complaint, columns: its } => {
                    columns.extend(its);
                    *complaint
                }
                other => other,
            };
            match complaint {
                Self::Several { complaints, more: others } => {
                    all.extend(complaints);
                    more += others;
                }
                other => all.push(other),
            }
        }
        more += all.len().saturating_sub(Self::MOST_LISTED);
        all.truncate(Self::MOST_LISTED);
        let one =
            if all.len() == 1 && more == 0 { all.remove(0) } else { Self::Several { complaints: all, more } };
        if columns.is_empty() { one } else { Self::NotAssigned { complaint: Box::new(one), columns } }
    }

    /// Whether it already reports a problem with the column of a quantity.
    pub(crate) fn is_about(&self, names: &str) -> bool {
        match self {
            Self::File { quantity, .. } => quantity.is_some_and(|quantity| names.contains(quantity)),
            // The quantity of these errors isn't recorded, so no other complaint is added.
            Self::ColumnMap(_) => true,
            _ => false,
        }
    }
}

/// Complaints, each on a line of its own.
fn bulleted(complaints: &[MeasurementError], more: usize) -> String {
    let mut lines: Vec<String> = complaints.iter().map(|complaint| format!("\n  {complaint}")).collect();
    if more > 0 {
        lines.push(format!("\n  and {more} more"));
    }
    lines.concat()
}
