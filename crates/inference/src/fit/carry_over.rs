//! Numbers taken over from one model to another one.

use bulge_model::Model;

/// Numbers that two models share start where the first left them; which of them they are.
pub(crate) fn carry_over(from: &Model, values: &[f64], to: &Model, theta: &mut [f64]) -> Vec<bool> {
    let mut carried = vec![false; theta.len()];
    for (place, number) in to.parameters().iter().enumerate() {
        let same = |other: &bulge_model::ModelParameter| {
            other.effect == number.effect && other.name == number.name && other.specimen == number.specimen
        };
        if let Some(old) = from.parameters().iter().position(same) {
            // What is known or held in the one may have been fitted in the other.
            theta[place] =
                if number.fixed { number.value } else { values[old].clamp(number.low, number.high) };
            carried[place] = true;
        }
    }
    let tied = to.with_ties(theta).into_owned();
    theta.copy_from_slice(&tied);
    carried
}
