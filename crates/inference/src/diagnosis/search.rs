//! Add and swap: from the base to the set of effects that explains the data, one step after the other, with adequacy before and after each.

use bulge_effects::Effect;
use bulge_model::{Model, ModelError};
use rayon::prelude::*;
use std::sync::Arc;

use crate::diagnosis::bending::may_bend;
use crate::diagnosis::candidates::{Candidate, explained, log_evidence};
use crate::diagnosis::confirm::{Confirmed, starts};
use crate::diagnosis::misfit::misfit;
use crate::diagnosis::null::Null;
use crate::diagnosis::scene::{Given, Scene};
use crate::diagnosis::something_else::smooth_evidence;

/// Chance with which the screen may raise a false alarm, and the smooth test.
pub(crate) const ALARM: [f64; 2] = [0.03, 0.006];
/// Chance with which the smooth test may raise one where effects are named: to say that they explain everything takes more than to say nothing.
const EXPLAINED: f64 = 0.01;
/// Log evidence from which the first effect is worth naming: before any data it is seven times as likely that something is missing in a model of a real muscle
/// as that nothing is. That a second effect is missing too is no more likely than not.
pub(crate) const WORTH: [f64; 2] = [-2.0, 0.0];
/// Log evidence of something that nobody thought of, before any data.
const SOMETHING_ELSE: f64 = -2.0;
/// Log evidence of form errors from which another effect is looked for that makes them superfluous, and what it must bring.
const BENT: f64 = 4.0;
const SUPERFLUOUS: f64 = 3.0;
/// Part of what a model explains that a further effect must explain where the formulas of the model may be wrong: what explains less mends a formula.
const MENDS: f64 = 0.01;
/// Effects that are added at most: a misfit that takes more is one that the catalogue doesn't hold.
const MOST_EFFECTS: usize = 3;
/// Hypotheses whose linear evidence is this much below the best are not fitted.
const FITTED: f64 = 12.0;
/// A fall of the square of the misfit beyond which tangents say little: then usual numbers are starts too, and the best of each kind are fitted.
const FAR: f64 = 200.0;
/// Part of the fall that the tangents say, from which they hold: then no other starts are needed.
const PROMISED: f64 = 0.95;
/// A fall of the sum of squares from which a minimum is another one: half a unit of log evidence.
const LOWER: f64 = 1.0;
/// Most single effects and most pairs that are fitted.
const MOST: [usize; 2] = [8, 6];
/// Forms from which a fit of an effect starts.
const FORMS: usize = 2;
/// Log evidence that an effect of time must bring beyond one of the path alone.
const SIMPLER: f64 = 0.2;
/// Log evidence that a second effect must bring at once to be named with the first.
const PAIR: f64 = 3.0;

/// One or two effects, with what they would explain in linear approximation.
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    /// Places in the scene's list of effects.
    pub(crate) effects: Vec<usize>,
    /// Log evidence with the prior tickets, over that of the model without them.
    pub(crate) log_evidence: f64,
    /// Fall of the square of the misfit.
    pub(crate) gain: f64,
    /// Starting numbers of a fit.
    pub(crate) starts: Vec<Vec<f64>>,
}

/// A hypothesis after its fit.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) hypothesis: Hypothesis,
    /// The fit; none if it failed.
    pub(crate) confirmed: Option<Confirmed>,
    /// Log evidence of the fit with tickets, over that of the model before.
    pub(crate) log_evidence: f64,
}

/// Whether a model explains the data.
#[derive(Debug, Clone)]
pub(crate) struct Adequacy {
    pub(crate) null: Null,
    /// Whether effects are named.
    names: bool,
    /// How often chance alone gives as much: the screen, the smooth test.
    pub(crate) chance: [f64; 2],
}

impl Adequacy {
    pub(crate) fn screen_fails(&self) -> bool {
        self.chance[0] < ALARM[0]
    }

    pub(crate) fn smooth_fails(&self) -> bool {
        self.chance[1] < if self.names { EXPLAINED } else { ALARM[1] }
    }

    pub(crate) fn holds(&self) -> bool {
        !self.screen_fails() && !self.smooth_fails()
    }
}

