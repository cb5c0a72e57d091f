//! Parts of the sentences in error messages.

use crate::error::MeasurementError;
use bulge_muscles::units::UnitError;

/// Complaints, each on a line of its own.
pub(crate) fn bulleted(complaints: &[MeasurementError], more: usize) -> String {
    let mut lines: Vec<String> = complaints.iter().map(|complaint| format!("\n  {complaint}")).collect();
    if more > 0 {
        lines.push(format!("\n  and {more} more"));
    }
    lines.concat()
}

/// The problem with the unit of a heading, as a continuation of "column `..`".
pub(crate) fn of_unit(problem: &UnitError) -> String {
    match problem {
        UnitError::NoUnit { wanted, .. } => format!("has no unit (known: {})", wanted.symbols()),
        UnitError::UnknownUnit { unit, suggestion, wanted, .. } => {
            let question =
                suggestion.map_or_else(String::new, |symbol| format!(": did you mean `{symbol}`?"));
            format!("has the unknown unit `{unit}`{question} (known: {})", wanted.symbols())
        }
        UnitError::OtherDimension { found, wanted, .. } => {
            format!("has a unit of {found} where one of {} is needed", wanted.quantity)
        }
        other => format!("has a unit that can't be read ({other})"),
    }
}

/// The remedy for a row whose number of fields differs from the header's.
pub(crate) fn ragged_cure(found: usize, expected: usize) -> &'static str {
    if found >= 2 * expected - 1 && expected > 1 {
        "if its numbers have decimal commas, write decimal points; else remove the surplus separators"
    } else if found > expected {
        "remove the surplus separators, or quote a text that holds one"
    } else {
        "write every field of the row, or remove the row"
    }
}
