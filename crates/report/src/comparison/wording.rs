//! Wording that several sections share: the sign of an error, and the size from which an error is mentioned.

use bulge_inference::{Comparison, Fit};

use crate::comparison::number::newton;

/// Whether effects were added, so that there is a before and an after.
pub(crate) fn has_effects(comparison: &Comparison) -> bool {
    comparison.ladder.len() > 1
}

/// The model on the last rung, in words.
pub(super) fn last_model(comparison: &Comparison) -> &'static str {
    if has_effects(comparison) { "the model with all effects" } else { "the base" }
}

/// Names of the first and the last rung in legends.
pub(super) fn names(comparison: &Comparison) -> Vec<&'static str> {
    if has_effects(comparison) { vec!["base alone", "with all effects"] } else { vec!["base alone"] }
}

/// `pulls 41 N too hard` for a mean error measured - model of -41 N.
pub(super) fn pulls(error_n: f64) -> String {
    if newton(error_n) == newton(0.0) {
        return "pulls as hard as the muscle".to_owned();
    }
    let side = if error_n < 0.0 { "too hard" } else { "too weakly" };
    format!("pulls {} {side}", newton(error_n.abs()))
}

/// Errors below this are not mentioned \[N\]: the noise floor, or half a per cent of full scale if there is
/// none.
pub(super) fn negligible_n(comparison: &Comparison) -> f64 {
    comparison.noise_floor.as_ref().map_or(0.005 * comparison.data.full_scale_n.abs(), |floor| floor.sd_n)
}

/// The fit of the last rung that fitted anything.
pub(super) fn last_fit(comparison: &Comparison) -> Option<&Fit> {
    let mut fits = comparison.ladder.iter().rev().filter_map(|rung| rung.fit.as_ref());
    fits.find(|fit| !fit.parameters.is_empty())
}

/// `specimen A`, `sweep “3, after the break”`: a name of several words is quoted.
pub(super) fn named(what: &str, name: &str) -> String {
    let is_one_word = name.chars().all(|c| c.is_alphanumeric() || c == '-' || c == '_');
    if is_one_word { format!("{what} {name}") } else { format!("{what} “{}”", name.trim()) }
}

/// The title of an effect, or its name if no rung has it.
pub(crate) fn effect_title<'a>(comparison: &'a Comparison, effect: &'a str) -> &'a str {
    let rung = comparison.ladder.iter().find(|rung| rung.added.as_deref() == Some(effect));
    rung.map_or(effect, |rung| &rung.title)
}

/// The words with a capital first letter.
pub(crate) fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_error_means_that_the_model_pulls_too_hard() {
        assert_eq!([pulls(-41.04), pulls(3.0)], ["pulls 41.0 N too hard", "pulls 3.00 N too weakly"]);
        assert_eq!(pulls(-0.0), "pulls as hard as the muscle");
        assert_eq!(sentence("the base"), "The base");
    }

    #[test]
    fn names_of_several_words_stand_in_quotes() {
        let shown = ["A", "run-3", "3, after the break "].map(|name| named("sweep", name));
        assert_eq!(shown, ["sweep A", "sweep run-3", "sweep “3, after the break”"]);
    }
}
