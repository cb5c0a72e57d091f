//! A comparison in progress: the record, the rows that count, and the rungs of the ladder one by one.

use bulge_effects::Effect;
use bulge_measurements::{Data, PureError};
use bulge_model::{Model, ModelError, Partly, Record, Restriction, Wanted, Warm};
use bulge_muscles::{Muscle, Quantity};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;

use crate::comparison::buckled::buckled;
use crate::comparison::document::{DataSummary, LeftOut, Mismatch, NoiseFloor, Rung};
use crate::comparison::doubt::doubtful_sd;
use crate::comparison::levels::{Folds, Levels};
use crate::comparison::loops::branches;
use crate::comparison::mismatch::{questions, unread};
use crate::comparison::options::Options;
use crate::comparison::other_units::in_other_units;
use crate::comparison::requirements::{COMPARED, check_memory, check_needs, check_size, of_no_muscle};
use crate::comparison::rows::{BY_HAND, Used, full_scale, lines, used};
use crate::comparison::specimens::of_specimens;
use crate::comparison::{loops, residuals};
use crate::error::InferenceError;
use crate::fit::carry_over::carry_over;
use crate::fit::document::Fit;
use crate::fit::held::held;
use crate::fit::nuisance::{Prepared, with_nuisances};
use crate::fit::problem::free;
use crate::fit::search::{Task, fit, fit_and_force, some_of_long};
use crate::fit::states::is_of_rows;
use crate::fit::weights::Noise;
use crate::vector::range;

/// Rows for held-out errors and contributions.
pub(crate) const FEWER_ROWS: usize = 4000;

/// One rung with its predictions.
#[derive(Clone)]
pub(crate) struct Climbed {
    pub(crate) prepared: Prepared,
    pub(crate) theta: Vec<f64>,
    pub(crate) fit: Option<Fit>,
    /// Model force of every row of the record \[N\]; NaN in rows without a state.
    pub(crate) force: Vec<f64>,
    /// Why its parameters couldn't be fitted.
    pub(crate) failed: Option<ModelError>,
}

/// The base, as the first rung of a ladder, and the noise that it shows.
#[derive(Clone)]
pub(crate) struct First {
    pub(crate) climbed: Climbed,
    pub(crate) floor: Option<NoiseFloor>,
}

/// A comparison in progress.
pub(crate) struct Analysis<'a> {
    pub(crate) data: Cow<'a, Data>,
    pub(crate) muscle: &'a Muscle,
    pub(crate) options: Cow<'a, Options>,
    /// Shared by the comparisons of one diagnosis, because it is the largest object of a long data set.
    pub(crate) record: Arc<Record>,
    pub(crate) used: Used,
    pub(crate) levels: Levels,
    pub(crate) folds: Option<Folds>,
    pub(crate) noise: Noise,
    pub(crate) full_scale: f64,
    /// Questions about units, signs and scales.
    pub(crate) findings: Vec<Mismatch>,
    /// Scatter between repeats.
    pub(crate) pure_error: Option<PureError>,
    /// Rows with a smaller weight because their direction is uncertain.
    pub(crate) doubtful: Vec<usize>,
    /// Rows in which the muscle as stated is slack, once they have been determined.
    slack: Option<Vec<usize>>,
    /// The base model before anything is added. Models made from it share the equilibria that they have
    /// solved.
    root: Model,
    /// A model with all effects, and parameters near those of its best fit.
    pub(crate) near: Option<(&'a Model, &'a [f64])>,
}

