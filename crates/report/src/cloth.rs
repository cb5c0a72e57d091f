//! The effect of a muscle's cloth, learnt from the states of a membrane case.

use bulge_effects::{Catalogue, CatalogueError};
use bulge_inference::{Fit, Fitting, InferenceError, Options, fit_effects};
use bulge_measurements::{Data, MeasurementError};
use bulge_membrane::case::{Case, Row, forces_csv};
use bulge_muscles::units::significant;
use bulge_muscles::{Fault, Muscle};
use serde::Serialize;
use std::sync::Arc;

use crate::learning::{LearningError, Learnt};

/// Largest relative difference between the fitted radius and the radius of the cloth without a fold: lobes
/// become taut a little before it.
const NEAR: f64 = 0.2;

/// Why nothing is learnt from the states of a case.
#[derive(Debug, thiserror::Error)]
pub enum ClothError {
    /// The case, or its states, have nothing to learn from.
    #[error("--as-effect: {0}")]
    Case(&'static str),
    /// The fit describes something else than the cloth.
    #[error("--as-effect: {0}")]
    Other(String),
    /// The effect isn't among the built-in ones.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The states can't be read as measurements.
    #[error(transparent)]
    Measurements(#[from] MeasurementError),
    /// The fit fails.
    #[error(transparent)]
    Fit(#[from] InferenceError),
    /// Its result can't be used.
    #[error(transparent)]
    Learning(#[from] LearningError),
}

impl ClothError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Case(_) | Self::Catalogue(_) | Self::Measurements(_) => Fault::Input,
            Self::Other(_) => Fault::NoSolution,
            Self::Fit(error) => error.fault(),
            Self::Learning(error) => error.fault(),
        }
    }
}

/// What a run's document says of the learnt effect.
#[derive(Debug, Serialize)]
pub struct ClothDocument<'a> {
    before_rmse_n: f64,
    rmse_n: f64,
    fit: &'a Fit,
    model: &'a str,
}

impl<'a> ClothDocument<'a> {
    /// Of a fit.
    #[must_use]
    pub fn of(learnt: &'a Learnt) -> Self {
        let Fitting { before_rmse_n, rmse_n, fit, .. } = &learnt.fitting;
        Self { before_rmse_n: *before_rmse_n, rmse_n: *rmse_n, fit, model: &learnt.model }
    }
}

/// The muscle whose effect of the cloth can be fitted to a case.
///
/// # Errors
/// [`ClothError::Case`] if it has none.
pub fn muscle(case: &Case) -> Result<&Muscle, ClothError> {
    let is_shortened = case
        .steps
        .iter()
        .any(|step| step.contraction.is_some() || step.fittings.iter().flatten().next().is_some());
    match &case.muscle {
        Some(muscle) if muscle.is_pleated() && is_shortened => Ok(muscle),
        _ => Err(ClothError::Case(
            "the case needs a pleated muscle (`muscle` in `[mesher]`) and steps with a `contraction`",
        )),
    }
}

/// The muscle of a case with the effect of its cloth, `limited-unfolding`, fitted to the states; `origin` is
/// what messages call these.
///
/// # Errors
/// [`ClothError`].
pub fn learn(case: &Case, states: &[Row], origin: &str) -> Result<Learnt, ClothError> {
    let muscle = muscle(case)?;
    let forces = forces_csv(states).ok_or(ClothError::Case(
        "no state has a pressure and a contraction: there is nothing to learn from",
    ))?;
    let catalogue = Catalogue::builtin();
    let effects = vec![Arc::clone(catalogue.find("limited-unfolding")?)];
    let data = Data::from_csv(&forces, origin)?;
    let learnt = Learnt::of(fit_effects(&data, muscle, &Options::new(catalogue, effects))?)?;
    is_the_cloth(case, &learnt.fitting)?;
    Ok(learnt)
}

/// Rejects a fit that describes something else: the cloth must be unfolded at the fitted radius.
fn is_the_cloth(case: &Case, fitting: &Fitting) -> Result<(), ClothError> {
    let radius = fitting.fit.parameters.iter().find(|parameter| parameter.name == "unfolded_radius");
    let (Some(cloth), Some(radius)) = (case.unfolded_radius.map(|radius| 1e3 * radius), radius) else {
        return Ok(());
    };
    if (radius.value / cloth - 1.0).abs() <= NEAR {
        return Ok(());
    }
    Err(ClothError::Other(format!(
        "nothing is written: fitted to these states (error {} N, before {} N), limited unfolding would act from {} mm on, but the cloth \
         has no fold left at {} mm only (forces.csv stands). What costs force before that are the lobes between the fibres: contract further, or compare forces.csv with a \
         muscle that states `[effects.lobes]`",
        significant(fitting.rmse_n, 3),
        significant(fitting.before_rmse_n, 3),
        significant(radius.value, 4),
        significant(cloth, 4),
    )))
}
