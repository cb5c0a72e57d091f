//! A model with what stands beside it: its misfit, whether it explains the data, and what something else on top of it would be worth.

use bulge_effects::Effect;
use bulge_model::ModelError;
use std::sync::Arc;

use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::hypotheses::Tried;
use crate::diagnosis::jump::Jump;
use crate::diagnosis::linearised_model::{Context, LinearisedModel};
use crate::diagnosis::null::Null;
use crate::diagnosis::something_else::smooth_evidence;

/// Whether a model explains the data.
#[derive(Debug, Clone)]
pub(crate) struct Adequacy {
    pub(crate) null: Null,
    /// Whether effects are named.
    names: bool,
    /// How often chance alone gives as much: the screen, the smooth test.
    pub(crate) chance: [f64; 2],
    /// Whether the readings scatter about the model by much more than the noise does, in whatever way.
    pub(crate) fit_fails: bool,
    /// What is left that no smooth function follows. Looked for only where the rest holds.
    pub(crate) unsmooth: Option<Unsmooth>,
}

/// What no smooth function follows.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Unsmooth {
    /// A line in the spectrum, by its period \[s\].
    Oscillation(f64),
    /// A jump within a sweep.
    Jump(Jump),
    /// What near replicates miss in common.
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

/// A model of the path from the base to the last step.
pub(crate) struct Stage {
    /// Effects that were added to the base.
    pub(crate) added: Vec<Arc<dyn Effect>>,
    pub(crate) confirmed: Confirmed,
    pub(crate) linear: LinearisedModel,
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

    /// The added effects with those at these places of the linearised model's list.
    pub(crate) fn with(&self, places: &[usize]) -> Vec<Arc<dyn Effect>> {
        let effects = &self.linear.sensitivities.effects;
        let new = places.iter().map(|place| &effects[*place].effect);
        self.added.iter().chain(new).cloned().collect()
    }

    /// Square of the misfit that smooth functions follow, beyond what chance gives.
    pub(crate) fn excess(&self) -> f64 {
        (self.linear.structure() - self.linear.smooth.len() as f64).max(0.0)
    }

    /// Part of the misfit of the base, as squares beyond chance, that the formulas of the effects explain as they are, not bent; 0 where they explain nothing.
    pub(crate) fn by_formulas(&self, base: &Self) -> f64 {
        let [exact, bent] = [self.confirmed.cost(), self.confirmed.bent_cost()];
        let left = if self.adequate { 0.0 } else { self.excess() };
        let all = base.confirmed.bent_cost() - bent + left;
        if all > 0.0 { ((base.confirmed.bent_cost() - exact) / all).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Log evidence of something that nobody thought of on top of the model; 0 where nothing is left to explain.
    pub(crate) fn something_else(&self) -> f64 {
        if self.adequate { 0.0 } else { (RULE.something_else + smooth_evidence(&self.linear)).max(0.0) }
    }

    /// Log evidence of the model, with or without something else on top, over that of another; implausible numbers cost nothing here.
    pub(crate) fn value_over(&self, other: &Self) -> f64 {
        let own = |stage: &Self| stage.confirmed.log_evidence + stage.confirmed.penalty;
        own(self) - own(other) + self.something_else()
    }

    /// Log evidence that the last digits of a formula are worth, where a smooth misfit follows them and the formula doesn't.
    pub(crate) fn digits_over(&self, base: &Self) -> f64 {
        0.5 * RULE.digits * (base.confirmed.bent_cost() - self.confirmed.bent_cost()).max(0.0)
    }

    /// How much more than chance the misfit scatters over the smooth functions, as a ratio of variances: 1 if the model explains the data.
    pub(crate) fn scatter(&self) -> f64 {
        let smooth = &self.linear.smooth;
        if self.adequate || smooth.is_empty() {
            return 1.0;
        }
        (self.linear.structure() / smooth.len() as f64).max(1.0)
    }
}
/// A log evidence when the noise is larger by the ratio `scatter` of variances than the law says; `gain` is the fall of the square of the misfit in it.
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
        // A test may be surprised by what no smooth misfit explains: that is no structure.
        let is_chance = || {
            !added.is_empty()
                && !adequacy.screen_fails()
                && !fit_fails
                && RULE.something_else + smooth_evidence(&linear) <= 0.0
        };
        let holds = adequacy.holds() || is_chance();
        adequacy.unsmooth = if holds { self.unsmooth(&linear) } else { None };
        // That beside effects that explain the rest is no reason to bend or add more of them.
        let adequate = holds && (adequacy.names || adequacy.unsmooth.is_none());
        Ok(Stage { added, confirmed, linear, adequate, adequacy, tried: Vec::new() })
    }

    /// What a model leaves that no smooth function follows, the most definite first.
    fn unsmooth(&self, linear: &LinearisedModel) -> Option<Unsmooth> {
        let oscillation = || linear.oscillation(self.record).map(Unsmooth::Oscillation);
        let jump = || linear.jump(self).map(Unsmooth::Jump);
        let chance = || linear.lack_of_fit(self.record).filter(|chance| *chance < RULE.near_replicates);
        oscillation().or_else(jump).or_else(|| chance().map(|_| Unsmooth::Recurs))
    }

    /// Whether readings scatter about a model by much more than their noise.
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
        // ln Z holds gain/2; with four times the variance a quarter of that is left.
        is(tempered(10.0, 12.0, 4.0), 10.0 - 6.0 + 1.5);
        is(tempered(10.0, 12.0, 1.0), 10.0);
    }
}
