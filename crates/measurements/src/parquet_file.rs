//! Parquet files: the same columns and checks as in CSV; a column's name is its heading, such as `length
//! [mm]`.

use crate::assignment::{Header, assign};
use crate::cell::Decimal;
use crate::cell_error::CellError;
use crate::csv_file::MOST_ROWS;
use crate::error::MeasurementError;
use crate::parquet_page::{CheckedPages, checked_place};
use crate::quote::quoted;
use crate::reading::ReadOptions;
use crate::slot::Slot;
use crate::source::has_room;
use crate::table::{Draft, Table, bytes_per_row};
use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::{ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Rows that are decoded at a time.
const BATCH: usize = 1 << 14;

/// Reads Parquet. `file` is its name, for messages.
pub(crate) fn read<R: ChunkReader + 'static>(
    file: &str,
    source: R,
    options: &ReadOptions,
) -> Result<Table, MeasurementError> {
    // Pages are checked before they are decoded, but a damaged file must not end the program in any case.
    catch_unwind(AssertUnwindSafe(|| read_columns(file, source, options)))
        .unwrap_or_else(|_| Err(no_parquet(file, "it is damaged", AGAIN)))
}

fn read_columns<R: ChunkReader + 'static>(
    file: &str,
    source: R,
    options: &ReadOptions,
) -> Result<Table, MeasurementError> {
    let refused = |error: &ParquetError| refused(file, error);
    let reader = SerializedFileReader::new(source).map_err(|error| refused(&error))?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let names: Vec<String> = schema.columns().iter().map(|column| column.path().string()).collect();
    let header = Header { file, line: 1, names: &names, units: None, first: &[] };
    let assignment = assign(&header, options)?;
    let (mut places, mut slots) = (Vec::new(), Vec::new());
    for (place, heading) in assignment.headings.into_iter().enumerate() {
        if let Some(heading) = heading {
            checked_type(file, &schema.columns()[place], &heading.text)?;
            places.push(place);
            slots.push(Slot::new(heading, 0));
        }
    }
    // The number of rows that the file states is checked by reading them. A column has room for twice its
    // values at most.
    let stated = usize::try_from(reader.metadata().file_metadata().num_rows()).unwrap_or(0).min(MOST_ROWS);
    has_room(file, (stated * bytes_per_row(2 * slots.len())) as u64)?;
    let mut draft = Draft::new(slots, assignment.uses, "row");
    let mut rows = vec![0; places.len()];
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|error| refused(&error))?;
        for (slot, (place, rows)) in places.iter().zip(&mut rows).enumerate() {
            let mut column = Column { draft: &mut draft, slot, rows };
            read_chunk(group.as_ref(), *place, &mut column)
                .map_err(|problem| problem.at(file, *column.rows))?;
        }
    }
    let expected = rows.first().copied().unwrap_or(0);
    if let Some(found) = rows.iter().find(|rows| **rows != expected) {
        let why = format!("its columns have {expected} and {found} rows");
        return Err(no_parquet(file, &why, AGAIN));
    }
    let last = u32::try_from(expected).unwrap_or(u32::MAX);
    draft.lines = (1..=last).collect();
    draft.finish(file, options)
}

/// A column with the rows that have been read so far.
struct Column<'a> {
    draft: &'a mut Draft,
    slot: usize,
    rows: &'a mut usize,
}

impl Column<'_> {
    /// Takes the next value.
    fn take(&mut self, push: impl FnOnce(&mut Slot) -> Result<(), CellError>) {
        if let Err(problem) = push(&mut self.draft.slots[self.slot]) {
            self.draft.spoilt(self.slot, *self.rows, &problem);
        }
        *self.rows += 1;
    }

    /// Leaves a gap for a value that is missing.
    fn leave_gap(&mut self) {
        self.take(|slot| {
            slot.push_gap();
            Err(CellError::empty())
        });
    }
}

/// The remedy for a damaged file.
const AGAIN: &str = "write it again, or export CSV";

/// The reader's message with a remedy.
fn refused(file: &str, error: &ParquetError) -> MeasurementError {
    let says = error.to_string();
    let says = says.strip_prefix("Parquet error: ").unwrap_or(&says);
    let (why, instead) = if let Some(codec) = says.strip_prefix("Disabled feature at compile time: ") {
        // The reader's message names its own feature instead of the codec.
        let codec = if codec == "flate2" { "gzip" } else { codec };
        (format!("it is compressed with {codec}"), "write it with Snappy compression or none, or export CSV")
    } else if says.contains("Corrupt footer") || says.starts_with("EOF") {
        ("it is cut off or damaged".to_owned(), AGAIN)
    } else if says.contains("encoding") {
        (says.to_owned(), "write it with plain or dictionary encoding, or export CSV")
    } else {
        (says.to_owned(), AGAIN)
    };
    no_parquet(file, &quoted(&why), instead)
}

