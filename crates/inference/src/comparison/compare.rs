//! Model against measurement: the ladder of errors, rung by rung, and where the error lies.

use bulge_effects::Effect;
use bulge_measurements::{Data, Finding, QualityOptions};
use bulge_model::{Model, ModelError, Restriction};
use bulge_muscles::{Muscle, Quantity};
use std::sync::Arc;

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::{Comparison, DataSummary, NoiseFloor, Rung};
use crate::comparison::options::Options;
use crate::comparison::recent::Recent;
use crate::comparison::row_by_row::Rows;
use crate::comparison::specimens::note;
use crate::comparison::warnings::without_state;
use crate::comparison::{isotonic, loops, residuals, rivals, stack};
use crate::error::InferenceError;
use crate::fit::document::{Convergence, Fit};
use crate::fit::held::{HeldNumber, held};

/// Compares a muscle with data.
///
/// # Errors
/// See [`InferenceError`]: too few rows, a muscle that doesn't match, an effect that doesn't suit the muscle
/// or the data.
pub fn compare(data: &Data, muscle: &Muscle, options: &Options) -> Result<Comparison, InferenceError> {
    // On a thread of the pool, so that small evaluations aren't handed over to it one by one.
    rayon::scope(|_| Comparing::of(Analysis::new(data, muscle, options)?)?.asked())
}

/// The comparison with its rows and the force of each rung, as a report draws them.
///
/// # Errors
/// As [`compare`].
pub fn compare_with_rows(
    data: &Data,
    muscle: &Muscle,
    options: &Options,
) -> Result<(Comparison, Rows), InferenceError> {
    rayon::scope(|_| Comparing::of(Analysis::new(data, muscle, options)?)?.asked_with_rows())
}

/// The comparison for a model with the same effects whose parameters are approximately known; it shares the
/// record of another analysis.
pub(crate) fn compare_near(
    other: &Analysis<'_>,
    options: &Options,
    near: (&Model, &[f64]),
) -> Result<(Comparison, Rows), InferenceError> {
    Comparing::of(other.with_options(options, near)?)?.asked_with_rows()
}

/// A comparison that is repeated with other effects and other restrictions. The base and each rung of the
/// ladder are computed once.
///
/// An answer equals that of [`compare`] with these effects and restrictions and doesn't depend on earlier
/// questions.
pub struct Comparing<'a> {
    analysis: Analysis<'a>,
    floor: Option<NoiseFloor>,
    quality: Vec<Finding>,
    base: Arc<Step>,
    /// Rungs, by their effects in order and by the restrictions.
    steps: Recent<Step>,
    /// Answers, by the same key.
    answers: Recent<Comparison>,
}

/// Most rungs and answers that are kept: several changes for each effect of the catalogue.
const MOST_KEPT: usize = 256;
/// Most forces that they may hold, 256 MB: a rung holds one for every row, an answer about as many.
const MOST_FORCES: usize = 1 << 25;
/// Fewest rungs that are kept, even of the longest record: one ladder.
const FEWEST_KEPT: usize = 12;

/// Key of rungs and answers: each effect with the restrictions of its parameters, in order.
fn key(effects: &[Arc<dyn Effect>], restrictions: &[Restriction]) -> Vec<String> {
    let one = |effect: &Arc<dyn Effect>| {
        let name = effect.card().name;
        let own: Vec<&Restriction> = restrictions.iter().filter(|one| one.number.effect == name).collect();
        if own.is_empty() { name.to_owned() } else { format!("{name} {own:?}") }
    };
    effects.iter().map(one).collect()
}

/// A rung with its predictions.
struct Step {
    climbed: Climbed,
    rung: Rung,
}

impl Step {
    /// Whether any row has a state.
    fn says_something(&self, analysis: &Analysis<'_>) -> bool {
        self.rung.without_state.as_ref().is_none_or(|left| left.rows < analysis.rows().count())
    }
}

/// The last rung in which any row has a state; the base if none has.
fn last_that_says_something(analysis: &Analysis<'_>, ladder: &[Arc<Step>]) -> usize {
    ladder.iter().rposition(|step| step.says_something(analysis)).unwrap_or(0)
}

/// Findings of the data check, for the muscle's length.
pub(crate) fn quality(data: &Data, muscle: &Muscle) -> Vec<Finding> {
    let known = QualityOptions { l0_m: Some(muscle.length().si()), ..QualityOptions::default() };
    data.quality(&known).findings
}

