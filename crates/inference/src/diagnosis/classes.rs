//! Classes of effects that the data can't distinguish from a named one: rivals with similar evidence, or with
//! a separation within the noise.
//!
//! ```text
//! d_ee' = min over a' of |s_e - s_e' a'|,    s_e the whitened change of the force by e at its best numbers, without what the other numbers can do
//! ```

use bulge_effects::Effect;
use bulge_model::{Model, ModelError, Wanted, Warm};
use rayon::prelude::*;
use std::sync::Arc;

use crate::diagnosis::bending::may_bend;
use crate::diagnosis::candidates::Candidate;
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::hypotheses::{Hypothesis, Tried, effect_log_prior, singles};
use crate::diagnosis::linearised_model::{Context, LinearisedModel};
use crate::diagnosis::search::names;
use crate::diagnosis::space::Space;
use crate::diagnosis::stage::{Stage, tempered};
use crate::vector::minus;
use bulge_numerics::vector::{dot, norm};

/// Rivals whose linear evidence is this far below the best are not fitted.
const FITTED: f64 = 8.0;
/// Most rivals that are fitted.
const MOST: usize = 8;

/// An effect that could replace a named one.
#[derive(Debug, Clone)]
pub(crate) struct Rival {
    pub(crate) effect: Arc<dyn Effect>,
    /// Log evidence relative to the model without either, less [`RULE`]`.by_bending` of what its form errors gain
    /// more than those of the named effect.
    pub(crate) log_evidence: f64,
    /// Sigmas between the two effects, with the rival at its best size.
    pub(crate) separation: f64,
    /// Whether the data can't decide between them.
    pub(crate) in_class: bool,
    /// The fit, if one was made.
    pub(crate) fit: Option<Confirmed>,
}

/// A named effect and its rivals.
#[derive(Debug, Clone)]
pub(crate) struct Class {
    pub(crate) effect: Arc<dyn Effect>,
    /// Log evidence relative to the model without it.
    pub(crate) log_evidence: f64,
    /// Whether larger errors of the other effects' formulas would explain as much.
    pub(crate) may_be_form_error: bool,
    /// Its length in sigmas beside the other effects.
    pub(crate) detectability: f64,
    /// Variance of the whole model's misfit relative to chance.
    pub(crate) scatter: f64,
    /// Whether other effects are named as well.
    pub(crate) is_further: bool,
    pub(crate) rivals: Vec<Rival>,
}

impl Class {
    /// Keeps the fits of all rivals beside the other effects of a stage.
    pub(crate) fn remember(&self, context: &Context<'_>, stage: &Stage) {
        let Some(fits) = context.fits else { return };
        let is_other = |effect: &&Arc<dyn Effect>| effect.card().name != self.effect.card().name;
        let others: Vec<Arc<dyn Effect>> = stage.added.iter().filter(is_other).cloned().collect();
        for (rival, fit) in self.rivals.iter().filter_map(|rival| Some((rival, rival.fit.as_ref()?))) {
            let mut all = others.clone();
            all.push(Arc::clone(&rival.effect));
            fits.add(&all, fit);
        }
    }

    /// The class of an effect without which no model can be fitted. It has no rivals, and its length follows
    /// from the decrease of the base's misfit.
    pub(crate) fn without_baseline(stage: &Stage, place: usize, base: &Stage) -> Self {
        let effect = Arc::clone(&stage.added[place]);
        let scatter = stage.scatter();
        let gain = (base.confirmed.cost() - stage.confirmed.cost()).max(0.0) / scatter;
        let is_further = stage.added.len() > 1;
        Self {
            effect,
            log_evidence: 0.5 * gain,
            may_be_form_error: false,
            detectability: gain.sqrt(),
            scatter,
            is_further,
            rivals: Vec::new(),
        }
    }
}

