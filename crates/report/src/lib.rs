//! Plots of pneumatic muscle characteristics, and the reports of comparisons and diagnoses.
//!
//! [`characteristics_svg`] draws force and volume against contraction, one curve for every pressure, as an SVG that stands for itself.
//! [`sizing_svg`] draws isobars with the way of a load. [`comparison`] turns a [`bulge_inference::Comparison`] into one page with plots and tables, [`diagnosis`] a
//! [`bulge_inference::Diagnosis`]. Letters stay letters: no font is needed to draw.
//! The same input gives the same bytes.
//!
//! [`scripts`] are the plots of rows in a browser, and [`rows`] what they draw: the page of the workbench and the reports share them.
//!
//! This crate computes no equilibrium, fits nothing and writes no file: a picture is a function of its numbers.
mod axis;
mod characteristics;
pub mod comparison;
pub mod diagnosis;
mod drawing;
mod error;
mod explore;
mod interval;
mod learning;
mod palette;
pub mod rows;
pub mod scripts;
mod shell;
mod sizing;

pub use characteristics::{Curve, characteristics_svg};
pub use error::PlotError;
pub use explore::policy;
pub use interval::with_interval;
pub use learning::{LearningError, Learnt, LearntDocument};
pub use shell::{Call, shell_word};
pub use sizing::{lines_svg, sizing_svg};
