//! Uncertainty of a muscle: the parameters that a fit gave it, and those that data sheets and stated widths
//! leave open.

use bulge_effects::{Catalogue, Known};
use bulge_model::{Model, ModelParameter};
use bulge_muscles::{FittedNumber, FittedNumbers, Muscle, Parameter};

use crate::error::InferenceError;
use crate::fit::nuisance::{known_model, with_nuisances};

/// Relative difference allowed between a fitted value and that of its effect: the digits of a file.
const SAME: f64 = 1e-9;

/// A muscle with its effects as a model, and the covariance of its uncertain parameters.
pub(crate) struct Uncertain {
    pub(crate) model: Model,
    pub(crate) theta: Vec<f64>,
    /// Indices of the uncertain parameters in the model.
    pub(crate) places: Vec<usize>,
    /// Whether each comes from a fit.
    pub(crate) is_fitted: Vec<bool>,
    /// Their standard deviations \[SI\].
    pub(crate) sd: Vec<f64>,
    /// Their correlations, row by row.
    pub(crate) correlations: Vec<f64>,
    pub(crate) warnings: Vec<String>,
}

impl Uncertain {
    /// The uncertainty of a muscle with the effects that its file states.
    pub(crate) fn of(
        muscle: &Muscle,
        known: &[Known],
        catalogue: &Catalogue,
        specimens: &[String],
    ) -> Result<Self, InferenceError> {
        let mut model = known_model(muscle, known, specimens)?;
        let mut warnings = Vec::new();
        let fitted = muscle.fitted().cloned().unwrap_or_default();
        for name in shapes(&fitted) {
            match with_shape(&model, muscle, catalogue, name) {
                Some(with) => model = with,
                None => warnings.push(unfollowed(name)),
            }
        }
        let prepared = with_nuisances(&model, catalogue)?;
        let (model, theta) = (&prepared.model, prepared.start());
        let place = |number: &FittedNumber| {
            model.parameters().iter().position(|p| p.effect == number.effect && p.key == number.value.key)
        };
        let is_same = |place: usize, number: &FittedNumber| {
            (theta[place] - number.value.si).abs() <= SAME * number.value.si.abs()
        };
        let mut places = Vec::new();
        let mut kept = Vec::new();
        for number in &fitted.numbers {
            match place(number) {
                Some(at) if is_same(at, number) => {
                    places.push(at);
                    kept.push(number);
                }
                Some(at) => return Err(other_value(number, &model.parameters()[at], theta[at])),
                None if shapes(&fitted).contains(&number.effect.as_str()) => {}
                None => {
                    return Err(wrong(number, "the muscle states no such effect or number".to_owned()));
                }
            }
        }
        let sure = fitted.keeping(|number| kept.iter().any(|kept| std::ptr::eq(*kept, number)));
        let count = places.len();
        let mut sd: Vec<f64> = (0..count).map(|place| sure.sd(place)).collect();
        for (at, prior) in prepared.priors.iter().enumerate() {
            // A fitted parameter is in the list already; its fit has used the prior.
            if let Some((_, width)) = prior.filter(|_| prepared.nuisance[at] && !places.contains(&at)) {
                places.push(at);
                sd.push(width);
            }
        }
        let all = places.len();
        let correlation = |one: usize, other: usize| match (one < count, other < count) {
            (true, true) => sure.correlation(one, other),
            _ => f64::from(u8::from(one == other)),
        };
        let correlations = (0..all * all).map(|at| correlation(at / all, at % all)).collect();
        let is_fitted = (0..all).map(|place| place < count).collect();
        let model = prepared.model.clone();
        Ok(Self { model, theta, places, is_fitted, sd, correlations, warnings })
    }

    /// Variance of the force of a row \[N^2\], from its derivatives.
    pub(crate) fn variance(&self, slopes: &[f64]) -> f64 {
        let k = self.places.len();
        let moves: Vec<f64> = slopes.iter().zip(&self.sd).map(|(slope, sd)| slope * sd).collect();
        let row = |i: usize| (0..k).map(|j| self.correlations[i * k + j] * moves[j]).sum::<f64>();
        // Correlations rounded to few digits may make the sum slightly negative.
        moves.iter().enumerate().map(|(i, own)| own * row(i)).sum::<f64>().max(0.0)
    }
}

/// Fitted effects that went into the muscle's own numbers.
fn shapes(fitted: &FittedNumbers) -> Vec<&str> {
    let is_fitted = |name: &&str| fitted.numbers.iter().any(|number| number.effect == *name);
    Parameter::effects().filter(is_fitted).collect()
}

/// The model with a shape effect at the muscle's own numbers, where it changes nothing; none if these can't
/// be found.
fn with_shape(model: &Model, muscle: &Muscle, catalogue: &Catalogue, name: &str) -> Option<Model> {
    let effect = catalogue.find(name).ok()?;
    let own = |key: &str| muscle.get(Parameter::of_effect(name, key)?);
    let values: Vec<f64> = effect.parameters().iter().map(|card| own(card.key)).collect::<Option<_>>()?;
    (effect.reshaped(&values, muscle).ok()? == muscle.into()).then_some(())?;
    model.with(effect, Some(&values)).ok()
}

fn unfollowed(name: &str) -> String {
    format!(
        "the doubt about `{name}` isn't in the intervals: its numbers can't be told from those of the muscle"
    )
}

fn wrong(number: &FittedNumber, why: String) -> InferenceError {
    InferenceError::Fitted { number: format!("{}.{}", number.effect, number.value.key), why }
}

fn other_value(number: &FittedNumber, p: &ModelParameter, value: f64) -> InferenceError {
    let shown = |si: f64| format!("{} {}", bulge_muscles::units::rounded(p.shown(si), 9), p.unit);
    wrong(number, format!("it is {} there, and {} in its effect", shown(number.value.si), shown(value)))
}
