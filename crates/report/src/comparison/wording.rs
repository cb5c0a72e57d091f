//! Words that several sections share: which side an error lies on, and from which size on it is worth a word.

use bulge_inference::{Comparison, Fit};

use crate::comparison::number::newton;

/// Whether effects were added, so that there is a before and an after.
pub(super) fn has_effects(comparison: &Comparison) -> bool {
    comparison.ladder.len() > 1
}

/// The model on the last rung, in a sentence.
pub(super) fn last_model(comparison: &Comparison) -> &'static str {
    if has_effects(comparison) { "the model with all effects" } else { "the base" }
}

/// Names of the first and the last rung in legends.
pub(super) fn names(comparison: &Comparison) -> Vec<&'static str> {
    if has_effects(comparison) { vec!["base alone", "with all effects"] } else { vec!["base alone"] }
}

/// `pulls 41 N too hard` for a mean error measured - model of -41 N.
pub(super) fn pulls(error_n: f64) -> String {
    let side = if error_n < 0.0 { "too hard" } else { "too weakly" };
    format!("pulls {} {side}", newton(error_n.abs()))
}

/// An error below this isn't worth a word \[N\]: the noise floor, or half a per cent of full scale where there is none.
pub(super) fn negligible_n(comparison: &Comparison) -> f64 {
    comparison.noise_floor.as_ref().map_or(0.005 * comparison.data.full_scale_n.abs(), |floor| floor.sd_n)
}

/// The fit of the last rung that has one.
pub(super) fn last_fit(comparison: &Comparison) -> Option<&Fit> {
    comparison.ladder.iter().rev().find_map(|rung| rung.fit.as_ref())
}

/// A first letter as at the beginning of a sentence.
pub(super) fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_error_means_that_the_model_pulls_too_hard() {
        assert_eq!([pulls(-41.04), pulls(3.0)], ["pulls 41.0 N too hard", "pulls 3.00 N too weakly"]);
        assert_eq!(sentence("the base"), "The base");
    }
}
