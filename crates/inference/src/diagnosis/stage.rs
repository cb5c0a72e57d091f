//! A model with its misfit, its adequacy, and the evidence for an unknown effect on top of it.

use bulge_effects::Effect;
use bulge_model::ModelError;
use std::sync::Arc;

use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::hypotheses::Tried;
use crate::diagnosis::jump::Jump;
use crate::diagnosis::linearised_model::{Context, LinearisedModel};
use crate::diagnosis::null::Null;
use crate::diagnosis::something_else::log_odds;

/// Whether a model explains the data.
#[derive(Debug, Clone)]
pub(crate) struct Adequacy {
    pub(crate) null: Null,
    /// Whether effects are named.
    names: bool,
    /// p-values of the screen and of the smooth test.
    pub(crate) chance: [f64; 2],
    /// Whether the readings scatter about the model much more than the noise, in any way.
    pub(crate) fit_fails: bool,
    /// A misfit that no smooth function follows. It is looked for only if the other tests pass.
    pub(crate) unsmooth: Option<Unsmooth>,
}

/// A misfit that no smooth function follows.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Unsmooth {
    /// A line in the spectrum, with its period \[s\].
    Oscillation(f64),
    /// A jump within a sweep.
    Jump(Jump),
    /// A common misfit of near replicates.
    Recurs,
}

impl Adequacy {
    pub(crate) fn screen_fails(&self) -> bool {
        self.chance[0] < RULE.screen
    }

    pub(crate) fn smooth_fails(&self) -> bool {
        self.chance[1] < if self.names { RULE.smooth_beside_names } else { RULE.smooth }
    }

    pub(crate) fn holds(&self) -> bool {
        !self.screen_fails() && !self.smooth_fails() && !self.fit_fails
    }
}

/// A model on the path from the base to the last step.
pub(crate) struct Stage {
    /// Effects that were added to the base.
    pub(crate) added: Vec<Arc<dyn Effect>>,
    pub(crate) confirmed: Confirmed,
    pub(crate) linear: LinearisedModel,
    pub(crate) adequacy: Adequacy,
    /// Whether the model explains the data.
    pub(crate) adequate: bool,
    /// Hypotheses that were tried from here.
    pub(crate) tried: Vec<Tried>,
}

impl Stage {
    /// The added effects without one.
    pub(crate) fn without(&self, place: usize) -> Vec<Arc<dyn Effect>> {
        let others = self.added.iter().enumerate().filter(|(i, _)| *i != place);
        others.map(|(_, effect)| Arc::clone(effect)).collect()
    }

    /// The added effects, and those with these indices in the linearised model's list.
    pub(crate) fn with(&self, places: &[usize]) -> Vec<Arc<dyn Effect>> {
        let effects = &self.linear.sensitivities.effects;
        let new = places.iter().map(|place| &effects[*place].effect);
        self.added.iter().chain(new).cloned().collect()
    }

    /// Squared misfit along the smooth functions, in excess of chance.
    pub(crate) fn excess(&self) -> f64 {
        (self.linear.structure() - self.linear.smooth.len() as f64).max(0.0)
    }

