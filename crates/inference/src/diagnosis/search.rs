//! Forward search: from the base to the set of effects that explains the data, step by step, with a test of
//! adequacy before and after each step.

use bulge_effects::Effect;
use bulge_model::{Model, ModelError};
use rayon::prelude::*;
use std::sync::Arc;

use crate::diagnosis::bending::{Kin, may_bend};
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::hypotheses::{FAR, Hypothesis, Tried, effect_log_prior, hypotheses};
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::stage::{Stage, tempered};

/// Most effects that are added: the catalogue doesn't explain a misfit that takes more.
pub const MOST_EFFECTS: usize = 3;
/// If a fit reaches this fraction of the predicted decrease, the linear approximation holds and no other
/// starts are needed.
const PROMISED: f64 = 0.95;
/// Decrease of the sum of squares from which a minimum counts as another one: half a unit of log evidence.
const LOWER: f64 = 1.0;

/// A complete search: the base first, then each model that was accepted.
pub(crate) struct Search {
    pub(crate) stages: Vec<Stage>,
    /// The stage from which an unknown effect explains the rest better than the best known effect. Effects
    /// added later are only the nearest ones, not claims.
    pub(crate) something_else: Option<usize>,
    /// Other linearised models that are not on the path.
    pub(crate) beside: Vec<Stage>,
}

/// Names of effects, sorted.
pub(crate) fn names<'e>(effects: impl Iterator<Item = &'e Arc<dyn Effect>>) -> Vec<String> {
    let mut names: Vec<String> = effects.map(|effect| effect.card().name.to_owned()).collect();
    names.sort_unstable();
    names
}

impl Search {
    /// The stage with these effects, in any order.
    pub(crate) fn of_effects(&self, effects: &[Arc<dyn Effect>]) -> Option<&Stage> {
        let asked = names(effects.iter());
        self.stages.iter().chain(&self.beside).find(|stage| names(stage.added.iter()) == asked)
    }

