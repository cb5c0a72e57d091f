//! Hypotheses of one or two effects for a misfit, best first, with what they would explain in linear
//! approximation.

use bulge_model::Model;
use rayon::prelude::*;

use crate::diagnosis::candidates::{Candidate, explained, log_evidence};
use crate::diagnosis::confirm::{Confirmed, starts};
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::linearised_model::LinearisedModel;

/// Hypotheses whose linear evidence is this far below the best are not fitted.
const FITTED: f64 = 12.0;
/// Most single effects and most pairs that are fitted.
const MOST: [usize; 2] = [8, 6];
/// Number of forms from which a fit of an effect starts.
const FORMS: usize = 2;
/// Decrease of the squared misfit beyond which the linear approximation is poor: usual parameters are then
/// starts too, and the best hypotheses of each kind are fitted.
pub(crate) const FAR: f64 = 200.0;

/// One or two effects, with what they would explain in linear approximation.
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    /// Indices in the linearised model's list of effects.
    pub(crate) effects: Vec<usize>,
    /// Log evidence including the log priors of the effects, relative to the model without them.
    pub(crate) log_evidence: f64,
    /// Decrease of the squared misfit.
    pub(crate) gain: f64,
    /// Starting parameters of a fit.
    pub(crate) starts: Vec<Vec<f64>>,
}
/// A hypothesis after its fit.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) hypothesis: Hypothesis,
    /// The fit; none if it failed.
    pub(crate) confirmed: Option<Confirmed>,
    /// Log evidence of the fit including those log priors, relative to the model before.
    pub(crate) log_evidence: f64,
}
/// Log prior probability of an effect: families are equally likely; the head of a family has half of its
/// probability, and the other members share the rest.
pub(crate) fn effect_log_prior(linear: &LinearisedModel, effect: usize) -> f64 {
    let effects = &linear.sensitivities.effects;
    let shown = |place: usize| linear.candidates.iter().any(|c| c.effect == place);
    let family_of = |place: usize| effects[place].effect.card().family.to_owned();
    let mut families: Vec<String> = (0..effects.len()).filter(|i| shown(*i)).map(family_of).collect();
    families.sort();
    let own = family_of(effect);
    let members = families.iter().filter(|family| **family == own).count();
    families.dedup();
    let of_family = -(families.len().max(1) as f64).ln();
    let heads = (0..effects.len()).filter(|i| shown(*i) && effects[*i].effect.card().name == own).count();
    let is_head = effects[effect].effect.card().name == own;
    // Of two effects that are indistinguishable on these data, prefer the one with fewer requirements.
    let simple =
        if effects[effect].effect.card().needs == bulge_effects::Needs::Time { -RULE.simpler } else { 0.0 };
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
pub(crate) fn hypotheses(linear: &LinearisedModel, model: &Model, room: usize) -> Vec<Hypothesis> {
    let singles = singles(linear, model);
    let pairs = if room > 1 { pairs(linear, model) } else { Vec::new() };
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

/// Every effect in its best forms.
pub(crate) fn singles(linear: &LinearisedModel, model: &Model) -> Vec<Hypothesis> {
    let mut found: Vec<Hypothesis> = Vec::new();
    for effect in 0..linear.sensitivities.effects.len() {
        let mut forms: Vec<(f64, f64, &Candidate, Vec<f64>)> = linear
            .candidates
            .iter()
            .filter(|c| c.effect == effect)
            .map(|c| {
                let explained = c.explains(&linear.z);
                (c.log_evidence(&explained), explained.gain, c, explained.sizes)
            })
            .collect();
        forms.sort_by(|a, b| b.0.total_cmp(&a.0));
        let Some((largest, gain, _, _)) = forms.first() else { continue };
        let (largest, gain) = (*largest, *gain);
        let sum: f64 = forms.iter().map(|form| (form.0 - largest).exp()).sum();
        let starts = forms
            .iter()
            .take(FORMS)
            .flat_map(|(_, _, c, sizes)| starts_of(linear, model, c, sizes))
            .collect();
        let log_evidence = largest + sum.ln() + effect_log_prior(linear, effect);
        found.push(Hypothesis { effects: vec![effect], log_evidence, gain, starts });
    }
    found.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    found
}

fn starts_of(linear: &LinearisedModel, model: &Model, candidate: &Candidate, sizes: &[f64]) -> Vec<Vec<f64>> {
    let effect = &linear.sensitivities.effects[candidate.effect].effect;
    starts(&linear.sensitivities.sensitivities[candidate.sensitivity], effect, model, sizes)
}

/// Every pair of effects of different families, in the forms that fit best together.
fn pairs(linear: &LinearisedModel, model: &Model) -> Vec<Hypothesis> {
    let effects = &linear.sensitivities.effects;
    let family = |candidate: &Candidate| effects[candidate.effect].effect.card().family;
    let log_priors: Vec<f64> = (0..effects.len()).map(|i| effect_log_prior(linear, i)).collect();
    let all = &linear.candidates;
    let mut found: Vec<(f64, f64, usize, usize)> = (0..all.len())
        .into_par_iter()
        .map(|i| {
            let mut best: Vec<(f64, f64, usize, usize)> = Vec::new();
            for j in i + 1..all.len() {
                let (a, b) = (&all[i], &all[j]);
                if a.effect == b.effect || family(a) == family(b) || a.columns.len() + b.columns.len() > 3 {
                    continue;
                }
                let together = explained(&[a, b], &linear.z);
                // A pair with an effect of size 0 is a single effect.
                if together.sizes.contains(&0.0) {
                    continue;
                }
                let value = log_evidence(&[a, b], &together) + log_priors[a.effect] + log_priors[b.effect];
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
        // Try the candidates that explain more alone first.
        let alone = |place: usize| all[place].explains(&linear.z).gain;
        let (first, second) = if alone(i) >= alone(j) { (i, j) } else { (j, i) };
        let chosen = [&all[first], &all[second]];
        let together = explained(&chosen, &linear.z);
        let (a, b) = together.sizes.split_at(chosen[0].columns.len());
        let starts_a = starts_of(linear, model, chosen[0], a);
        let starts_b = starts_of(linear, model, chosen[1], b);
        let starts = starts_a
            .iter()
            .flat_map(|a| starts_b.iter().map(move |b| a.iter().chain(b).copied().collect()))
            .collect();
        let effects = vec![all[first].effect, all[second].effect];
        kept.push(Hypothesis { effects, log_evidence, gain, starts });
    }
    kept
}
