//! Errors of files and tables: one sentence each, with the place and the remedy.

use crate::cell_error::CellError;
use crate::reading::ColumnUse;
use crate::wording::{bulleted, of_unit, ragged_cure};
use bulge_muscles::units::UnitError;
use thiserror::Error;

/// Why a file or a table isn't a set of measurements.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeasurementError {
    /// No file is given.
    #[error(
        "no data file is given: name at least one file of CSV, Excel, MATLAB or Parquet, or `-` for standard input"
    )]
    NoFile,
    /// A file that can't be opened or read.
    #[error("{file}: can't be read ({why}): check the name and the permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// The message of the operating system.
        why: String,
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
    /// The file has more rows than the limit.
    #[error("{file}:{line}: there are more than {limit} rows: keep fewer rows per second")]
    TooManyRows {
        /// The file.
        file: String,
        /// The line of the first excess row.
        line: usize,
        /// The limit.
        limit: usize,
    },
    /// The line is too long.
    #[error(
        "{file}:{line}: the line has {bytes} bytes, but at most {limit} are read: put each row on a line of its own"
    )]
    LineTooLong {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// Its length.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// The file is of another kind.
    #[error("{file}: is {what}: {instead}")]
    OtherFormat {
        /// The file.
        file: String,
        /// Its kind.
        what: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// A NUL byte.
    #[error("{file}:{line}: holds a NUL byte: it is damaged or no text; export it again as CSV in UTF-8")]
    NulByte {
        /// The file.
        file: String,
        /// The line.
        line: usize,
    },
    /// A quote that isn't closed on its line.
    #[error("{file}:{line}: a quoted field is not closed on its line: close the quote, or remove it")]
    OpenQuote {
        /// The file.
        file: String,
        /// The line.
        line: usize,
    },
    /// The file has only comments and blank lines.
    #[error(
        "{file}: is empty: write a header such as `pressure [bar],length [mm],force [N]` and one row per reading"
    )]
    Empty {
        /// The file.
        file: String,
    },
    /// A header without rows.
    #[error("{file}: has a header but no row: write one row per reading below the header")]
    NoRows {
        /// The file.
        file: String,
    },
    /// A different header in the middle of the file.
    #[error(
        "{file}:{line}: another table begins here, with the columns {columns}: write it into a file of its own, and name both files"
    )]
    SecondTable {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// Its columns.
        columns: String,
    },
    /// A number in place of a column name.
    #[error(
        "{file}:{line}: `{text}` is a number where a column's name is needed: write a header first, such as `pressure [bar],length [mm],force [N]`, or say the columns by their numbers, such as `--columns \"time=1 [s],pressure=2 [bar],length=3 [mm],force=4 [N]\"`"
    )]
    NoHeader {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The number.
        text: String,
    },
    /// A header without separators.
    #[error(
        "{file}:{line}: the header `{text}` is a single field: separate the names of the columns with commas, semicolons or tabs, and begin comments with `#` (known are {known})"
    )]
    OneField {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// What is written.
        text: String,
        /// All headings.
        known: String,
    },
    /// The unit is missing, unknown or of another dimension.
    #[error(
        "{file}:{line}: column `{column}` {}; write the unit in brackets behind the name, such as `{example}`",
        of_unit(problem)
    )]
    Unit {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The heading.
        column: String,
        /// The problem with the unit.
        problem: Box<UnitError>,
        /// A correct heading.
        example: &'static str,
    },
    /// Units that neither the heading nor the readings show.
    #[error(
        "{file}:{line}: {what}: write the unit in brackets behind the name, such as `{example}`, or say it, such as `--columns \"{instead}\"`"
    )]
    OpenUnit {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The columns, and what they may be.
        what: String,
        /// A correct heading.
        example: &'static str,
        /// What to write.
        instead: String,
    },
    /// Two columns have the same name.
    #[error(
        "{file}:{line}: the columns {first} and {second} are both `{name}`: leave one out, or say which it is, such as `--columns \"{name}={first}\"`"
    )]
    TwiceTheColumn {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The name.
        name: &'static str,
        /// Number of the first column, from 1.
        first: usize,
        /// Number of the second column.
        second: usize,
    },
    /// Contraction and length contradict each other.
    #[error(
        "{file}: `contraction` and `length` are both given, and do not follow from one another: leave out the one that was computed (most rigs measure `length`)"
    )]
    BothMotions {
        /// The file.
        file: String,
    },
    /// A mandatory column is missing.
    #[error(
        "{file}:{line}: there is no column `{name}`: add one, such as `{example}`, or say which it is, such as `--columns \"{field}=NAME [UNIT]\"` (found: {found})"
    )]
    MissingColumn {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The name.
        name: &'static str,
        /// A correct heading.
        example: &'static str,
        /// The quantity.
        field: &'static str,
        /// The existing headings.
        found: String,
    },
    /// Several columns may hold one quantity.
    #[error("{file}:{line}: which column is `{name}`: {candidates}? write which, such as `{instead}`")]
    Ambiguous {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The quantity.
        name: &'static str,
        /// The columns.
        candidates: String,
        /// What to write.
        instead: String,
    },
    /// The user's statement about columns is invalid.
    #[error("--columns (or `[data.columns]`): {what}")]
    ColumnMap {
        /// What, where, and what to write instead.
        what: String,
    },
    /// A displacement whose zero isn't known.
    #[error(
        "{file}: the column `{column}` is a displacement, whose zero is the length of the unpressurised muscle: name the muscle, or write `length` or `contraction` instead"
    )]
    NoRestLength {
        /// The file.
        file: String,
        /// The heading.
        column: String,
    },
    /// Too many unusable rows.
    #[error(
        "{file}: {unusable} of {rows} rows can't be used, more than a fifth:{reasons}\ncorrect these rows, or leave them out{hint}"
    )]
    TooManyUnusable {
        /// The file.
        file: String,
        /// Number of unusable rows.
        unusable: usize,
        /// Number of all rows.
        rows: usize,
        /// Their reasons, counted, with the first lines; one per line.
        reasons: String,
        /// The possible cause.
        hint: &'static str,
    },
    /// The order of the times can't be that of the test.
    #[error(
        "{file}:{line}: the time goes back at {backward} of {rows} rows, and sorted by time the readings jump ({why}): sort the rows as they were measured, number the runs in a column `sweep`, or leave out the column `time` if the rows are a static map"
    )]
    TimeShuffled {
        /// The file.
        file: String,
        /// The first line at which the time goes back.
        line: usize,
        /// Number of such rows.
        backward: usize,
        /// Number of all rows.
        rows: usize,
        /// The quantity that jumps.
        why: String,
    },
    /// Several complaints at once.
    #[error("{} things keep the data from being read:{}", complaints.len() + more, bulleted(complaints, *more))]
    Several {
        /// The first of them.
        complaints: Vec<MeasurementError>,
        /// Number of complaints that are not listed.
        more: usize,
    },
    /// The list of lines is invalid.
    #[error("lines `{range}`: {why}; write such as `12, 33-40`")]
    Lines {
        /// The part of the list.
        range: String,
        /// The problem with it.
        why: String,
    },
    /// The columns can't be assigned.
    #[error("{complaint}")]
    NotAssigned {
        /// The complaint that prevents it.
        complaint: Box<MeasurementError>,
        /// The columns of the file, with the best guesses.
        columns: Vec<ColumnUse>,
    },
    /// A row has more or fewer fields than the header.
    #[error("{file}:{line}: the row has {found} field{}, the header has {expected}: {}", if *found == 1 { "" } else { "s" }, ragged_cure(*found, *expected))]
    Ragged {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// Number of its fields.
        found: usize,
        /// Number of fields of the header.
        expected: usize,
    },
    /// A field doesn't fit its column.
    #[error("{file}:{line}: column `{column}`: {problem}")]
    Cell {
        /// The file.
        file: String,
        /// The line (CSV) or row (Parquet).
        line: usize,
        /// The heading.
        column: String,
        /// The problem.
        problem: CellError,
    },
    /// The workbook can't be read.
    #[error(
        "{file}: can't be read as an Excel workbook ({why}): unpack it if it is another archive, save it as .xlsx again, or export the sheet as CSV"
    )]
    Workbook {
        /// The file.
        file: String,
        /// The message of the reader.
        why: String,
    },
    /// The workbook doesn't have this sheet.
    #[error("{file}: there is no sheet `{sheet}`: there are {sheets}")]
    NoSheet {
        /// The file.
        file: String,
        /// The requested sheet.
        sheet: String,
        /// The existing sheets.
        sheets: String,
    },
    /// The MATLAB file is truncated or damaged.
    #[error("{file}: is a damaged or cut-off file of MATLAB: write it again with `save('x.mat','-v7')`")]
    Matlab {
        /// The file.
        file: String,
    },
    /// The MATLAB file has no columns.
    #[error(
        "{file}: holds no numeric vectors: store each column as a variable or as a field of a structure (a `table` is none: `writetable` writes it as CSV)"
    )]
    NoVectors {
        /// The file.
        file: String,
    },
    /// The file claims to be Parquet, but can't be read as such.
    #[error("{file}: can't be read as Parquet ({why}): {instead}")]
    Parquet {
        /// The file.
        file: String,
        /// The message of the reader.
        why: String,
        /// What to do.
        instead: &'static str,
    },
    /// A Parquet column whose type is neither numeric nor text.
    #[error(
        "{file}: column `{column}` has the Parquet type {found}: store it as double, float, int64, int32 or string"
    )]
    ParquetType {
        /// The file.
        file: String,
        /// The heading.
        column: String,
        /// Its type.
        found: String,
    },
    /// A column is missing in one of the files of an analysis.
    #[error(
        "{without} has no column `{name}`, {with} has: files of one analysis need the same columns; add it there, leave it out here, or analyse them separately"
    )]
    ColumnsDiffer {
        /// The column.
        name: &'static str,
        /// A file that has it.
        with: String,
        /// A file that doesn't.
        without: String,
    },
    /// Two files have the same content.
    #[error("{first} and {second} have the same content: name each file once")]
    SameContent {
        /// The first file.
        first: String,
        /// The second file.
        second: String,
    },
    /// Columns of a program differ in length.
    #[error("column `{name}` has {found} values, `pressure` has {expected}: give one value per row")]
    LengthsDiffer {
        /// The column.
        name: &'static str,
        /// Its length.
        found: usize,
        /// The number of rows.
        expected: usize,
    },
}

