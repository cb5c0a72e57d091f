//! Resistance over contraction: sensitivity, linearity, resolution, and the inverse from resistance to
//! contraction.

use bulge_numerics::root::{RootError, newton_bracketed};
use rayon::prelude::*;
use serde::Serialize;

use super::sensor::{Pose, Sensor};
use super::surface::interpolate;
use super::winding::{is_positive, number};
use super::{Linearity, Reading, SensingError};

/// Fewest and most points of a curve.
const POINTS: [usize; 2] = [11, 10_001];
/// Newton step in the contraction at which the inverse ends. The slope is that of a chord, so the error is a
/// fraction of this step.
const LAST_STEP: f64 = 1e-12;

/// Equally spaced contractions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Range {
    /// First contraction.
    pub from: f64,
    /// Last contraction, greater.
    pub to: f64,
    /// Number of contractions, 11 to 10001; the slopes are as accurate as a polynomial of degree 5 through
    /// six of them.
    pub points: usize,
}

impl Range {
    /// The contractions.
    ///
    /// # Errors
    /// [`SensingError::Input`] if the ends are not finite or not in order, or the number is out of its
    /// range.
    pub fn contractions(&self) -> Result<Vec<f64>, SensingError> {
        let Self { from, to, points } = *self;
        number("first contraction of the range [%]", from, "a finite number below 100 %", |e| {
            e.is_finite() && e < 1.0
        })?;
        number(
            "last contraction of the range [%]",
            to,
            "greater than the first one by 0.0001 % or more, and below 100 %",
            |e| e - from >= 1e-6 && e < 1.0,
        )?;
        number("number of contractions", points as f64, "from 11 to 10001", |_| {
            (POINTS[0]..=POINTS[1]).contains(&points)
        })?;
        let last = points - 1;
        Ok((0..points)
            .map(|i| if i == last { to } else { from + (to - from) * i as f64 / last as f64 })
            .collect())
    }
}

/// The characteristic of a winding at one pressure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Resistance R0 in the reference \[ohm\].
    pub reference_resistance_ohm: f64,
    /// Unpressurised length of the muscle \[m\].
    pub muscle_length_m: f64,
    /// The readings, in order of the contraction.
    pub readings: Vec<Reading>,
    /// Gauge factor dR/(R0 de) at each reading \[-\].
    pub sensitivity: Vec<f64>,
    /// Its linearity; `None` for a winding whose resistance doesn't change.
    pub linearity: Option<Linearity>,
}

/// Effect of noise of the resistance on the contraction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resolution {
    /// Noise of the resistance \[ohm\].
    pub noise_ohm: f64,
    /// noise/|dR/de| at each reading \[-\].
    pub contraction: Vec<f64>,
    /// Largest of these values \[-\].
    pub worst: f64,
    /// Contraction at the largest value.
    pub worst_at: f64,
    /// The largest value as a length of the muscle \[m\].
    pub worst_m: f64,
}

impl Curve {
    pub(super) fn of_readings(readings: Vec<Reading>, reference_ohm: f64, muscle_length_m: f64) -> Self {
        let contractions: Vec<f64> = readings.iter().map(|reading| reading.contraction).collect();
        let resistances: Vec<f64> = readings.iter().map(|reading| reading.resistance_ohm).collect();
        let values: Vec<[f64; 1]> = resistances.iter().map(|r| [r / reference_ohm]).collect();
        let sensitivity = (0..readings.len())
            .map(|i| {
                let first = i.saturating_sub(3).min(readings.len() - 6);
                interpolate(&contractions[first..], &values[first..], contractions[i]).1[0]
            })
            .collect();
        let linearity = Linearity::of(&contractions, &resistances, reference_ohm);
        Self { reference_resistance_ohm: reference_ohm, muscle_length_m, readings, sensitivity, linearity }
    }

    /// Checks that the resistance is strictly monotone.
    ///
    /// # Errors
    /// [`SensingError::NoChange`], or [`SensingError::NotMonotone`] with the first contractions between which
    /// it turns.
    pub fn check_monotone(&self) -> Result<(), SensingError> {
        let linearity = self.linearity.ok_or(SensingError::NoChange)?;
        let sign = linearity.slope_ohm.signum();
        let falls = |pair: &&[Reading]| sign * (pair[1].resistance_ohm - pair[0].resistance_ohm) <= 0.0;
        let turn =
            self.readings.windows(2).find(falls).map(|pair| [pair[0].contraction, pair[1].contraction]);
        turn.map_or(Ok(()), |between| Err(SensingError::NotMonotone { between }))
    }

