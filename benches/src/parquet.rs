//! Simulated columns as Parquet, with Snappy compression.

use bulge_measurements::Columns;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

use crate::Failure;

fn column(name: &str, physical: Physical, logical: Option<LogicalType>) -> Result<Arc<Type>, Failure> {
    let builder = Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
    Ok(Arc::new(builder.with_logical_type(logical).build()?))
}

/// Writes time, pressure, contraction and force in SI, and the sweep.
///
/// # Errors
/// Never: the columns have equal lengths.
pub fn parquet(columns: &Columns) -> Result<Vec<u8>, Failure> {
    let numbers = [
        ("time [s]", columns.time_s.as_deref().unwrap_or_default()),
        ("pressure [Pa]", columns.pressure_pa.as_slice()),
        ("contraction", columns.motion.values()),
        ("force [N]", columns.force_n.as_slice()),
    ];
    let labels = columns.sweep.as_ref().ok_or("the columns have no sweeps")?;
    let mut fields = numbers
        .iter()
        .map(|(name, _)| column(name, Physical::DOUBLE, None))
        .collect::<Result<Vec<_>, _>>()?;
    fields.push(column("sweep", Physical::BYTE_ARRAY, Some(LogicalType::String))?);
    let schema = Arc::new(Type::group_type_builder("rows").with_fields(fields).build()?);
    let properties = Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties)?;
    let mut group = writer.next_row_group()?;
    for (_, values) in numbers {
        let mut column = group.next_column()?.ok_or("a column is missing")?;
        column.typed::<DoubleType>().write_batch(values, None, None)?;
        column.close()?;
    }
    let mut column = group.next_column()?.ok_or("a column is missing")?;
    let texts: Vec<ByteArray> =
        labels.rows().iter().map(|row| ByteArray::from(labels.names()[*row as usize].as_str())).collect();
    column.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
    column.close()?;
    group.close()?;
    writer.close()?;
    Ok(bytes)
}
