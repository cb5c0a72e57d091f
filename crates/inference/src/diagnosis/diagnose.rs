//! Diagnosis: the noise first, then the missing effects, step by step, with the confidence of the answer.

use bulge_effects::Effect;
use bulge_measurements::Data;
use bulge_model::Model;
use bulge_muscles::Muscle;
use rayon::prelude::*;
use std::sync::Arc;

use crate::comparison::analysis::{Analysis, Climbed, First};
use crate::comparison::compare::{compare_after, compare_with_rows};
use crate::comparison::options::Options;
use crate::comparison::requirements::{DIAGNOSED, check_memory};
use crate::comparison::rows::lines;
use crate::comparison::specimens::of_specimens;
use crate::diagnosis::averaged_data::{
    AveragedData, Stop, averaged_data, averaged_data_again, effective_rows, row_sd,
};
use crate::diagnosis::classes::Class;
use crate::diagnosis::confidence::{Confidence, confidence};
use crate::diagnosis::document::{Diagnosis, Verdict};
use crate::diagnosis::either::quieter;
use crate::diagnosis::event::{Anew, event};
use crate::diagnosis::fits::Fits;
use crate::diagnosis::geometry::{Asked, Doubt, geometry};
use crate::diagnosis::late::Late;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::next::{Judged, next_experiment};
use crate::diagnosis::not_looked_for::not_looked_for;
use crate::diagnosis::proposals::{Limits, NextLimits};
use crate::diagnosis::rungs::bent_rungs;
use crate::diagnosis::search::Search;
use crate::diagnosis::stage::Stage;
use crate::diagnosis::unanswered::{cannot_tell, unanswered};
use crate::diagnosis::write::{Findings, document};
use crate::error::InferenceError;
use crate::progress::Progress;

/// Most times that rows without a state are left out.
const MOST_LEFT_OUT: usize = 8;

/// Most times that an accepted effect is replaced by a better one or removed.
const MOST_CHANGES: usize = 3;

/// Options of a diagnosis, besides muscle and data.
#[derive(Debug, Clone)]
pub struct DiagnoseOptions {
    /// Effects that the base has (`--with`), known effects, catalogue and law.
    pub base: Options,
    /// Names of the effects that are looked for; none means the whole catalogue.
    pub among: Option<Vec<String>>,
    /// RMS misfit that doesn't matter \[N\]. It can withdraw claims, but never adds one.
    pub tolerance_n: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Limits of the next experiment; the ranges of these data if nothing is stated.
    pub limits: NextLimits,
    /// Callbacks for the progress.
    pub progress: Progress,
}

impl DiagnoseOptions {
    /// The whole catalogue, no tolerance, seed 1, no progress callbacks.
    #[must_use]
    pub fn new(base: Options) -> Self {
        Self {
            base,
            among: None,
            tolerance_n: None,
            seed: 1,
            limits: NextLimits::default(),
            progress: Progress::default(),
        }
    }

    /// The same question where only the verdict and the names of its answer are looked at.
    fn names_alone(&self) -> Self {
        let base = Options { rivals: false, held_out: false, ..self.base.clone() };
        Self { base, progress: Progress::default(), ..self.clone() }
    }
}

/// Finds the physical effect that is missing in the model of a muscle.
///
/// Too few data are no error: the verdict is then [`crate::Verdict::CannotTell`], with the reason.
///
/// # Errors
/// See [`InferenceError`]: no rows at all, a muscle that doesn't match, an effect that doesn't suit the
/// muscle or the data.
pub fn diagnose(
    data: &Data,
    muscle: &Muscle,
    options: &DiagnoseOptions,
) -> Result<Diagnosis, InferenceError> {
    // On a thread of the pool, so that small evaluations aren't handed over to it one by one.
    rayon::scope(|_| {
        check_memory(data, DIAGNOSED)?;
        let doubt = Doubt::of(muscle);
        let found = answered(data, [muscle, &doubt.doubted], options)?;
        options.progress.at(0.96, "the geometry in doubt");
        let of_exact = |exact: &Muscle, asked: Asked| {
            let options = match asked {
                Asked::Whole => DiagnoseOptions { progress: Progress::default(), ..options.clone() },
                Asked::Names => options.names_alone(),
            };
            answered(data, [muscle, exact], &options)
        };
        let mut found = doubt.settled(found, of_exact)?;
        doubt.say(&mut found, &options.base.catalogue);
        found.not_looked_for = not_looked_for(&found, &options.base.catalogue);
        if let Some(among) = &options.among {
            let names = among.join(", ");
            found
                .warnings
                .insert(0, format!("looked for {names} alone: what is missing may be another effect"));
        }
        options.progress.at(1.0, "done");
        Ok(found)
    })
}

