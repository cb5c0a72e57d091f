//! How the fit ended.

use bulge_inference::Comparison;

use crate::comparison::number::{count, newton, three};
use crate::comparison::wording::last_fit;

/// The sentence above the table; empty if nothing was fitted.
pub(super) fn says(comparison: &Comparison) -> String {
    let Some(fit) = last_fit(comparison) else { return String::new() };
    let end = &fit.convergence;
    if !end.converged {
        return format!(
            "The search did not end in a minimum ({}): the fitted numbers are not to be relied on.",
            end.reason
        );
    }
    let agreeing = if end.starts > 1 {
        format!(": {} of {} starting points lead to it", end.agreeing, end.starts)
    } else {
        String::new()
    };
    let others = match end.minima {
        0 | 1 => "no other minimum was seen".to_owned(),
        2 => "another minimum with a larger error was seen as well".to_owned(),
        n => format!("{} other minima with larger errors were seen as well", n - 1),
    };
    format!("The search ended in a minimum{agreeing}, and {others}.")
}

/// Names and values.
pub(super) fn facts(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let Some(fit) = last_fit(comparison) else { return Vec::new() };
    let end = &fit.convergence;
    vec![
        ("why it stopped", end.reason.clone()),
        ("gradient (0 at a minimum)", format!("largest cosine {}", three(end.gradient_cosine))),
        ("iterations", end.iterations.to_string()),
        ("starting points", format!("{}, of which {} agree", end.starts, end.agreeing)),
        ("determined", format!("{} of {}", end.rank, count(fit.parameters.len(), "number"))),
        ("weight of a reading", format!("standard deviation {}", newton(fit.sd_n))),
        ("independent rows", format!("{} (neighbours in a sweep err alike)", three(fit.effective_rows))),
    ]
}
