//! Force laws of the literature on the same data, beside the model.

use bulge_inference::Comparison;
use serde::Serialize;

use crate::comparison::number::{newton, three};
use crate::comparison::wording::{last_model, sentence};

/// One row, with forces in N.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    title: String,
    law: String,
    printed: String,
    rmse: String,
    percent: String,
    held_out: String,
    fitted: String,
    failed: String,
    /// Whether it is the model of this page.
    own: bool,
}

/// The laws and the last rung, smallest error first; laws that could not be fitted come last. Empty without
/// laws.
pub(super) fn rows(comparison: &Comparison) -> Vec<Row> {
    if comparison.rivals.is_empty() {
        return Vec::new();
    }
    let optional = |error: Option<f64>| error.map_or_else(|| "–".to_owned(), three);
    let laws = comparison.rivals.iter().map(|rival| {
        let shown = |text: String| if rival.failed.is_none() { text } else { "–".to_owned() };
        let row = Row {
            title: rival.title.clone(),
            law: rival.law.clone(),
            printed: optional(rival.printed_rmse_n),
            rmse: shown(three(rival.rmse_n)),
            percent: shown(three(rival.rmse_percent)),
            held_out: shown(optional(rival.held_out_rmse_n)),
            fitted: shown(rival.fitted.to_string()),
            failed: rival.failed.clone().unwrap_or_default(),
            own: false,
        };
        (if rival.failed.is_none() { rival.rmse_n } else { f64::INFINITY }, row)
    });
    let own = comparison.ladder.last().map(|rung| {
        let row = Row {
            title: sentence(last_model(comparison)),
            law: comparison.base.clone(),
            printed: "–".to_owned(),
            rmse: three(rung.rmse_n),
            percent: three(rung.rmse_percent),
            held_out: optional(rung.held_out_rmse_n),
            fitted: rung.fitted.to_string(),
            failed: String::new(),
            own: true,
        };
        (rung.rmse_n, row)
    });
    let mut rows: Vec<(f64, Row)> = laws.chain(own).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.into_iter().map(|(_, row)| row).collect()
}

/// The sentence above the table.
pub(super) fn says(comparison: &Comparison) -> String {
    let fitted = comparison.rivals.iter().filter(|rival| rival.failed.is_none());
    let Some(best) = fitted.min_by(|a, b| a.rmse_n.total_cmp(&b.rmse_n)) else {
        return "None of the laws could be fitted to these data.".to_owned();
    };
    let own = comparison.ladder.last().map_or_else(String::new, |rung| {
        let against = if rung.rmse_n <= best.rmse_n { "which is less" } else { "which is more" };
        format!("; {} has {}, {against}", last_model(comparison), newton(rung.rmse_n))
    });
    format!(
        "Of the published force laws, “{}” follows these data best, with an error of {} after fitting its own numbers{own}.",
        best.title,
        newton(best.rmse_n)
    )
}