    /// Replaces the last model, and the models on the path to it that don't lead to the new one.
    pub(crate) fn replace_last(&mut self, stage: Stage) {
        let has = |effect: &Arc<dyn Effect>| {
            stage.added.iter().any(|other| other.card().name == effect.card().name)
        };
        self.stages.pop();
        self.stages.retain(|before| before.added.len() < stage.added.len() && before.added.iter().all(has));
        self.stages.push(stage);
    }
}
impl Context<'_> {
    /// Searches from the base model for the set of effects that explains the data, until nothing more helps.
    ///
    /// `near` are the approximate parameters of the base.
    pub(crate) fn search(&self, base: &Model, near: (&Model, &[f64])) -> Result<Search, ModelError> {
        let confirmed = self.confirm(base, &[], Some(near), &[])?;
        let mut stages = vec![self.stage(Vec::new(), confirmed)?];
        let mut again = false;
        let mut something_else = None;
        while let [.., stage] = &mut stages[..] {
            // A form error may hide another effect.
            let is_bent = stage.confirmed.form.log_evidence > RULE.bent;
            let room = MOST_EFFECTS - stage.added.len();
            if stage.adequate && !is_bent || room == 0 || something_else.is_some() {
                break;
            }
            stage.tried = self.tried(base, stage, room);
            // A trial found a lower minimum of the stage's own model: repeat the trials once from there.
            if !again && let Some(lower) = self.lower(base, stage) {
                (*stage, again) = (lower, true);
                continue;
            }
            again = false;
            let ranked = ranked(&stages[stages.len() - 1].tried);
            let next = ranked.into_iter().find_map(|(best, confirmed)| self.step(&stages, best, confirmed));
            let next = next.map(|next| self.one_of(&stages, next));
            let stage = &stages[stages.len() - 1];
            let Some((next, stands_out, worth)) = next else {
                // Only the screen rejects the model, and no effect is worth its prior cost: that is chance.
                let adequacy = &stage.adequacy;
                let is_chance =
                    !adequacy.smooth_fails() && !adequacy.fit_fails && adequacy.unsmooth.is_none();
                if let Some(stage) = stages.last_mut() {
                    stage.adequate |= is_chance;
                }
                break;
            };
            // If the rest follows no smooth function, an effect that doesn't remove it explains nothing.
            if stage.adequacy.unsmooth.is_some() && !stage.adequate && next.adequacy.unsmooth.is_some() {
                break;
            }
            let replaces_bending = || {
                let [bent, left] = [stage, &next].map(|stage| stage.confirmed.form.log_evidence);
                next.adequate && worth > RULE.superfluous && left < RULE.less_bent * bent
            };
            if stage.adequate && !replaces_bending() {
                break;
            }
            if stage.something_else() > next.value_over(stage) + next.digits_over(&stages[0]) {
                something_else = Some(stages.len() - 1);
                if !stage.added.is_empty() {
                    break;
                }
            } else if !stands_out {
                break;
            }
            stages.push(next);
        }
        Ok(Search { stages, something_else, beside: Vec::new() })
    }

    /// The stage at a lower minimum of its own model, if a fit with further effects reached one and set those
    /// effects to zero.
    pub(crate) fn lower(&self, base: &Model, stage: &Stage) -> Option<Stage> {
        let effects = &stage.linear.sensitivities.effects;
        let is_idle = |tried: &&Tried| {
            let new: Vec<_> =
                tried.hypothesis.effects.iter().map(|i| Arc::clone(&effects[*i].effect)).collect();
            tried.confirmed.as_ref().is_some_and(|confirmed| confirmed.is_idle(&new))
        };
        let found = stage.tried.iter().filter(is_idle).filter_map(|tried| tried.confirmed.as_ref());
        let least = found.min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        if least.cost() > stage.confirmed.cost() - LOWER {
            return None;
        }
        let confirmed = self.confirm(base, &stage.added, Some(least.numbers()), &[]).ok()?;
        (confirmed.cost() < stage.confirmed.cost() - LOWER)
            .then(|| self.stage(stage.added.clone(), confirmed).ok())?
    }

    /// The stage that a hypothesis leads to from the last of `stages`, whether the step is significant
    /// against the remaining misfit, and its log evidence. None if it isn't worth its prior cost, or if the
    /// new model can't be linearised.
    fn step(&self, stages: &[Stage], tried: &Tried, confirmed: &Confirmed) -> Option<(Stage, bool, f64)> {
        let (base, stage) = (stages.first()?, stages.last()?);
        let worth = RULE.worth[usize::from(!stage.added.is_empty())];
        let effects = &stage.linear.sensitivities.effects;
        let new: Vec<Arc<dyn Effect>> =
            tried.hypothesis.effects.iter().map(|i| Arc::clone(&effects[*i].effect)).collect();
        if tried.log_evidence <= worth || confirmed.is_absurd(&new, self.record) || confirmed.is_idle(&new) {
            return None;
        }
        let gain = stage.confirmed.bent_cost() - confirmed.bent_cost();
        let mends = |first: &Confirmed| {
            let explained = base.confirmed.bent_cost() - first.bent_cost();
            may_bend(&first.prepared) && first.bent_cost() - confirmed.bent_cost() < RULE.mends * explained
        };
        let member = |one: &&Tried| matches!(&one.hypothesis.effects[..], [only] if new.len() > 1 && tried.hypothesis.effects.contains(only));
        let alone = stage.tried.iter().filter(member).filter_map(|one| one.confirmed.as_ref());
        // If the second effect of a pair only corrects the formula of the first, take a single effect.
        if alone.into_iter().any(mends) {
            let best = ranked(&stage.tried).into_iter().find(|(one, _)| one.hypothesis.effects.len() == 1);
            return best.and_then(|(one, confirmed)| self.step(stages, one, confirmed));
        }
        let mends = !stage.added.is_empty() && mends(&stage.confirmed);
        // It isn't an error of a formula if its evidence holds beside all form errors and an unknown effect
        // wouldn't do as well.
        let lead =
            tried.hypothesis.log_evidence.min(tried.log_evidence - stage.something_else() - RULE.no_bending);
        if mends && (new.len() > 1 || lead <= worth) {
            return None;
        }
        let mut added = stage.added.clone();
        added.extend(new);
        let next = self.stage(added, confirmed.clone()).ok()?;
        if mends && !next.adequate {
            return None;
        }
        // If something unknown remains, its scatter counts as noise, and the step must be significant against
        // that too.
        let stands_out = tempered(tried.log_evidence, gain, next.scatter()) > worth;
        Some((next, stands_out, tried.log_evidence))
    }

    /// Replaces a pair by its better half if an unknown effect on top of that does as well as the other half.
    fn one_of(&self, stages: &[Stage], pair: (Stage, bool, f64)) -> (Stage, bool, f64) {
        let Some(stage) = stages.last().filter(|stage| pair.0.added.len() == stage.added.len() + 2) else {
            return pair;
        };
        let effects = &stage.linear.sensitivities.effects;
        let is_half = |tried: &&Tried| {
            let [only] = &tried.hypothesis.effects[..] else { return false };
            let name = effects[*only].effect.card().name;
            tried.confirmed.is_some() && pair.0.added.iter().any(|effect| effect.card().name == name)
        };
        let halves = stage.tried.iter().filter(is_half);
        let best = halves.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
        let half = best.and_then(|half| self.step(stages, half, half.confirmed.as_ref()?));
        let margin = stages.first().map_or(0.0, |base| pair.0.digits_over(base));
        match half {
            Some(half)
                if half.0.adequate
                    || half.0.value_over(stage) > pair.0.value_over(stage) - RULE.pair + margin =>
            {
                half
            }
            _ => pair,
        }
    }

    /// The best hypotheses of a stage, each fitted; `room` is the number of effects that may still be added.
    fn tried(&self, base: &Model, stage: &Stage, room: usize) -> Vec<Tried> {
        let hypotheses = hypotheses(&stage.linear, &stage.confirmed.prepared.model, room);
        let (singles, pairs): (Vec<_>, Vec<_>) = hypotheses.into_iter().partition(|h| h.effects.len() == 1);
        let fitted = |list: Vec<Hypothesis>, kin: &Kin| -> Vec<Tried> {
            let known = Context { kin: Some(kin), ..*self };
            let tried: Vec<Tried> =
                list.into_par_iter().map(|hypothesis| known.fitted(base, stage, hypothesis)).collect();
            for one in &tried {
                self.remember(stage, one);
            }
            tried
        };
        let mut kin = stage.confirmed.form.kin.clone();
        let mut tried = fitted(singles, &kin);
        for confirmed in tried.iter().filter_map(|one| one.confirmed.as_ref()) {
            kin.extend(confirmed.form.kin.iter().map(|(name, own)| (name.clone(), Arc::clone(own))));
        }
        tried.extend(fitted(pairs, &kin));
        tried
    }

    /// Keeps the fit of a hypothesis on top of a stage.
    pub(crate) fn remember(&self, stage: &Stage, tried: &Tried) {
        if let (Some(fits), Some(confirmed)) = (self.fits, &tried.confirmed) {
            fits.add(&stage.with(&tried.hypothesis.effects), confirmed);
        }
    }

    /// Fits a hypothesis on top of a stage.
    pub(crate) fn fitted(&self, base: &Model, stage: &Stage, hypothesis: Hypothesis) -> Tried {
        let all = stage.with(&hypothesis.effects);
        let effects = &all[stage.added.len()..];
        let before = Self::numbers_of(base, stage);
        let starts: Vec<Vec<f64>> =
            hypothesis.starts.iter().map(|start| before.iter().chain(start).copied().collect()).collect();
        let holds =
            |confirmed: &Confirmed| stage.confirmed.cost() - confirmed.cost() >= PROMISED * hypothesis.gain;
        let near = self.fits.and_then(|fits| fits.near(&all));
        // The same model needs no other fit.
        let again = self.fits.and_then(|fits| fits.of(&all)).or_else(|| {
            near.as_ref().and_then(|near| self.confirm(base, &all, Some(near.numbers()), &[]).ok())
        });
        let mut confirmed = match again {
            Some(again) if holds(&again) => Some(again),
            again => {
                let found = self.confirm(base, &all, Some(stage.confirmed.numbers()), &starts).ok();
                lower(again, found)
            }
        };
        // The fit under the earlier noise law has tried further starts already.
        let is_far = hypothesis.gain > FAR && near.is_none() && !confirmed.as_ref().is_some_and(holds);
        if confirmed.is_none() || is_far {
            // Far from the validity of the linear approximation, start from the usual parameters and from a
            // tenth of them.
            let further: Vec<Vec<f64>> = [1.0, 0.1]
                .iter()
                .map(|part| before.iter().copied().chain(Self::usual(base, effects, *part)).collect())
                .collect();
            confirmed =
                lower(confirmed, self.confirm(base, &all, Some(stage.confirmed.numbers()), &further).ok());
        }
        let log_priors: f64 = hypothesis.effects.iter().map(|i| effect_log_prior(&stage.linear, *i)).sum();
        let log_evidence = confirmed
            .as_ref()
            .map_or(f64::NEG_INFINITY, |c| c.log_evidence - stage.confirmed.log_evidence + log_priors);
        Tried { hypothesis, confirmed, log_evidence }
    }

    /// A fraction `part` of the way from `off` to the usual parameters of effects.
    pub(crate) fn usual(base: &Model, effects: &[Arc<dyn Effect>], part: f64) -> Vec<f64> {
        let of = |effect: &Arc<dyn Effect>| {
            let copies = base.copies(effect.as_ref());
            let own: Vec<f64> = effect
                .parameters()
                .into_iter()
                .map(|card| card.of(base.muscle()))
                .map(|card| card.off + part * (card.typical - card.off))
                .collect();
            (0..copies).flat_map(move |_| own.clone()).collect::<Vec<f64>>()
        };
        effects.iter().flat_map(of).collect()
    }

    /// Parameters of the effects that a stage has added, in order.
    fn numbers_of(base: &Model, stage: &Stage) -> Vec<f64> {
        let names: Vec<&str> = stage.added.iter().map(|effect| effect.card().name).collect();
        let own = base.parameters().len();
        stage.confirmed.prepared.model.parameters()[own..]
            .iter()
            .zip(&stage.confirmed.theta[own..])
            .filter(|(p, _)| names.contains(&p.effect.as_str()))
            .map(|(_, value)| *value)
            .collect()
    }
}

