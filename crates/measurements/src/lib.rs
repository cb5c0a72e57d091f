//! Measured force maps and histories: reads laboratory files and finds sweeps, directions and repeats;
//! includes a quality check.
//!
//! Data only, no model. Numbers are finite and in SI; errors in a file are reported with the line and the
//! remedy. Deliberately absent: cleaning. Nothing is dropped, filtered or interpolated silently:
//! [`Data::reading`] reports how columns were interpreted and which rows can't be used, [`Data::quality`]
//! what looks wrong and where, and [`Data::disturbed`] which rows should not count.

mod assignment;
mod cell;
mod cell_error;
mod clock;
mod column_map;
mod columns;
mod csv_file;
mod data;
mod dimension;
mod driven;
mod encoding;
mod error;
mod heading;
mod history;
mod isobars;
mod layout;
mod line;
mod line_list;
mod magnitude;
mod matlab;
mod motion;
mod names;
mod order;
mod parquet_file;
mod parquet_page;
mod quality;
mod quote;
mod rate;
mod reading;
mod recorded;
mod repeats;
mod resolution;
#[cfg(test)]
mod simulated;
mod slot;
mod source;
mod spreadsheet;
mod stretch;
mod structure;
mod sweep;
mod table;
#[cfg(test)]
mod tests {
    mod dialects;
    mod strangers;
}
mod turning;
mod unit;
mod window;
mod written;

pub use column_map::{ColumnEntry, ColumnMap};
pub use columns::{Channel, Columns, Labels, Trace};
pub use data::Data;
pub use error::MeasurementError;
pub use heading::{RecognisedColumn, recognised_columns};
pub use history::History;
pub use quality::{Disturbance, Finding, FindingKind, LineRange, Quality, QualityOptions, Severity};
pub use reading::{ColumnUse, ReadOptions, Reading, SetApart};
pub use repeats::{Offset, PureError, RepeatGroup, Repeats, Run};
pub use source::SourceFile;
pub use sweep::{Sweep, SweepKind, is_weight};
pub use written::{WrittenColumn, WrittenError, WrittenValues, to_csv, to_parquet, written};