/// The answer for a muscle, given as `[stated, doubted]`.
fn answered(
    data: &Data,
    muscles: [&Muscle; 2],
    options: &DiagnoseOptions,
) -> Result<Diagnosis, InferenceError> {
    match diagnosed(data, muscles, options, Across::NoEvent) {
        Err(error @ (InferenceError::TooFewRows { .. } | InferenceError::Identical { .. })) => {
            Ok(cannot_tell(&*of_specimens(data, muscles[0])?, muscles[0], &error.to_string()))
        }
        found => found,
    }
}

/// What an answer may stretch across.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Across {
    /// Nothing that happened during the test.
    NoEvent,
    /// Anything: the answer for a part of the rows.
    Anything,
}

fn diagnosed(
    data: &Data,
    [stated, muscle]: [&Muscle; 2],
    options: &DiagnoseOptions,
    across: Across,
) -> Result<Diagnosis, InferenceError> {
    let mut analysis = Analysis::new(data, muscle, &options.base)?;
    analysis.ask()?;
    if analysis.findings.iter().any(|finding| finding.decided) {
        let options = Options { rivals: false, held_out: false, ..options.base.clone() };
        let (comparison, rows) = compare_with_rows(data, stated, &options)?;
        return Ok(Diagnosis { rows: Some(rows), ..unanswered(&analysis.data, stated, comparison) });
    }
    let first = analysis.begin()?;
    let mut base = analysis.climb(options.base.effects.len(), Some(&first.climbed))?;
    let without = |rows: &[usize]| {
        let mut options = options.names_alone();
        options.base.excluded.extend_from_slice(rows);
        diagnosed(data, [stated, muscle], &options, Across::Anything).ok()
    };
    let exchanged = |names: [&str; 2]| {
        let [stated, muscle] = [with_exchanged(stated, names)?, with_exchanged(muscle, names)?];
        diagnosed(data, [&stated, &muscle], &options.names_alone(), Across::Anything).ok()
    };
    let moved = |late: Late| {
        let mut options = options.names_alone();
        options.base.excluded.extend(late.without_partner(data));
        diagnosed(&data.clone().moved(late.channel, late.rows), [stated, muscle], &options, Across::Anything)
            .ok()
    };
    let anew = Anew { without: &without, exchanged: &exchanged, moved: &moved };
    let anew = (across == Across::NoEvent).then_some(anew);
    let (diagnosis, used) = where_it_has_a_state(&analysis, &mut base, |base, used| {
        on_rows(&analysis, &first, base, used, (options, anew))
    })?;
    Ok(diagnosis.without(&analysis, &used))
}

/// The muscle with the numbers of two specimens exchanged; none if they don't differ.
fn with_exchanged(muscle: &Muscle, [one, other]: [&str; 2]) -> Option<Muscle> {
    let numbers = |name: &str| {
        let own = muscle.specimens().iter().find(|specimen| specimen.name() == name);
        own.map_or(Vec::new(), |specimen| specimen.numbers().to_vec())
    };
    let [of_one, of_other] = [numbers(one), numbers(other)];
    if of_one == of_other {
        return None;
    }
    muscle.clone().with_specimen(one, of_other).ok()?.with_specimen(other, of_one).ok()
}