    /// Effect of noise of the resistance \[ohm\] on the contraction.
    ///
    /// # Errors
    /// [`SensingError::Input`] if the noise isn't greater than 0; as [`Curve::check_monotone`].
    pub fn resolution(&self, noise_ohm: f64) -> Result<Resolution, SensingError> {
        number("noise of the resistance [ohm]", noise_ohm, "a finite number greater than 0", is_positive)?;
        self.check_monotone()?;
        let relative = noise_ohm / self.reference_resistance_ohm;
        let contraction: Vec<f64> = self.sensitivity.iter().map(|slope| relative / slope.abs()).collect();
        let places = contraction.iter().zip(&self.readings);
        let (worst, worst_at) =
            places.fold(
                (0.0, 0.0),
                |best, (size, reading)| {
                    if *size > best.0 { (*size, reading.contraction) } else { best }
                },
            );
        // The slope may be 0 even though the readings increase: the resolution isn't finite there.
        if !worst.is_finite() {
            return Err(SensingError::NotMonotone { between: [worst_at; 2] });
        }
        Ok(Resolution { noise_ohm, contraction, worst, worst_at, worst_m: worst * self.muscle_length_m })
    }
}

impl Sensor {
    /// The characteristic over a range, computed in parallel.
    ///
    /// # Errors
    /// [`SensingError::Input`] for an invalid range; as [`Sensor::reading`], for the smallest contraction at
    /// which it fails.
    pub fn curve(&self, range: Range) -> Result<Curve, SensingError> {
        let found: Vec<Result<Reading, SensingError>> =
            range.contractions()?.par_iter().map(|contraction| self.reading(*contraction)).collect();
        let readings = found.into_iter().collect::<Result<_, _>>()?;
        Ok(Curve::of_readings(readings, self.reference_resistance_ohm(), self.muscle_length_m()))
    }

    /// Poses over a range, computed in parallel.
    pub(super) fn poses(&self, range: Range) -> Result<Vec<Pose>, SensingError> {
        let found: Vec<Result<Pose, SensingError>> =
            range.contractions()?.par_iter().map(|contraction| self.pose(*contraction)).collect();
        found.into_iter().collect()
    }

    /// The contraction at which the winding has a resistance \[ohm\]. A curve of this sensor brackets it
    /// between two points; it is then found on the model itself.
    ///
    /// # Errors
    /// As [`Curve::check_monotone`]; [`SensingError::Input`] if the resistance lies outside the curve, or the
    /// curve belongs to another sensor; as [`Sensor::reading`].
    pub fn contraction(&self, curve: &Curve, resistance_ohm: f64) -> Result<f64, SensingError> {
        let wrong = |what: String| Err(SensingError::Input(what));
        curve.check_monotone()?;
        let own = [self.reference_resistance_ohm(), self.pressure_pa()].map(f64::to_bits);
        let its = curve.readings.first().map(|reading| [curve.reference_resistance_ohm, reading.pressure_pa]);
        if its.map(|its| its.map(f64::to_bits)) != Some(own) {
            return wrong(
                "this curve is not one of this winding: compute it with the same sensor".to_owned(),
            );
        }
        let inside = |pair: &&[Reading]| {
            let [a, b] = [pair[0].resistance_ohm, pair[1].resistance_ohm];
            resistance_ohm >= a.min(b) && resistance_ohm <= a.max(b)
        };
        let Some([left, right]) =
            curve.readings.windows(2).find(inside).and_then(|pair| pair.first_chunk::<2>())
        else {
            let ends = [0, curve.readings.len() - 1].map(|i| curve.readings[i].resistance_ohm);
            let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            return wrong(format!(
                "the resistance {resistance_ohm} ohm lies outside those of the curve, {low} ohm to {high} ohm: measure within it, or compute a wider curve"
            ));
        };
        let ends = [left, right];
        if let Some(end) = ends.iter().find(|end| end.resistance_ohm.to_bits() == resistance_ohm.to_bits()) {
            return Ok(end.contraction);
        }
        let width = right.contraction - left.contraction;
        let rise = right.resistance_ohm - left.resistance_ohm;
        // Makes the function positive at the left end and negative at the right one, for rising and falling
        // resistance.
        let sign = rise.signum();
        let value = |contraction: f64| {
            let reading = self.reading(contraction)?;
            Ok((sign * (resistance_ohm - reading.resistance_ohm), -rise.abs() / width))
        };
        let start = left.contraction + width * (resistance_ohm - left.resistance_ohm) / rise;
        let found = newton_bracketed(value, left.contraction, right.contraction, start, [LAST_STEP, 0.0]);
        found.or_else(|error| match error {
            RootError::Function(error) => Err(error),
            RootError::Budget { at, .. } => wrong(format!(
                "no contraction was found to the resistance {resistance_ohm} ohm near {:.4} %: compute the curve with more points",
                100.0 * at
            )),
        })
    }
}
