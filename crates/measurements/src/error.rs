//! Why a file or a table is no set of measurements: one sentence each, with the place and the cure.

use bulge_muscles::units::UnitError;
use thiserror::Error;

/// Why a file or a table is no set of measurements.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeasurementError {
    /// No file is named.
    #[error("no data file is given: name at least one CSV or Parquet file")]
    NoFile,
    /// A file that can't be opened or read.
    #[error("{file}: can't be read ({why}): check the name and the permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// What the operating system says.
        why: String,
    },
    /// More bytes than are read.
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
    /// More rows than are read.
    #[error("{file}:{line}: there are more than {limit} rows: keep fewer rows per second")]
    TooManyRows {
        /// The file.
        file: String,
        /// The line of the first row too many.
        line: usize,
        /// The limit.
        limit: usize,
    },
    /// A line that no table has.
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
    /// Text in another encoding.
    #[error(
        "{file}:{line}: the byte 0x{byte:02X} is not UTF-8: save the file as UTF-8 (a spreadsheet calls it \"CSV UTF-8\"), \
         or write units without special characters, such as degC and um"
    )]
    NotUtf8 {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The first byte that isn't.
        byte: u8,
    },
    /// Text with two or four bytes per character.
    #[error(
        "{file}:1: the text is in UTF-16 or UTF-32: save the file as UTF-8 (a spreadsheet calls it \"CSV UTF-8\")"
    )]
    Utf16 {
        /// The file.
        file: String,
    },
    /// A file of another kind.
    #[error("{file}: is {what}: {instead}")]
    OtherFormat {
        /// The file.
        file: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// A zero byte.
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
    /// Nothing but comments and blank lines.
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
    /// Numbers where names should be.
    #[error(
        "{file}:{line}: `{text}` is a number where a column's name is needed: write a header first, such as `pressure [bar],length [mm],force [N]`"
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
    /// A column without a name, such as the row numbers of a data frame.
    #[error(
        "{file}:{line}: column {place} has no name: name it, or leave it out (a data frame's row numbers by `index=False`); known are {known}"
    )]
    NoName {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// Which column, counted from 1.
        place: usize,
        /// All headings.
        known: String,
    },
    /// A name that isn't known.
    #[error("{file}:{line}: column {place} is called `{name}`, which is not known: {}known are {known}", meant(nearest.as_ref()))]
    UnknownColumn {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// Which column, counted from 1.
        place: usize,
        /// What is written.
        name: String,
        /// The heading that was probably meant.
        nearest: Option<String>,
        /// All headings.
        known: String,
    },
    /// A unit that is missing, unknown or of another dimension.
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
        /// What is wrong with the unit.
        problem: Box<UnitError>,
        /// A heading as it should be.
        example: &'static str,
    },
    /// A unit for labels.
    #[error("{file}:{line}: column `{column}` holds labels or counts, which have no unit: write `{name}`")]
    NeedlessUnit {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The heading.
        column: String,
        /// The heading as it should be.
        name: &'static str,
    },
    /// One name twice.
    #[error("{file}:{line}: the columns {first} and {second} are both `{name}`: leave one out")]
    TwiceTheColumn {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The name.
        name: &'static str,
        /// The first, counted from 1.
        first: usize,
        /// The second.
        second: usize,
    },
    /// Contraction and length.
    #[error(
        "{file}:{line}: both `contraction` and `length` are given: leave out the one that was computed from the other (most rigs measure `length`)"
    )]
    BothMotions {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
    },
    /// A column that every data set needs.
    #[error("{file}:{line}: there is no column `{name}`: add one, such as `{example}` (found: {found})")]
    MissingColumn {
        /// The file.
        file: String,
        /// The line of the header.
        line: usize,
        /// The name.
        name: &'static str,
        /// A heading as it should be.
        example: &'static str,
        /// The headings that are there.
        found: String,
    },
    /// A row with more or fewer fields than the header.
    #[error("{file}:{line}: the row has {found} field{}, the header has {expected}: {}", if *found == 1 { "" } else { "s" }, ragged_cure(*found, *expected))]
    Ragged {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// Its fields.
        found: usize,
        /// Those of the header.
        expected: usize,
    },
    /// A field that isn't what its column holds.
    #[error("{file}:{line}: column `{column}`: {problem}")]
    Cell {
        /// The file.
        file: String,
        /// The line (CSV) or row (Parquet).
        line: usize,
        /// The heading.
        column: String,
        /// What is wrong.
        problem: CellError,
    },
    /// A file that claims to be Parquet and can't be read as such.
    #[error("{file}: can't be read as Parquet ({why}): {instead}")]
    Parquet {
        /// The file.
        file: String,
        /// What the reader says.
        why: String,
        /// What to do.
        instead: &'static str,
    },
    /// A Parquet column of a type that is no number and no text.
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
    /// A column in one file and not in another of the same analysis.
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
    /// The same content twice.
    #[error("{first} and {second} have the same content: name each file once")]
    SameContent {
        /// A file.
        first: String,
        /// Another.
        second: String,
    },
    /// Columns of a program that differ in length.
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
    /// The line (CSV) or row (Parquet) at fault, counted from 1, where there is one.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::TooManyRows { line, .. }
            | Self::LineTooLong { line, .. }
            | Self::NotUtf8 { line, .. }
            | Self::NulByte { line, .. }
            | Self::OpenQuote { line, .. }
            | Self::NoHeader { line, .. }
            | Self::OneField { line, .. }
            | Self::NoName { line, .. }
            | Self::UnknownColumn { line, .. }
            | Self::Unit { line, .. }
            | Self::NeedlessUnit { line, .. }
            | Self::TwiceTheColumn { line, .. }
            | Self::BothMotions { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::Ragged { line, .. }
            | Self::Cell { line, .. } => Some(*line),
            Self::Utf16 { .. } => Some(1),
            _ => None,
        }
    }
}

