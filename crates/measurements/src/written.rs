//! Writes columns as a file that [`crate::Data`] can read again: CSV, or Parquet with the same headings.
//!
//! Numbers are written in full, so that reading restores the same bits. Values that aren't finite are written
//! as an empty cell or a null.

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// Rows per row group of a Parquet file.
const GROUP: usize = 1 << 20;

/// A column to write: its heading, such as `force [N]`, and one value for each row.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenColumn<'a> {
    /// The heading.
    pub heading: &'a str,
    /// Its values.
    pub values: WrittenValues<'a>,
}

/// Values of a column, one for each row.
#[derive(Debug, Clone, PartialEq)]
pub enum WrittenValues<'a> {
    /// Numbers; not finite means missing.
    Numbers(Cow<'a, [f64]>),
    /// Whole numbers.
    Counts(&'a [u32]),
    /// True or false.
    Flags(&'a [bool]),
    /// Names from a list, by their indices; none means missing.
    Names(&'a [String], Vec<Option<u32>>),
}

impl<'a> WrittenValues<'a> {
    /// Numbers from a slice.
    #[must_use]
    pub const fn numbers(values: &'a [f64]) -> Self {
        Self::Numbers(Cow::Borrowed(values))
    }

    /// Names of all rows, by their indices in the list.
    #[must_use]
    pub fn names(list: &'a [String], places: &[u32]) -> Self {
        Self::Names(list, places.iter().map(|place| Some(*place)).collect())
    }

    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Names(_, places) => places.len(),
        }
    }
}

/// Why columns can't be written, as the Parquet library reports it, for example because they differ in
/// length.
#[derive(Debug, thiserror::Error)]
#[error("the columns can't be written as Parquet: {0}")]
pub struct WrittenError(Box<ParquetError>);

impl From<ParquetError> for WrittenError {
    fn from(error: ParquetError) -> Self {
        Self(Box::new(error))
    }
}

/// The name at an index.
fn name<'a>(list: &'a [String], place: Option<&Option<u32>>) -> Option<&'a str> {
    list.get((*place?)? as usize).map(String::as_str)
}

