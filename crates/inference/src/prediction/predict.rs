//! Predicts the force at rows, with intervals from the uncertainty of the muscle's parameters.
//!
//! ```text
//! s_i^2 = g_i' C g_i,    g_i = dF_i/d(numbers),    95 % of the readings lie within F_i +- q sqrt(s_i^2 + e^2)
//! ```
//! C is the covariance of the fitted parameters and of those stated with a width, e the RMS error of the fit
//! (or else the noise of the load cell), q Student's quantile.

use bulge_effects::{Catalogue, Effect, known};
use bulge_measurements::Data;
use bulge_model::{Record, Wanted, Warm};
use bulge_muscles::{Muscle, Quantity};
use std::sync::Arc;

use crate::comparison::document::LeftOut;
use crate::comparison::levels::sweep_of;
use crate::comparison::requirements::{COMPARED, check_memory, check_needs, check_size};
use crate::comparison::row_by_row::short;
use crate::comparison::rows::{BY_HAND, lines, used};
use crate::comparison::specimens::{note, of_specimens};
use crate::error::InferenceError;
use crate::fit::interval::quantile;
use crate::prediction::document::{Against, Predicted, PredictedColumns, UncertainNumber};
use crate::prediction::uncertain::Uncertain;
use crate::vector::minus;

/// The force of a muscle, with the effects that its file states, at rows that it wasn't fitted to.
///
/// The intervals come from the muscle file: the table `[fitted]` that `bulge fit` writes, widths, and
/// instruments. If the data have no force ([`Data::has_force`]), nothing is compared. Rows `excluded` by hand
/// are predicted, but left out of the errors.
///
/// # Errors
/// [`InferenceError`]: an unknown effect, a muscle of another size, or a table `[fitted]` that doesn't belong
/// to this muscle.
pub fn predict(
    data: &Data,
    muscle: &Muscle,
    catalogue: &Catalogue,
    excluded: &[usize],
) -> Result<Predicted, InferenceError> {
    rayon::scope(|_| predicted(data, muscle, catalogue, excluded))
}

fn predicted(
    data: &Data,
    muscle: &Muscle,
    catalogue: &Catalogue,
    excluded: &[usize],
) -> Result<Predicted, InferenceError> {
    let data = &*of_specimens(data, muscle)?;
    let known = known(muscle, catalogue).map_err(|error| InferenceError::Specimens(Box::new(error)))?;
    check_memory(data, COMPARED)?;
    let record = Record::new(data, muscle.length().si());
    let idle = known.iter().filter_map(|(effect, _)| does_nothing(effect, &record));
    let idle: Vec<String> = idle.collect();
    let all = vec![true; record.len()];
    check_size(data, muscle, &record, &all)?;
    let uncertain = Uncertain::of(muscle, &known, catalogue, record.specimens())?;
    let wanted = Wanted { parameters: uncertain.places.clone(), readings: false };
    let found = uncertain.model.evaluate_partly(&record, &uncertain.theta, &wanted, &Warm::new())?;
    let without_state = (!found.without_state.is_empty()).then(|| LeftOut {
        why: found.error.map_or_else(String::new, |error| {
            uncertain.model.explained(&record, &uncertain.theta, error).to_string()
        }),
        lines: lines(data, &found.without_state),
        rows: found.without_state.len(),
    });
    let fitted = muscle.fitted();
    let stated = muscle.instruments().force.map(|force| force.noise()).filter(|sd| *sd > 0.0);
    let reading_sd_n = fitted.map(|fitted| fitted.error_n).or(stated);
    let freedom =
        fitted.map_or(f64::INFINITY, |fitted| (fitted.rows as f64 - fitted.numbers.len() as f64).max(1.0));
    let k = wanted.parameters.len();
    let quantile = quantile(freedom);
    let slopes = |row: usize| &found.prediction.jacobian[row * k..(row + 1) * k];
    let columns = columns(data, &record, &found.prediction.force, |row| {
        let variance = uncertain.variance(slopes(row));
        let half = reading_sd_n.map_or(f64::NAN, |sd| quantile * (variance + sd * sd).sqrt());
        [variance.sqrt(), half]
    });
    let mut warnings = [idle, uncertain.warnings.clone()].concat();
    if fitted.is_none() {
        warnings.push(
            "the muscle file says nothing of how sure its numbers are (`bulge fit` writes `[fitted]`): the intervals lack that".to_owned(),
        );
    }
    if reading_sd_n.is_none() {
        warnings.push(
            "nothing is known of the noise of a reading: there are no intervals; write `[instruments]`"
                .to_owned(),
        );
    }
    warnings.extend(note(data, muscle));
    let counting = data.has_force().then(|| {
        let mut used = used(data);
        used.leave_out(data, excluded.iter().copied(), BY_HAND.to_owned());
        used
    });
    Ok(Predicted {
        schema: "bulge.prediction/1",
        muscle: muscle.name().to_owned(),
        files: data.files().iter().map(|file| file.name.clone()).collect(),
        sha256: data.sha256(),
        rows: record.len(),
        without_state,
        uncertain: numbers(&uncertain, &found.prediction.jacobian, &found.prediction.force),
        reading_sd_n,
        against: counting.as_ref().and_then(|used| against(&columns, &used.mask)),
        left_out: counting.map(|used| used.left_out).unwrap_or_default(),
        warnings,
        columns,
    })
}