/// The log evidence of a rival of an effect of `stage`, by its fit. Of two that explain as much, the one with the
/// more accurate formula is preferred: a rival that is bent more loses as much as in the ranking of the search. (One
/// that is bent less gains nothing: it would replace what the published loops of a fluidic muscle hold.)
fn evidence_of_rival(tried: &Tried, stage: &Stage, without: &Stage, scatter: f64) -> f64 {
    let Some(fit) = &tried.confirmed else { return tried.log_evidence };
    let gain = without.confirmed.bent_cost() - fit.bent_cost();
    let more_bent = fit.form.log_evidence - stage.confirmed.form.log_evidence;
    tempered(tried.log_evidence, gain, scatter) - RULE.by_bending * more_bent.max(0.0)
}

impl Context<'_> {
    /// The class of one of the added effects, with all others staying, and the stage without it if none was
    /// `known`. None if without this effect there is no model that could have produced these data.
    pub(crate) fn class(
        &self,
        base: &Model,
        stage: &Stage,
        place: usize,
        known: Option<&Stage>,
    ) -> Option<(Class, Option<Stage>)> {
        let effect = Arc::clone(&stage.added[place]);
        let mut made = None;
        let without = if let Some(known) = known {
            known
        } else {
            let others = stage.without(place);
            let fitted = self.refitted(base, &stage.confirmed, &others).ok()?;
            &*made.insert(self.stage(others, fitted).ok()?)
        };
        let signal = self.signal(&stage.confirmed, &without.linear).ok()?;
        let bent: Vec<&Vec<f64>> = stage.linear.bent.iter().collect();
        let plain = self.beside(&without.linear, &signal, &bent);
        let name = effect.card().name;
        let own = without.linear.place(name);
        let effect_log_prior = own.map_or(0.0, |own| effect_log_prior(&without.linear, own));
        let scatter = stage.scatter();
        let gain = without.confirmed.bent_cost() - stage.confirmed.bent_cost();
        let log_evidence = tempered(
            stage.confirmed.log_evidence - without.confirmed.log_evidence + effect_log_prior,
            gain,
            scatter,
        );
        let margin = RULE.rival.max(RULE.rival_bent * stage.confirmed.form.log_evidence);
        let beside = Context { kin: Some(&stage.confirmed.form.kin), ..*self };
        let list = singles(&without.linear, &without.confirmed.prepared.model);
        let best = list.iter().map(|h| h.log_evidence).fold(f64::NEG_INFINITY, f64::max);
        let mut fitted = 0;
        let known_of = |place: usize| without.tried.iter().find(|tried| tried.hypothesis.effects == [place]);
        let rivals: Vec<(Hypothesis, f64, bool)> = list
            .into_iter()
            .filter(|h| Some(h.effects[0]) != own)
            .map(|h| {
                let separation = plain.separation(&without.linear, h.effects[0]) / scatter.sqrt();
                // Only rivals close to the best one or to this effect are fitted, and at most `MOST` of them.
                let near = (h.log_evidence > best - FITTED * scatter || separation < RULE.separation)
                    && fitted < MOST;
                fitted += usize::from(near);
                // A fit that is there says more than a linear step, which is far off where an effect is large.
                let near = near || known_of(h.effects[0]).is_some();
                (h, separation, near)
            })
            .collect();
        let rivals = rivals
            .into_par_iter()
            .map(|(hypothesis, separation, near)| {
                let (linear, gain_of) = (hypothesis.log_evidence, hypothesis.gain);
                let place = hypothesis.effects[0];
                let known = known_of(place);
                let tried =
                    near.then(|| known.cloned().unwrap_or_else(|| beside.fitted(base, without, hypothesis)));
                let fit = tried.as_ref().and_then(|tried| tried.confirmed.as_ref());
                // If the rival has a form error, the separation takes its directions into account as well.
                let own = fit.filter(|fit| fit.form.log_evidence > 0.0);
                let own = own.map_or(Vec::new(), |fit| {
                    let known = Context { kin: Some(&fit.form.kin), ..*self };
                    known.form_directions(&fit.prepared, &fit.theta)
                });
                let separation = if own.is_empty() {
                    separation
                } else {
                    let both: Vec<&Vec<f64>> = bent.iter().copied().chain(&own).collect();
                    self.beside(&without.linear, &signal, &both).separation(&without.linear, place)
                        / scatter.sqrt()
                };
                let evidence = tried.as_ref().map_or_else(
                    || tempered(linear, gain_of, scatter),
                    |tried| evidence_of_rival(tried, stage, without, scatter),
                );
                Self::rival(without, place, evidence, separation, tried, log_evidence, margin)
            })
            .collect();
        let seen = without.linear.space.coordinates(&self.white(&signal, without.linear.priors));
        let detectability = norm(&seen) / scatter.sqrt();
        let is_further = stage.added.len() > 1;
        let may_be_form_error = self.may_be_form_error(stage, without);
        let class =
            Class { effect, log_evidence, may_be_form_error, detectability, scatter, is_further, rivals };
        Some((class, made))
    }

    /// Whether larger errors of the formulas of a model would explain as much as the effects that another one has
    /// beside them: where all formulas may be as wrong as they are drawn, these effects lose evidence, and are not
    /// worth their prior cost any more.
    pub(crate) fn may_be_form_error(&self, stage: &Stage, without: &Stage) -> bool {
        if !may_bend(&without.confirmed.prepared) {
            return false;
        }
        let loose = |model: &Confirmed| {
            let loose = Context { to_draw: true, kin: Some(&model.form.kin), ..*self };
            let form = loose.form_error(&model.prepared, &model.theta).ok()?;
            Some(model.log_evidence - model.form.log_evidence + form.log_evidence)
        };
        let known = names(without.added.iter());
        let more = stage.added.iter().filter(|effect| !known.iter().any(|name| name == effect.card().name));
        let places = more.filter_map(|effect| without.linear.place(effect.card().name));
        let log_priors: f64 = places.map(|place| effect_log_prior(&without.linear, place)).sum();
        let usual = stage.confirmed.log_evidence - without.confirmed.log_evidence + log_priors;
        let left = loose(&stage.confirmed).zip(loose(&without.confirmed));
        left.map(|(with, without)| with - without + log_priors)
            .is_some_and(|left| left <= RULE.worth[1] && usual - left > RULE.rival)
    }

    /// The stage without an effect that isn't worth its prior cost any more beside later ones (backward
    /// elimination).
    pub(crate) fn dropped(&self, base: &Model, stage: &Stage, place: usize, class: &Class) -> Option<Stage> {
        if stage.added.len() == 1 || class.log_evidence > RULE.worth[1] {
            return None;
        }
        let others = stage.without(place);
        let fitted = self.refitted(base, &stage.confirmed, &others).ok()?;
        let other = self.stage(others, fitted).ok()?;
        (other.adequate || !stage.adequate).then_some(other)
    }

    /// The stage with the best rival in place of an effect, if that is clearly better and explains the data
    /// no less.
    pub(crate) fn swapped(&self, stage: &Stage, place: usize, class: &Class) -> Option<Stage> {
        let converged = |rival: &&Rival| rival.fit.as_ref().is_some_and(|fit| fit.converged);
        let better = |a: &&Rival, b: &&Rival| a.log_evidence.total_cmp(&b.log_evidence);
        let rival = class.rivals.iter().filter(converged).max_by(better)?;
        if rival.log_evidence <= class.log_evidence + RULE.swap {
            return None;
        }
        let mut added = stage.added.clone();
        added.remove(place);
        added.push(Arc::clone(&rival.effect));
        let fit = rival.fit.as_ref()?;
        let new = [Arc::clone(&rival.effect)];
        if fit.is_absurd(&new, self.record) || fit.is_idle(&new) {
            return None;
        }
        let other = self.stage(added, fit.clone()).ok()?;
        (other.adequate || !stage.adequate).then_some(other)
    }

    /// A model with fewer effects. The fit starts from the fit `with` all effects and, if it doesn't
    /// converge, from usual parameters: the best parameters with the effect may not even have an equilibrium
    /// without it.
    pub(crate) fn refitted(
        &self,
        base: &Model,
        with: &Confirmed,
        others: &[Arc<dyn Effect>],
    ) -> Result<Confirmed, ModelError> {
        if let Some(known) = self.fits.and_then(|fits| fits.of(others)).filter(|known| known.converged) {
            return Ok(known);
        }
        let carried = self.confirm(base, others, Some(with.numbers()), &[]);
        let mut best = carried;
        for part in [1.0, 0.1] {
            if best.as_ref().is_ok_and(|found| found.converged) {
                break;
            }
            let usual = Self::usual(base, others, part);
            let other = self.confirm(base, others, None, &[usual]);
            best = match (best, other) {
                (Ok(a), Ok(b)) => Ok(if b.cost() < a.cost() { b } else { a }),
                (Err(_), Ok(b)) => Ok(b),
                (best, Err(_)) => best,
            };
        }
        best
    }

    fn rival(
        without: &Stage,
        place: usize,
        log_evidence: f64,
        separation: f64,
        tried: Option<Tried>,
        named: f64,
        margin: f64,
    ) -> Rival {
        // A rival that is indistinguishable on these data stays, however implausible its parameters are:
        // priors may be wrong.
        let undecided = log_evidence > named - margin
            || separation < RULE.separation && log_evidence > named - RULE.decided.max(margin)
            || separation < RULE.same;
        let worth = RULE.worth[usize::from(!without.added.is_empty())];
        let in_class = tried.is_some() && log_evidence.is_finite() && log_evidence > worth && undecided;
        let effect = Arc::clone(&without.linear.sensitivities.effects[place].effect);
        Rival { effect, log_evidence, separation, in_class, fit: tried.and_then(|tried| tried.confirmed) }
    }

    /// Change of the force by an effect \[N\], relative to the model without it.
    pub(crate) fn signal(&self, with: &Confirmed, without: &LinearisedModel) -> Result<Vec<f64>, ModelError> {
        let model = &with.prepared.model;
        let force = model.evaluate_warm(self.record, &with.theta, &Wanted::default(), &Warm::new())?.force;
        Ok(minus(&force, &without.force))
    }

    /// A signal \[N\] relative to a linearised model and form errors `bent` of one standard deviation \[N\].
    pub(crate) fn beside(&self, linear: &LinearisedModel, signal: &[f64], bent: &[&Vec<f64>]) -> Beside {
        let whiten = |column: &[f64]| self.white(column, linear.priors);
        let signal = whiten(signal);
        if bent.is_empty() {
            return Beside {
                signal: linear.space.coordinates(&signal),
                length: 0,
                bent: 0,
                space: Space::default(),
            };
        }
        let mut space = linear.space.clone();
        let white: Vec<Vec<f64>> = bent.iter().map(|column| whiten(column)).collect();
        let columns = space.enter_all(&white);
        let length = space.len();
        let prior = |(place, mut column): (usize, Vec<f64>)| {
            column.resize(length + bent.len(), 0.0);
            column[length + place] = 1.0;
            column
        };
        let columns: Vec<Vec<f64>> = columns.into_iter().enumerate().map(prior).collect();
        let mut beside =
            Beside { signal: Vec::new(), length, bent: bent.len(), space: Space::without(&columns) };
        let mut own = beside.space.clone();
        beside.signal = beside.enter(&mut own, &space.coordinates(&signal));
        beside.space = own;
        beside
    }
}

