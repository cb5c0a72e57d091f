//! Published force laws on the same data: the error that an empirical fit reaches, and with how many
//! coefficients.

use bulge_effects::law::{LAWS, Law, LawGeometry};
use bulge_model::{Model, Wanted};

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::Rival;
use crate::comparison::residuals;
use crate::error::InferenceError;
use crate::fit::nuisance::Prepared;
use crate::fit::problem::free;
use crate::fit::search::{Task, fit};

/// Every law for this kind of muscle, with its printed coefficients, if there are any, and fitted.
pub(crate) fn laws(analysis: &Analysis<'_>) -> Vec<Rival> {
    // A law for a single pressure can't follow several.
    let isobaric = |law: &Law| law.is_isobaric() && analysis.levels.len() > 1;
    let suits = |law: &&'static Law| law.suits(analysis.muscle.kind()) && !isobaric(law);
    LAWS.iter().filter(suits).map(|law| rival(analysis, law)).collect()
}

fn rival(analysis: &Analysis<'_>, law: &'static Law) -> Rival {
    let geometry = LawGeometry::from(analysis.muscle);
    let table = law.table_for(analysis.muscle.name());
    let start = law.start(&geometry, table);
    let printed = table.and_then(|_| printed_error(analysis, law, &start).ok());
    let mut rival = Rival {
        law: law.name.to_owned(),
        title: law.title.to_owned(),
        printed_rmse_n: printed,
        rmse_n: f64::NAN,
        rmse_percent: f64::NAN,
        held_out_rmse_n: None,
        fitted: 0,
        failed: None,
    };
    match fitted(analysis, law, &start) {
        Ok(climbed) => {
            rival.rmse_n = residuals::summary(analysis, &climbed.force).rmse;
            rival.rmse_percent = 100.0 * rival.rmse_n / analysis.full_scale.max(f64::MIN_POSITIVE);
            rival.held_out_rmse_n = analysis.held_out(&climbed);
            rival.fitted = free(&climbed.prepared.model).len();
        }
        Err(error) => rival.failed = Some(error.to_string()),
    }
    rival
}

fn printed_error(analysis: &Analysis<'_>, law: &'static Law, values: &[f64]) -> Result<f64, InferenceError> {
    let model = Model::from_law(analysis.muscle, law, values, false);
    let prediction = model.evaluate(&analysis.record, &model.start(), &Wanted::default());
    Ok(residuals::summary(analysis, &prediction.map_err(|error| analysis.about(error))?.force).rmse)
}

fn fitted(analysis: &Analysis<'_>, law: &'static Law, values: &[f64]) -> Result<Climbed, InferenceError> {
    let model = Model::from_law(analysis.muscle, law, values, true);
    let count = model.parameters().len();
    let prepared = Prepared { model, priors: vec![None; count], nuisance: vec![false; count] };
    let numbers = free(&prepared.model).len();
    let rows = analysis.rows().count();
    if rows <= numbers {
        return Err(InferenceError::TooFewRows { rows, numbers });
    }
    // One start is enough: most coefficients are linear, and the bounds of the others are no guide to where
    // to start.
    let task = Task {
        record: &analysis.record,
        used: &analysis.used.mask,
        noise: analysis.noise,
        loss: analysis.options.loss,
        known: &[],
        is_near: true,
        quick: true,
    };
    let found = fit(&prepared, values, &task).map_err(|error| analysis.about(error))?;
    let theta = found.theta.clone();
    let prediction = prepared.model.evaluate(&analysis.record, &theta, &Wanted::default());
    let force = prediction.map_err(|error| analysis.about(error))?.force;
    Ok(Climbed { prepared, theta, fit: Some(found), force, failed: None })
}
