//! Add and swap: from the base to the set of effects that explains the data, one step after the other, with adequacy before and after each.

use bulge_effects::Effect;
use bulge_model::{Model, ModelError};
use rayon::prelude::*;
use std::sync::Arc;

use crate::candidates::{Candidate, explained, log_evidence};
use crate::confirm::{Confirmed, starts};
use crate::null::{Null, Statistics};
use crate::scene::{Given, Scene};

/// Chance with which the screen may raise a false alarm, and the smooth test.
pub(crate) const ALARM: [f64; 2] = [0.05, 0.015];
/// Effects that are added at most, one step after the other.
const STEPS: usize = 4;
/// Hypotheses whose linear evidence is this much below the best are not fitted.
const FITTED: f64 = 12.0;
/// Most single effects and most pairs that are fitted.
const MOST: [usize; 2] = [8, 6];
/// Forms from which a fit of an effect starts.
const FORMS: usize = 2;
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
    /// Names of the effects.
    pub(crate) names: Vec<String>,
    /// The fit; none if it failed.
    pub(crate) confirmed: Option<Confirmed>,
    /// Log evidence of the fit with tickets, over that of the model before.
    pub(crate) log_evidence: f64,
}

/// Whether a model explains the data.
#[derive(Debug, Clone)]
pub(crate) struct Adequacy {
    pub(crate) statistics: Statistics,
    pub(crate) null: Null,
    /// How often chance alone gives as much: the screen, the smooth test.
    pub(crate) chance: [f64; 2],
}

impl Adequacy {
    pub(crate) fn screen_fails(&self) -> bool {
        self.chance[0] < ALARM[0]
    }

