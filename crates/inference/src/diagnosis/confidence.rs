//! Confidence of a claim on data like these: the whole decision is simulated on the user's own design, in the
//! coordinates of the screen.
//!
//! A truth is drawn from what the data leave possible: nothing, or one of the effects, with a size that they
//! allow. The misfit with its noise follows from that truth, and the decision is made as on the real data.
//! Among the simulated data sets that lead to the same claim, as clearly as the real ones do, the fraction of
//! right claims is the confidence. It is reduced by the chance that no effect of the catalogue is the right
//! one.

use rayon::prelude::*;
use serde::Serialize;

use crate::diagnosis::candidates::{Candidate, log_evidence};
use crate::diagnosis::classes::{Class, Rival, separation};
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::hypotheses::{Tried, effect_log_prior};
use crate::diagnosis::linearised_model::{Context, LinearisedModel};
use crate::diagnosis::null::{Null, Statistics};
use crate::diagnosis::sensitivity::Screened;
use bulge_numerics::Random;
use bulge_numerics::vector::{add, norm};

/// Number of simulated data sets.
const DRAWS: usize = 4000;
/// Data sets per random stream.
const PER_STREAM: usize = 100;
/// Two claims are equally clear if the lead of their log evidence over the next effect differs by less than
/// this fraction of the lead, or by less than this much.
const AS_CLEAR: [f64; 2] = [0.3, 1.0];
/// Larger leads are treated as equal to this one.
const CLEAR: f64 = RULE.decided;
/// Fewest claims of the same kind for a rate.
const ENOUGH: usize = 20;

/// How often a claim is right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Confidence {
    /// Fraction of the simulated claims of this kind in which the right effect is of the named family.
    pub named: f64,
    /// Fraction in which the right effect is in the class.
    pub class: f64,
    /// Wilson's 95 % interval of `named`.
    pub interval: [f64; 2],
    /// Number of simulated claims of this kind.
    pub claims: usize,
}

impl Confidence {
    /// Confidence of an effect without which no model could be fitted: its weight among the hypotheses tried
    /// when it was added. Nothing is simulated.
    pub(crate) fn of_tried(tried: &[Tried], effect: &str, effects: &[Screened]) -> Self {
        let most = tried.iter().map(|t| t.log_evidence).fold(f64::NEG_INFINITY, f64::max);
        let weight = |t: &Tried| (t.log_evidence - most).exp();
        let holds =
            |t: &&Tried| t.hypothesis.effects.iter().any(|i| effects[*i].effect.card().name == effect);
        let all: f64 = tried.iter().map(weight).sum();
        let own: f64 = tried.iter().filter(holds).map(weight).sum();
        // An empty sum is -0.
        let share = if own > 0.0 { (1.0 - RULE.incomplete) * own / all } else { 0.0 };
        Self { named: share, class: share, interval: [0.0, 1.0], claims: 0 }
    }
}

/// A possible truth: an effect in one of its forms, or nothing.
struct Truth<'a> {
    candidate: Option<&'a Candidate>,
    effect: Option<usize>,
    weight: f64,
    sizes: Vec<f64>,
}

