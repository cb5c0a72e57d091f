//! A comparison under way: the record, which of its rows count, and the rungs of the ladder one by one.

use bulge_effects::law::Law;
use bulge_effects::{Catalogue, Effect};
use bulge_measurements::Data;
use bulge_model::{Model, ModelError, Record, Wanted, Warm};
use bulge_muscles::{Muscle, Parameter, Quantity};
use rayon::prelude::*;
use std::sync::Arc;

use crate::comparison::document::{DataSummary, NoiseFloor, Rung};
use crate::comparison::floor::noise_floor;
use crate::comparison::levels::{Folds, Levels};
use crate::comparison::requirements::{check_needs, check_size};
use crate::comparison::rows::{Used, full_scale, lines, used};
use crate::comparison::{loops, residuals};
use crate::error::InferenceError;
use crate::fit::carry_over::carry_over;
use crate::fit::document::Fit;
use crate::fit::nuisance::{Prepared, with_nuisances};
use crate::fit::problem::free;
use crate::fit::search::{Task, fit, fit_and_force};
use crate::fit::weights::Noise;

/// Rows on which held-out errors and contributions are computed.
pub(crate) const FEWER_ROWS: usize = 4000;
/// A measured force above this part of full scale where the model would push is a muscle that doesn't match.
const CLEARLY_PULLS: f64 = 0.1;

/// What is compared, besides muscle and data.
#[derive(Debug, Clone)]
pub struct Options {
    /// Effects to add, in this order.
    pub effects: Vec<Arc<dyn Effect>>,
    /// Effects that a muscle file states, with their numbers.
    pub known: Vec<(Arc<dyn Effect>, Vec<f64>)>,
    /// Where nuisances are looked up.
    pub catalogue: Catalogue,
    /// A force law as the base instead of the equilibrium: with these coefficients, fitted if so asked.
    pub law: Option<(&'static Law, Vec<f64>, bool)>,
    /// Whether errors on held-out data are computed.
    pub held_out: bool,
    /// Whether the papers' force laws are fitted to the same data.
    pub rivals: bool,
}

impl Options {
    /// The equilibrium with some effects, held-out errors, no rivals.
    #[must_use]
    pub fn new(catalogue: Catalogue, effects: Vec<Arc<dyn Effect>>) -> Self {
        Self { effects, known: Vec::new(), catalogue, law: None, held_out: true, rivals: false }
    }
}

/// One rung with what it predicts.
pub(crate) struct Climbed {
    pub(crate) prepared: Prepared,
    pub(crate) theta: Vec<f64>,
    pub(crate) fit: Option<Fit>,
    /// Of every row of the record \[N\].
    pub(crate) force: Vec<f64>,
}

/// A comparison under way.
pub(crate) struct Analysis<'a> {
    pub(crate) data: &'a Data,
    pub(crate) muscle: &'a Muscle,
    pub(crate) options: &'a Options,
    pub(crate) record: Record,
    pub(crate) used: Used,
    pub(crate) levels: Levels,
    pub(crate) folds: Option<Folds>,
    pub(crate) noise: Noise,
    pub(crate) full_scale: f64,
    /// A model with all effects, and numbers near those of its best fit.
    pub(crate) near: Option<(&'a Model, &'a [f64])>,
}

impl<'a> Analysis<'a> {
    pub(crate) fn new(
        data: &'a Data,
        muscle: &'a Muscle,
        options: &'a Options,
    ) -> Result<Self, InferenceError> {
        let record = Record::new(data, muscle.length().si());
        let used = used(data);
        if !used.mask.contains(&true) {
            let left_out =
                if data.is_empty() { "the file has none" } else { "all are slack or without pressure" };
            return Err(InferenceError::NoRows { left_out: left_out.to_owned() });
        }
        for effect in &options.effects {
            check_needs(effect, &record)?;
        }
        check_size(data, muscle, &record, &used.mask)?;
        let full_scale = full_scale(data.force());
        let levels = Levels::of(&record, &used.mask);
        let folds = Folds::of(&record, &levels);
        // Until the noise is known: a hundredth of full scale.
        let noise = Noise::of(muscle, (0.01 * full_scale).max(f64::MIN_POSITIVE));
        Ok(Self { data, muscle, options, record, used, levels, folds, noise, full_scale, near: None })
    }