/// The file claims to be Parquet, but can't be read as such.
pub(crate) fn no_parquet(file: &str, why: &str, instead: &str) -> MeasurementError {
    MeasurementError::of_file(file, format!("can't be read as Parquet ({why}): {instead}"))
}

/// Whether integers are unsigned.
fn is_unsigned(column: &ColumnDescriptor) -> bool {
    match column.logical_type_ref() {
        Some(LogicalType::Integer(integer)) => !integer.is_signed,
        Some(_) => false,
        None => matches!(column.converted_type(), ConvertedType::UINT_32 | ConvertedType::UINT_64),
    }
}

/// Reads the rows of one column in one group.
fn read_chunk(group: &dyn RowGroupReader, place: usize, column: &mut Column<'_>) -> Result<(), Problem> {
    fn chunk<T: DataType>(column: ColumnDescPtr, pages: CheckedPages) -> ColumnReaderImpl<T> {
        ColumnReaderImpl::new(column, Box::new(pages))
    }
    checked_place(group.metadata().column(place)).map_err(Problem::Reader)?;
    let description = group.metadata().schema_descr().column(place);
    let pages = group.get_column_page_reader(place).map_err(Problem::Reader)?;
    let pages = CheckedPages::new(pages, Arc::clone(&description));
    match description.physical_type() {
        Type::INT32 if is_unsigned(&description) => {
            numbers(chunk::<Int32Type>(description, pages), column, |value| f64::from(value.cast_unsigned()))
        }
        Type::INT64 if is_unsigned(&description) => {
            numbers(chunk::<Int64Type>(description, pages), column, |value| value.cast_unsigned() as f64)
        }
        Type::INT32 => numbers(chunk::<Int32Type>(description, pages), column, |value| f64::from(*value)),
        Type::INT64 => numbers(chunk::<Int64Type>(description, pages), column, |value| *value as f64),
        Type::FLOAT => numbers(chunk::<FloatType>(description, pages), column, |value| f64::from(*value)),
        Type::DOUBLE => numbers(chunk::<DoubleType>(description, pages), column, |value| *value),
        Type::BYTE_ARRAY => texts(chunk(description, pages), column),
        // `checked_type` has refused these already.
        _ => Ok(()),
    }
}

/// Requires a plain column of numbers or text. Dates and decimals are stored as integers too, in units of
/// their own.
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
        // The name of the type without its parameters.
        Some(logical) => {
            let shown = format!("{logical:?}");
            format!("{physical} as {}", shown.split(['(', ' ']).next().unwrap_or_default())
        }
        None if column.converted_type() == ConvertedType::NONE => physical.to_string(),
        None => format!("{physical} as {}", column.converted_type()),
    };
    let what = format!(
        "column `{heading}` has the Parquet type {}: store it as double, float, int64, int32 or string",
        quoted(&found)
    );
    Err(MeasurementError::of_file(file, what))
}

/// Why a column can't be read; the row is the one after the last readable one.
enum Problem {
    Reader(ParquetError),
    TooMany,
}

impl Problem {
    fn at(self, file: &str, rows: usize) -> MeasurementError {
        match self {
            Self::Reader(error) => refused(file, &error),
            Self::TooMany => MeasurementError::too_many_rows(file, rows + 1),
        }
    }
}

fn numbers<T: DataType>(
    reader: ColumnReaderImpl<T>,
    column: &mut Column<'_>,
    number: impl Fn(&T::T) -> f64,
) -> Result<(), Problem> {
    each(reader, column, |slot, value| slot.push_number(number(value)))
}

fn texts(reader: ColumnReaderImpl<ByteArrayType>, column: &mut Column<'_>) -> Result<(), Problem> {
    each(reader, column, |slot, value| {
        if let Ok(text) = std::str::from_utf8(value.data()) {
            return slot.push_text(text.trim(), Decimal::Point);
        }
        slot.push_gap();
        Err(CellError::new("no text", ""))
    })
}

/// Passes on every value of a column.
fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &mut Column<'_>,
    take: impl Fn(&mut Slot, &T::T) -> Result<(), CellError>,
) -> Result<(), Problem> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    loop {
        values.clear();
        levels.clear();
        let (records, count, _) =
            reader.read_records(BATCH, Some(&mut levels), None, &mut values).map_err(Problem::Reader)?;
        if records == 0 {
            return Ok(());
        }
        if *column.rows + records > MOST_ROWS {
            return Err(Problem::TooMany);
        }
        let mut present = values.iter().take(count);
        for record in 0..records {
            // A missing value of an optional column has definition level 0.
            let is_there = count == records || levels.get(record).is_some_and(|level| *level > 0);
            match is_there.then(|| present.next()).flatten() {
                Some(value) => column.take(|slot| take(slot, value)),
                None => column.leave_gap(),
            }
        }
    }
}