impl<'a> Analysis<'a> {
    pub(crate) fn new(
        data: &'a Data,
        muscle: &'a Muscle,
        options: &'a Options,
    ) -> Result<Self, InferenceError> {
        check_memory(data, COMPARED)?;
        let data = of_specimens(data, muscle)?;
        let options = Cow::Borrowed(options);
        let record = Arc::new(Record::new(&data, muscle.length().si()));
        let mut used = used(&data);
        used.leave_out(&data, options.excluded.iter().copied(), BY_HAND.to_owned());
        if !used.mask.contains(&true) {
            let left_out = if data.is_empty() {
                "the file has none"
            } else {
                "the gauge pressure is 0 or less in all of them; check its sign and its zero, and write `abs` behind the unit of a pressure that counts from a vacuum"
            };
            return Err(InferenceError::NoRows { left_out: left_out.to_owned() });
        }
        for effect in &options.effects {
            check_needs(effect, &record)?;
        }
        if let Some((rows, why)) = of_no_muscle(&data, muscle, &record, &used) {
            used.leave_out(&data, rows, why);
        }
        check_size(&data, muscle, &record, &used.mask)?;
        let full_scale = full_scale(data.force(), used.rows());
        if full_scale == 0.0 {
            let left_out =
                "the force is 0 in all of them; was the load cell connected, and is this its column?";
            return Err(InferenceError::NoRows { left_out: left_out.to_owned() });
        }
        let levels = Levels::of(&record, &used.mask);
        let folds = Folds::of(&record, &levels, &used.mask);
        // Before it is estimated: a hundredth of full scale.
        let noise = Noise::of(muscle, (0.01 * full_scale).max(f64::MIN_POSITIVE));
        let root = match &options.law {
            Some((law, values, free)) => Model::from_law(muscle, law, values, *free),
            None => Model::new(muscle),
        };
        let root = root.restricted(&options.restrictions);
        Ok(Self {
            pure_error: data.repeats(muscle.length().si()).pure_error(),
            data,
            muscle,
            options,
            record,
            used,
            levels,
            folds,
            noise,
            full_scale,
            findings: Vec::new(),
            doubtful: Vec::new(),
            slack: None,
            root,
            near: None,
        })
    }

    /// The base model with the effects that the muscle file states. Those among the first `count` requested
    /// effects are left out, because they are fitted anew.
    pub(crate) fn base(&self, count: usize) -> Result<Model, ModelError> {
        let mut model = self.root.clone().for_specimens(self.record.specimens())?;
        for (effect, values) in &self.options.known {
            let is_asked = |other: &Arc<dyn Effect>| other.card().name == effect.card().name;
            if !self.options.effects[..count].iter().any(is_asked) {
                model = model.with(effect, Some(values))?;
            }
        }
        Ok(model)
    }

    /// The base model with the first `count` requested effects, without nuisance parameters.
    fn with_first(&self, count: usize) -> Result<Model, ModelError> {
        let effects = &self.options.effects[..count];
        effects.iter().try_fold(self.base(count)?, |model, effect| model.with(effect, None))
    }

    /// The base model with all requested effects, without nuisance parameters.
    pub(crate) fn base_with_effects(&self) -> Result<Model, InferenceError> {
        self.with_first(self.options.effects.len()).map_err(|error| self.about(error))
    }

    /// The model with the first `count` effects and its nuisance parameters.
    pub(crate) fn model(&self, count: usize) -> Result<Prepared, InferenceError> {
        let with_effects = self.with_first(count);
        let prepared = with_effects.and_then(|model| with_nuisances(&model, &self.options.catalogue));
        prepared.map_err(|error| self.about(error))
    }

