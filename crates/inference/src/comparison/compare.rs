//! Model against measurement: the ladder of errors, rung by rung, and where the error lies.

use bulge_effects::Effect;
use bulge_measurements::{Data, Finding, QualityOptions};
use bulge_model::{Model, ModelError, Restriction};
use bulge_muscles::{Muscle, Quantity};
use std::sync::Arc;

use crate::comparison::analysis::{Analysis, Climbed, First};
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
use crate::fit::posterior::{Posterior, posterior_of};

/// Compares a muscle with data.
///
/// # Errors
/// See [`InferenceError`]: too few rows, a muscle that doesn't match, an effect that doesn't suit the muscle
/// or the data.
pub fn compare(data: &Data, muscle: &Muscle, options: &Options) -> Result<Comparison, InferenceError> {
    // On a thread of the pool, so that small evaluations aren't handed over to it one by one.
    rayon::scope(|_| {
        Comparing::of(Analysis::new(data, muscle, options)?)?
            .asked(|own, analysis, ladder| Ok(own.compared(analysis, ladder)))
    })
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

/// The comparison that goes on from the first rung of an analysis, with effects whose parameters are
/// approximately known.
pub(crate) fn compare_after<'b>(
    first: &First,
    analysis: &'b Analysis<'_>,
    effects: &[Arc<dyn Effect>],
    near: (&'b Model, &'b [f64]),
) -> Result<(Comparison, Rows), InferenceError> {
    let mut analysis = analysis.with_effects(effects, &[])?;
    analysis.near = Some(near);
    Comparing::after(first.clone(), analysis)?.asked_with_rows()
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

/// The rows with the forces of the base and the last rung, or of all rungs.
fn rungs(analysis: &Analysis<'_>, ladder: &[Arc<Step>], of_all: bool) -> Result<Rows, InferenceError> {
    let last = last_that_says_something(analysis, ladder);
    let wanted = (0..=last).filter(|place| of_all || [0, last].contains(place));
    let rungs: Vec<&Climbed> = wanted.map(|place| &ladder[place].climbed).collect();
    Rows::of(analysis, &rungs, last)
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
        Self::after(analysis.begin()?, analysis)
    }

    /// Goes on from the first rung.
    fn after(First { climbed, floor }: First, mut analysis: Analysis<'a>) -> Result<Self, InferenceError> {
        analysis.bound_tails(&climbed);
        // The weights follow from the noise: repeat the first rung if it fits anything.
        let climbed = if climbed.fit.is_some() { analysis.climb(0, Some(&climbed))? } else { climbed };
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
        let answer = |own: &Comparing<'_>, analysis: &Analysis<'_>, ladder: &[Arc<Step>]| {
            Ok(own.compared(analysis, ladder))
        };
        if self.is_of_base(restrictions) {
            return self.asking(effects, restrictions, answer);
        }
        let key = key(effects, restrictions);
        let found = self.answers.of(&key, || self.asking(effects, restrictions, answer))?;
        Ok(Comparison::clone(&found))
    }

    /// Whether a restriction concerns a parameter of the base, such as a rig error that is fitted along.
    fn is_of_base(&self, restrictions: &[Restriction]) -> bool {
        let base = &self.base.climbed.prepared.model;
        restrictions.iter().any(|restriction| base.mentions(restriction))
    }

    /// An answer from the ladder with these effects and restrictions. The comparison starts anew if a
    /// restriction concerns the base.
    fn asking<T: Send>(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
        answer: impl FnOnce(&Comparing<'_>, &Analysis<'_>, &[Arc<Step>]) -> Result<T, InferenceError> + Send,
    ) -> Result<T, InferenceError> {
        rayon::scope(|_| {
            let analysis = self.analysis.with_effects(effects, restrictions)?;
            if self.is_of_base(restrictions) {
                let other = Analysis::new(&analysis.data, analysis.muscle, &analysis.options)?;
                return Comparing::of(other)?.asked(answer);
            }
            answer(self, &analysis, &self.ladder(&analysis, restrictions)?)
        })
    }

    /// An answer from the ladder with the effects of the options.
    fn asked<T>(
        &self,
        answer: impl FnOnce(&Self, &Analysis<'_>, &[Arc<Step>]) -> Result<T, InferenceError>,
    ) -> Result<T, InferenceError> {
        answer(self, &self.analysis, &self.ladder(&self.analysis, &[])?)
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
        self.asking(effects, restrictions, |_, analysis, ladder| rungs(analysis, ladder, false))
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
        self.asking(effects, restrictions, |_, analysis, ladder| rungs(analysis, ladder, true))
    }

    /// The last rung alone; equals the result of [`fit_effects`] with these effects and restrictions.
    ///
    /// # Errors
    /// As [`compare`]; also if some rows have no state with the numbers that the fit starts from.
    pub fn fitting(
        &self,
        effects: &[Arc<dyn Effect>],
        restrictions: &[Restriction],
    ) -> Result<Fitting, InferenceError> {
        self.asking(effects, restrictions, fitted)
    }

    fn asked_with_rows(&self) -> Result<(Comparison, Rows), InferenceError> {
        self.asked(|comparing, analysis, ladder| {
            Ok((comparing.compared(analysis, ladder), rungs(analysis, ladder, true)?))
        })
    }

    /// The rungs from the base to the last effect. They are kept for further questions.
    fn ladder(
        &self,
        analysis: &Analysis<'_>,
        restrictions: &[Restriction],
    ) -> Result<Vec<Arc<Step>>, InferenceError> {
        let mut ladder = vec![Arc::clone(&self.base)];
        let key = key(&analysis.options.effects, restrictions);
        for place in 0..key.len() {
            let step = self.steps.of(&key[..=place], || {
                let climbed = analysis.climb(place + 1, Some(&ladder[place].climbed))?;
                Ok::<_, InferenceError>(Step { rung: analysis.rung(place + 1, &climbed), climbed })
            })?;
            ladder.push(step);
        }
        Ok(ladder)
    }

    fn compared(&self, analysis: &Analysis<'_>, ladder: &[Arc<Step>]) -> Comparison {
        let last = &ladder[last_that_says_something(analysis, ladder)].climbed;
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
        for step in ladder {
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
        Comparison {
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
        }
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
/// As [`compare`]; also if some rows have no state with the numbers that the fit starts from.
pub fn fit_effects(data: &Data, muscle: &Muscle, options: &Options) -> Result<Fitting, InferenceError> {
    let options = Options { held_out: false, ..options.clone() };
    rayon::scope(|_| Comparing::of(Analysis::new(data, muscle, &options)?)?.asked(fitted))
}

/// The fit of [`fit_effects`], with the posterior of its parameters. The same seed gives the same draws.
///
/// # Errors
/// As [`fit_effects`].
pub fn posterior(
    data: &Data,
    muscle: &Muscle,
    options: &Options,
    seed: u64,
) -> Result<(Fitting, Posterior), InferenceError> {
    let options = Options { held_out: false, ..options.clone() };
    rayon::scope(|_| {
        Comparing::of(Analysis::new(data, muscle, &options)?)?.asked(|own, analysis, ladder| {
            let fitting = fitted(own, analysis, ladder)?;
            let climbed = &ladder[ladder.len() - 1].climbed;
            let found = posterior_of(analysis, climbed, &fitting.fit, seed);
            Ok((fitting, found.map_err(|error| analysis.about(error))?))
        })
    })
}

/// The last rung alone.
fn fitted(
    own: &Comparing<'_>,
    analysis: &Analysis<'_>,
    ladder: &[Arc<Step>],
) -> Result<Fitting, InferenceError> {
    let (base, last) = (&own.base, &ladder[ladder.len() - 1]);
    let Climbed { prepared, theta, fit, force, failed } = &last.climbed;
    if let Some(error) = failed {
        let what =
            "nothing was fitted, and nothing is written: with the numbers that the fit starts from there is ";
        return Err(InferenceError::Model { what: what.to_owned(), source: Box::new(error.clone()) });
    }
    let mut fit = fit.clone().unwrap_or_else(|| nothing_fitted(analysis, theta.clone(), force));
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
        noise_floor: own.floor.clone(),
    })
}

/// The fit of a model without free parameters.
fn nothing_fitted(analysis: &Analysis<'_>, theta: Vec<f64>, force: &Vec<f64>) -> Fit {
    let error = residuals::summary(analysis, force);
    let reason = "there was nothing to fit".to_owned();
    Fit {
        theta,
        rmse_n: error.rmse,
        sd_n: analysis.noise.force_n,
        effective_rows: analysis.rows().count() as f64,
        convergence: Convergence { converged: true, reason, ..Convergence::default() },
        ..Fit::default()
    }
}