/// The result of `find` on the rows at which the base has a state, and those rows.
pub(crate) fn where_it_has_a_state<T>(
    analysis: &Analysis<'_>,
    base: &mut Climbed,
    mut find: impl FnMut(&mut Climbed, &[bool]) -> Result<T, Stop>,
) -> Result<(T, Vec<bool>), InferenceError> {
    // Without a state of the base there is no force to compare a catalogue effect with.
    let mut used = vec![false; analysis.record.len()];
    for row in analysis.with_state(&[&base.force]) {
        used[row] = true;
    }
    for _ in 0..MOST_LEFT_OUT {
        match find(base, &used) {
            Ok(found) => return Ok((found, used)),
            Err(Stop::Error(error)) => return Err(error),
            Err(Stop::Rows(rows)) => {
                for row in rows {
                    used[row] = false;
                }
                base.force = analysis.predicted(&base.prepared, &base.theta)?.prediction.force;
            }
        }
    }
    let left_out = "the model has no state at nearly all of them".to_owned();
    Err(InferenceError::NoRows { left_out })
}

impl Diagnosis {
    /// Adds a warning about rows that count but have no state in the base.
    fn without(mut self, analysis: &Analysis<'_>, used: &[bool]) -> Self {
        let rows: Vec<usize> = analysis.rows().filter(|row| !used[*row]).collect();
        if !rows.is_empty() {
            self.warnings.push(format!(
                "{} rows took no part in the diagnosis, because the base has no state there (line {})",
                rows.len(),
                lines(&analysis.data, &rows)
            ));
            self.data.used = self.data.used.saturating_sub(rows.len());
        }
        self
    }
}

/// The diagnosis on some of the rows.
fn on_rows(
    analysis: &Analysis<'_>,
    first: &First,
    base: &mut Climbed,
    used: &[bool],
    (options, anew): (&DiagnoseOptions, Option<Anew<'_>>),
) -> Result<Diagnosis, Stop> {
    let progress = &options.progress;
    progress.at(0.1, "the noise");
    let model = analysis.base_with_effects()?;
    let averaged_data = averaged_data(analysis, base, used, options)?;
    // The forces of many rows are large, and the means are used from here on.
    base.force = Vec::new();
    let Some(law) = &averaged_data.law else {
        let rows = averaged_data.record.len();
        let says = format!("{rows} rows are too few to know their noise");
        return Ok(cannot_tell(&analysis.data, analysis.muscle, &says));
    };
    progress.at(0.2, "the catalogue");
    let near = (&base.prepared.model, &base.theta[..]);
    let searched = |averaged_data: &AveragedData, context: &Context<'_>| {
        let search = context.search(&model, near);
        search.map_err(|error| Stop::at_means(error, &averaged_data.averaged, analysis))
    };
    let fits = Fits::after(None);
    let mut search = searched(&averaged_data, &averaged_data.context(law, options, Some(&fits)))?;
    // The first law includes the part of the base's misfit that no smooth function follows. The residuals of
    // a better model give a better law.
    progress.at(0.4, "the noise again");
    let again = averaged_data_again(analysis, &search, &averaged_data, used, options);
    let second = Fits::after(Some(&fits));
    let (averaged_data, context) = match again.as_ref().and_then(|again| Some((again, again.law.as_ref()?))) {
        Some((again, law)) => {
            let context = again.context(law, options, Some(&second));
            progress.at(0.45, "the catalogue again");
            search = searched(again, &context)?;
            (again, context)
        }
        None => (&averaged_data, averaged_data.context(law, options, Some(&fits))),
    };
    progress.at(0.55, "exchanges");
    let quieter = quieter(&context, averaged_data, &model, &mut search);
    let quieter = quieter.map_err(|error| Stop::at_means(error, &averaged_data.averaged, analysis))?;
    if let Some((law, whitening)) = &quieter {
        let quiet = Context { whitening, law, fits: None, ..context };
        return concluded((analysis, first), (&quiet, averaged_data), &model, search, (options, anew));
    }
    context.exchange(&model, &mut search);
    concluded((analysis, first), (&context, averaged_data), &model, search, (options, anew))
}