    /// Fraction of the base's squared misfit beyond chance that the effects explain by their formulas,
    /// without form errors; 0 if they explain nothing.
    pub(crate) fn by_formulas(&self, base: &Self) -> f64 {
        let [exact, bent] = [self.confirmed.cost(), self.confirmed.bent_cost()];
        let left = if self.adequate { 0.0 } else { self.excess() };
        let all = base.confirmed.bent_cost() - bent + left;
        if all > 0.0 { ((base.confirmed.bent_cost() - exact) / all).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Log odds of an unknown effect on top of the model, at least 0; 0 if nothing is left to explain.
    pub(crate) fn something_else(&self) -> f64 {
        if self.adequate { 0.0 } else { log_odds(&self.linear).max(0.0) }
    }

    /// Log evidence of the model, possibly with an unknown effect on top, relative to that of another model;
    /// without the penalty for implausible parameters.
    pub(crate) fn value_over(&self, other: &Self) -> f64 {
        let own = |stage: &Self| stage.confirmed.log_evidence + stage.confirmed.penalty;
        own(self) - own(other) + self.something_else()
    }

    /// Log evidence attributed to small errors of the formulas, which a smooth misfit can follow and the
    /// formulas can't.
    pub(crate) fn digits_over(&self, base: &Self) -> f64 {
        0.5 * RULE.digits * (base.confirmed.bent_cost() - self.confirmed.bent_cost()).max(0.0)
    }

    /// Ratio of the misfit's variance along the smooth functions to chance: 1 if the model explains the data.
    pub(crate) fn scatter(&self) -> f64 {
        let smooth = &self.linear.smooth;
        if self.adequate || smooth.is_empty() {
            return 1.0;
        }
        (self.linear.structure() / smooth.len() as f64).max(1.0)
    }
}
/// A log evidence if the noise variance exceeds the law's by the ratio `scatter`; `gain` is the decrease of
/// the squared misfit that it contains.
pub(crate) fn tempered(log_evidence: f64, gain: f64, scatter: f64) -> f64 {
    log_evidence - 0.5 * gain * (1.0 - 1.0 / scatter)
}
impl Context<'_> {
    /// A model, linearised, with its adequacy.
    pub(crate) fn stage(
        &self,
        added: Vec<Arc<dyn Effect>>,
        confirmed: Confirmed,
    ) -> Result<Stage, ModelError> {
        let known = Context { kin: Some(&confirmed.form.kin), ..*self };
        let linear = known.linearised(&confirmed.prepared, &confirmed.theta)?;
        let (null, chance) = linear.chance(self);
        let fit_fails = self.scatters(&confirmed);
        let names = !added.is_empty();
        let mut adequacy = Adequacy { null, names, chance, fit_fails, unsmooth: None };
        // A test may reject a model although no smooth misfit explains that: it isn't a structure.
        let is_chance =
            || !added.is_empty() && !adequacy.screen_fails() && !fit_fails && log_odds(&linear) <= 0.0;
        let holds = adequacy.holds() || is_chance();
        adequacy.unsmooth = if holds { self.unsmooth(&linear) } else { None };
        // Beside effects that explain everything else, such a misfit is no reason to add effects or form
        // errors.
        let adequate = holds && (adequacy.names || adequacy.unsmooth.is_none());
        Ok(Stage { added, confirmed, linear, adequate, adequacy, tried: Vec::new() })
    }

    /// The misfit that no smooth function follows, the most specific kind first.
    fn unsmooth(&self, linear: &LinearisedModel) -> Option<Unsmooth> {
        let oscillation = || linear.oscillation(self).map(Unsmooth::Oscillation);
        let jump = || linear.jump(self).map(Unsmooth::Jump);
        let chance = || linear.lack_of_fit(self.record).filter(|chance| *chance < RULE.near_replicates);
        oscillation().or_else(jump).or_else(|| chance().map(|_| Unsmooth::Recurs))
    }

    /// Whether readings scatter about a model much more than their noise.
    fn scatters(&self, confirmed: &Confirmed) -> bool {
        let rows = self.record.len() as f64;
        let ratio = confirmed.bent_cost() / rows;
        let sd = (2.0 / rows + 2.0 / self.law.degrees_of_freedom.max(1.0)).sqrt();
        ratio > (1.0 + RULE.scatters[0] * sd).max(RULE.scatters[1])
    }
}

#[cfg(test)]
mod tests {
    use super::tempered;

    #[test]
    fn scatter_beyond_the_noise_takes_its_part_of_the_evidence() {
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        // ln Z contains gain/2; with four times the variance, a quarter of that is left.
        is(tempered(10.0, 12.0, 4.0), 10.0 - 6.0 + 1.5);
        is(tempered(10.0, 12.0, 1.0), 10.0);
    }
}
