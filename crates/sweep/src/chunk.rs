//! One chunk of a sweep: its points, and their encoding as Parquet or CSV. The bytes are a pure function of
//! the plan and the number of the chunk.

use bulge_fibre::RangeEnd;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::ops::Range;
use std::sync::Arc;

use crate::design::{Coordinate, Layout};
use crate::family::Family;
use crate::family_error::FamilyError;
use crate::member::{Asked, Member};
use crate::plan::Plan;

/// Points of a part of a chunk. The number is large enough that a muscle shared by two parts costs little. It
/// is small enough that a chunk of muscles that need an integration has parts for every thread.
const PART: u64 = 256;

/// The points of a chunk, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// Number of the first point.
    pub first: u64,
    /// Values of the axes in SI, in the order of the plan. On an axis up to the limit, the contraction is set
    /// to the lower end if the muscle has no limit or a limit below that end.
    pub axes: Vec<Vec<f64>>,
    /// Values of the outputs in SI, in the order of the plan. They are meaningless where
    /// [`Chunk::infeasible`] gives a reason.
    pub outputs: Vec<Vec<f64>>,
    /// Reasons of the points without equilibrium, with their index in the chunk, in rising order.
    pub infeasible: Vec<(usize, String)>,
}

/// A column of the data set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number, empty for text and numbers of points.
    pub unit: String,
}

/// A family and the layout of its points, from which chunks are computed.
#[derive(Debug)]
pub struct Computer<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    family: Family,
}

/// A muscle with the end of its range if points depend on it. Neighbouring points share it.
struct Placed {
    number: u64,
    member: Result<(Member, Option<RangeEnd>), String>,
}

impl<'a> Computer<'a> {
    /// Prepares the computation of a plan that has a design.
    ///
    /// # Errors
    /// If the muscle file states an effect that doesn't exist.
    pub fn new(plan: &'a Plan, layout: &'a Layout) -> Result<Self, FamilyError> {
        Ok(Self { plan, layout, family: Family::new(plan)? })
    }

    /// Computes the points of a range of numbers.
    #[must_use]
    pub fn chunk(&self, points: Range<u64>) -> Chunk {
        let count = usize::try_from(points.end.saturating_sub(points.start)).unwrap_or(0);
        let (axes, outputs) = (self.plan.axes.len(), self.plan.outputs.len());
        let mut chunk = Chunk {
            first: points.start,
            axes: vec![Vec::with_capacity(count); axes],
            outputs: vec![Vec::with_capacity(count); outputs],
            infeasible: Vec::new(),
        };
        let mut start = points.start;
        while start < points.end {
            let end = points.end.min(start.saturating_add(PART));
            self.part(start..end, &mut chunk);
            start = end;
        }
        chunk
    }

    /// Adds the points of a part.
    fn part(&self, points: Range<u64>, chunk: &mut Chunk) {
        let first = chunk.rows();
        let mut place = vec![Coordinate::Value(0.0); self.plan.axes.len()];
        let mut point = vec![0.0; self.plan.axes.len()];
        // Each muscle once, and the row, muscle and contraction of each point that has one.
        let mut members: Vec<Placed> = Vec::new();
        let mut placed = Vec::new();
        for (row, number) in (first..).zip(points) {
            self.layout.place(number, &mut place);
            // The contraction depends on the limit, but the muscle doesn't depend on the contraction. Without
            // a limit the axis stays at its lower end.
            for (x, at) in point.iter_mut().zip(&place) {
                *x = if let Coordinate::OfLimit { from, .. } = at { *from } else { at.value(1.0) };
            }
            let member = self.layout.member(number);
            if members.last().is_none_or(|last| last.number != member) {
                let follows = place.iter().any(|at| matches!(at, Coordinate::OfLimit { .. }));
                members.push(Placed { number: member, member: self.member(&point, follows) });
            }
            let last = members.len() - 1;
            let contraction = members[last].member.as_ref().map_err(Clone::clone).and_then(|(_, end)| {
                let limit = end.map(RangeEnd::contraction);
                begins_below(&place, limit)?;
                for (x, at) in point.iter_mut().zip(&place) {
                    *x = at.value(limit.unwrap_or(1.0));
                }
                Ok(self.family.contraction(&point))
            });
            for (column, x) in chunk.axes.iter_mut().zip(&point) {
                column.push(*x);
            }
            match contraction {
                Ok(contraction) => placed.push((row, last, contraction)),
                Err(reason) => chunk.infeasible.push((row, reason)),
            }
        }
        let rows = chunk.rows();
        chunk.outputs.iter_mut().for_each(|column| column.resize(rows, 0.0));
        let asked = placed.iter().filter_map(|(_, member, contraction)| {
            let (member, end) = members[*member].member.as_ref().ok()?;
            Some(Asked { member, contraction: *contraction, end: *end })
        });
        Member::pulling_each(&asked.collect::<Vec<_>>(), &self.plan.outputs, |i, found| match found {
            Ok(values) => {
                for (column, value) in chunk.outputs.iter_mut().zip(values) {
                    column[placed[i].0] = *value;
                }
            }
            Err(error) => chunk.infeasible.push((placed[i].0, error.to_string())),
        });
        chunk.infeasible.sort_by_key(|(row, _)| *row);
    }