/// The signal of an effect in coordinates, with form errors taken into account: what they can absorb doesn't
/// distinguish it from another effect.
pub(crate) struct Beside {
    signal: Vec<f64>,
    /// Number of coordinates of the linearised model, and of form errors with a prior each.
    length: usize,
    bent: usize,
    space: Space,
}

impl Beside {
    fn enter(&self, space: &mut Space, column: &[f64]) -> Vec<f64> {
        let mut column = column.to_vec();
        column.resize(self.length + self.bent, 0.0);
        space.enter(&column)
    }

    /// Sigmas between the signal and an effect at its best size.
    pub(crate) fn separation(&self, linear: &LinearisedModel, effect: usize) -> f64 {
        let candidates = linear.candidates.iter().filter(|c| c.effect == effect);
        if self.bent == 0 {
            return separation(&self.signal, candidates);
        }
        let mut space = self.space.clone();
        let moved: Vec<Candidate> = candidates
            .map(|c| c.with_columns(c.columns.iter().map(|column| self.enter(&mut space, column)).collect()))
            .collect();
        separation(&self.signal, moved.iter())
    }
}

/// Sigmas between a signal in coordinates and the nearest candidate at its best size.
pub(crate) fn separation<'c>(signal: &[f64], candidates: impl Iterator<Item = &'c Candidate>) -> f64 {
    let most = candidates.map(|c| c.explains(signal).gain).fold(0.0, f64::max);
    (dot(signal, signal) - most).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::law::{NoiseLaw, NoiseSource};
    use crate::noise::whitening::Whitening;
    use bulge_effects::{Catalogue, Moment};
    use bulge_model::Record;
    use bulge_muscles::preset;
    use bulge_numerics::Random;

    #[test]
    fn an_effect_that_is_worth_nothing_is_dropped_and_lower_minima_are_taken() {
        let catalogue = Catalogue::builtin();
        let base = Model::new(&preset("ppam-2-r16").unwrap());
        let at = |i: u32| {
            let (up, place) = (i % 40 < 20, if i % 40 < 20 { i % 40 } else { 39 - i % 40 });
            let direction = if up { 1.0 } else { -1.0 };
            Moment {
                direction,
                ..Moment::at_rest(2e5 + 1e5 * f64::from(i / 80), 0.05 + 0.01 * f64::from(place))
            }
        };
        let moments: Vec<Moment> = (0..160).map(at).collect();
        let record = Record::from_moments(moments, vec![0.0; 160], vec![0..80, 80..160]).unwrap();
        let exact = base.evaluate(&record, &[], &Wanted::default()).unwrap().force;
        let mut random = Random::new(6, 0);
        let measured = exact.iter().zip(record.moments());
        let measured =
            measured.map(|(f, m)| f - (10.0 - 2e-5 * m.pressure) * m.direction + random.normal()).collect();
        let record = record.with_force(measured);
        let law = NoiseLaw::white(1.0, NoiseSource::Saturated, 1e6, String::new());
        let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &[]).unwrap();
        let context = Context::new(&catalogue, &record, &whitening, &law);
        let [friction, offset] =
            ["coulomb-friction", "force-offset"].map(|n| Arc::clone(catalogue.find(n).unwrap()));
        let both = vec![friction, offset];
        let confirmed = context.confirm(&base, &both, None, &[]).unwrap();
        let stage = context.stage(both, confirmed).unwrap();
        let dropped = |place: usize| {
            let (class, _) = context.class(&base, &stage, place, None).unwrap();
            context.dropped(&base, &stage, place, &class).map(|stage| stage.added[0].card().name.to_owned())
        };
        assert_eq!([dropped(0), dropped(1)], [None, Some("coulomb-friction".to_owned())]);
        // The stage is replaced by a lower minimum of its own model, which is 40 below, if a fit with an idle
        // effect found it.
        let one = vec![Arc::clone(&stage.added[0])];
        let right = context.confirm(&base, &one, None, &[]).unwrap();
        let mut worse = context.stage(one, right.clone()).unwrap();
        let other = Arc::clone(catalogue.find("pressure-friction").unwrap());
        let idle =
            context.confirm(&base, &[Arc::clone(&worse.added[0]), Arc::clone(&other)], None, &[]).unwrap();
        assert!(context.lower(&base, &worse).is_none());
        worse.confirmed.minimum.cost += 40.0;
        let place = worse.linear.place(other.card().name);
        let hypothesis =
            Hypothesis { effects: vec![place.unwrap()], log_evidence: 0.0, gain: 0.0, starts: Vec::new() };
        assert!(idle.is_idle(&[other]), "friction that falls with the pressure leaves it off");
        worse.tried = vec![Tried { hypothesis, confirmed: Some(idle), log_evidence: 0.0 }];
        let found = context.lower(&base, &worse).unwrap();
        assert!((found.confirmed.cost() - right.cost()).abs() < 1e-6);
    }
}