    pub(crate) fn smooth_fails(&self) -> bool {
        self.chance[1] < ALARM[1]
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

/// A whole search: the base first, then each model that was accepted.
pub(crate) struct Search {
    pub(crate) stages: Vec<Stage>,
}

impl Given<'_> {
    /// A model with its scene and adequacy.
    pub(crate) fn stage(
        &self,
        added: Vec<Arc<dyn Effect>>,
        confirmed: Confirmed,
    ) -> Result<Stage, ModelError> {
        let scene = self.scene(&confirmed.prepared, &confirmed.theta)?;
        let (statistics, null, chance) = scene.chance(self);
        let adequacy = Adequacy { statistics, null, chance };
        Ok(Stage { added, confirmed, scene, adequate: adequacy.holds(), adequacy, tried: Vec::new() })
    }

    /// From the base model to the set of effects that explains the data, or to where nothing more helps.
    pub(crate) fn search(&self, base: &Model) -> Result<Search, ModelError> {
        let confirmed = self.confirm(base, &[], None, &[])?;
        let mut stages = vec![self.stage(Vec::new(), confirmed)?];
        for step in 0..STEPS {
            let stage = &mut stages[step];
            if stage.adequacy.holds() {
                break;
            }
            stage.tried = self.tried(base, stage);
            let Some((best, confirmed)) = best(&stage.tried).filter(|(best, _)| best.log_evidence > 0.0) else {
                // The screen alone, and no effect that is worth its price: chance.
                stage.adequate = !stage.adequacy.smooth_fails();
                break;
            };
            let mut added = stage.added.clone();
            added.extend(
                best.hypothesis.effects.iter().map(|i| Arc::clone(&stage.scene.showings.effects[*i].effect)),
            );
            let confirmed = confirmed.clone();
            stages.push(self.stage(added, confirmed)?);
        }
        Ok(Search { stages })
    }

    /// The best hypotheses of a stage, each fitted.
    pub(crate) fn tried(&self, base: &Model, stage: &Stage) -> Vec<Tried> {
        let hypotheses = hypotheses(&stage.scene, &stage.confirmed.prepared.model);
        hypotheses.into_par_iter().map(|hypothesis| self.fitted(base, stage, hypothesis)).collect()
    }

    /// A hypothesis fitted on top of a stage.
    pub(crate) fn fitted(&self, base: &Model, stage: &Stage, hypothesis: Hypothesis) -> Tried {
        let effects: Vec<Arc<dyn Effect>> =
            hypothesis.effects.iter().map(|i| Arc::clone(&stage.scene.showings.effects[*i].effect)).collect();
        let names = effects.iter().map(|effect| effect.card().name.to_owned()).collect();
        let all: Vec<Arc<dyn Effect>> = stage.added.iter().chain(&effects).cloned().collect();
        let before = self.numbers_of(base, stage);
        let starts: Vec<Vec<f64>> =
            hypothesis.starts.iter().map(|start| before.iter().chain(start).copied().collect()).collect();
        let confirmed = self.confirm(base, &all, Some(&stage.confirmed), &starts).ok();
        let tickets: f64 = hypothesis.effects.iter().map(|i| ticket(&stage.scene, *i)).sum();
        let log_evidence = confirmed
            .as_ref()
            .map_or(f64::NEG_INFINITY, |c| c.log_evidence - stage.confirmed.log_evidence + tickets);
        Tried { hypothesis, names, confirmed, log_evidence }
    }

    /// Numbers of the effects that a stage has added, in order.
    fn numbers_of(&self, base: &Model, stage: &Stage) -> Vec<f64> {
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

/// The hypothesis with the largest evidence among those whose fit converged; a pair only if it is clearly better than the best single effect.
fn best(tried: &[Tried]) -> Option<(&Tried, &Confirmed)> {
    let of = |count: usize| {
        tried
            .iter()
            .filter(|t| t.hypothesis.effects.len() == count)
            .filter_map(|t| Some((t, t.confirmed.as_ref()?)))
            .max_by(|a, b| a.0.log_evidence.total_cmp(&b.0.log_evidence))
    };
    match (of(1), of(2)) {
        (Some(single), Some(pair)) if pair.0.log_evidence > single.0.log_evidence + PAIR => Some(pair),
        (Some(single), _) => Some(single),
        (None, pair) => pair,
    }
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
    of_family
        + match (members, heads, is_head) {
            (0 | 1, _, _) => 0.0,
            (_, 0, _) => -(members as f64).ln(),
            (_, _, true) => 0.5_f64.ln(),
            (_, _, false) => (0.5 / (members - 1) as f64).ln(),
        }
}

/// Single effects and pairs that may explain the misfit, the best of each first.
pub(crate) fn hypotheses(scene: &Scene, model: &Model) -> Vec<Hypothesis> {
    let singles = singles(scene, model);
    let pairs = pairs(scene, model);
    let best = singles.iter().chain(&pairs).map(|h| h.log_evidence).fold(f64::NEG_INFINITY, f64::max);
    let near = |list: Vec<Hypothesis>, most: usize| {
        list.into_iter().filter(|h| h.log_evidence > best - FITTED).take(most).collect::<Vec<_>>()
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
                if together.sizes.iter().any(|size| *size == 0.0) {
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
        let mut places = vec![all[i].effect, all[j].effect];
        places.sort_unstable();
        if kept.len() >= MOST[1] {
            break;
        }
        if kept.iter().any(|h| h.effects == places) {
            continue;
        }
        let (first, second) = if all[i].effect < all[j].effect { (i, j) } else { (j, i) };
        let chosen = [&all[first], &all[second]];
        let together = explained(&chosen, &scene.z);
        let (a, b) = together.sizes.split_at(chosen[0].columns.len());
        let starts_a = starts_of(scene, model, chosen[0], a);
        let starts_b = starts_of(scene, model, chosen[1], b);
        let starts = starts_a
            .iter()
            .flat_map(|a| starts_b.iter().map(move |b| a.iter().chain(b).copied().collect()))
            .collect();
        kept.push(Hypothesis { effects: places, log_evidence, gain, starts });
    }
    kept
}
