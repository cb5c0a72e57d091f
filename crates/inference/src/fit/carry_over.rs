//! Transfer of parameter values from one model to another.

use bulge_model::Model;

/// Starts the parameters that two models share at their values in the first model. Returns which of them are
/// shared.
pub(crate) fn carry_over(from: &Model, values: &[f64], to: &Model, theta: &mut [f64]) -> Vec<bool> {
    let mut carried = vec![false; theta.len()];
    for (place, number) in to.parameters().iter().enumerate() {
        let same = |other: &bulge_model::ModelParameter| {
            other.effect == number.effect && other.name == number.name && other.specimen == number.specimen
        };
        if let Some(old) = from.parameters().iter().position(same) {
            // A parameter that is held in the new model may have been fitted in the old one.
            theta[place] =
                if number.fixed { number.value } else { values[old].clamp(number.low, number.high) };
            carried[place] = true;
        }
    }
    let tied = to.with_ties(theta).into_owned();
    theta.copy_from_slice(&tied);
    carried
}