    /// The rung with the first `count` effects, fitted if there are free parameters.
    pub(crate) fn climb(&self, count: usize, below: Option<&Climbed>) -> Result<Climbed, InferenceError> {
        let prepared = self.model(count)?;
        let mut theta = prepared.start();
        let mut known = Vec::new();
        if let Some(below) = below {
            known = carry_over(&below.prepared.model, &below.theta, &prepared.model, &mut theta);
        }
        let near = self.near.filter(|_| count == self.options.effects.len());
        if let Some((model, numbers)) = near {
            carry_over(model, numbers, &prepared.model, &mut theta);
        }
        let numbers = free(&prepared.model).len();
        let mut failed = None;
        if numbers > 0 {
            self.check_rows(numbers)?;
            let task = Task {
                record: &self.record,
                used: &self.used.mask,
                noise: self.noise,
                loss: self.options.loss,
                known: &known,
                is_near: near.is_some(),
                quick: false,
            };
            match fit_and_force(&prepared, &theta, &task) {
                Ok((fit, force)) => {
                    return Ok(Climbed { prepared, theta: fit.theta.clone(), fit: Some(fit), force, failed });
                }
                // Without a state at the rows nothing can be fitted: the rung keeps its start and reports the
                // error.
                Err(error) if is_of_rows(&error) => {
                    failed = Some(prepared.model.explained(&self.record, &theta, error));
                }
                Err(error) => return Err(self.about(error)),
            }
        }
        let found = self.predicted(&prepared, &theta)?;
        if count == 0 && self.with_state(&[&found.prediction.force]).next().is_none() {
            // Not a single row has a state, so there is nothing to compare.
            let error = found.error.unwrap_or(ModelError::Values { given: 0, expected: 1 });
            return Err(self.about(prepared.model.explained(&self.record, &theta, error)));
        }
        Ok(Climbed { prepared, theta, fit: None, force: found.prediction.force, failed })
    }

    /// Predictions of a model with parameters `theta` for all rows that count.
    pub(crate) fn predicted(&self, prepared: &Prepared, theta: &[f64]) -> Result<Partly, InferenceError> {
        let counting = Warm::of_rows(&self.used.mask);
        let found = prepared.model.evaluate_partly(&self.record, theta, &Wanted::default(), &counting);
        found.map_err(|error| self.about(error))
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

    /// Rows that count and have a state in each of these predictions.
    pub(crate) fn with_state<'b>(
        &self,
        forces: &'b [&Vec<f64>],
    ) -> impl Iterator<Item = usize> + use<'_, 'b> {
        self.rows().filter(move |row| forces.iter().all(|force| force[*row].is_finite()))
    }

    /// Rows that count and have no state in a prediction, with the reason.
    pub(crate) fn without_state(&self, climbed: &Climbed) -> Option<LeftOut> {
        let rows: Vec<usize> = self.rows().filter(|row| !climbed.force[*row].is_finite()).collect();
        let model = &climbed.prepared.model;
        let mut only = vec![false; self.record.len()];
        *only.get_mut(*rows.first()?)? = true;
        let first =
            model.evaluate_warm(&self.record, &climbed.theta, &Wanted::default(), &Warm::of_rows(&only));
        let why = first.err().map_or_else(
            || "no state within the fit".to_owned(),
            |error| model.explained(&self.record, &climbed.theta, error).to_string(),
        );
        Some(LeftOut { why, lines: lines(&self.data, &rows), rows: rows.len() })
    }

    /// A model error with the lines of the file.
    pub(crate) fn about(&self, error: ModelError) -> InferenceError {
        let what = match &error {
            ModelError::NoEquilibrium { rows, .. } | ModelError::NotFinite { rows, .. }
                if !rows.is_empty() =>
            {
                format!("line {}: ", lines(&self.data, rows))
            }
            _ => String::new(),
        };
        InferenceError::Model { what, source: Box::new(error) }
    }

    /// The same with other effects and further restrictions; noise, weights and rows stay. Data, record and
    /// solved equilibria are shared.
    pub(crate) fn with_effects<'b>(
        &'b self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Analysis<'b>, InferenceError> {
        for effect in effects {
            check_needs(effect, &self.record)?;
        }
        let mut options = Options { effects: effects.to_vec(), ..Options::clone(&self.options) };
        options.restrictions.extend_from_slice(restrictions);
        Ok(Analysis {
            root: self.root.clone().restricted(&options.restrictions),
            data: Cow::Borrowed(&self.data),
            muscle: self.muscle,
            options: Cow::Owned(options),
            record: Arc::clone(&self.record),
            used: self.used.clone(),
            levels: self.levels.clone(),
            folds: self.folds.clone(),
            noise: self.noise,
            full_scale: self.full_scale,
            findings: self.findings.clone(),
            pure_error: self.pure_error,
            doubtful: self.doubtful.clone(),
            slack: self.slack.clone(),
            near: self.near,
        })
    }

