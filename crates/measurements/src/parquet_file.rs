//! Parquet: the same columns and checks as in CSV; a column's name is its heading, such as `length [mm]`.

use crate::csv_file::{MOST_ROWS, Table};
use crate::error::{CellError, MeasurementError};
use crate::heading;
use crate::parquet_page::{CheckedPages, checked_place};
use crate::quote::quoted;
use crate::slot::{Slot, columns};
use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::{ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};
use std::sync::Arc;

/// Rows that are decoded at a time.
const BATCH: usize = 1 << 14;

/// Reads Parquet. `file` is its name, for messages.
pub(crate) fn read<R: ChunkReader + 'static>(file: &str, source: R) -> Result<Table, MeasurementError> {
    let refused = |error: &ParquetError| refused(file, error);
    let reader = SerializedFileReader::new(source).map_err(|error| refused(&error))?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let names: Vec<String> = schema.columns().iter().map(|column| column.path().string()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let headings = heading::read(file, 1, &names)?;
    for (column, heading) in schema.columns().iter().zip(&headings) {
        checked_type(file, column, &heading.text)?;
    }
    let mut slots: Vec<Slot> = headings.into_iter().map(|heading| Slot::new(heading, 0)).collect();
    let mut rows = vec![0; slots.len()];
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|error| refused(&error))?;
        for (i, (slot, rows)) in slots.iter_mut().zip(&mut rows).enumerate() {
            read_chunk(group.as_ref(), i, slot, rows).map_err(|problem| problem.at(file, *rows + 1, slot))?;
        }
    }
    let expected = rows.first().copied().unwrap_or(0);
    if let Some(found) = rows.iter().find(|rows| **rows != expected) {
        let why = format!("its columns have {expected} and {found} rows");
        return Err(MeasurementError::Parquet { file: file.to_owned(), why, instead: AGAIN });
    }
    if expected == 0 {
        return Err(MeasurementError::NoRows { file: file.to_owned() });
    }
    let last = u32::try_from(expected).unwrap_or(u32::MAX);
    Ok(Table { columns: columns(slots), lines: (1..=last).collect() })
}

/// What to do with a damaged file.
const AGAIN: &str = "write it again, or export CSV";

/// What the reader of the file says, with its cure.
fn refused(file: &str, error: &ParquetError) -> MeasurementError {
    let says = error.to_string();
    let says = says.strip_prefix("Parquet error: ").unwrap_or(&says);
    let (why, instead) = if let Some(codec) = says.strip_prefix("Disabled feature at compile time: ") {
        // The name of the reader's own feature.
        let codec = if codec == "flate2" { "gzip" } else { codec };
        (format!("it is compressed with {codec}"), "write it with Snappy compression or none, or export CSV")
    } else if says.contains("Corrupt footer") || says.starts_with("EOF") {
        ("it is cut off or damaged".to_owned(), AGAIN)
    } else if says.contains("encoding") {
        (says.to_owned(), "write it with plain or dictionary encoding, or export CSV")
    } else {
        (says.to_owned(), AGAIN)
    };
    MeasurementError::Parquet { file: file.to_owned(), why: quoted(&why), instead }
}

/// Whether integers are without sign.
fn is_unsigned(column: &ColumnDescriptor) -> bool {
    match column.logical_type_ref() {
        Some(LogicalType::Integer(integer)) => !integer.is_signed,
        Some(_) => false,
        None => matches!(column.converted_type(), ConvertedType::UINT_32 | ConvertedType::UINT_64),
    }
}

/// The rows of one column in one group.
fn read_chunk(
    group: &dyn RowGroupReader,
    column: usize,
    slot: &mut Slot,
    rows: &mut usize,
) -> Result<(), Problem> {
    fn chunk<T: DataType>(column: ColumnDescPtr, pages: CheckedPages) -> ColumnReaderImpl<T> {
        ColumnReaderImpl::new(column, Box::new(pages))
    }
    checked_place(group.metadata().column(column)).map_err(Problem::Reader)?;
    let description = group.metadata().schema_descr().column(column);
    let pages = group.get_column_page_reader(column).map_err(Problem::Reader)?;
    let pages = CheckedPages::new(pages, Arc::clone(&description));
    match description.physical_type() {
        Type::INT32 if is_unsigned(&description) => {
            numbers(chunk::<Int32Type>(description, pages), rows, slot, |value| {
                f64::from(value.cast_unsigned())
            })
        }
        Type::INT64 if is_unsigned(&description) => {
            numbers(chunk::<Int64Type>(description, pages), rows, slot, |value| value.cast_unsigned() as f64)
        }
        Type::INT32 => numbers(chunk::<Int32Type>(description, pages), rows, slot, |value| f64::from(*value)),
        Type::INT64 => numbers(chunk::<Int64Type>(description, pages), rows, slot, |value| *value as f64),
        Type::FLOAT => numbers(chunk::<FloatType>(description, pages), rows, slot, |value| f64::from(*value)),
        Type::DOUBLE => numbers(chunk::<DoubleType>(description, pages), rows, slot, |value| *value),
        Type::BYTE_ARRAY => texts(chunk(description, pages), rows, slot),
        // Refused by `checked_type` already.
        _ => Ok(()),
    }
}

