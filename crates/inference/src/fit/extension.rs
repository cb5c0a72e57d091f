//! Writes the result of a fit into the muscle. Effects that change its shape go into its own numbers, all
//! others into tables of their own.

use bulge_effects::{Group, learnt};
use bulge_model::{Chosen, Model, ModelError, ModelParameter};
use bulge_muscles::{Dimension, FittedNumber, FittedNumbers, LearntValue, Muscle, Parameter, units};

use crate::fit::document::{Fit, Fitted};

/// Quantile 0.975 of the normal distribution, at the ends of a 95 % interval.
const NORMAL: f64 = 1.959_964;

/// A muscle with the result of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Extension {
    /// The muscle; [`bulge_muscles::to_toml`] writes it, and [`bulge_effects::known`] reads its effects.
    pub muscle: Muscle,
    /// Effects whose parameters the muscle now states.
    pub written: Vec<String>,
    /// Effects that a muscle file can't state, with the reason.
    pub left_out: Vec<(String, &'static str)>,
}

/// The muscle of a fitted model with the fitted effects.
///
/// Rig errors that were fitted as noise within the data sheets are not carried over, because the next data
/// set has its own. Effects of single specimens have no place in the muscle file. The standard deviation of a
/// parameter is half its 95 % interval over 1.96; the value is rounded to a thousandth of the standard
/// deviation.
///
/// # Errors
/// If the muscle can't have an effect with these parameters.
pub fn extended(model: &Model, fit: &Fit) -> Result<Extension, ModelError> {
    let mut extension =
        Extension { muscle: model.muscle().clone(), written: Vec::new(), left_out: Vec::new() };
    for chosen in model.effects() {
        let card = chosen.effect.card();
        let name = card.name.to_owned();
        if chosen.fixed {
            // The muscle states this effect already, with its widths.
            continue;
        }
        if model.copies(chosen.effect.as_ref()) > 1 || card.group == Group::Specimen {
            extension.left_out.push((name, "it belongs to single specimens, not to the muscle"));
            continue;
        }
        let places: Vec<usize> =
            (0..model.parameters().len()).filter(|i| model.parameters()[*i].effect == name).collect();
        let nuisance = |i: &usize| fitted(model, fit, *i).is_some_and(|(_, found)| found.nuisance);
        if places.iter().any(nuisance) {
            let why = if card.group == Group::Rig {
                "it is an error of the rig, which the next data set has anew"
            } else {
                "the muscle file states it with a width (`+-`), and keeps its own value"
            };
            extension.left_out.push((name, why));
            continue;
        }
        let (numbers, widths): (Vec<f64>, Vec<Option<f64>>) =
            places.iter().map(|i| stated(model, fit, *i)).unzip();
        extension.muscle = put(&extension.muscle, chosen, &numbers, &widths)?;
        extension.written.push(name);
    }
    let fitted = fitted_numbers(model, fit, &extension.written);
    extension.muscle = extension.muscle.with_fitted(fitted);
    Ok(extension)
}

/// The uncertainty of the effects that were written, and that of the others as the muscle file stated it
/// before. The latter stays as it was.
fn fitted_numbers(model: &Model, fit: &Fit, written: &[String]) -> FittedNumbers {
    let sources: Vec<usize> = fit.parameters.iter().filter_map(|found| place_of(model, found)).collect();
    let mut own: Vec<usize> = Vec::new();
    let mut numbers: Vec<FittedNumber> = Vec::new();
    for (place, p) in model.parameters().iter().enumerate().filter(|(_, p)| written.contains(&p.effect)) {
        let (si, Some(sd)) = stated(model, fit, place) else { continue };
        let Some(source) = sources.iter().position(|source| *source == p.tied.unwrap_or(place)) else {
            continue;
        };
        let value = LearntValue {
            key: p.key.clone(),
            si,
            dimension: units::unit(&p.unit).map_or(Dimension::NONE, |(_, dimension)| dimension),
            unit: p.unit.clone(),
            width: Some(sd),
        };
        let correlations = own.iter().map(|other| correlation(fit, source, *other)).collect();
        numbers.push(FittedNumber { effect: p.effect.clone(), value, correlations });
        own.push(source);
    }
    let count = numbers.len();
    let before = model.muscle().fitted().cloned().unwrap_or_default();
    let others = before.keeping(|number| !written.contains(&number.effect));
    numbers.extend(others.numbers.into_iter().map(|mut number| {
        number.correlations.splice(0..0, std::iter::repeat_n(0.0, count));
        number
    }));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of rows")]
    let rows = fit.effective_rows.round() as u64;
    FittedNumbers { error_n: units::rounded(fit.rmse_n, 4), rows, numbers }
}