    /// Computes a chunk in parts that other threads may take over. Outputs at points without equilibrium are
    /// meaningless and may differ from those of [`Self::chunk`].
    #[must_use]
    pub(crate) fn shared_chunk(&self, points: Range<u64>) -> Chunk {
        let parts = points.end.saturating_sub(points.start).div_ceil(PART);
        let parts: Vec<Chunk> = (0..parts)
            .into_par_iter()
            .map(|i| {
                let start = points.start + i * PART;
                self.chunk(start..points.end.min(start.saturating_add(PART)))
            })
            .collect();
        let mut all = self.chunk(points.start..points.start);
        let count = parts.iter().map(Chunk::rows).sum();
        for column in all.axes.iter_mut().chain(&mut all.outputs) {
            column.reserve_exact(count);
        }
        for part in parts {
            let rows = all.rows();
            for (columns, more) in [(&mut all.axes, part.axes), (&mut all.outputs, part.outputs)] {
                for (column, more) in columns.iter_mut().zip(more) {
                    column.extend(more);
                }
            }
            all.infeasible.extend(part.infeasible.into_iter().map(|(row, reason)| (rows + row, reason)));
        }
        all
    }

    fn member(&self, point: &[f64], follows: bool) -> Result<(Member, Option<RangeEnd>), String> {
        let of = |member: Member| {
            let end = if follows { Some(member.range_end()?) } else { None };
            Ok((member, end))
        };
        self.family.member(point).and_then(of).map_err(|error: FamilyError| error.to_string())
    }