/// A plain column of numbers or text. A date or a decimal is stored as an integer too, in a unit of its own.
fn checked_type(file: &str, column: &ColumnDescriptor, heading: &str) -> Result<(), MeasurementError> {
    let logical = column.logical_type_ref();
    let is_plain = match logical {
        None => matches!(
            column.converted_type(),
            ConvertedType::NONE
                | ConvertedType::UTF8
                | ConvertedType::ENUM
                | ConvertedType::INT_8
                | ConvertedType::INT_16
                | ConvertedType::INT_32
                | ConvertedType::INT_64
                | ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64
        ),
        Some(LogicalType::String | LogicalType::Enum | LogicalType::Integer(_)) => true,
        Some(_) => false,
    };
    let physical = column.physical_type();
    let is_known =
        matches!(physical, Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE | Type::BYTE_ARRAY);
    if is_plain && is_known && column.max_rep_level() == 0 {
        return Ok(());
    }
    let found = match logical {
        _ if column.max_rep_level() > 0 => format!("list of {physical}"),
        // The name of the type without what it is made of.
        Some(logical) => {
            let shown = format!("{logical:?}");
            format!("{physical} as {}", shown.split(['(', ' ']).next().unwrap_or_default())
        }
        None if column.converted_type() == ConvertedType::NONE => physical.to_string(),
        None => format!("{physical} as {}", column.converted_type()),
    };
    Err(MeasurementError::ParquetType {
        file: file.to_owned(),
        column: heading.to_owned(),
        found: quoted(&found),
    })
}

/// Why a column can't be read; the row is the one after those that could.
enum Problem {
    Cell(CellError),
    Reader(ParquetError),
    TooMany,
}

impl Problem {
    fn at(self, file: &str, line: usize, slot: &Slot) -> MeasurementError {
        let file = file.to_owned();
        match self {
            Self::Cell(problem) => {
                MeasurementError::Cell { file, line, column: slot.heading.text.clone(), problem }
            }
            Self::Reader(error) => refused(&file, &error),
            Self::TooMany => MeasurementError::TooManyRows { file, line, limit: MOST_ROWS },
        }
    }
}

fn numbers<T: DataType>(
    column: ColumnReaderImpl<T>,
    rows: &mut usize,
    slot: &mut Slot,
    number: impl Fn(&T::T) -> f64,
) -> Result<(), Problem> {
    each(column, rows, |value| slot.push_number(number(value)))
}

fn texts(column: ColumnReaderImpl<ByteArrayType>, rows: &mut usize, slot: &mut Slot) -> Result<(), Problem> {
    each(column, rows, |value| {
        let text = std::str::from_utf8(value.data()).map_err(|_| CellError::NotUtf8)?;
        slot.push_text(text.trim())
    })
}

/// Hands over every value of a column; counts the rows that were taken.
fn each<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: &mut usize,
    mut take: impl FnMut(&T::T) -> Result<(), CellError>,
) -> Result<(), Problem> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    loop {
        values.clear();
        levels.clear();
        let (records, count, _) =
            column.read_records(BATCH, Some(&mut levels), None, &mut values).map_err(Problem::Reader)?;
        if records == 0 {
            return Ok(());
        }
        if *rows + records > MOST_ROWS {
            return Err(Problem::TooMany);
        }
        // A value that is missing has the level 0 of an optional column.
        let present =
            if count == records { records } else { levels.iter().take_while(|level| **level > 0).count() };
        for value in values.iter().take(present) {
            take(value).map_err(Problem::Cell)?;
            *rows += 1;
        }
        if count != records {
            return Err(Problem::Cell(CellError::Empty));
        }
    }
}
