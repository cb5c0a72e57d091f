//! Specimens that differ: the data with the lengths of the specimens that the muscle file states.

use bulge_measurements::Data;
use bulge_muscles::shown::{listed, shortened};
use bulge_muscles::{Muscle, Quantity};
use std::borrow::Cow;

use crate::error::InferenceError;

/// The data with the unpressurised lengths of specimens that have their own.
///
/// # Errors
/// If a specimen that the muscle file states wasn't measured, or if a name in the data looks misspelt.
pub(crate) fn of_specimens<'d>(data: &'d Data, muscle: &Muscle) -> Result<Cow<'d, Data>, InferenceError> {
    muscle.check_specimens(data.specimens()).map_err(|error| InferenceError::Specimens(Box::new(error)))?;
    if muscle.specimens().is_empty() {
        return Ok(Cow::Borrowed(data));
    }
    let length = |name: &str| muscle.of_specimen(name).ok().map(|own| own.length().si());
    Ok(Cow::Owned(data.clone().with_lengths(length)))
}

/// The warning about specimens of which the muscle file states nothing.
pub(crate) fn note(data: &Data, muscle: &Muscle) -> Option<String> {
    let others = muscle.check_specimens(data.specimens()).ok().filter(|others| !others.is_empty())?;
    let (is, its) = if others.len() == 1 { ("specimen", "a table") } else { ("specimens", "tables") };
    Some(format!(
        "the muscle as stated stands for the {is} {}, of which nothing else is stated: add {its} such as `[specimens.{}]` if they differ",
        listed(20, "`", &others),
        shortened(others[0])
    ))
}
