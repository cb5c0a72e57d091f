//! Fits that were made of the readings, by their effects: none is made twice.
//!
//! A pair that was tried on the base is the same model as its second effect on top of its first, and the rivals of one named effect are tried beside the others
//! of the search. Fits of the same readings with another noise are not the same, but end near each other: there others begin.

use bulge_effects::Effect;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::diagnosis::confirm::Confirmed;

/// Fits under one noise law. They are added when all that were made side by side have ended, so that none depends on which ended first.
#[derive(Debug, Default)]
pub(crate) struct Fits<'b> {
    made: Mutex<BTreeMap<Vec<String>, Confirmed>>,
    /// Those under another law.
    before: Option<&'b Fits<'b>>,
}

/// Names of effects in the order in which the model has them.
fn names(effects: &[Arc<dyn Effect>]) -> Vec<String> {
    effects.iter().map(|effect| effect.card().name.to_owned()).collect()
}

impl<'b> Fits<'b> {
    /// None, after those under another law.
    pub(crate) fn after(before: Option<&'b Fits<'b>>) -> Self {
        Self { made: Mutex::default(), before }
    }

    /// The fit of a model with these effects in this order.
    pub(crate) fn of(&self, effects: &[Arc<dyn Effect>]) -> Option<Confirmed> {
        self.made.lock().unwrap_or_else(PoisonError::into_inner).get(&names(effects)).cloned()
    }

    /// A fit of these effects in any order, of this law first: a model with the same numbers about.
    pub(crate) fn near(&self, effects: &[Arc<dyn Effect>]) -> Option<Confirmed> {
        let mut asked = names(effects);
        asked.sort_unstable();
        let is_it = |own: &Vec<String>| {
            own.len() == asked.len() && {
                let mut own = own.clone();
                own.sort_unstable();
                own == asked
            }
        };
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let found = made.iter().find(|(own, _)| is_it(own)).map(|(_, confirmed)| confirmed.clone());
        drop(made);
        found.or_else(|| self.before?.near(effects))
    }

    /// Keeps the lower of two fits of the same model, one with these effects in any order.
    pub(crate) fn add(&self, effects: &[Arc<dyn Effect>], confirmed: &Confirmed) {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let of_model = confirmed.prepared.model.effects().iter().map(|chosen| chosen.effect.card().name);
        let is_asked = |name: &&str| effects.iter().any(|effect| effect.card().name == *name);
        let key: Vec<String> = of_model.filter(is_asked).map(str::to_owned).collect();
        if made.get(&key).is_none_or(|known| confirmed.cost() < known.cost()) {
            made.insert(key, confirmed.clone());
        }
    }
}
