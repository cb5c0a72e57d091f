//! A cache of fits by their effects, so that none is made twice.
//!
//! A pair that was tried on the base is the same model as its second effect on top of its first, and the
//! rivals of one named effect are tried beside the other effects of the search. Fits of the same readings
//! under another noise law differ, but end near each other and serve as starts.

use bulge_effects::Effect;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::diagnosis::confirm::Confirmed;

/// Fits under one noise law. Fits that run in parallel are added after all of them have ended, so that the
/// result doesn't depend on which ended first.
#[derive(Debug, Default)]
pub(crate) struct Fits<'b> {
    made: Mutex<BTreeMap<Vec<String>, Confirmed>>,
    /// Fits under another law.
    before: Option<&'b Fits<'b>>,
}

/// Names of effects in the order of the model.
fn names(effects: &[Arc<dyn Effect>]) -> Vec<String> {
    effects.iter().map(|effect| effect.card().name.to_owned()).collect()
}

impl<'b> Fits<'b> {
    /// An empty cache that refers to fits under another law.
    pub(crate) fn after(before: Option<&'b Fits<'b>>) -> Self {
        Self { made: Mutex::default(), before }
    }

    /// The fit of a model with these effects in this order.
    pub(crate) fn of(&self, effects: &[Arc<dyn Effect>]) -> Option<Confirmed> {
        self.made.lock().unwrap_or_else(PoisonError::into_inner).get(&names(effects)).cloned()
    }

    /// A fit of these effects in any order, preferably under this law. Its parameters are approximately those
    /// wanted.
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

    /// Keeps the lower one of two fits of the same model; `effects` may be in any order.
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
