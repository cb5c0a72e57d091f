//! Effects that could not be tested on the data but may be missing.

use bulge_effects::{Catalogue, Mechanism, Needs};
use serde::Serialize;

use crate::diagnosis::document::{Diagnosis, Verdict};

/// An effect that these data can't show separately, but that may be missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotLookedFor {
    /// Its name.
    pub effect: String,
    /// Why it could not be tested.
    pub why: String,
}

/// Effects that could not be tested and whose absence matters: those with the mechanism of a named effect or
/// of one in its class, and all of them if the verdict is *unknown*. If the model explains the data, the list
/// is empty.
pub(crate) fn not_looked_for(diagnosis: &Diagnosis, catalogue: &Catalogue) -> Vec<NotLookedFor> {
    let mechanism = |name: &str| catalogue.find(name).ok().map(|effect| effect.card().mechanism);
    let named: Vec<Mechanism> = diagnosis
        .missing
        .iter()
        .flat_map(|missing| missing.class.iter().chain([&missing.effect, &missing.fitted]))
        .filter_map(|name| mechanism(name))
        .collect();
    let matters = |name: &str| {
        let Ok(effect) = catalogue.find(name) else { return false };
        let card = effect.card();
        // With a single specimen, a difference between specimens explains nothing.
        card.needs != Needs::Specimens
            && match diagnosis.verdict {
                Verdict::Unknown => true,
                Verdict::Missing => named.contains(&card.mechanism),
                Verdict::Adequate | Verdict::CannotTell => false,
            }
    };
    let wanting = |why: &str| why.starts_with("needs ");
    // What stands in a class is a name that these data leave open, for whatever reason they can't show it alone.
    let is_open = |name: &String| {
        diagnosis.missing.iter().any(|missing| missing.class.contains(name) || missing.forms.contains(name))
    };
    diagnosis
        .candidates
        .iter()
        .filter(|c| c.status == "not-testable" && matters(&c.effect) && !is_open(&c.effect))
        .filter_map(|c| {
            let why = c.why.clone().filter(|why| wanting(why))?;
            Some(NotLookedFor { effect: c.effect.clone(), why })
        })
        .collect()
}