/// A model of the path from the base to the last step.
pub(crate) struct Stage {
    /// Effects that were added to the base.
    pub(crate) added: Vec<Arc<dyn Effect>>,
    pub(crate) confirmed: Confirmed,
    pub(crate) scene: Scene,
    pub(crate) adequacy: Adequacy,
    /// Whether the model explains the data.
    pub(crate) adequate: bool,
    /// What was tried from here.
    pub(crate) tried: Vec<Tried>,
}

impl Stage {
    /// The added effects but one.
    pub(crate) fn without(&self, place: usize) -> Vec<Arc<dyn Effect>> {
        let others = self.added.iter().enumerate().filter(|(i, _)| *i != place);
        others.map(|(_, effect)| Arc::clone(effect)).collect()
    }

    /// Square of the misfit that smooth functions follow, beyond what chance gives.
    pub(crate) fn excess(&self) -> f64 {
        (self.scene.structure() - self.scene.smooth.len() as f64).max(0.0)
    }

    /// Log evidence of something that nobody thought of on top of the model; 0 where nothing is left to explain.
    pub(crate) fn something_else(&self) -> f64 {
        if self.adequate { 0.0 } else { (SOMETHING_ELSE + smooth_evidence(&self.scene)).max(0.0) }
    }

    /// Log evidence of the model, with or without something else on top, over that of another; implausible numbers cost nothing here.
    fn value_over(&self, other: &Self) -> f64 {
        let own = |stage: &Self| stage.confirmed.log_evidence + stage.confirmed.penalty;
        own(self) - own(other) + self.something_else()
    }

    /// How much more than chance the misfit scatters over the smooth functions, as a ratio of variances: 1 if the model explains the data.
    pub(crate) fn scatter(&self) -> f64 {
        let smooth = &self.scene.smooth;
        if self.adequate || smooth.is_empty() {
            return 1.0;
        }
        (self.scene.structure() / smooth.len() as f64).max(1.0)
    }
}

/// A log evidence when the noise is larger by the ratio `scatter` of variances than the law says; `gain` is the fall of the square of the misfit in it.
pub(crate) fn tempered(log_evidence: f64, gain: f64, scatter: f64) -> f64 {
    log_evidence - 0.5 * gain * (1.0 - 1.0 / scatter)
}

/// A whole search: the base first, then each model that was accepted.
pub(crate) struct Search {
    pub(crate) stages: Vec<Stage>,
    /// The stage of which something that nobody thought of explains what is left better than the best effect: what was added after it is the nearest, and no claim.
    pub(crate) something_else: Option<usize>,
}

/// Names of effects, sorted.
fn names<'e>(effects: impl Iterator<Item = &'e Arc<dyn Effect>>) -> Vec<String> {
    let mut names: Vec<String> = effects.map(|effect| effect.card().name.to_owned()).collect();
    names.sort_unstable();
    names
}

impl Search {
    /// The stage of these effects, in any order.
    pub(crate) fn of_effects(&self, effects: &[Arc<dyn Effect>]) -> Option<&Stage> {
        let asked = names(effects.iter());
        self.stages.iter().find(|stage| names(stage.added.iter()) == asked)
    }

    /// The fit of these effects, in any order, where one was made.
    fn fit_of(&self, effects: &[Arc<dyn Effect>]) -> Option<&Confirmed> {
        let asked = names(effects.iter());
        let is_it = |(stage, tried): &(&Stage, &Tried)| {
            let all = &stage.scene.showings.effects;
            let new = tried.hypothesis.effects.iter().map(|place| &all[*place].effect);
            names(stage.added.iter().chain(new)) == asked
        };
        let mut tried = self.stages.iter().flat_map(|stage| stage.tried.iter().map(move |one| (stage, one)));
        self.of_effects(effects)
            .map(|stage| &stage.confirmed)
            .or_else(|| tried.find(is_it).and_then(|(_, tried)| tried.confirmed.as_ref()))
    }

    /// Another model instead of the last one, and of those on the way to it that aren't on the way to this one.
    pub(crate) fn replace_last(&mut self, stage: Stage) {
        let has = |effect: &Arc<dyn Effect>| {
            stage.added.iter().any(|other| other.card().name == effect.card().name)
        };
        self.stages.pop();
        self.stages.retain(|before| before.added.len() < stage.added.len() && before.added.iter().all(has));
        self.stages.push(stage);
    }
}