    /// The base with what the muscle file states, but for those of the first `count` effects: they are fitted anew.
    fn base(&self, count: usize) -> Result<Model, ModelError> {
        let mut model = match &self.options.law {
            Some((law, values, free)) => Model::from_law(self.muscle, law, values, *free),
            None => Model::new(self.muscle),
        }
        .for_specimens(self.record.specimens());
        for (effect, values) in &self.options.known {
            let is_asked = |other: &Arc<dyn Effect>| other.card().name == effect.card().name;
            if !self.options.effects[..count].iter().any(is_asked) {
                model = model.with(effect, Some(values))?;
            }
        }
        Ok(model)
    }

    /// The base with all effects that were asked for, without what data sheets leave open.
    pub(crate) fn base_with_effects(&self) -> Result<Model, ModelError> {
        let mut model = self.base(self.options.effects.len())?;
        for effect in &self.options.effects {
            model = model.with(effect, None)?;
        }
        Ok(model)
    }

    /// The model with the first `count` effects.
    pub(crate) fn model(&self, count: usize) -> Result<Prepared, InferenceError> {
        let with_effects = || {
            let mut model = self.base(count)?;
            for effect in &self.options.effects[..count] {
                model = model.with(effect, None)?;
            }
            with_nuisances(&model, &self.options.catalogue)
        };
        with_effects().map_err(|error| self.about(error))
    }

    /// The force of the base with everything as stated, nothing fitted \[N\].
    pub(crate) fn as_stated(&self) -> Result<Vec<f64>, InferenceError> {
        let prepared = self.model(0)?;
        let counting = Warm::of_rows(&self.used.mask);
        let found = prepared.model.evaluate_warm(
            &self.record,
            &prepared.model.start(),
            &Wanted::default(),
            &counting,
        );
        Ok(found.map_err(|error| self.about(error))?.force)
    }

    /// The rung of the first `count` effects: fitted if there is anything to fit.
    pub(crate) fn climb(&self, count: usize, below: Option<&Climbed>) -> Result<Climbed, InferenceError> {
        let prepared = self.model(count)?;
        let mut theta = prepared.model.start();
        if let Some(below) = below {
            carry_over(&below.prepared.model, &below.theta, &prepared.model, &mut theta);
        }
        let near = self.near.filter(|_| count == self.options.effects.len());
        if let Some((model, numbers)) = near {
            carry_over(model, numbers, &prepared.model, &mut theta);
        }
        let numbers = free(&prepared.model).len();
        if numbers > 0 {
            self.check_rows(numbers)?;
            let task = Task {
                record: &self.record,
                used: &self.used.mask,
                noise: self.noise,
                is_near: near.is_some(),
                quick: false,
            };
            let (fit, force) = fit_and_force(&prepared, &theta, &task).map_err(|error| self.about(error))?;
            return Ok(Climbed { prepared, theta: fit.theta.clone(), fit: Some(fit), force });
        }
        let counting = Warm::of_rows(&self.used.mask);
        let prediction = prepared.model.evaluate_warm(&self.record, &theta, &Wanted::default(), &counting);
        let force = prediction.map_err(|error| self.about(error))?.force;
        Ok(Climbed { prepared, theta, fit: None, force })
    }

    fn check_rows(&self, numbers: usize) -> Result<(), InferenceError> {
        let rows: Vec<usize> = self.rows().collect();
        let moments = self.record.moments();
        let point = |row: usize| (moments[row].pressure.to_bits(), moments[row].contraction.to_bits());
        if rows.len() > 1 && rows.iter().all(|row| point(*row) == point(rows[0])) {
            return Err(InferenceError::Identical { rows: rows.len() });
        }
        if rows.len() < numbers + 1 {
            return Err(InferenceError::TooFewRows { rows: rows.len(), numbers });
        }
        Ok(())
    }

    /// Rows that count.
    pub(crate) fn rows(&self) -> impl Iterator<Item = usize> {
        (0..self.record.len()).filter(|row| self.used.mask[*row])
    }

    /// A model error with the lines of the file.
    pub(crate) fn about(&self, error: ModelError) -> InferenceError {
        let what = match &error {
            ModelError::NoEquilibrium { rows, .. } | ModelError::NotFinite { rows, .. }
                if !rows.is_empty() =>
            {
                format!("line {}: ", lines(self.data, rows))
            }
            _ => String::new(),
        };
        InferenceError::Model { what, source: Box::new(error) }
    }

