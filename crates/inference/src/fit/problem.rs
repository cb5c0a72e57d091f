//! A fit as a least-squares problem: weighted residuals of the used rows, then one residual for each prior.

use bulge_model::{Model, ModelError, ModelParameter, Record, Wanted, Warm};
use bulge_numerics::least_squares::{Bounds, Residuals};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

use crate::fit::loss::Loss;
use crate::noise::whitening::Whitening;

/// Rows that one thread weights at a time.
const ROWS: usize = 4096;

/// The free parameters of a model against a record.
pub(crate) struct FitProblem<'a> {
    model: &'a Model,
    record: &'a Record,
    /// Rows that count.
    rows: Vec<usize>,
    /// Standard deviation of each row of the record.
    sd: Vec<f64>,
    /// Indices of the free parameters.
    free: Vec<usize>,
    /// All parameters; the free ones are replaced in each evaluation.
    base: Vec<f64>,
    /// Index among the free parameters, mean and standard deviation, in the coordinates of the search.
    priors: Vec<(usize, f64, f64)>,
    logarithmic: Vec<bool>,
    /// Whitening of the residuals if the noise covariance is known; the standard deviations are then 1.
    whitening: Option<&'a Whitening>,
    /// What a reading contributes; of whitened residuals always its square.
    loss: Loss,
    /// Equilibria of the last evaluation, from which the next one starts.
    warm: Warm,
}

impl<'a> FitProblem<'a> {
    pub(crate) fn new(
        model: &'a Model,
        record: &'a Record,
        used: &[bool],
        sd: Vec<f64>,
        base: Vec<f64>,
        priors: &[Option<(f64, f64)>],
    ) -> Self {
        let free = free(model);
        let numbers = model.parameters();
        let logarithmic: Vec<bool> = free.iter().map(|i| numbers[*i].logarithmic).collect();
        let of_free = |(place, index): (usize, &usize)| {
            let (mean, sd) = priors[*index]?;
            // The standard deviation on a logarithmic scale is the relative one.
            Some(if logarithmic[place] { (place, mean.ln(), sd / mean) } else { (place, mean, sd) })
        };
        let priors = free.iter().enumerate().filter_map(of_free).collect();
        let rows = (0..record.len()).filter(|row| used[*row]).collect();
        let warm = Warm::of_rows(used);
        let loss = Loss::Squares;
        Self { model, record, rows, sd, free, base, priors, logarithmic, whitening: None, loss, warm }
    }

    /// The same with another loss.
    pub(crate) fn with_loss(self, loss: Loss) -> Self {
        Self { loss, ..self }
    }

    /// The same for correlated noise: all rows of the record are used, and the noise law weights them.
    pub(crate) fn whitened(
        model: &'a Model,
        record: &'a Record,
        whitening: &'a Whitening,
        base: Vec<f64>,
        priors: &[Option<(f64, f64)>],
    ) -> Self {
        let rows = record.len();
        let plain = Self::new(model, record, &vec![true; rows], vec![1.0; rows], base, priors);
        Self { whitening: Some(whitening), ..plain }
    }

    /// All parameters of the model, from the coordinates of the search.
    pub(crate) fn theta(&self, free: &[f64]) -> Vec<f64> {
        let mut theta = self.base.clone();
        for ((index, value), logarithmic) in self.free.iter().zip(free).zip(&self.logarithmic) {
            theta[*index] = if *logarithmic { value.exp() } else { *value };
        }
        if let Cow::Owned(tied) = self.model.with_ties(&theta) { tied } else { theta }
    }

    /// The coordinates of the search, from all parameters.
    pub(crate) fn coordinates(&self, theta: &[f64]) -> Vec<f64> {
        let coordinate = |(index, logarithmic): (&usize, &bool)| {
            if *logarithmic { theta[*index].ln() } else { theta[*index] }
        };
        self.free.iter().zip(&self.logarithmic).map(coordinate).collect()
    }

    /// Bounds in the coordinates of the search.
    pub(crate) fn bounds(&self) -> Bounds {
        let numbers = self.model.parameters();
        let low: Vec<f64> = numbers.iter().map(|p| p.low).collect();
        let high: Vec<f64> = numbers.iter().map(|p| p.high).collect();
        Bounds { lower: self.coordinates(&low), upper: self.coordinates(&high) }
    }

    /// Solves the equilibria in the next evaluation only and holds them afterwards, see [`Warm::hold`].
    pub(crate) fn hold(&self) {
        self.warm.hold();
    }

    /// Holds no further equilibria, see [`Warm::hold_no_more`].
    pub(crate) fn hold_no_more(&self) {
        self.warm.hold_no_more();
    }

    /// Solves the equilibria in each evaluation again.
    pub(crate) fn release(&self) {
        self.warm.release();
    }

    pub(crate) fn is_held(&self) -> bool {
        self.warm.is_held()
    }