impl MeasurementError {
    /// The line (CSV) or row (Parquet) at fault, counted from 1, if there is one.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::TooManyRows { line, .. }
            | Self::LineTooLong { line, .. }
            | Self::NulByte { line, .. }
            | Self::OpenQuote { line, .. }
            | Self::NoHeader { line, .. }
            | Self::SecondTable { line, .. }
            | Self::OneField { line, .. }
            | Self::Unit { line, .. }
            | Self::OpenUnit { line, .. }
            | Self::TwiceTheColumn { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::Ragged { line, .. }
            | Self::Ambiguous { line, .. }
            | Self::TimeShuffled { line, .. }
            | Self::Cell { line, .. } => Some(*line),
            Self::Several { complaints, .. } => complaints.first().and_then(Self::line),
            Self::NotAssigned { complaint, .. } => complaint.line(),
            _ => None,
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
    pub(crate) fn is_about(&self, quantity: &str) -> bool {
        match self {
            Self::Ambiguous { name, .. } | Self::TwiceTheColumn { name, .. } => quantity.contains(*name),
            Self::Unit { example, .. } => {
                example.split(' ').next().is_some_and(|name| quantity.contains(name))
            }
            // The quantity of these errors isn't recorded, so no other complaint is added.
            Self::ColumnMap { .. } => true,
            _ => false,
        }
    }
}
