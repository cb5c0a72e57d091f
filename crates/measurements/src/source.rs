//! Files: their format, their digest, and their contents.

use crate::cell;
use crate::cell_error::CellError;
use crate::columns::Columns;
use crate::csv_file;
use crate::data::Data;
use crate::error::MeasurementError;
use crate::matlab;
use crate::parquet_file;
use crate::reading::{ReadOptions, Reading};
use crate::spreadsheet;
use crate::table::Table;
use bulge_muscles::memory;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Most bytes of a file.
const MOST_BYTES: u64 = 2 << 30;
/// Bytes that are read at once if fewer are expected.
const LEAST_READ: u64 = 1 << 16;
/// The first bytes of every Parquet file.
const PARQUET_MAGIC: &[u8] = b"PAR1";

/// The first bytes of other files in which people keep measurements, with their kind and the remedy.
const FOREIGN: [(&[u8], &str, &str); 12] = [
    (b"\xd0\xcf\x11\xe0", "a spreadsheet of an old kind", "save it as .xlsx, or export the sheet as CSV"),
    (b"\x1f\x8b", "compressed by gzip", "unpack it first"),
    (b"\x28\xb5\x2f\xfd", "compressed by Zstandard", "unpack it first"),
    (
        b"\x89HDF",
        "an HDF5 file, perhaps of MATLAB 7.3",
        "in MATLAB, load it and write `save('x.mat','-v7')`; elsewhere write CSV or Parquet",
    ),
    (b"ARROW1", "an Arrow (Feather) file", "write Parquet or CSV"),
    (b"<html", MARKUP, AS_TABLE),
    (b"<HTML", MARKUP, AS_TABLE),
    (b"<!DOCTYPE", MARKUP, AS_TABLE),
    (b"<?xml", MARKUP, AS_TABLE),
    (b"[{", "JSON", AS_TABLE),
    (b"{", "JSON", AS_TABLE),
    (b"TDSm", "a TDMS file of LabVIEW", "export CSV"),
];
/// Kind of pages that claim to be tables.
const MARKUP: &str = "a page of HTML or XML, whatever its name says";
const AS_TABLE: &str = "open it in a spreadsheet or a script, and save it as .xlsx or CSV";
/// Separator between a workbook's name and that of one of its sheets.
const SHEET: char = '#';
/// The name of standard input.
const STDIN: &str = "-";

/// A file of measurements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SourceFile {
    /// Its name, as given.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Its rows in this data set.
    pub rows: usize,
}

/// A file as read.
pub(crate) struct Source {
    pub(crate) file: SourceFile,
    pub(crate) table: Table,
}

impl Source {
    /// Reads a file of the kind that its first bytes show, otherwise as text. `book.xlsx#name` is one sheet
    /// of a workbook.
    pub(crate) fn read(name: &str, path: &Path, options: &ReadOptions) -> Result<Self, MeasurementError> {
        let is_stdin = path == Path::new(STDIN);
        let (path, sheet) = sheet_of(path);
        let bytes =
            if is_stdin { read_all(name, std::io::stdin().lock(), 0) } else { read_file(name, path) }?;
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let is_parquet = bytes.starts_with(PARQUET_MAGIC);
        if !is_parquet && ["parquet", "pq"].contains(&extension.as_str()) {
            let cure = "if it is CSV, name it `.csv`; else write it again";
            return Err(parquet_file::no_parquet(name, "it does not begin as Parquet does", cure));
        }
        if !is_parquet {
            return Self::sheet(name, &bytes, sheet, options);
        }
        let sha256 = fingerprint(&bytes);
        Ok(Self::new(name, sha256, parquet_file::read(name, bytes::Bytes::from(bytes), options)?))
    }

    /// The name of a path in messages.
    pub(crate) fn name_of(path: &Path) -> String {
        if path == Path::new(STDIN) { "standard input".to_owned() } else { path.display().to_string() }
    }

    /// Reads bytes in memory: a workbook, MATLAB, otherwise text.
    pub(crate) fn bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, MeasurementError> {
        Self::sheet(name, bytes, None, options)
    }