    /// Columns of the data set in order: number of the point, axes, outputs, reason.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let column = |name: String, unit: String| Column { name, unit };
        let mut columns = vec![column("index".to_owned(), String::new())];
        columns.extend(self.plan.axes.iter().map(|axis| column(axis.name.clone(), axis.unit.clone())));
        columns.extend(self.plan.outputs.iter().map(|output| column(output.name(), output.unit())));
        columns.push(column("infeasible".to_owned(), String::new()));
        columns
    }

    /// A chunk as a Parquet file: `index` int64, the axes as required doubles, the outputs as optional
    /// doubles, `infeasible` as optional text.
    /// Metadata: `bulge.columns` (names and units), `bulge.sweep` (`about`).
    ///
    /// # Errors
    /// If the Parquet library fails.
    pub fn parquet(&self, chunk: &Chunk, about: &str) -> Result<Vec<u8>, ParquetError> {
        let columns = self.columns();
        let (axes, outputs) = (chunk.axes.len(), chunk.outputs.len());
        let field = |(i, column): (usize, &Column)| {
            let (physical, repetition, logical) = if i == 0 {
                (Physical::INT64, Repetition::REQUIRED, None)
            } else if i <= axes {
                (Physical::DOUBLE, Repetition::REQUIRED, None)
            } else if i <= axes + outputs {
                (Physical::DOUBLE, Repetition::OPTIONAL, None)
            } else {
                (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String))
            };
            let builder = Type::primitive_type_builder(&column.name, physical);
            builder.with_repetition(repetition).with_logical_type(logical).build().map(Arc::new)
        };
        let fields = columns.iter().enumerate().map(field).collect::<Result<Vec<_>, _>>()?;
        let schema = Arc::new(Type::group_type_builder("points").with_fields(fields).build()?);
        let described = serde_json::to_string(&columns)
            .map_err(|error| ParquetError::General(format!("the names of the columns: {error}")))?;
        let metadata = vec![
            KeyValue::new("bulge.columns".to_owned(), described),
            KeyValue::new("bulge.sweep".to_owned(), about.to_owned()),
        ];
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            // Numbers hardly repeat, so a dictionary wouldn't help. Point numbers rise by 1, so deltas pack
            // well.
            .set_dictionary_enabled(false)
            .set_column_encoding(ColumnPath::from("index"), Encoding::DELTA_BINARY_PACKED)
            .set_column_dictionary_enabled(ColumnPath::from("infeasible"), true)
            .set_key_value_metadata(Some(metadata))
            .build();
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        let rows = chunk.rows();
        let mut levels = vec![1_i16; rows];
        for (row, _) in &chunk.infeasible {
            levels[*row] = 0;
        }
        let missing = || ParquetError::General("a column is missing".to_owned());
        let numbers: Vec<i64> =
            (chunk.first..).take(rows).map(|n| i64::try_from(n).unwrap_or(i64::MAX)).collect();
        let mut column = group.next_column()?.ok_or_else(missing)?;
        column.typed::<Int64Type>().write_batch(&numbers, None, None)?;
        column.close()?;
        for values in &chunk.axes {
            let mut column = group.next_column()?.ok_or_else(missing)?;
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
        for values in &chunk.outputs {
            let mut column = group.next_column()?.ok_or_else(missing)?;
            let present = chunk.present(values);
            column.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
            column.close()?;
        }
        let reasons: Vec<ByteArray> =
            chunk.infeasible.iter().map(|(_, reason)| ByteArray::from(reason.as_str())).collect();
        let with_reason: Vec<i16> = levels.iter().map(|level| 1 - level).collect();
        let mut column = group.next_column()?.ok_or_else(missing)?;
        column.typed::<ByteArrayType>().write_batch(&reasons, Some(&with_reason), None)?;
        column.close()?;
        group.close()?;
        writer.close()?;
        Ok(bytes)
    }

    /// A chunk as CSV with a header of `name [unit]`. Cells are empty where there is no equilibrium.
    #[must_use]
    pub fn csv(&self, chunk: &Chunk) -> String {
        let heading = |column: &Column| match column.unit.as_str() {
            "" | "1" => column.name.clone(),
            unit => format!("{} [{unit}]", column.name),
        };
        let mut text = self.columns().iter().map(heading).collect::<Vec<_>>().join(",") + "\n";
        let mut reasons = chunk.infeasible.iter().peekable();
        for row in 0..chunk.rows() {
            let reason = reasons.next_if(|(place, _)| *place == row).map(|(_, reason)| reason);
            let _ = write!(text, "{}", chunk.first + row as u64);
            for column in &chunk.axes {
                let _ = write!(text, ",{}", column[row]);
            }
            for column in &chunk.outputs {
                let _ = match reason {
                    None => write!(text, ",{}", column[row]),
                    Some(_) => write!(text, ","),
                };
            }
            let quoted = reason.map_or_else(String::new, |r| format!("\"{}\"", r.replace('"', "\"\"")));
            let _ = writeln!(text, ",{quoted}");
        }
        text
    }
}

/// Refuses an axis up to the limit that begins at or beyond it.
fn begins_below(place: &[Coordinate], limit: Option<f64>) -> Result<(), String> {
    for at in place {
        if let (Coordinate::OfLimit { from, .. }, Some(limit)) = (at, limit)
            && *from >= limit
        {
            let [from, limit] = [100.0 * from, 100.0 * limit];
            return Err(format!(
                "the axis begins at {from:.4} %, beyond this muscle's limit of {limit:.4} %"
            ));
        }
    }
    Ok(())
}

impl Chunk {
    /// Number of points.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.axes.first().map_or(0, Vec::len)
    }

    /// Values of the points that have an equilibrium.
    fn present(&self, values: &[f64]) -> Vec<f64> {
        let mut skip = self.infeasible.iter().map(|(row, _)| *row).peekable();
        let keep = |(row, _): &(usize, &f64)| skip.next_if_eq(row).is_none();
        values.iter().enumerate().filter(keep).map(|(_, value)| *value).collect()
    }
}