    /// Whether the model pulls where the muscle does.
    pub(crate) fn check_match(&self, first: &Climbed) -> Result<(), InferenceError> {
        let measured = self.record.force();
        let pushes =
            |row: &usize| first.force[*row] < 0.0 && measured[*row] > CLEARLY_PULLS * self.full_scale;
        let rows: Vec<usize> = self.rows().filter(pushes).collect();
        let Some(&row) = rows.first() else { return Ok(()) };
        let moment = &self.record.moments()[row];
        Err(InferenceError::BeyondLimit {
            muscle: self.muscle.name().to_owned(),
            lines: format!("line {}", lines(self.data, &rows)),
            rows: rows.len(),
            contraction: moment.contraction,
            pressure_pa: moment.pressure,
            force_n: first.force[row],
            measured_n: rows.iter().map(|row| measured[*row]).fold(0.0, f64::max),
        })
    }

    /// What no model can go below, as the residuals of a rung show it.
    pub(crate) fn noise_floor(&self, climbed: &Climbed) -> Option<NoiseFloor> {
        let residuals: Vec<f64> = self
            .record
            .force()
            .iter()
            .zip(&climbed.force)
            .map(|(measured, model)| measured - model)
            .collect();
        let repeats = self.data.repeats(self.muscle.length().si());
        noise_floor(repeats.pure_error().as_ref(), &self.record, &self.used.mask, &residuals, self.muscle)
    }

    /// The noise of the force from here on, and the floor for people.
    pub(crate) fn measure_noise(&mut self, first: &Climbed) -> Option<NoiseFloor> {
        let floor = self.noise_floor(first);
        let stated = self.muscle.instruments().force.map_or(0.0, |force| force.noise());
        let sd = if stated > 0.0 { stated } else { floor.as_ref().map_or(0.0, |floor| floor.sd_n) };
        if sd > 0.0 {
            self.noise.force_n = sd;
        }
        floor
    }

    pub(crate) fn rung(&self, number: usize, climbed: &Climbed) -> Rung {
        let added = number.checked_sub(1).map(|i| &self.options.effects[i]);
        let title = match (added, &self.options.law) {
            (Some(effect), _) => effect.card().title.to_owned(),
            (None, Some((law, _, _))) => law.title.to_owned(),
            (None, None) if self.options.known.is_empty() => "equilibrium of the muscle as stated".to_owned(),
            (None, None) => {
                let learnt: Vec<_> =
                    self.options.known.iter().map(|(effect, _)| effect.card().name).collect();
                format!("the muscle as stated, with its {}", learnt.join(", "))
            }
        };
        let error = residuals::summary(self, &climbed.force);
        let held_out = if self.options.held_out { self.held_out(climbed) } else { None };
        Rung {
            added: added.map(|effect| effect.card().name.to_owned()),
            title,
            rmse_n: error.rmse,
            rmse_percent: 100.0 * error.rmse / self.full_scale.max(f64::MIN_POSITIVE),
            bias_n: error.bias,
            largest_n: error.largest,
            held_out_rmse_n: held_out,
            held_out_by: held_out.and(self.folds.as_ref().map(|folds| folds.by)),
            r_squared: error.r_squared,
            fitted: free(&climbed.prepared.model).len(),
            half_gap_rmse_n: loops::half_gap_error(self, &climbed.force),
            fit: climbed.fit.clone(),
        }
    }

