//! Pairs of fitted parameters that the data can't separate.

use bulge_inference::Comparison;
use serde::Serialize;

use crate::comparison::number::{count, three};
use crate::comparison::parameters_table::label;
use crate::comparison::wording::last_fit;

/// Pairs with at least this correlation are listed.
pub(super) const HIGH: f64 = 0.9;
/// Most pairs listed.
const MOST: usize = 30;

/// One correlated pair.
#[derive(Debug, Serialize)]
pub(super) struct Pair {
    first: String,
    second: String,
    correlation: String,
    #[serde(skip)]
    size: f64,
}

/// Pairs with |r| > 0.9, strongest correlation first, and their total number.
pub(super) fn pairs(comparison: &Comparison) -> (Vec<Pair>, usize) {
    let Some(fit) = last_fit(comparison) else { return (Vec::new(), 0) };
    let n = fit.parameters.len();
    let mut pairs = Vec::new();
    for (i, first) in fit.parameters.iter().enumerate() {
        for (j, second) in fit.parameters.iter().enumerate().skip(i + 1) {
            let Some(r) = fit.correlations.get(i * n + j).filter(|r| r.abs() > HIGH) else { continue };
            let correlation = three(*r);
            pairs.push(Pair { first: label(first), second: label(second), correlation, size: r.abs() });
        }
    }
    pairs.sort_by(|a, b| b.size.total_cmp(&a.size));
    let all = pairs.len();
    pairs.truncate(MOST);
    (pairs, all)
}

/// The sentence above the table.
pub(super) fn says(pairs: &[Pair], all: usize) -> String {
    let Some(first) = pairs.first() else { return String::new() };
    let more =
        if all > pairs.len() { format!(" The {} nearest are listed.", pairs.len()) } else { String::new() };
    let (these, move_) = if all == 1 { ("1 pair".to_owned(), "moves") } else { (count(all, "pair"), "move") };
    format!(
        "{these} of numbers {move_} together, first of all “{}” and “{}” (r = {}): if one is changed, the other makes up for it, so \
         neither can be believed on its own.{more}",
        first.first, first.second, first.correlation
    )
}