/// Classes, confidence and the ladder for the result of a search.
fn concluded(
    (analysis, first): (&Analysis<'_>, &First),
    (context, averaged_data): (&Context<'_>, &AveragedData),
    model: &Model,
    mut search: Search,
    (options, anew): (&DiagnoseOptions, Option<Anew<'_>>),
) -> Result<Diagnosis, Stop> {
    let progress = &options.progress;
    progress.at(0.6, "rivals");
    let mut judged = classes(context, model, &search);
    // The rivals may show that an effect can be dropped or swapped; the classes are then judged again.
    for _ in 0..MOST_CHANGES {
        let last = &search.stages[search.stages.len() - 1];
        let better = judged.iter().enumerate().find_map(|(place, j)| {
            let dropped = context.dropped(model, last, place, &j.class);
            dropped.or_else(|| context.swapped(last, place, &j.class))
        });
        let Some(better) = better else { break };
        search.replace_last(better);
        judged = classes(context, model, &search);
    }
    progress.at(0.75, "the next experiment");
    let is_whole = anew.is_some();
    let limits = || Limits::of(&averaged_data.record, options.limits);
    let next = if is_whole { next_experiment(context, &judged, &limits()) } else { None };
    progress.at(0.8, "what happened");
    let classes: Vec<(Class, Confidence)> =
        judged.into_iter().map(|judged| (judged.class, judged.confidence)).collect();
    let sd_n = row_sd(context.law, averaged_data);
    let mut found = Findings {
        context,
        search: &search,
        classes: &classes,
        sd_n,
        effective_rows: effective_rows(context, averaged_data, sd_n),
        known: options.base.effects.len(),
        tolerance_n: options.tolerance_n,
        next,
        all_may_be_form_error: match &search.stages[..] {
            [base, .., last] => context.may_be_form_error(last, base),
            _ => false,
        },
        event: None,
    };
    found.event = anew
        .and_then(|anew| event(&found, analysis, &averaged_data.averaged.groups, anew))
        .or_else(|| changed_after_the_first_sweep(&found, analysis));
    let compared = |found: &Findings<'_>| {
        let effects: Vec<Arc<dyn Effect>> =
            options.base.effects.iter().chain(found.shown()).cloned().collect();
        compare_after(first, analysis, &effects, found.last().confirmed.numbers())
    };
    progress.at(0.85, "the ladder");
    let answer = compared(&found)?;
    progress.at(0.92, "what form errors allow");
    let above_n = answer.0.ladder.last().map_or(f64::INFINITY, |rung| rung.rmse_n);
    let groups = &averaged_data.averaged.groups;
    let bent =
        if is_whole { bent_rungs(analysis, found.shown_stage(), groups, above_n)? } else { Vec::new() };
    let mut diagnosis = document(analysis.muscle, &found, answer, &bent);
    diagnosis.geometry = geometry(analysis, found.regardless());
    Ok(diagnosis)
}

/// What is said if nothing is missing without the first sweep, which was left out. The other sweeps don't show what
/// came to its end with it.
fn changed_after_the_first_sweep(found: &Findings<'_>, analysis: &Analysis<'_>) -> Option<String> {
    let left = analysis.used.first_is_shifted(&analysis.data)?;
    (found.verdict().0 == Verdict::Adequate).then(|| {
        format!(
            "without its first sweep (line {}) nothing is missing, and that one is shifted as a whole: the load cell was zeroed after it, or the muscle changed \
             (run-in, creep, warming up). Measure its set point once more at the end",
            left.lines
        )
    })
}

/// Each named effect with its rivals, and how often such a claim is right.
fn classes(context: &Context<'_>, model: &Model, search: &Search) -> Vec<Judged> {
    let last = &search.stages[search.stages.len() - 1];
    let of = |place: usize| {
        let known = search.of_effects(&last.without(place));
        if let Some((class, made)) = context.class(model, last, place, known)
            && let Some(without) = made.as_ref().or(known)
        {
            let confidence = confidence(context, &without.linear, &without.adequacy.null, &class);
            return Judged {
                class,
                confidence,
                models: Some((last.confirmed.clone(), without.confirmed.clone())),
            };
        }
        let name = last.added[place].card().name;
        let holds = |stage: &&Stage| stage.added.iter().any(|effect| effect.card().name == name);
        let before = search.stages.iter().take_while(|stage| !holds(stage)).last().unwrap_or(last);
        let confidence = Confidence::of_tried(&before.tried, name, &before.linear.sensitivities.effects);
        Judged { class: Class::without_baseline(last, place, before), confidence, models: None }
    };
    let judged: Vec<Judged> = (0..last.added.len()).into_par_iter().map(of).collect();
    for one in &judged {
        one.class.remember(context, last);
    }
    judged
}