    /// Reads bytes in memory; of a workbook, the named sheet.
    fn sheet(
        name: &str,
        bytes: &[u8],
        sheet: Option<&str>,
        options: &ReadOptions,
    ) -> Result<Self, MeasurementError> {
        let text = bytes.trim_ascii_start();
        let mut foreign = FOREIGN.iter();
        let table = if spreadsheet::is_one(bytes) {
            spreadsheet::read(name, bytes, sheet, options)?
        } else if let Some((_, what, instead)) =
            foreign.find(|(start, _, _)| bytes.starts_with(start) || text.starts_with(start))
        {
            return Err(MeasurementError::of_file(name, format!("is {what}: {instead}")));
        } else if matlab::is_one(bytes) {
            matlab::read(name, bytes, options)?
        } else {
            csv_file::read(name, bytes, options)?
        };
        let sha256 = match sheet {
            Some(sheet) => fingerprint(&[bytes, sheet.as_bytes()].concat()),
            None => fingerprint(bytes),
        };
        Ok(Self::new(name, sha256, table))
    }

    /// Checks the columns of a program.
    pub(crate) fn columns(columns: Columns) -> Result<Self, MeasurementError> {
        let name = "columns";
        checked(name, &columns)?;
        let mut hash = Sha256::new();
        for (name, values) in columns.numbers() {
            hash.update(name);
            for value in values {
                hash.update(value.to_le_bytes());
            }
        }
        for labels in [&columns.sweep, &columns.specimen].into_iter().flatten() {
            labels.rows().iter().for_each(|row| hash.update(labels.names()[*row as usize].as_bytes()));
        }
        columns.cycle.iter().flatten().for_each(|cycle| hash.update(cycle.to_le_bytes()));
        columns.direction.iter().flatten().for_each(|direction| hash.update(direction.to_le_bytes()));
        let last = u32::try_from(columns.len()).unwrap_or(u32::MAX);
        let table = Table {
            columns,
            lines: (1..=last).collect(),
            reading: Reading::default(),
            displaced_from_m: None,
        };
        Ok(Self::new(name, hexadecimal(&hash.finalize()), table))
    }

    fn new(name: &str, sha256: String, table: Table) -> Self {
        let file = SourceFile { name: name.to_owned(), sha256, rows: table.lines.len() };
        Self { file, table }
    }
}

impl Data {
    /// SHA-256 of the file in hexadecimal; for several files, that of their concatenated digests.
    #[must_use]
    pub fn sha256(&self) -> String {
        match self.files() {
            [file] => file.sha256.clone(),
            files => {
                fingerprint(files.iter().map(|file| file.sha256.as_str()).collect::<String>().as_bytes())
            }
        }
    }
}

/// The file and the sheet of `book.xlsx#name`, unless a file has this name.
fn sheet_of(path: &Path) -> (&Path, Option<&str>) {
    let parts = path.to_str().filter(|_| !path.exists()).and_then(|name| name.rsplit_once(SHEET));
    match parts {
        Some((file, sheet)) if Path::new(file).is_file() && !sheet.is_empty() => {
            (Path::new(file), Some(sheet))
        }
        _ => (path, None),
    }
}

fn unreadable(file: &str, why: impl std::fmt::Display) -> MeasurementError {
    MeasurementError::of_file(file, format!("can't be read ({why}): check the name and the permissions"))
}

fn too_large(file: &str, bytes: u64) -> MeasurementError {
    MeasurementError::TooLarge { file: file.to_owned(), bytes, limit: MOST_BYTES }
}

fn read_file(name: &str, path: &Path) -> Result<Vec<u8>, MeasurementError> {
    let file = File::open(path).map_err(|error| unreadable(name, error))?;
    let metadata = file.metadata().map_err(|error| unreadable(name, error))?;
    if metadata.is_dir() {
        return Err(unreadable(name, "it is a folder"));
    }
    if metadata.len() > MOST_BYTES {
        return Err(too_large(name, metadata.len()));
    }
    read_all(name, file, metadata.len())
}