/// The lower one of two minima.
fn lower(one: Option<Confirmed>, other: Option<Confirmed>) -> Option<Confirmed> {
    match (one, other) {
        (Some(a), Some(b)) => Some(if b.cost() < a.cost() { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Hypotheses that could be fitted, best first. A pair has a penalty, so that it must be clearly better than
/// a single effect; so does evidence from form errors.
fn ranked(tried: &[Tried]) -> Vec<(&Tried, &Confirmed)> {
    let mut list: Vec<(&Tried, &Confirmed)> =
        tried.iter().filter_map(|t| Some((t, t.confirmed.as_ref()?))).collect();
    let further = |t: &Tried| t.hypothesis.effects.len() - 1;
    let worth = |(t, c): (&Tried, &Confirmed)| {
        t.log_evidence - RULE.pair * further(t) as f64 - RULE.by_bending * c.form.log_evidence
    };
    let best = |of: usize| {
        let some = list.iter().copied().filter(|(t, _)| further(t) == of);
        let best = some.max_by(|a, b| worth(*a).total_cmp(&worth(*b)));
        best.map_or(0.0, |(_, confirmed)| confirmed.form.log_evidence)
    };
    // Pairs get no credit for exact formulas if one effect with a form error does as well.
    let exactness = RULE.by_bending * (best(0) - best(1)).max(0.0);
    let key = |one: &(&Tried, &Confirmed)| worth(*one) - if further(one.0) > 0 { exactness } else { 0.0 };
    let keys: Vec<f64> = list.iter().map(key).collect();
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by(|a, b| keys[*b].total_cmp(&keys[*a]));
    list = order.into_iter().map(|place| list[place]).collect();
    list
}