/// The bytes of a file of the kind that its name's extension says: Parquet for `.parquet`, otherwise CSV.
///
/// # Errors
/// [`WrittenError`], for example if columns differ in length.
pub fn written(path: &Path, columns: &[WrittenColumn<'_>]) -> Result<Vec<u8>, WrittenError> {
    let is_parquet = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"));
    if is_parquet { to_parquet(columns) } else { Ok(to_csv(columns).into_bytes()) }
}

/// CSV with a line of headings. The number of rows is that of the longest column; shorter ones are filled
/// with empty cells.
#[must_use]
pub fn to_csv(columns: &[WrittenColumn<'_>]) -> String {
    let headings: Vec<String> = columns.iter().map(|column| field(column.heading)).collect();
    let mut text = headings.join(",") + "\n";
    for row in 0..columns.iter().map(|column| column.values.len()).max().unwrap_or(0) {
        for (place, column) in columns.iter().enumerate() {
            if place > 0 {
                text.push(',');
            }
            // Writing to a String can't fail.
            let _ = match &column.values {
                WrittenValues::Numbers(values) => match values.get(row).filter(|value| value.is_finite()) {
                    Some(value) => write!(text, "{value}"),
                    None => Ok(()),
                },
                WrittenValues::Counts(values) => {
                    values.get(row).map_or(Ok(()), |value| write!(text, "{value}"))
                }
                WrittenValues::Flags(values) => {
                    values.get(row).map_or(Ok(()), |value| write!(text, "{value}"))
                }
                WrittenValues::Names(list, places) => {
                    name(list, places.get(row)).map_or(Ok(()), |name| write!(text, "{}", field(name)))
                }
            };
        }
        text.push('\n');
    }
    text
}

/// A field, quoted if necessary. A line break in a name would end the row for other readers.
fn field(text: &str) -> String {
    let text = bulge_muscles::shown::one_line(text);
    let needs = text.contains([',', '"', ';', '#']) || text.trim().len() != text.len();
    if needs { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into_owned() }
}

/// A Parquet file: numbers as optional doubles, whole ones as 64-bit integers, names as optional text.
///
/// # Errors
/// [`WrittenError`], for example if columns differ in length.
pub fn to_parquet(columns: &[WrittenColumn<'_>]) -> Result<Vec<u8>, WrittenError> {
    let fields = columns.iter().map(|column| {
        let (physical, repetition, logical) = match column.values {
            WrittenValues::Numbers(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            WrittenValues::Counts(_) => (Physical::INT64, Repetition::REQUIRED, None),
            WrittenValues::Flags(_) => (Physical::BOOLEAN, Repetition::REQUIRED, None),
            WrittenValues::Names(..) => {
                (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String))
            }
        };
        let builder = Type::primitive_type_builder(column.heading, physical);
        builder.with_repetition(repetition).with_logical_type(logical).build().map(Arc::new)
    });
    let schema =
        Type::group_type_builder("rows").with_fields(fields.collect::<Result<_, ParquetError>>()?).build()?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
    for start in (0..rows).step_by(GROUP) {
        let mut group = writer.next_row_group()?;
        for column in columns {
            put(&mut group, &column.values, start)?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(bytes)
}

/// Writes one group of a column.
fn put<W: std::io::Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &WrittenValues<'_>,
    start: usize,
) -> Result<(), ParquetError> {
    let missing = || ParquetError::General("a column is missing".to_owned());
    let mut column = group.next_column()?.ok_or_else(missing)?;
    match values {
        WrittenValues::Numbers(values) => {
            let part: Vec<f64> = values.iter().skip(start).take(GROUP).copied().collect();
            let levels: Vec<i16> = part.iter().map(|value| i16::from(value.is_finite())).collect();
            let present: Vec<f64> = part.into_iter().filter(|value| value.is_finite()).collect();
            column.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
        }
        WrittenValues::Counts(values) => {
            let part: Vec<i64> =
                values.iter().skip(start).take(GROUP).map(|value| i64::from(*value)).collect();
            column.typed::<Int64Type>().write_batch(&part, None, None)?;
        }
        WrittenValues::Flags(values) => {
            let part: Vec<bool> = values.iter().skip(start).take(GROUP).copied().collect();
            column.typed::<BoolType>().write_batch(&part, None, None)?;
        }
        WrittenValues::Names(list, places) => {
            let part = || places.iter().skip(start).take(GROUP).map(|place| name(list, Some(place)));
            let levels: Vec<i16> = part().map(|name| i16::from(name.is_some())).collect();
            let present: Vec<ByteArray> = part().flatten().map(ByteArray::from).collect();
            column.typed::<ByteArrayType>().write_batch(&present, Some(&levels), None)?;
        }
    }
    column.close()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Data;

    #[test]
    fn what_is_written_is_read_again_to_the_bit() {
        let pressure = [1e5 / 3.0, 2.0e5, 3.1e5];
        let (contraction, force) = ([0.1, 0.2, 1.0 / 3.0], [100.0, 1e-3 / 7.0, 55.5]);
        let other = [1.0, f64::NAN, f64::NEG_INFINITY];
        let names = ["a,b \"c\"".to_owned(), "d".to_owned()];
        let columns = [
            WrittenColumn { heading: "pressure [Pa]", values: WrittenValues::numbers(&pressure) },
            WrittenColumn { heading: "contraction [-]", values: WrittenValues::numbers(&contraction) },
            WrittenColumn { heading: "specimen", values: WrittenValues::names(&names, &[1, 0, 0]) },
            WrittenColumn { heading: "counts", values: WrittenValues::Flags(&[true, false, true]) },
            WrittenColumn { heading: "why", values: WrittenValues::Names(&names, vec![None, Some(1), None]) },
            WrittenColumn { heading: "line", values: WrittenValues::Counts(&[2, 3, 4]) },
            WrittenColumn { heading: "model force [N]", values: WrittenValues::numbers(&other) },
            WrittenColumn { heading: "force [N]", values: WrittenValues::numbers(&force) },
        ];
        let text = to_csv(&columns);
        let mut lines = text.lines();
        assert_eq!(lines.next().unwrap().matches(',').count(), 7);
        assert!(lines.next().unwrap().ends_with(",0.1,d,true,,2,1,100"), "{text}");
        assert!(lines.next().unwrap().contains(",\"a,b \"\"c\"\"\",false,d,3,,"), "{text}");
        let folder = tempfile::tempdir().unwrap();
        for name in ["rows.csv", "rows.parquet"] {
            let path = folder.path().join(name);
            std::fs::write(&path, written(&path, &columns).unwrap()).unwrap();
            let data = Data::read(&[&path]).unwrap();
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(data.pressure()), bits(&pressure), "{name}");
            assert_eq!(bits(&data.contraction(1.0)), bits(&contraction), "{name}");
            assert_eq!(bits(data.force()), bits(&force), "{name}");
            assert_eq!(data.specimens(), ["d", "a,b \"c\""], "{name}");
        }
    }

    #[test]
    fn no_rows_are_a_heading() {
        let none = [WrittenColumn { heading: "force [N]", values: WrittenValues::numbers(&[]) }];
        assert_eq!(to_csv(&none), "force [N]\n");
        assert!(to_parquet(&none).unwrap().starts_with(b"PAR1"));
    }
}
