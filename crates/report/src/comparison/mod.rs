//! The report of a comparison: one self-contained page, and each of its plots.
//!
//! ```text
//! html(&comparison, rows)?  -> report.html, without network or fonts of its own; with rows also interactive plots
//! plots(&comparison)?       -> NAME.svg for each plot
//! ```
//!
//! All numbers come from the comparison: nothing is fitted or predicted here. Errors are measured - model
//! throughout, so a positive error means that the model pulls too weakly.

mod breakdown;
pub(crate) mod check;
mod contributions;
mod convergence;
mod correlations;
pub(crate) mod data;
mod force;
mod headline;
mod held_length;
mod isotonic;
pub(crate) mod ladder;
mod ladder_table;
pub(crate) mod legend;
pub(crate) mod levels;
mod loops;
pub(crate) mod number;
pub(crate) mod page;
pub(crate) mod panel;
mod parameters;
mod parameters_table;
mod residual_map;
mod rivals;
mod scatter;
pub(crate) mod svg;
pub(crate) mod wording;

use bulge_inference::{Comparison, Rows};
use serde::Serialize;

use crate::PlotError;

/// Width of every plot \[px\].
pub(crate) const WIDTH: f64 = 920.0;

/// One plot of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Plot {
    /// Stem of its file name.
    pub name: &'static str,
    /// What the plot shows, in a few words.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The drawing as a self-contained SVG document.
    pub svg: String,
}

/// The page: one HTML document with all plots and tables, readable on screen and on paper.
///
/// With the rows of all rungs ([`bulge_inference::compare_with_rows`]) the page shows them in plots that
/// zoom, give the line of a row in its file, and switch between the rungs. Without scripts static drawings
/// take the place of these plots.
///
/// # Errors
/// A number isn't finite, lists that should have the same length don't, or the range of the values on an axis
/// overflows.
///
/// # Examples
/// A base without effects that is off by 41 N:
/// ```
/// use bulge_inference::{Comparison, DataSummary, Rung};
/// use bulge_report::comparison::html;
///
/// let comparison = Comparison {
///     muscle: "Braided muscle <20 mm>".to_owned(),
///     data: DataSummary { rows: 2, used: 2, force_n: [0.0, 800.0], full_scale_n: 800.0, ..DataSummary::default() },
///     ladder: vec![Rung { rmse_n: 41.0, rmse_percent: 5.1, bias_n: -38.0, ..Rung::default() }],
///     scatter: vec![[100.0, 130.0, 130.0], [800.0, 841.0, 841.0]],
///     ..Comparison::default()
/// };
/// let page = html(&comparison, None)?;
/// assert!(page.contains("The base alone misses the measured force by 41.0 N (5.10 % of full scale)."));
/// // Names are text, whatever they look like.
/// assert!(page.contains("Braided muscle &lt;20 mm&gt;"));
/// # Ok::<(), bulge_report::PlotError>(())
/// ```
pub fn html(comparison: &Comparison, rows: Option<&Rows>) -> Result<String, PlotError> {
    check::check(comparison)?;
    page::render(comparison, rows)
}

/// The plots for which there are data, in the order of the page.
///
/// # Errors
/// As [`html`].
///
/// # Examples
/// ```
/// use bulge_inference::{Comparison, Rows};
/// use bulge_report::comparison::plots;
///
/// /// The page and its plots as files.
/// fn write(comparison: &Comparison, rows: &Rows, folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
///     std::fs::write(folder.join("report.html"), bulge_report::comparison::html(comparison, Some(rows))?)?;
///     for plot in plots(comparison)? {
///         std::fs::write(folder.join(plot.name).with_extension("svg"), plot.svg)?;
///     }
///     Ok(())
/// }
/// ```
pub fn plots(comparison: &Comparison) -> Result<Vec<Plot>, PlotError> {
    check::check(comparison)?;
    let mut plots = Vec::new();
    plots.extend(ladder::plot(comparison)?);
    plots.extend(force::plot(comparison)?);
    plots.extend(breakdown::plots(comparison)?);
    plots.extend(residual_map::plot(comparison)?);
    plots.extend(loops::plot(comparison)?);
    plots.extend(isotonic::plot(comparison)?);
    plots.extend(contributions::plot(comparison)?);
    plots.extend(scatter::plot(comparison)?);
    plots.extend(parameters::plot(comparison));
    Ok(plots)
}
