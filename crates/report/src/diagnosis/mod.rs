//! The report of a diagnosis: one self-contained page, each of its plots, and the sentences that it shares
//! with the command line.
//!
//! ```text
//! html(&diagnosis)?      -> report.html, without network or fonts of its own; its plots of rows are interactive
//! plots(&diagnosis)?     -> NAME.svg for each plot
//! headlines(&diagnosis)  -> the verdict in plain words
//! ```
//!
//! All numbers come from the diagnosis: nothing is fitted or predicted here. A misfit is measured - model
//! throughout.

mod asides;
mod bent;
mod candidates;
mod check;
mod explained;
mod headline;
mod limits;
mod located;
mod multiples;
mod next;
mod page;
mod remaining;
mod rivals;
mod steps;
mod words;

use bulge_inference::Diagnosis;

use crate::PlotError;
use crate::comparison::Plot;

pub use headline::{bending_says, forms_says, further, headlines, others_in_class};
pub use next::{NextDocument, NextStep};
pub use words::{base_name, chance, found_by, is_significant, noise_says, once_in, remains_says, step_name};

/// The page: one HTML document with the verdict, all plots and tables, readable on screen and on paper.
///
/// # Errors
/// A number isn't finite, lists that should have the same length don't, or the range of the values on an axis
/// overflows.
///
/// # Examples
/// ```
/// use bulge_inference::Diagnosis;
/// use bulge_report::diagnosis::{headlines, html, plots};
///
/// /// The verdict on the screen, the page and its plots as files.
/// fn write(diagnosis: &Diagnosis, folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
///     println!("{}", headlines(diagnosis).join("\n"));
///     std::fs::write(folder.join("report.html"), html(diagnosis)?)?;
///     for plot in plots(diagnosis)? {
///         std::fs::write(folder.join(plot.name).with_extension("svg"), plot.svg)?;
///     }
///     Ok(())
/// }
/// ```
pub fn html(diagnosis: &Diagnosis) -> Result<String, PlotError> {
    check::check(diagnosis)?;
    page::render(diagnosis)
}

/// The plots for which there are numbers, in the order of the page: the plots of the diagnosis, then those of
/// its comparison.
///
/// # Errors
/// As [`html`].
pub fn plots(diagnosis: &Diagnosis) -> Result<Vec<Plot>, PlotError> {
    check::check(diagnosis)?;
    let mut plots: Vec<Plot> = Vec::new();
    plots.extend(steps::plot(diagnosis)?);
    plots.extend(explained::plots(diagnosis)?);
    plots.extend(bent::with_sentences(diagnosis)?.into_iter().map(|(plot, _)| plot));
    plots.extend(candidates::plot(diagnosis)?);
    plots.extend(rivals::plot(diagnosis)?);
    plots.extend(located::plot(diagnosis)?);
    plots.extend(remaining::plot(diagnosis)?);
    // Both have a ladder; the one of the diagnosis is kept.
    let shown = crate::comparison::plots(&diagnosis.comparison)?;
    plots.extend(shown.into_iter().filter(|plot| plot.name != "ladder"));
    Ok(plots)
}
