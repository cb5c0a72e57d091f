//! Plots of pneumatic muscle characteristics.
//!
//! [`characteristics_svg`] draws force and volume against contraction, one curve for every pressure, as an SVG that stands for itself. Letters stay
//! letters: no font is needed to draw it. The same curves give the same bytes.
//!
//! This crate computes no equilibrium and writes no file: a plot is a function of [`bulge_fibre::Response`]s.
mod axis;
mod characteristics;
mod error;
mod palette;

pub use characteristics::{Curve, characteristics_svg};
pub use error::PlotError;