/// Reads everything: first as many bytes as are expected, then as many again, and so on. Memory is taken for no
/// more than that.
pub(crate) fn read_all(
    name: &str,
    mut source: impl Read,
    expected: u64,
) -> Result<Vec<u8>, MeasurementError> {
    let mut bytes = Vec::new();
    // The byte beyond the expected ones would show that there are more.
    let mut more = (expected + 1).max(LEAST_READ);
    loop {
        has_room(name, more)?;
        bytes.reserve_exact(usize::try_from(more).unwrap_or(usize::MAX));
        let read = source.by_ref().take(more).read_to_end(&mut bytes);
        if (read.map_err(|error| unreadable(name, error))? as u64) < more {
            return Ok(bytes);
        }
        more = bytes.len() as u64;
        if more > MOST_BYTES {
            return Err(too_large(name, more));
        }
    }
}

/// Refuses what needs more memory than there is, before it is taken: an allocation that fails would end the
/// process.
pub(crate) fn has_room(file: &str, bytes: u64) -> Result<(), MeasurementError> {
    memory::check(bytes).map_err(|shortage| {
        let cure = "split the file, keep fewer rows per second, or allow more memory";
        MeasurementError::of_file(file, format!("{shortage}: {cure}"))
    })
}

/// Checks equal lengths, finite numbers, valid directions.
fn checked(file: &str, columns: &Columns) -> Result<(), MeasurementError> {
    let expected = columns.len();
    let lengths = columns.numbers().map(|(name, values)| (name, values.len())).chain(columns.marks());
    for (name, found) in lengths {
        if found != expected {
            let what = format!(
                "column `{name}` has {found} values, `pressure` has {expected}: give one value per row"
            );
            return Err(MeasurementError::Request(what));
        }
    }
    if expected == 0 {
        return Err(MeasurementError::no_rows(file));
    }
    if expected > csv_file::MOST_ROWS {
        return Err(MeasurementError::too_many_rows(file, csv_file::MOST_ROWS + 1));
    }
    let at = |row: usize, column: &str, problem: &CellError, cure: &str| {
        let what = format!("column `{column}`: `{}` is {}{cure}", problem.text, problem.kind);
        MeasurementError::at(file, row + 1, what)
    };
    for (name, values) in columns.numbers() {
        for (row, value) in values.iter().enumerate() {
            let cure = if value.is_finite() {
                " (1e30 in SI units): check the number and its unit"
            } else {
                ": leave out the row, or write what was read"
            };
            cell::measurable(*value, || value.to_string())
                .map_err(|problem| at(row, name, &problem, cure))?;
        }
    }
    let directions = columns.direction.iter().flatten();
    if let Some((row, value)) = directions.enumerate().find(|(_, value)| value.unsigned_abs() > 1) {
        let cure = ": write `shortening`, `contracting`, `up` or `+1`; `lengthening`, `extending`, `down` or `-1`; `rest` or `0`";
        return Err(at(row, "direction", &CellError::not_a_direction(value.to_string()), cure));
    }
    Ok(())
}

/// SHA-256 in hexadecimal.
pub(crate) fn fingerprint(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(digest: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    digest
        .iter()
        .flat_map(|byte| [byte >> 4, byte & 15])
        .map(|digit| char::from(DIGITS[usize::from(digit)]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Trace;

    #[test]
    fn fingerprints_are_those_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(fingerprint(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn columns_of_a_program_are_checked() {
        let columns = || Columns::new(vec![1e5; 2], Trace::Length(vec![0.1; 2]), vec![1.0; 2]);
        let says = |columns| Source::columns(columns).err().unwrap().to_string();
        let mut short = columns();
        short.force_n.pop();
        assert!(says(short).contains("`force` has 1 values, `pressure` has 2"));
        let mut infinite = columns();
        infinite.time_s = Some(vec![0.0, f64::NAN]);
        assert!(says(infinite).contains("columns:2: column `time`: `NaN`"));
        let mut odd = columns();
        odd.direction = Some(vec![0, -3]);
        assert!(says(odd).contains("`-3` is not a direction"));
        let none = Columns::new(Vec::new(), Trace::Length(Vec::new()), Vec::new());
        assert!(says(none).contains("no row"));
    }
}
