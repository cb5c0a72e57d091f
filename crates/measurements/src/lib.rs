//! Measured force maps and histories: CSV and Parquet in, sweeps, directions, repeats and a quality gate.
//!
//! Data only, no model. Numbers are finite and in SI; what a file gets wrong is answered with its line and its cure.
//! Deliberately absent: cleaning. Nothing is dropped, filtered or interpolated silently; [`Data::quality`] says what looks wrong and where, [`Data::disturbed`] which rows
//! had better not count.

mod cell;
mod columns;
mod csv_file;
mod data;
mod dimension;
mod error;
mod heading;
mod history;
mod isobars;
mod parquet_file;
mod parquet_page;
mod quality;
mod quote;
mod rate;
mod repeats;
mod resolution;
#[cfg(test)]
mod simulated;
mod slot;
mod source;
mod stretch;
mod sweep;
mod turning;
mod window;

pub use columns::{Columns, Labels, Trace};
pub use data::{Data, Motion};
pub use error::{CellError, MeasurementError};
pub use history::History;
pub use quality::{Disturbance, Finding, FindingKind, LineRange, Quality, QualityOptions, Severity};
pub use repeats::{Offset, PureError, RepeatGroup, Repeats, Run};
pub use source::SourceFile;
pub use sweep::{Sweep, SweepKind};