    /// Checks once for impossible units, signs and scales, and leaves out parts of the rows that are in other
    /// units, and rows in which the muscle as stated is slack.
    pub(crate) fn ask(&mut self) -> Result<(), InferenceError> {
        if self.slack.is_some() {
            return Ok(());
        }
        let prepared = self.model(0)?;
        let used = &self.used.mask;
        for (rows, why) in in_other_units(&self.data, self.muscle, &prepared.model, &self.record, used) {
            self.used.leave_out(&self.data, rows, why);
            self.full_scale = full_scale(self.data.force(), self.used.rows());
            self.noise = Noise::of(self.muscle, (0.01 * self.full_scale).max(f64::MIN_POSITIVE));
        }
        let unread = unread(&self.data, &prepared.model, &self.record, self.full_scale);
        if let Some((_, rows)) = &unread {
            let why = "no force, all along a sweep in which the muscle as stated pulls";
            self.used.leave_out(&self.data, rows.iter().copied(), why.to_owned());
        }
        self.findings = questions(&self.data, self.muscle, &prepared.model, &self.record, &self.used.mask);
        self.findings.extend(unread.map(|(question, _)| question));
        let is_decided = self.findings.iter().any(|finding| finding.decided);
        if let Some(what) = self.data.impossible(|row| self.used.mask[row]).filter(|_| !is_decided) {
            return Err(InferenceError::Unit { what });
        }
        let is_law = self.options.law.is_some();
        let slack = if is_law { Vec::new() } else { buckled(&prepared.model, &self.record, &self.used.mask) };
        self.leave_out_slack(slack);
        Ok(())
    }

    fn leave_out_slack(&mut self, rows: Vec<usize>) {
        let why =
            "slack: the pressure is too low for the rubber of the muscle as stated, and it hardly pulled";
        self.used.leave_out(&self.data, rows.iter().copied(), why.to_owned());
        self.slack = Some(rows);
    }

    /// Climbs the base and measures the noise with it, after [`Self::ask`].
    pub(crate) fn begin(&mut self) -> Result<First, InferenceError> {
        self.ask()?;
        let climbed = self.climb(0, None)?;
        Ok(First { floor: self.measure_noise(&climbed), climbed })
    }

    /// Estimates the noise floor and sets the noise of the force. From here on, readings that the residuals
    /// show to be disturbed don't count, and rows of uncertain direction get larger standard deviations.
    fn measure_noise(&mut self, first: &Climbed) -> Option<NoiseFloor> {
        let floor = self.noise_floor(first);
        let stated = self.muscle.instruments().force.map_or(0.0, |force| force.noise());
        let sd = if stated > 0.0 { stated } else { floor.as_ref().map_or(0.0, |floor| floor.sd_n) };
        if sd > 0.0 {
            self.noise.force_n = sd;
        }
        self.used.leave_out_spikes(&self.data, self.residuals(first));
        let residuals = self.residuals(first);
        self.used.leave_out_shifted(&self.data, &self.record, &residuals, self.noise.force_n);
        let doubtful = self.data.direction_in_doubt();
        // As the file states them; the record may have those of an earlier comparison.
        let of_file = (&*doubtful, self.data.force_sd());
        let sd = self.noise.force_n;
        if let Some(sd) = doubtful_sd(&self.record, of_file, &self.used.mask, &self.levels, &residuals, sd) {
            self.record = Arc::new(Record::clone(&self.record).with_force_sd(sd));
            self.doubtful = doubtful;
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
            directed_rmse_n: self.directed_rmse(&climbed.force, error.rmse),
            half_gap_rmse_n: loops::half_gap_error(self, &climbed.force),
            fit: climbed.fit.clone(),
            held: held(&climbed.prepared.model, &climbed.theta),
            without_state: self.without_state(climbed),
        }
    }