    /// RMS error on pressures (specimens, sweeps) that took no part in the fit.
    pub(crate) fn held_out(&self, climbed: &Climbed) -> Option<f64> {
        let folds = self.folds.as_ref()?;
        let (thin, kept) = self.record.thinned(FEWER_ROWS);
        let numbers = free(&climbed.prepared.model).len();
        let of_fold = |fold: usize| -> Result<Option<(f64, usize)>, ModelError> {
            let in_fold = |row: &usize| folds.of[*row] == fold;
            let train: Vec<bool> = kept.iter().map(|row| self.used.mask[*row] && !in_fold(row)).collect();
            if numbers > 0 && train.iter().filter(|t| **t).count() <= numbers {
                return Ok(None);
            }
            let theta = if numbers > 0 {
                let task =
                    Task { record: &thin, used: &train, noise: self.noise, is_near: true, quick: true };
                fit(&climbed.prepared, &climbed.theta, &task)?.theta
            } else {
                climbed.theta.clone()
            };
            // Predicted are all rows that were held out, with all of their history.
            let test: Vec<bool> =
                (0..self.record.len()).map(|row| self.used.mask[row] && in_fold(&row)).collect();
            let warm = Warm::of_rows(&test);
            let model = &climbed.prepared.model;
            let force = model.evaluate_warm(&self.record, &theta, &Wanted::default(), &warm)?.force;
            let rows = (0..test.len()).filter(|row| test[*row]);
            let square = rows.clone().map(|row| (self.record.force()[row] - force[row]).powi(2)).sum();
            Ok(Some((square, rows.count())))
        };
        let found: Vec<_> = (0..folds.count).into_par_iter().map(of_fold).collect();
        let mut sums = (0.0, 0_usize);
        for fold in found {
            // Numbers that suit the other rows may leave these without an equilibrium: there is no error to state then.
            let (square, count) = fold.ok().flatten()?;
            sums = (sums.0 + square, sums.1 + count);
        }
        (sums.1 > 0).then(|| (sums.0 / sums.1 as f64).sqrt())
    }

    pub(crate) fn summary(&self) -> DataSummary {
        let range = |value: &dyn Fn(usize) -> f64| {
            (0..self.record.len())
                .map(value)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
        };
        let moments = self.record.moments();
        DataSummary {
            rows: self.record.len(),
            used: self.rows().count(),
            left_out: self.used.left_out.clone(),
            reading: self.used.reading.clone(),
            sha256: self.data.sha256(),
            files: self.data.files().iter().map(|file| file.name.clone()).collect(),
            sweeps: self.record.sweeps().len(),
            specimens: self.record.specimens().to_vec(),
            is_path: self.record.is_path(),
            pressure_pa: range(&|row| moments[row].pressure),
            contraction: range(&|row| moments[row].contraction),
            force_n: range(&|row| self.record.force()[row]),
            full_scale_n: self.full_scale,
        }
    }

    pub(crate) fn warnings(&self, ladder: &[Rung]) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.folds.is_none() && self.options.held_out {
            warnings.push(
                "nothing could be held out: there are fewer than three pressures, two specimens and three sweeps".to_owned(),
            );
        }
        let used = |p: Parameter| matches!(p, Parameter::Length | Parameter::Radius | Parameter::BraidAngle);
        for (parameter, _) in self.muscle.widths().iter().filter(|(p, _)| !used(*p)) {
            warnings.push(format!(
                "the width stated for `{}` is not used: only those of length, radius and braid angle are",
                parameter.key()
            ));
        }
        let lowest = ladder.iter().filter_map(|rung| rung.held_out_rmse_n).fold(f64::INFINITY, f64::min);
        if let Some((last, held_out)) = ladder.last().and_then(|rung| Some((rung, rung.held_out_rmse_n?)))
            && held_out > 1.2 * lowest
        {
            warnings.push(format!(
                "the last effect, `{}`, makes the error on unseen data larger ({held_out:.1} N instead of {lowest:.1} N): it follows these \
                 rows, not the muscle",
                last.added.as_deref().unwrap_or("")
            ));
        }
        if let Some(fit) = ladder.last().and_then(|rung| rung.fit.as_ref()) {
            warnings.extend(fit.warnings.iter().cloned());
        }
        warnings
    }

    pub(crate) fn nothing_fitted(&self, theta: Vec<f64>, force: &[f64]) -> Fit {
        let error = residuals::summary(self, force);
        Fit {
            parameters: Vec::new(),
            theta,
            rmse_n: error.rmse,
            cost: 0.0,
            sd_n: self.noise.force_n,
            effective_rows: self.rows().count() as f64,
            correlations: Vec::new(),
            convergence: crate::fit::document::Convergence {
                converged: true,
                reason: "there was nothing to fit".to_owned(),
                gradient_cosine: 0.0,
                iterations: 0,
                starts: 0,
                agreeing: 0,
                minima: 0,
                rank: 0,
            },
            warnings: Vec::new(),
        }
    }
}