    /// The model force of every row of the record \[N\], from the residuals; 0 in rows that don't count.
    pub(crate) fn force(&self, residuals: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.record.len()];
        for (row, residual) in self.rows.iter().zip(residuals) {
            force[*row] = self.record.force()[*row] - self.loss.straightened(*residual) * self.sd[*row];
        }
        force
    }

    /// Number of rows of the record that count.
    pub(crate) fn measured(&self) -> usize {
        self.rows.len()
    }

    /// Standard deviation of each row of the record.
    pub(crate) fn sd(&self) -> &[f64] {
        &self.sd
    }

    /// Indices of the free parameters among all of the model.
    pub(crate) fn places(&self) -> &[usize] {
        &self.free
    }

    /// The unit in which a free parameter is shown, in SI.
    pub(crate) fn unit(&self, place: usize) -> f64 {
        self.model.parameters()[self.free[place]].factor
    }

    /// Derivatives of the free parameters, in the units in which they are shown, by their coordinates.
    pub(crate) fn shown_slopes(&self, coordinates: &[f64]) -> Vec<f64> {
        let slope = |place: usize| {
            let si = if self.logarithmic[place] { coordinates[place].exp() } else { 1.0 };
            si / self.unit(place)
        };
        (0..self.free.len()).map(slope).collect()
    }

    /// Whether the coordinate of a free parameter is its logarithm.
    pub(crate) fn is_logarithmic(&self, place: usize) -> bool {
        self.logarithmic[place]
    }
}

impl FitProblem<'_> {
    /// Puts residuals through the loss; returns the slopes if they are wanted and not all 1.
    fn bend(&self, residuals: &mut [f64], wants_slopes: bool) -> Vec<f64> {
        if self.loss == Loss::Squares {
            return Vec::new();
        }
        let bend = |residual: &mut f64| {
            let bent = self.loss.bent(*residual);
            *residual = bent.value;
            bent.slope
        };
        let slopes: Vec<f64> = residuals.iter_mut().map(bend).collect();
        if wants_slopes { slopes } else { Vec::new() }
    }

    fn whiten(&self, columns: &mut [f64]) -> Result<(), ModelError> {
        let Some(whitening) = self.whitening else { return Ok(()) };
        let what = "the noise law doesn't suit the record";
        whitening.apply(columns).map_err(|_| ModelError::NotFinite { rows: Vec::new(), what })
    }
}

/// Indices of the parameters that a fit may change.
pub(crate) fn free(model: &Model) -> Vec<usize> {
    let is_free = |(_, p): &(usize, &ModelParameter)| !p.fixed;
    model.parameters().iter().enumerate().filter(is_free).map(|(i, _)| i).collect()
}

impl Residuals for FitProblem<'_> {
    type Error = ModelError;

    fn rows(&self) -> usize {
        self.rows.len() + self.priors.len()
    }

    fn parameters(&self) -> usize {
        self.free.len()
    }

    /// All rows in one block: the rows of a sweep depend on each other, and the model runs in parallel
    /// itself.
    fn block(&self) -> usize {
        self.rows()
    }

    /// The model returns derivatives together with the equilibria.
    fn joint(&self) -> bool {
        true
    }

    fn evaluate(
        &self,
        coordinates: &[f64],
        _: Range<usize>,
        residuals: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) -> Result<(), ModelError> {
        let theta = self.theta(coordinates);
        let parameters = if jacobian.is_some() { self.free.clone() } else { Vec::new() };
        let wanted = Wanted { parameters, readings: false };
        let prediction = self.model.evaluate_warm(self.record, &theta, &wanted, &self.warm)?;
        let measured = self.record.force();
        let (used, _) = residuals.split_at_mut(self.rows.len());
        used.par_chunks_mut(ROWS).zip(self.rows.par_chunks(ROWS)).for_each(|(residuals, rows)| {
            for (residual, row) in residuals.iter_mut().zip(rows) {
                *residual = (measured[*row] - prediction.force[*row]) / self.sd[*row];
            }
        });
        let n = self.rows.len();
        self.whiten(&mut residuals[..n])?;
        let slopes = self.bend(&mut residuals[..n], jacobian.is_some());
        for (residual, (place, mean, sd)) in residuals[n..].iter_mut().zip(&self.priors) {
            *residual = (coordinates[*place] - mean) / sd;
        }
        let k = self.free.len();
        let Some(jacobian) = jacobian.filter(|_| k > 0) else { return Ok(()) };
        let scale: Vec<f64> =
            (0..k).map(|place| if self.logarithmic[place] { theta[self.free[place]] } else { 1.0 }).collect();
        let (used, priors) = jacobian.split_at_mut(n * k);
        used.par_chunks_mut(ROWS * k).zip(self.rows.par_chunks(ROWS)).for_each(|(lines, rows)| {
            for (line, row) in lines.chunks_exact_mut(k).zip(rows) {
                let slopes = &prediction.jacobian[row * k..(row + 1) * k];
                let weight = -1.0 / self.sd[*row];
                for ((out, slope), scale) in line.iter_mut().zip(slopes).zip(&scale) {
                    *out = slope * scale * weight;
                }
            }
        });
        self.whiten(used)?;
        for (line, slope) in used.chunks_exact_mut(k).zip(&slopes) {
            for entry in line {
                *entry *= slope;
            }
        }
        for (line, (place, _, sd)) in priors.chunks_exact_mut(k).zip(&self.priors) {
            line.fill(0.0);
            line[*place] = 1.0 / sd;
        }
        Ok(())
    }
}