/// Why a field isn't what its column holds.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CellError {
    /// Nothing there.
    #[error("the field is empty: write the value, or leave out the row (or the column, if it is optional)")]
    Empty,
    /// A comma within the number.
    #[error(
        "`{text}` has a decimal comma: write `{fixed}`, with a point, in all number columns{}",
        or_thousands(fixed)
    )]
    DecimalComma {
        /// What is written.
        text: String,
        /// The same with a point.
        fixed: String,
    },
    /// Separators between thousands, a typographic minus, the D of Fortran.
    #[error("`{text}` is not spelt as numbers are read: write `{fixed}`")]
    Spelling {
        /// What is written.
        text: String,
        /// The same as it is read.
        fixed: String,
    },
    /// A number and a unit.
    #[error("`{text}` has a unit in the field: write {}, in the unit of the header", alone(fixed.as_ref()))]
    UnitInside {
        /// What is written.
        text: String,
        /// The number in the unit of the header, if the unit is known.
        fixed: Option<String>,
    },
    /// A time of day.
    #[error("`{text}` is a time of day: write seconds since the start of the test, such as `12.5`")]
    Clock {
        /// What is written.
        text: String,
    },
    /// A comment behind a field.
    #[error("`{text}` has a comment behind it: put the comment on a line of its own that begins with `#`")]
    Comment {
        /// What is written.
        text: String,
    },
    /// Bytes that are no text.
    #[error("the text is not UTF-8: store it as UTF-8")]
    NotUtf8,
    /// Text.
    #[error("`{text}` is not a number: write one such as `12.5` or `1.25e1`, or leave out the row")]
    NotANumber {
        /// What is written.
        text: String,
    },
    /// Infinite, not a number, or beyond what a double holds.
    #[error("`{text}` is not a finite number: leave out the row, or write what was read")]
    NotFinite {
        /// What is written.
        text: String,
    },
    /// Beyond anything that is measured.
    #[error(
        "`{text}` is larger than anything that is measured (1e30 in SI units): check the number and its unit"
    )]
    TooLarge {
        /// What is written.
        text: String,
    },
    /// No whole number.
    #[error("`{text}` is not a whole number: write a count such as `3`")]
    NotWhole {
        /// What is written.
        text: String,
    },
    /// No direction.
    #[error(
        "`{text}` is not a direction: write `shortening`, `contracting`, `up` or `+1`; `lengthening`, `extending`, `down` or `-1`; `rest` or `0`"
    )]
    NotADirection {
        /// What is written.
        text: String,
    },
}

fn meant(nearest: Option<&String>) -> String {
    nearest.map_or_else(String::new, |heading| format!("write `{heading}` if that is meant; "))
}

/// What is wrong with the unit of a heading, after "column `..`".
fn of_unit(problem: &UnitError) -> String {
    let symbols = |units: &[(&'static str, f64)]| {
        let named: Vec<_> =
            units.iter().map(|(symbol, _)| *symbol).filter(|symbol| !symbol.is_empty()).collect();
        named.join(", ")
    };
    match problem {
        UnitError::NoUnit { known, .. } => format!("has no unit (known: {})", symbols(known)),
        UnitError::UnknownUnit { unit, suggestion, known, .. } => {
            let question =
                suggestion.map_or_else(String::new, |symbol| format!(": did you mean `{symbol}`?"));
            format!("has the unknown unit `{unit}`{question} (known: {})", symbols(known))
        }
        UnitError::OtherDimension { found, quantity, .. } => {
            format!("has a unit of {found} where one of {quantity} is needed")
        }
        other => format!("has a unit that can't be read ({other})"),
    }
}

/// "1,234" may be either.
fn or_thousands(fixed: &str) -> String {
    let decimals = fixed.split_once('.').map_or("", |(_, decimals)| decimals);
    if decimals.len() == 3 && decimals.bytes().all(|byte| byte.is_ascii_digit()) {
        format!(" (or `{}` if it separates thousands)", fixed.replace('.', ""))
    } else {
        String::new()
    }
}

fn alone(fixed: Option<&String>) -> String {
    fixed.map_or_else(|| "the number alone".to_owned(), |fixed| format!("`{fixed}`, the number alone"))
}

fn ragged_cure(found: usize, expected: usize) -> &'static str {
    if found >= 2 * expected - 1 && expected > 1 {
        "if its numbers have decimal commas, write decimal points; else remove the surplus separators"
    } else if found > expected {
        "remove the surplus separators, or quote a text that holds one"
    } else {
        "write every field of the row, or remove the row"
    }
}
