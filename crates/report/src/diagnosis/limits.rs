//! Detection limits of these data as rows of a table.

use bulge_inference::{CandidateResult, Diagnosis};
use serde::Serialize;

use crate::comparison::number::{count, three};

/// One row.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    effect: String,
    status: &'static str,
    limit: String,
    limit_n: String,
    compensation: String,
    score: String,
}

/// Effects that could be tested, in the order of their names in the catalogue.
pub(super) fn rows(diagnosis: &Diagnosis) -> Vec<Row> {
    let mut rows: Vec<Row> = limited(diagnosis).map(row).collect();
    rows.sort_by(|a, b| a.effect.cmp(&b.effect));
    rows
}

fn limited(diagnosis: &Diagnosis) -> impl Iterator<Item = &CandidateResult> {
    diagnosis.candidates.iter().filter(|c| c.detection_limit.is_some())
}

fn row(candidate: &CandidateResult) -> Row {
    let unit = if candidate.unit == "1" { "" } else { &candidate.unit };
    let limit = candidate.detection_limit.map_or_else(|| "–".to_owned(), three);
    Row {
        effect: candidate.effect.clone(),
        status: candidate.status,
        limit: format!("{limit} {unit}").trim_end().to_owned(),
        limit_n: candidate.detection_limit_n.map_or_else(|| "–".to_owned(), three),
        compensation: format!("{:.0} %", 100.0 * candidate.compensation.clamp(0.0, 1.0)),
        score: three(candidate.score.max(0.0).sqrt()),
    }
}

/// The sentence above the table.
pub(super) fn says(diagnosis: &Diagnosis) -> String {
    match limited(diagnosis).count() {
        0 => "These data set no limit to any effect.".to_owned(),
        n => format!(
            "Each of these {} would have been noticed if it were larger than its limit; what is smaller may be there unseen.",
            count(n, "effect")
        ),
    }
}