impl Given<'_> {
    /// A model with its scene and adequacy.
    pub(crate) fn stage(
        &self,
        added: Vec<Arc<dyn Effect>>,
        confirmed: Confirmed,
    ) -> Result<Stage, ModelError> {
        let scene = self.scene(&confirmed.prepared, &confirmed.theta)?;
        let (null, chance) = scene.chance(self);
        let adequacy = Adequacy { null, names: !added.is_empty(), chance };
        let is_small =
            || self.tolerance_n.is_some_and(|tolerance| misfit(&scene, self.seed).1[1] <= tolerance);
        let adequate = adequacy.holds() || is_small();
        Ok(Stage { added, confirmed, scene, adequate, adequacy, tried: Vec::new() })
    }

    /// From the base model to the set of effects that explains the data, or to where nothing more helps.
    ///
    /// `near` are numbers that the base is known to have about; `before` is a search of the same readings with another noise: where its fits ended, fits begin.
    pub(crate) fn search(
        &self,
        base: &Model,
        near: (&Model, &[f64]),
        before: Option<&Search>,
    ) -> Result<Search, ModelError> {
        let confirmed = self.confirm(base, &[], Some(near), &[])?;
        let mut stages = vec![self.stage(Vec::new(), confirmed)?];
        let mut again = false;
        let mut something_else = None;
        while let [.., stage] = &mut stages[..] {
            // A form error may be another effect.
            let is_bent = stage.confirmed.form.log_evidence > BENT;
            let room = MOST_EFFECTS - stage.added.len();
            if stage.adequate && !is_bent || room == 0 || something_else.is_some() {
                break;
            }
            stage.tried = self.tried(base, stage, room, before);
            if !again && let Some(lower) = self.lower(base, stage) {
                (*stage, again) = (lower, true);
                continue;
            }
            again = false;
            let ranked = ranked(&stages[stages.len() - 1].tried);
            if std::env::var_os("TRACE").is_some() {
                let stage = &stages[stages.len() - 1];
                eprintln!(
                    "STAGE {:?} adequate {} chance {:?} cost {:.1} bent {:.1} form {:.1} excess {:.1} else {:.1}",
                    names(stage.added.iter()),
                    stage.adequate,
                    stage.adequacy.chance,
                    stage.confirmed.cost(),
                    stage.confirmed.bent_cost(),
                    stage.confirmed.form.log_evidence,
                    stage.excess(),
                    stage.something_else()
                );
                for b in &stage.confirmed.form.effects {
                    eprintln!("   bent {} sd {:?} part {:.3}", b.effect.card().name, b.sd, b.part);
                }
                for (t, c) in &ranked {
                    let n: Vec<_> = t
                        .hypothesis
                        .effects
                        .iter()
                        .map(|i| stage.scene.showings.effects[*i].effect.card().name)
                        .collect();
                    eprintln!(
                        "   try {:?} lin {:.1} logZ {:.1} cost {:.1} bent {:.1} form {:.1} {}",
                        n,
                        t.hypothesis.log_evidence,
                        t.log_evidence,
                        c.cost(),
                        c.bent_cost(),
                        c.form.log_evidence,
                        c.form
                            .effects
                            .iter()
                            .map(|b| format!("{:?} {:.2}", b.sd, b.part))
                            .collect::<Vec<_>>()
                            .join("; ")
                    );
                }
            }
            let next = ranked.into_iter().find_map(|(best, confirmed)| self.step(&stages, best, confirmed));
            let stage = &stages[stages.len() - 1];
            let Some((next, stands_out)) = next else {
                // The screen alone, and no effect that is worth its price: chance.
                let is_chance = !stage.adequacy.smooth_fails();
                if let Some(stage) = stages.last_mut() {
                    stage.adequate |= is_chance;
                }
                break;
            };
            let replaces_bending = || {
                next.adequate
                    && next.confirmed.log_evidence > stage.confirmed.log_evidence + SUPERFLUOUS
                    && next.confirmed.form.log_evidence < stage.confirmed.form.log_evidence
            };
            if stage.adequate && !replaces_bending() {
                break;
            }
            if std::env::var_os("TRACE").is_some() {
                eprintln!(
                    " -> {:?} adequate {} else {:.1} value {:.1} vs else {:.1} stands {}",
                    names(next.added.iter()),
                    next.adequate,
                    next.something_else(),
                    next.value_over(stage),
                    stage.something_else(),
                    stands_out
                );
            }
            if stage.something_else() > next.value_over(stage) {
                something_else = Some(stages.len() - 1);
                if !stage.added.is_empty() {
                    break;
                }
            } else if !stands_out {
                break;
            }
            stages.push(next);
        }
        Ok(Search { stages, something_else })
    }

    /// The stage at a lower minimum of its model, where a fit with further effects came to one and left them off.
    pub(crate) fn lower(&self, base: &Model, stage: &Stage) -> Option<Stage> {
        let effects = &stage.scene.showings.effects;
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

    /// The stage that a hypothesis leads to from the last of `stages`, and whether the step stands out of what remains; none if it isn't worth its price, or nothing
    /// can be seen from there.
    fn step(&self, stages: &[Stage], tried: &Tried, confirmed: &Confirmed) -> Option<(Stage, bool)> {
        let (base, stage) = (stages.first()?, stages.last()?);
        let worth = WORTH[usize::from(!stage.added.is_empty())];
        let effects = &stage.scene.showings.effects;
        let new: Vec<Arc<dyn Effect>> =
            tried.hypothesis.effects.iter().map(|i| Arc::clone(&effects[*i].effect)).collect();
        if tried.log_evidence <= worth || confirmed.is_absurd(&new) || confirmed.is_idle(&new) {
            return None;
        }
        let gain = stage.confirmed.bent_cost() - confirmed.bent_cost();
        let mends = |first: &Confirmed| {
            let explained = base.confirmed.bent_cost() - first.bent_cost();
            may_bend(&first.prepared) && first.bent_cost() - confirmed.bent_cost() < MENDS * explained
        };
        let member = |one: &&Tried| matches!(&one.hypothesis.effects[..], [only] if new.len() > 1 && tried.hypothesis.effects.contains(only));
        let alone = stage.tried.iter().filter(member).filter_map(|one| one.confirmed.as_ref());
        if alone.into_iter().any(mends) || !stage.added.is_empty() && mends(&stage.confirmed) {
            return None;
        }
        let mut added = stage.added.clone();
        added.extend(new);
        let next = self.stage(added, confirmed.clone()).ok()?;
        // Where something unknown remains, its scatter counts as noise: a step must stand out of that too.
        let stands_out = tempered(tried.log_evidence, gain, next.scatter()) > worth;
        Some((next, stands_out))
    }

    /// The best hypotheses of a stage with so much `room` for further effects, each fitted.
    fn tried(&self, base: &Model, stage: &Stage, room: usize, before: Option<&Search>) -> Vec<Tried> {
        let hypotheses = hypotheses(&stage.scene, &stage.confirmed.prepared.model, room);
        hypotheses.into_par_iter().map(|hypothesis| self.fitted(base, stage, hypothesis, before)).collect()
    }

    /// A hypothesis fitted on top of a stage.
    pub(crate) fn fitted(
        &self,
        base: &Model,
        stage: &Stage,
        hypothesis: Hypothesis,
        search: Option<&Search>,
    ) -> Tried {
        let effects: Vec<Arc<dyn Effect>> =
            hypothesis.effects.iter().map(|i| Arc::clone(&stage.scene.showings.effects[*i].effect)).collect();
        let all: Vec<Arc<dyn Effect>> = stage.added.iter().chain(&effects).cloned().collect();
        let before = Self::numbers_of(base, stage);
        let starts: Vec<Vec<f64>> =
            hypothesis.starts.iter().map(|start| before.iter().chain(start).copied().collect()).collect();
        let holds =
            |confirmed: &Confirmed| stage.confirmed.cost() - confirmed.cost() >= PROMISED * hypothesis.gain;
        let known = search.and_then(|search| search.fit_of(&all));
        let again = known.and_then(|known| self.confirm(base, &all, Some(known.numbers()), &[]).ok());
        let mut confirmed = match again {
            Some(again) if holds(&again) => Some(again),
            again => {
                let found = self.confirm(base, &all, Some(stage.confirmed.numbers()), &starts).ok();
                lower(again, found)
            }
        };
        // The search before has tried further starts already.
        let is_far = hypothesis.gain > FAR && known.is_none() && !confirmed.as_ref().is_some_and(holds);
        if confirmed.is_none() || is_far {
            // Far from where the tangents hold: usual numbers, and nearly none of them.
            let further: Vec<Vec<f64>> = [1.0, 0.1]
                .iter()
                .map(|part| before.iter().copied().chain(Self::usual(base, &effects, *part)).collect())
                .collect();
            confirmed =
                lower(confirmed, self.confirm(base, &all, Some(stage.confirmed.numbers()), &further).ok());
        }
        let tickets: f64 = hypothesis.effects.iter().map(|i| ticket(&stage.scene, *i)).sum();
        let log_evidence = confirmed
            .as_ref()
            .map_or(f64::NEG_INFINITY, |c| c.log_evidence - stage.confirmed.log_evidence + tickets);
        Tried { hypothesis, confirmed, log_evidence }
    }

    /// A part of the way from `off` to the usual numbers of effects.
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

    /// Numbers of the effects that a stage has added, in order.
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

/// The lower of two minima.
fn lower(one: Option<Confirmed>, other: Option<Confirmed>) -> Option<Confirmed> {
    match (one, other) {
        (Some(a), Some(b)) => Some(if b.cost() < a.cost() { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Hypotheses that could be fitted, the best first; a pair counts for less, so that it is only taken if it is clearly better than a single effect.
fn ranked(tried: &[Tried]) -> Vec<(&Tried, &Confirmed)> {
    let mut list: Vec<(&Tried, &Confirmed)> =
        tried.iter().filter_map(|t| Some((t, t.confirmed.as_ref()?))).collect();
    let lambda: f64 = std::env::var("LAMBDA").ok().and_then(|v| v.parse().ok()).unwrap_or(0.1);
    let worth = |(t, c): &(&Tried, &Confirmed)| {
        t.log_evidence - PAIR * (t.hypothesis.effects.len() as f64 - 1.0) - lambda * c.form.log_evidence
    };
    list.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    list
}

/// Log of the prior chance of an effect: families are equally likely; the head of a family has half of its chance, the other members share the rest.
pub(crate) fn ticket(scene: &Scene, effect: usize) -> f64 {
    let effects = &scene.showings.effects;
    let shown = |place: usize| scene.candidates.iter().any(|c| c.effect == place);
    let family_of = |place: usize| effects[place].effect.card().family.to_owned();
    let mut families: Vec<String> = (0..effects.len()).filter(|i| shown(*i)).map(family_of).collect();
    families.sort();
    let own = family_of(effect);
    let members = families.iter().filter(|family| **family == own).count();
    families.dedup();
    let of_family = -(families.len().max(1) as f64).ln();
    let heads = (0..effects.len()).filter(|i| shown(*i) && effects[*i].effect.card().name == own).count();
    let is_head = effects[effect].effect.card().name == own;
    // Of two that are the same on these data, the one that takes less to be seen.
    let simple =
        if effects[effect].effect.card().needs == bulge_effects::Needs::Time { -SIMPLER } else { 0.0 };
    of_family
        + simple
        + match (members, heads, is_head) {
            (0 | 1, _, _) => 0.0,
            (_, 0, _) => -(members as f64).ln(),
            (_, _, true) => 0.5_f64.ln(),
            (_, _, false) => (0.5 / (members - 1) as f64).ln(),
        }
}

/// Single effects and pairs that may explain the misfit, the best of each first.
pub(crate) fn hypotheses(scene: &Scene, model: &Model, room: usize) -> Vec<Hypothesis> {
    let singles = singles(scene, model);
    let pairs = if room > 1 { pairs(scene, model) } else { Vec::new() };
    let best = singles.iter().chain(&pairs).map(|h| h.log_evidence).fold(f64::NEG_INFINITY, f64::max);
    let near = |list: Vec<Hypothesis>, most: usize| {
        list.into_iter()
            .filter(|h| h.log_evidence > best - FITTED || best > FAR)
            .take(most)
            .collect::<Vec<_>>()
    };
    let mut all = near(singles, MOST[0]);
    all.extend(near(pairs, MOST[1]));
    all
}

/// Every effect with the forms that suit best.
pub(crate) fn singles(scene: &Scene, model: &Model) -> Vec<Hypothesis> {
    let mut found: Vec<Hypothesis> = Vec::new();
    for effect in 0..scene.showings.effects.len() {
        let mut forms: Vec<(f64, f64, &Candidate, Vec<f64>)> = scene
            .candidates
            .iter()
            .filter(|c| c.effect == effect)
            .map(|c| {
                let explained = c.explains(&scene.z);
                (c.log_evidence(&explained), explained.gain, c, explained.sizes)
            })
            .collect();
        forms.sort_by(|a, b| b.0.total_cmp(&a.0));
        let Some((largest, gain, _, _)) = forms.first() else { continue };
        let (largest, gain) = (*largest, *gain);
        let sum: f64 = forms.iter().map(|form| (form.0 - largest).exp()).sum();
        let starts =
            forms.iter().take(FORMS).flat_map(|(_, _, c, sizes)| starts_of(scene, model, c, sizes)).collect();
        let log_evidence = largest + sum.ln() + ticket(scene, effect);
        found.push(Hypothesis { effects: vec![effect], log_evidence, gain, starts });
    }
    found.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    found
}

fn starts_of(scene: &Scene, model: &Model, candidate: &Candidate, sizes: &[f64]) -> Vec<Vec<f64>> {
    let effect = &scene.showings.effects[candidate.effect].effect;
    starts(&scene.showings.showings[candidate.showing], effect, model, sizes)
}

/// Every pair of effects of different families, at the forms that suit best together.
fn pairs(scene: &Scene, model: &Model) -> Vec<Hypothesis> {
    let effects = &scene.showings.effects;
    let family = |candidate: &Candidate| effects[candidate.effect].effect.card().family;
    let tickets: Vec<f64> = (0..effects.len()).map(|i| ticket(scene, i)).collect();
    let all = &scene.candidates;
    let mut found: Vec<(f64, f64, usize, usize)> = (0..all.len())
        .into_par_iter()
        .map(|i| {
            let mut best: Vec<(f64, f64, usize, usize)> = Vec::new();
            for j in i + 1..all.len() {
                let (a, b) = (&all[i], &all[j]);
                if a.effect == b.effect || family(a) == family(b) || a.columns.len() + b.columns.len() > 3 {
                    continue;
                }
                let together = explained(&[a, b], &scene.z);
                // A pair of which one does nothing is no pair.
                if together.sizes.contains(&0.0) {
                    continue;
                }
                let value = log_evidence(&[a, b], &together) + tickets[a.effect] + tickets[b.effect];
                best.push((value, together.gain, i, j));
            }
            best
        })
        .flatten()
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)).then(a.3.cmp(&b.3)));
    let mut kept: Vec<Hypothesis> = Vec::new();
    for (log_evidence, gain, i, j) in found {
        let places = [all[i].effect, all[j].effect];
        if kept.len() >= MOST[1] {
            break;
        }
        if kept.iter().any(|h| places.iter().all(|place| h.effects.contains(place))) {
            continue;
        }
        // What explains more alone comes first.
        let alone = |place: usize| all[place].explains(&scene.z).gain;
        let (first, second) = if alone(i) >= alone(j) { (i, j) } else { (j, i) };
        let chosen = [&all[first], &all[second]];
        let together = explained(&chosen, &scene.z);
        let (a, b) = together.sizes.split_at(chosen[0].columns.len());
        let starts_a = starts_of(scene, model, chosen[0], a);
        let starts_b = starts_of(scene, model, chosen[1], b);
        let starts = starts_a
            .iter()
            .flat_map(|a| starts_b.iter().map(move |b| a.iter().chain(b).copied().collect()))
            .collect();
        let effects = vec![all[first].effect, all[second].effect];
        kept.push(Hypothesis { effects, log_evidence, gain, starts });
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_beyond_the_noise_takes_its_part_of_the_evidence() {
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        // ln Z holds gain/2; with four times the variance a quarter of that is left.
        is(tempered(10.0, 12.0, 4.0), 10.0 - 6.0 + 1.5);
        is(tempered(10.0, 12.0, 1.0), 10.0);
    }
}
