//! Plots of pneumatic muscle characteristics, and the reports of comparisons and diagnoses.
//!
//! [`characteristics_svg`] draws force and volume against contraction as a self-contained SVG, with one curve
//! per pressure. [`sizing_svg`] draws isobars with the path of a load. [`comparison`] turns a
//! [`bulge_inference::Comparison`] into one page with plots and tables, and [`diagnosis`] does so for a
//! [`bulge_inference::Diagnosis`]. Text remains text: drawing needs no font. The same input gives the same
//! bytes.
//!
//! [`scripts`] contains the plots of rows for a browser, and [`rows`] the data they draw. The page of the
//! workbench and the reports share both.
//!
//! This crate computes no equilibrium, fits nothing and writes no file: a picture is a function of its
//! numbers.
mod axis;
mod characteristics;
pub mod cloth;
pub mod comparison;
pub mod diagnosis;
mod drawing;
mod error;
mod explore;
mod interval;
mod learning;
mod palette;
mod posterior;
pub mod rows;
pub mod scripts;
mod shell;
mod sizing;

pub use characteristics::{Curve, characteristics_svg};
pub use error::PlotError;
pub use explore::policy;
pub use interval::with_interval;
pub use learning::{LearningError, Learnt, LearntDocument};
pub use posterior::posterior_svg;
pub use shell::{Call, shell_word};
pub use sizing::{lines_svg, sizing_svg};