/// The correlation to four digits: a number in a file should not pretend to be exact.
fn correlation(fit: &Fit, one: usize, other: usize) -> f64 {
    let found = fit.correlations.get(one * fit.parameters.len() + other).copied().unwrap_or(0.0);
    if one == other { 1.0 } else { units::rounded(found, 4).clamp(-1.0, 1.0) }
}

/// Index of a fitted parameter in the model.
fn place_of(model: &Model, fitted: &Fitted) -> Option<usize> {
    model
        .parameters()
        .iter()
        .position(|p| fitted.effect == p.effect && fitted.name == p.name && fitted.specimen == p.specimen)
}

/// Value and standard deviation of a parameter \[SI\]. A held parameter has only its value; a tied one takes
/// both from the parameter that it is tied to.
fn stated(model: &Model, fit: &Fit, index: usize) -> (f64, Option<f64>) {
    let Some((source, found)) = fitted(model, fit, index) else { return (fit.theta[index], None) };
    let number = &model.parameters()[source];
    (rounded(fit.theta[source], found, number), width(found).map(|sd| in_si(sd, number)))
}

/// Index and fit of a parameter, or of the one that it is tied to.
fn fitted<'f>(model: &Model, fit: &'f Fit, index: usize) -> Option<(usize, &'f Fitted)> {
    let index = model.parameters()[index].tied.unwrap_or(index);
    let number = &model.parameters()[index];
    let is_it =
        |f: &&Fitted| f.effect == number.effect && f.name == number.name && f.specimen == number.specimen;
    fit.parameters.iter().find(is_it).map(|found| (index, found))
}

/// One standard deviation in the unit shown; none if the interval isn't two-sided (undetermined, or at a
/// bound).
fn width(fitted: &Fitted) -> Option<f64> {
    let sure = fitted.determined && fitted.at_bound.is_none();
    sure.then(|| units::rounded((fitted.high - fitted.low) / (2.0 * NORMAL), 2))
}

/// The value, rounded to a thousandth of its standard deviation, or to nine digits without one: a number in a
/// file should not pretend to be exact.
fn rounded(value: f64, fitted: &Fitted, number: &ModelParameter) -> f64 {
    let shown = value / number.factor;
    let digits = width(fitted).map_or(9.0, |sd| (shown.abs() / sd).log10().ceil() + 3.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 3 and 15")]
    let digits = digits.clamp(3.0, 15.0) as usize;
    in_si(units::rounded(shown, digits), number).clamp(number.low, number.high)
}

/// The value in SI as a reader of the file gets it, so that it is written with as few digits as it was
/// rounded to.
fn in_si(shown: f64, number: &ModelParameter) -> f64 {
    units::any(&format!("{shown} {}", number.unit)).map_or(shown * number.factor, |value| value.si)
}

fn put(
    muscle: &Muscle,
    chosen: &Chosen,
    numbers: &[f64],
    widths: &[Option<f64>],
) -> Result<Muscle, ModelError> {
    let card = chosen.effect.card();
    let about = |source| ModelError::Reshape { effect: card.name.to_owned(), source: Box::new(source) };
    let cards = chosen.effect.parameters();
    let own: Option<Vec<_>> = cards.iter().map(|of| Parameter::of_effect(card.name, of.key)).collect();
    if let Some(own) = own.filter(|own| !own.is_empty()) {
        let stated: Vec<_> = own.into_iter().zip(numbers.iter().copied()).collect();
        // What is absent at 0 is not stated.
        let is_off = stated.iter().any(|(_, value)| *value == 0.0);
        let reshaped = if is_off { muscle.clone() } else { muscle.with_all(&stated).map_err(about)? };
        // In the ratio in which they were while it was fitted.
        return Ok(reshaped.with_specimens_following(muscle));
    }
    let table = learnt(chosen.effect.as_ref(), numbers, widths).map_err(about)?;
    Ok(muscle.clone().with_learnt(table))
}