impl<'a> Comparing<'a> {
    /// Compares with the base alone; the effects of `options` are not added yet.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn new(data: &'a Data, muscle: &'a Muscle, options: &'a Options) -> Result<Self, InferenceError> {
        rayon::scope(|_| Self::of(Analysis::new(data, muscle, options)?))
    }

    fn of(mut analysis: Analysis<'a>) -> Result<Self, InferenceError> {
        analysis.ask()?;
        let first = analysis.climb(0, None)?;
        let floor = analysis.measure_noise(&first);
        analysis.bound_tails(&first);
        // The weights follow from the noise: repeat the first rung if it fits anything.
        let climbed = if first.fit.is_some() { analysis.climb(0, Some(&first))? } else { first };
        let base = Arc::new(Step { rung: analysis.rung(0, &climbed), climbed });
        let quality = quality(&analysis.data, analysis.muscle);
        let most = (MOST_FORCES / analysis.record.len()).clamp(FEWEST_KEPT, MOST_KEPT);
        let (steps, answers) = (Recent::new(most), Recent::new(most));
        Ok(Self { analysis, floor, quality, base, steps, answers })
    }

    /// Compares with these effects, in this order, instead of those of the options. The restrictions are
    /// added to those of the options.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn with(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Comparison, InferenceError> {
        if let Some(options) = self.of_other_base(effects, restrictions) {
            return rayon::scope(|_| self.begun_with(&options)?.asked());
        }
        let found = self.answers.of(&key(effects, restrictions), || {
            let analysis = self.analysis.with_effects(effects, restrictions)?;
            rayon::scope(|_| self.compared(&analysis, restrictions, true))
        })?;
        Ok(Comparison::clone(&found))
    }

    /// The options of a comparison with another base, if a restriction concerns a parameter of the base, such
    /// as a rig error that is fitted along.
    fn of_other_base(&self, effects: &[Arc<dyn Effect>], restrictions: &[Restriction]) -> Option<Options> {
        let base = &self.base.climbed.prepared.model;
        restrictions.iter().any(|restriction| base.mentions(restriction)).then(|| {
            let mut options = Options { effects: effects.to_vec(), ..Options::clone(&self.analysis.options) };
            options.restrictions.extend_from_slice(restrictions);
            options
        })
    }

    /// The comparison of the same data and muscle, started anew with other options.
    fn begun_with<'b>(&'b self, options: &'b Options) -> Result<Comparing<'b>, InferenceError> {
        Comparing::of(Analysis::new(&self.analysis.data, self.analysis.muscle, options)?)
    }

    /// Why an effect can't be added to this muscle with these data; none if it can.
    #[must_use]
    pub fn unsuitable(&self, effect: &Arc<dyn Effect>) -> Option<String> {
        let with_it = || self.analysis.with_effects(std::slice::from_ref(effect), &[])?.model(1);
        with_it().err().map(|error: InferenceError| error.to_string())
    }

    /// Every row of the data, with the force of the base and of the model with these effects.
    ///
    /// Rungs that [`Comparing::with`] has computed are not computed again.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn rows(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Rows, InferenceError> {
        self.rows_with(effects, restrictions, false)
    }

    /// The rows with the force of each rung, for a report.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn rows_of_rungs(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Rows, InferenceError> {
        self.rows_with(effects, restrictions, true)
    }

    fn rows_with(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
        of_all_rungs: bool,
    ) -> Result<Rows, InferenceError> {
        rayon::scope(|_| match self.of_other_base(effects, restrictions) {
            Some(options) => {
                let other = self.begun_with(&options)?;
                other.rungs(&other.analysis, &[], of_all_rungs)
            }
            None => {
                self.rungs(&self.analysis.with_effects(effects, restrictions)?, restrictions, of_all_rungs)
            }
        })
    }

    /// The last rung alone; equals the result of [`fit_effects`] with these effects and restrictions.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn fitting(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Fitting, InferenceError> {
        rayon::scope(|_| match self.of_other_base(effects, restrictions) {
            Some(options) => {
                let other = self.begun_with(&options)?;
                other.fitted(&other.analysis, &[], false)
            }
            None => self.fitted(&self.analysis.with_effects(effects, restrictions)?, restrictions, true),
        })
    }

    fn fitted(
        &self,
        analysis: &Analysis<'_>,
        restrictions: &[Restriction],
        again: bool,
    ) -> Result<Fitting, InferenceError> {
        let ladder = self.ladder(analysis, restrictions, again)?;
        let (base, last) = (&self.base, &ladder[ladder.len() - 1]);
        let Climbed { prepared, theta, fit, force, failed } = &last.climbed;
        let mut fit = fit.clone().unwrap_or_else(|| nothing_fitted(analysis, theta.clone(), force));
        fit.warnings.extend(failed.as_ref().map(|error| not_fitted("the fit", error)));
        fit.warnings.extend(last.rung.without_state.as_ref().map(|left| without_state("the fit", left)));
        fit.warnings.extend(note(&analysis.data, analysis.muscle));
        fit.warnings.splice(0..0, analysis.findings.iter().map(ToString::to_string));
        Ok(Fitting {
            held: held(&prepared.model, &fit.theta),
            model: prepared.model.clone(),
            fit,
            data: analysis.summary(),
            before_rmse_n: base.rung.rmse_n,
            rmse_n: last.rung.rmse_n,
            noise_floor: self.floor.clone(),
        })
    }

    /// The rows with the forces of the base and the last rung, or of all rungs.
    fn rungs(
        &self,
        analysis: &Analysis<'_>,
        restrictions: &[Restriction],
        of_all: bool,
    ) -> Result<Rows, InferenceError> {
        let ladder = self.ladder(analysis, restrictions, true)?;
        let last = last_that_says_something(analysis, &ladder);
        let wanted = (0..=last).filter(|place| of_all || [0, last].contains(place));
        let rungs: Vec<&Climbed> = wanted.map(|place| &ladder[place].climbed).collect();
        Rows::of(analysis, &rungs, last)
    }

    /// The comparison with the effects of the options, when nothing else will be asked.
    fn asked(self) -> Result<Comparison, InferenceError> {
        self.compared(&self.analysis, &[], false)
    }

    fn asked_with_rows(self) -> Result<(Comparison, Rows), InferenceError> {
        Ok((self.compared(&self.analysis, &[], true)?, self.rungs(&self.analysis, &[], true)?))
    }

    /// The rungs from the base to the last effect; they are kept if more questions will follow.
    fn ladder(
        &self,
        analysis: &Analysis<'_>,
        restrictions: &[Restriction],
        again: bool,
    ) -> Result<Vec<Arc<Step>>, InferenceError> {
        let mut ladder = vec![Arc::clone(&self.base)];
        let key = key(&analysis.options.effects, restrictions);
        for place in 0..key.len() {
            if place > 0
                && let Some(below) = Arc::get_mut(&mut ladder[place])
            {
                // The forces of many rows are large, and the ladder has the results of the rungs between.
                below.climbed.force = Vec::new();
            }
            let step = self.step(&key[..=place], again, || {
                let climbed = analysis.climb(place + 1, Some(&ladder[place].climbed))?;
                Ok(Step { rung: analysis.rung(place + 1, &climbed), climbed })
            })?;
            ladder.push(step);
        }
        Ok(ladder)
    }

    /// The rung that is kept under a key, or a new one, which is kept if more questions will follow.
    fn step(
        &self,
        key: &[String],
        again: bool,
        climb: impl FnOnce() -> Result<Step, InferenceError>,
    ) -> Result<Arc<Step>, InferenceError> {
        if again { self.steps.of(key, climb) } else { Ok(Arc::new(climb()?)) }
    }

    fn compared(
        &self,
        analysis: &Analysis<'_>,
        restrictions: &[Restriction],
        again: bool,
    ) -> Result<Comparison, InferenceError> {
        let mut ladder = self.ladder(analysis, restrictions, again)?;
        let place = last_that_says_something(analysis, &ladder);
        if let Some(Step { climbed, .. }) = Arc::get_mut(&mut ladder[place])
            && climbed.force.is_empty()
        {
            climbed.force = analysis.predicted(&climbed.prepared, &climbed.theta)?.prediction.force;
        }
        let last = &ladder[place].climbed;
        // The saturated surface follows the residuals of a better model more closely: less of them is taken
        // for noise then.
        let again = analysis.noise_floor(last);
        let floor = match (&self.floor, again) {
            (Some(first), Some(again)) if again.sd_n < first.sd_n => Some(again),
            (first, _) => first.clone(),
        };
        let forces = [&ladder[0].climbed.force, &last.force];
        let rungs: Vec<Rung> = ladder.iter().map(|step| step.rung.clone()).collect();
        let mut warnings = analysis.warnings(&rungs);
        for step in &ladder {
            let name = step.rung.added.as_deref().unwrap_or("base");
            warnings.extend(step.climbed.failed.as_ref().map(|error| not_fitted(name, error)));
        }
        let (contributions, maps) =
            rayon::join(|| stack::contributions(analysis, last), || residuals::maps(analysis, forces));
        // With the last fit's parameters the muscle may not even pull before all effects are added.
        let contributions = contributions.unwrap_or_else(|error| {
            warnings.push(format!("what each effect contributes can't be shown one by one: {error}"));
            Vec::new()
        });
        if contributions.is_empty() && !analysis.options.effects.is_empty() && warnings.is_empty() {
            let why = "with the numbers of the last fit the muscle has no state before all effects are in";
            warnings.push(format!("what each effect contributes can't be shown one by one: {why}"));
        }
        warnings.extend(floor.as_ref().and_then(|floor| beyond_sheet(analysis.muscle, floor)));
        let Analysis { muscle, options, .. } = analysis;
        Ok(Comparison {
            schema: "bulge.comparison/1",
            muscle: muscle.name().to_owned(),
            base: options.law.as_ref().map_or("equilibrium", |(law, _, _)| law.name).to_owned(),
            data: analysis.summary(),
            quality: self.quality.clone(),
            noise_floor: floor,
            by: residuals::breakdowns(analysis, forces),
            loops: loops::gaps(analysis, forces),
            isotonic: isotonic::held_loads(analysis, [&ladder[0].climbed, last]),
            maps,
            curves: residuals::curves(analysis, forces),
            contributions,
            scatter: residuals::scatter(analysis, forces),
            rivals: if options.rivals { rivals::laws(analysis) } else { Vec::new() },
            warnings,
            ladder: rungs,
        })
    }
}