    /// The noise of a fit: that of a robust one may be smaller than that of the data.
    fn noise_of(&self, climbed: &Climbed) -> Noise {
        let force_n = climbed.fit.as_ref().map_or(self.noise.force_n, |fit| fit.sd_n);
        Noise { force_n, ..self.noise }
    }

    /// RMS error on pressures (specimens, sweeps) that took no part in the fit, over the rows that have a
    /// state there; none if fewer than half have one.
    pub(crate) fn held_out(&self, climbed: &Climbed) -> Option<f64> {
        let folds = self.folds.as_ref()?;
        let (thin, kept) = self.record.thinned(FEWER_ROWS);
        let some = some_of_long(&self.record);
        let numbers = free(&climbed.prepared.model).len();
        let of_fold = |fold: usize| -> Result<Option<(f64, usize)>, ModelError> {
            let in_fold = |row: &usize| folds.at(*row) == fold;
            let train: Vec<bool> = kept.iter().map(|row| self.used.mask[*row] && !in_fold(row)).collect();
            if numbers > 0 && train.iter().filter(|t| **t).count() <= numbers {
                return Ok(None);
            }
            let theta = if numbers > 0 {
                let task = Task {
                    record: &thin,
                    used: &train,
                    noise: self.noise_of(climbed),
                    loss: self.options.loss,
                    known: &[],
                    is_near: true,
                    quick: true,
                };
                fit(&climbed.prepared, &climbed.theta, &task)?.theta
            } else {
                climbed.theta.clone()
            };
            // All held-out rows are predicted, with their whole history; of a long record, the rows that a
            // fit takes.
            let test: Vec<bool> = match &some {
                Some((_, kept)) => kept.iter().map(|row| self.used.mask[*row] && in_fold(row)).collect(),
                None => (0..self.record.len()).map(|row| self.used.mask[row] && in_fold(&row)).collect(),
            };
            let record = some.as_ref().map_or(&*self.record, |(record, _)| record);
            let warm = Warm::of_rows(&test);
            let model = &climbed.prepared.model;
            let found = model.evaluate_partly(record, &theta, &Wanted::default(), &warm)?;
            let force = found.prediction.force;
            let rows = (0..test.len()).filter(|row| test[*row] && force[*row].is_finite());
            let square = rows.clone().map(|row| (record.force()[row] - force[row]).powi(2)).sum();
            Ok(Some((square, rows.count())))
        };
        let found: Vec<_> = (0..folds.count).into_par_iter().map(of_fold).collect();
        let mut sums = (0.0, 0_usize);
        for fold in found {
            // Parameters fitted to the other rows may leave the held-out ones without a state.
            let (square, count) = fold.ok().flatten()?;
            sums = (sums.0 + square, sums.1 + count);
        }
        let counting = match &some {
            Some((_, kept)) => kept.iter().filter(|row| self.used.mask[**row]).count(),
            None => self.rows().count(),
        };
        (2 * sums.1 > counting).then(|| (sums.0 / sums.1 as f64).sqrt())
    }

    pub(crate) fn summary(&self) -> DataSummary {
        let range = |value: &dyn Fn(usize) -> f64| range(self.rows().map(value));
        let moments = self.record.moments();
        DataSummary {
            rows: self.record.len(),
            used: self.rows().count(),
            left_out: self.used.left_out.clone(),
            findings: self.findings.clone(),
            reading: self.used.reading.clone(),
            sha256: self.data.sha256(),
            files: self.data.files().iter().map(|file| file.name.clone()).collect(),
            sweeps: self.record.sweeps().len(),
            sweep_kinds: self.data.sweeps().iter().map(|sweep| sweep.kind).collect(),
            branches: branches(&self.data),
            specimens: self.record.specimens().to_vec(),
            is_path: self.record.is_path(),
            pressure_pa: range(&|row| moments[row].pressure),
            contraction: range(&|row| moments[row].contraction),
            force_n: range(&|row| self.record.force()[row]),
            full_scale_n: self.full_scale,
        }
    }
}
