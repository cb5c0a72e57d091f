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
            theta[place] = values[old];
            carried[place] = true;
        }
    }
    carried
}