/// Ratio of the readings' scatter to the noise of the data sheet from which the two are said to disagree.
const BEYOND_SHEET: f64 = 4.0;

/// Warns if the readings scatter far more than the noise of the data sheet, which weights the fits if it is
/// stated.
fn beyond_sheet(muscle: &Muscle, floor: &NoiseFloor) -> Option<String> {
    let stated = muscle.instruments().force.map(|force| force.noise()).filter(|sd| *sd > 0.0)?;
    let times = floor.sd_n / stated;
    (times > BEYOND_SHEET).then(|| {
        format!(
            "the readings of the force scatter by {:.1} N, {times:.0} times the noise of {stated:.2} N that the muscle file states of its sensor: check that number: fits \
             weigh their rows by it",
            floor.sd_n
        )
    })
}

fn not_fitted(name: &str, error: &ModelError) -> String {
    format!("`{name}` could not be fitted, its numbers are those that it starts from: {error}")
}

/// The effects fitted to the data, and the error before and after.
#[derive(Debug, Clone)]
pub struct Fitting {
    /// The model with its effects, and the rig errors that were fitted along.
    pub model: Model,
    /// The fit.
    pub fit: Fit,
    /// Parameters that were held at a value or tied to another one.
    pub held: Vec<HeldNumber>,
    /// Summary of the data.
    pub data: DataSummary,
    /// RMS error of the muscle as stated \[N\].
    pub before_rmse_n: f64,
    /// RMS error with the effects \[N\].
    pub rmse_n: f64,
    /// The error that no model can go below, if it is known.
    pub noise_floor: Option<NoiseFloor>,
}

/// Fits the effects to the data: the last rung of the ladder of [`compare`], without held-out errors and the
/// other results beside it.
///
/// # Errors
/// As [`compare`].
pub fn fit_effects(data: &Data, muscle: &Muscle, options: &Options) -> Result<Fitting, InferenceError> {
    let options = Options { held_out: false, ..options.clone() };
    rayon::scope(|_| {
        let comparing = Comparing::of(Analysis::new(data, muscle, &options)?)?;
        comparing.fitted(&comparing.analysis, &[], false)
    })
}

/// The fit of a model without free parameters.
fn nothing_fitted(analysis: &Analysis<'_>, theta: Vec<f64>, force: &Vec<f64>) -> Fit {
    let error = residuals::summary(analysis, force);
    Fit {
        parameters: Vec::new(),
        theta,
        rmse_n: error.rmse,
        cost: 0.0,
        sd_n: analysis.noise.force_n,
        effective_rows: analysis.rows().count() as f64,
        correlations: Vec::new(),
        convergence: Convergence {
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
