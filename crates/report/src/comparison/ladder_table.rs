//! The ladder of errors as rows of a table.

use bulge_inference::{Comparison, Rung};
use serde::Serialize;

use crate::comparison::number::{share, signed_newton, three};

/// One row, with forces in N.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    title: String,
    added: String,
    rmse: String,
    percent: String,
    bias: String,
    largest: String,
    held_out: String,
    half_gap: String,
    r_squared: String,
    fitted: usize,
}

/// All rungs.
pub(super) fn rows(comparison: &Comparison) -> Vec<Row> {
    comparison.ladder.iter().map(row).collect()
}

fn row(rung: &Rung) -> Row {
    let optional = |error: Option<f64>| error.map_or_else(|| "–".to_owned(), three);
    Row {
        title: rung.title.clone(),
        added: rung.added.clone().unwrap_or_default(),
        rmse: three(rung.rmse_n),
        percent: three(rung.rmse_percent),
        bias: signed_newton(rung.bias_n).trim_end_matches(" N").to_owned(),
        largest: three(rung.largest_n),
        held_out: optional(rung.held_out_rmse_n),
        half_gap: optional(rung.half_gap_rmse_n),
        r_squared: share(rung.r_squared),
        fitted: rung.fitted,
    }
}