/// The warning for an effect that needs something the data don't have, such as a direction where rows have no
/// order.
fn does_nothing(effect: &Arc<dyn Effect>, record: &Record) -> Option<String> {
    let Err(InferenceError::Needs { effect, needs }) = check_needs(effect, record) else { return None };
    Some(format!("`{effect}` needs {needs}, which these data don't have: it does nothing here"))
}

/// The columns row by row; `doubt` gives the standard deviation of the force and half the interval.
fn columns(
    data: &Data,
    record: &Record,
    force: &[f64],
    doubt: impl Fn(usize) -> [f64; 2],
) -> PredictedColumns {
    let moments = record.moments();
    let lines: Vec<(usize, usize)> = (0..record.len()).map(|row| data.line(row)).collect();
    let doubts: Vec<[f64; 2]> = (0..record.len())
        .map(|row| if force[row].is_finite() { doubt(row) } else { [f64::NAN; 2] })
        .collect();
    let measured_n = data.has_force().then(|| record.force().to_vec());
    PredictedColumns {
        specimens: record.specimens().to_vec(),
        sweeps: data.is_path().then(|| data.sweeps().iter().map(|sweep| sweep.name.clone()).collect()),
        file: lines.iter().map(|(file, _)| short(*file)).collect(),
        line: lines.iter().map(|(_, line)| short(*line)).collect(),
        sweep: (0..record.len()).map(|row| short(sweep_of(record.sweeps(), row))).collect(),
        specimen: moments.iter().map(|moment| moment.specimen).collect(),
        time_s: data.time().map(<[f64]>::to_vec),
        pressure_pa: moments.iter().map(|moment| moment.pressure).collect(),
        contraction: moments.iter().map(|moment| moment.contraction).collect(),
        sd_n: doubts.iter().map(|[sd, _]| *sd).collect(),
        low_n: force.iter().zip(&doubts).map(|(force, [_, half])| force - half).collect(),
        high_n: force.iter().zip(&doubts).map(|(force, [_, half])| force + half).collect(),
        residual_n: measured_n.as_ref().map(|measured| minus(measured, force)),
        measured_n,
        force_n: force.to_vec(),
    }
}

/// Errors over the rows that count and have a state; none without such rows.
fn against(columns: &PredictedColumns, counts: &[bool]) -> Option<Against> {
    let residual = columns.residual_n.as_ref()?;
    let rows: Vec<usize> =
        (0..counts.len()).filter(|row| counts[*row] && residual[*row].is_finite()).collect();
    if rows.is_empty() {
        return None;
    }
    let mean = |of: &dyn Fn(usize) -> f64| rows.iter().map(|row| of(*row)).sum::<f64>() / rows.len() as f64;
    let half = |row: usize| columns.high_n[row] - columns.force_n[row];
    let within = |row: usize| f64::from(u8::from(residual[row].abs() <= half(row)));
    Some(Against {
        rows: rows.len(),
        rmse_n: mean(&|row| residual[row].powi(2)).sqrt(),
        bias_n: mean(&|row| residual[row]),
        coverage: half(rows[0]).is_finite().then(|| mean(&within)),
    })
}

/// The uncertain parameters, with the changes of the force that they cause.
fn numbers(uncertain: &Uncertain, jacobian: &[f64], force: &[f64]) -> Vec<UncertainNumber> {
    let k = uncertain.places.len();
    let rows: Vec<usize> = (0..force.len()).filter(|row| force[*row].is_finite()).collect();
    let one = |(column, place): (usize, &usize)| {
        let p = &uncertain.model.parameters()[*place];
        let square: f64 = rows.iter().map(|row| jacobian[row * k + column].powi(2)).sum();
        UncertainNumber {
            effect: p.effect.clone(),
            name: p.name.clone(),
            value: p.shown(uncertain.theta[*place]),
            sd: p.shown(uncertain.sd[column]),
            unit: p.unit.clone(),
            from: if uncertain.is_fitted[column] { "fitted" } else { "stated" },
            moves_n: uncertain.sd[column] * (square / rows.len().max(1) as f64).sqrt(),
        }
    };
    uncertain.places.iter().enumerate().map(one).collect()
}
