//! The report of a comparison: one page that stands for itself, and each of its plots.
//!
//! ```text
//! html(&comparison)?   -> report.html, without scripts, network or fonts of its own
//! plots(&comparison)?  -> NAME.svg for each plot
//! ```
//! Numbers come from the comparison alone: nothing is fitted or predicted here. Errors are measured - model throughout, so a positive error
//! means that the model pulls too weakly.

mod breakdown;
mod check;
mod contributions;
mod convergence;
mod correlations;
mod data;
mod force;
mod headline;
mod ladder;
mod ladder_table;
mod legend;
mod levels;
mod loops;
mod number;
mod page;
mod panel;
mod parameters;
mod parameters_table;
mod residual_map;
mod rivals;
mod scatter;
mod svg;
mod wording;

use bulge_inference::Comparison;
use serde::Serialize;

use crate::PlotError;

/// Width of every plot \[px\].
const WIDTH: f64 = 920.0;

/// One plot of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Plot {
    /// Stem of a file name.
    pub name: &'static str,
    /// What is seen, in a few words.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The drawing, an SVG document that stands for itself.
    pub svg: String,
}

/// The page: one HTML document with all plots and tables, readable on screen and on paper.
///
/// # Errors
/// A number that isn't finite, lists of different lengths that belong together, or values too far apart for an axis.
pub fn html(comparison: &Comparison) -> Result<String, PlotError> {
    check::check(comparison)?;
    page::render(comparison)
}

/// The plots for which there are data, in the order of the page.
///
/// # Errors
/// As [`html`].
pub fn plots(comparison: &Comparison) -> Result<Vec<Plot>, PlotError> {
    check::check(comparison)?;
    let mut plots = Vec::new();
    plots.extend(ladder::plot(comparison)?);
    plots.extend(force::plot(comparison)?);
    plots.extend(breakdown::plots(comparison)?);
    plots.extend(residual_map::plot(comparison)?);
    plots.extend(loops::plot(comparison)?);
    plots.extend(contributions::plot(comparison)?);
    plots.extend(scatter::plot(comparison)?);
    plots.extend(parameters::plot(comparison));
    Ok(plots)
}