/// The confidence of a claim, relative to the model without the named effect.
///
/// If something unknown remains, its scatter counts as noise, and misfits are in units of that noise.
pub(crate) fn confidence(
    context: &Context<'_>,
    linear: &LinearisedModel,
    null: &Null,
    class: &Class,
) -> Confidence {
    let unit = 1.0 / class.scatter.sqrt();
    let found: Vec<f64> = linear.z.iter().map(|z| z * unit).collect();
    let Some(named) = linear.place(class.effect.card().name) else {
        return Confidence { named: 0.0, class: 0.0, interval: [0.0, 1.0], claims: 0 };
    };
    let worth = RULE.worth[usize::from(class.is_further)];
    let log_priors: Vec<f64> =
        (0..linear.sensitivities.effects.len()).map(|i| effect_log_prior(linear, i)).collect();
    let truths = truths(linear, &found, &log_priors, class, named);
    let family = class.effect.card().family;
    let rivals = class.rivals.iter().filter(|rival| rival.effect.card().family != family);
    let lead = class.log_evidence - rivals.map(|rival| rival.log_evidence).fold(0.0, f64::max);
    let counted: Vec<[usize; 3]> = (0..DRAWS / PER_STREAM)
        .into_par_iter()
        .map(|stream| {
            let mut random = Random::new(context.seed, 1000 + stream as u64);
            let mut counts = [0; 3];
            for _ in 0..PER_STREAM {
                let truth = drawn(&truths, random.uniform());
                let z = misfit(context, linear, truth, &mut random);
                let Some(claim) = Claim::of(linear, null, &log_priors, worth, &z) else { continue };
                if claim.named != named || !is_as_clear(claim.lead(linear), lead) {
                    continue;
                }
                counts[0] += 1;
                counts[1] += usize::from(truth.is_some_and(|t| claim.is_same(linear, t)));
                counts[2] += usize::from(truth.is_some_and(|t| claim.holds(linear, t)));
            }
            counts
        })
        .collect();
    let [claims, right, held] =
        counted.into_iter().fold([0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
    if claims < ENOUGH {
        // Hardly any simulation repeats the claim, so use the weights of the evidence instead.
        let of = |counts: &dyn Fn(&Rival) -> bool| {
            let is_one = |effect: usize| {
                let card = linear.sensitivities.effects[effect].effect.card();
                let rival = class.rivals.iter().find(|rival| rival.effect.card().name == card.name);
                card.family == family || rival.is_some_and(counts)
            };
            let right = truths.iter().filter(|t| t.effect.is_some_and(is_one));
            (1.0 - RULE.incomplete) * right.map(|t| t.weight).sum::<f64>()
        };
        let (named, class) = (of(&|_| false), of(&|rival| rival.in_class));
        return Confidence { named, class, interval: [0.0, 1.0], claims };
    }
    let part = |count: usize| (1.0 - RULE.incomplete) * count as f64 / claims as f64;
    let interval = wilson(right, claims).map(|end| (1.0 - RULE.incomplete) * end);
    Confidence { named: part(right), class: part(held), interval, claims }
}

/// Whether two leads are equally clear.
fn is_as_clear(lead: f64, other: f64) -> bool {
    let (lead, other) = (lead.min(CLEAR), other.min(CLEAR));
    (lead - other).abs() <= (AS_CLEAR[0] * other).max(AS_CLEAR[1])
}

/// All truths that the data leave possible, with weights that add up to 1.
fn truths<'a>(
    linear: &'a LinearisedModel,
    z: &[f64],
    log_priors: &[f64],
    class: &Class,
    named: usize,
) -> Vec<Truth<'a>> {
    let mut found = vec![Truth { candidate: None, effect: None, weight: 0.0, sizes: Vec::new() }];
    for candidate in &linear.candidates {
        let explained = candidate.explains(z);
        if explained.gain <= 0.0 {
            continue;
        }
        let weight = candidate.log_evidence(&explained) + log_priors[candidate.effect];
        found.push(Truth {
            candidate: Some(candidate),
            effect: Some(candidate.effect),
            weight,
            sizes: explained.sizes,
        });
    }
    // If an effect was fitted, use the evidence of the fit, divided among its forms.
    let mut fitted: Vec<(usize, f64)> = class
        .rivals
        .iter()
        .filter(|rival| rival.fit.is_some() && rival.log_evidence.is_finite())
        .filter_map(|rival| Some((linear.place(rival.effect.card().name)?, rival.log_evidence)))
        .collect();
    fitted.push((named, class.log_evidence));
    for (effect, evidence) in fitted {
        let own = || found.iter().filter(|t| t.effect == Some(effect)).map(|t| t.weight);
        let most = own().fold(f64::NEG_INFINITY, f64::max);
        let all = most + own().map(|w| (w - most).exp()).sum::<f64>().ln();
        for truth in found.iter_mut().filter(|t| t.effect == Some(effect)) {
            truth.weight += evidence - all;
        }
    }
    let most = found.iter().map(|t| t.weight).fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = found.iter().map(|t| (t.weight - most).exp()).sum();
    for truth in &mut found {
        truth.weight = (truth.weight - most).exp() / sum;
    }
    found
}

fn drawn<'t, 'a>(truths: &'t [Truth<'a>], mut left: f64) -> Option<&'t Truth<'a>> {
    for truth in truths {
        left -= truth.weight;
        if left <= 0.0 {
            return Some(truth);
        }
    }
    truths.last()
}

/// A random misfit under this truth.
fn misfit(
    context: &Context<'_>,
    linear: &LinearisedModel,
    truth: Option<&Truth<'_>>,
    random: &mut Random,
) -> Vec<f64> {
    let mut z = linear.chance_of(context).draw(random);
    let Some((truth, candidate)) = truth.and_then(|t| Some((t, t.candidate?))) else { return z };
    for (column, size) in candidate.columns.iter().zip(&truth.sizes) {
        // Draw the size within its uncertainty, but keep its sign.
        let sd = 1.0 / norm(column).max(f64::MIN_POSITIVE);
        let mut drawn = if candidate.whole { *size } else { size + sd * random.normal() };
        if drawn * size < 0.0 {
            drawn = 0.0;
        }
        add(&mut z, drawn, column);
    }
    z
}

/// The claim on one data set.
struct Claim {
    named: usize,
    /// Log evidence of each effect.
    evidence: Vec<f64>,
    /// Signal of the named effect.
    signal: Vec<f64>,
    /// Log evidence from which an effect counts.
    worth: f64,
}

impl Claim {
    /// The decision on a misfit; none if nothing would be named.
    fn of(linear: &LinearisedModel, null: &Null, log_priors: &[f64], worth: f64, z: &[f64]) -> Option<Self> {
        let statistics = Statistics::of(z, &linear.candidates, &[]);
        if null.chance(&statistics)[0] >= RULE.screen {
            return None;
        }
        let mut evidence = vec![f64::NEG_INFINITY; log_priors.len()];
        let mut best: Option<(f64, &Candidate, Vec<f64>)> = None;
        for candidate in &linear.candidates {
            let explained = candidate.explains(z);
            let value = log_evidence(&[candidate], &explained) + log_priors[candidate.effect];
            let own = &mut evidence[candidate.effect];
            let high = own.max(value);
            *own = if high == f64::NEG_INFINITY {
                high
            } else {
                high + ((*own - high).exp() + (value - high).exp()).ln()
            };
            if best.as_ref().is_none_or(|(other, _, _)| value > *other) {
                best = Some((value, candidate, explained.sizes));
            }
        }
        let named = (0..evidence.len()).max_by(|a, b| evidence[*a].total_cmp(&evidence[*b]))?;
        let (_, candidate, sizes) = best.filter(|_| evidence[named] > worth)?;
        let length = candidate.columns.iter().map(Vec::len).max().unwrap_or(0);
        let mut signal = vec![0.0; length];
        for (column, size) in candidate.columns.iter().zip(&sizes) {
            add(&mut signal, *size, column);
        }
        Some(Self { named, evidence, signal, worth })
    }

    /// Lead of the log evidence over the next effect of another family, and over no effect.
    fn lead(&self, linear: &LinearisedModel) -> f64 {
        let family = |effect: usize| linear.sensitivities.effects[effect].effect.card().family;
        let others = (0..self.evidence.len()).filter(|effect| family(*effect) != family(self.named));
        self.evidence[self.named] - others.map(|effect| self.evidence[effect]).fold(0.0, f64::max)
    }

    fn separation(&self, linear: &LinearisedModel, effect: usize) -> f64 {
        separation(&self.signal, linear.candidates.iter().filter(|c| c.effect == effect))
    }

    /// Whether the truth is of the named family.
    fn is_same(&self, linear: &LinearisedModel, truth: &Truth<'_>) -> bool {
        let family = |effect: usize| linear.sensitivities.effects[effect].effect.card().family;
        truth.effect.is_some_and(|effect| family(effect) == family(self.named))
    }

    /// Whether the truth is in the class.
    fn holds(&self, linear: &LinearisedModel, truth: &Truth<'_>) -> bool {
        self.is_same(linear, truth)
            || truth.effect.is_some_and(|effect| {
                let separation = self.separation(linear, effect);
                separation < RULE.same
                    || self.evidence[effect] > self.worth
                        && (self.evidence[effect] > self.evidence[self.named] - RULE.rival
                            || self.evidence[effect] > self.evidence[self.named] - RULE.decided
                                && separation < RULE.separation)
            })
    }
}

/// Wilson's 95 % interval of a rate.
#[must_use]
pub fn wilson(good: usize, all: usize) -> [f64; 2] {
    const Z: f64 = 1.959_964;
    if all == 0 {
        return [0.0, 1.0];
    }
    let (n, p) = (all as f64, good as f64 / all as f64);
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_are_alike_if_they_lead_by_as_much() {
        // Within 1 below a lead of 3.3, within three tenths above, and all equal from 6 on.
        assert!(is_as_clear(1.9, 1.0) && !is_as_clear(2.1, 1.0));
        assert!(is_as_clear(3.1, 4.0) && is_as_clear(5.1, 4.0) && !is_as_clear(5.3, 4.0));
        assert!(is_as_clear(60.0, 9.0) && is_as_clear(4.3, 100.0) && !is_as_clear(4.1, 100.0));
    }

    #[test]
    fn wilsons_interval_by_hand() {
        // 93 of 100: 0.8625 to 0.9657 (Wilson 1927).
        let [low, high] = wilson(93, 100);
        assert!((low - 0.8625).abs() < 1e-3 && (high - 0.9657).abs() < 1e-3, "{low} {high}");
        assert!(wilson(0, 0)[0] < 1e-15 && wilson(0, 0)[1] > 1.0 - 1e-15);
        assert!(wilson(10, 10)[1] > 0.999 && wilson(10, 10)[0] > 0.7);
    }
}
