//! What could not be looked for in the data and could be the answer.

use bulge_effects::{Catalogue, Mechanism, Needs};
use serde::Serialize;

use crate::diagnosis::document::{Diagnosis, Verdict};

/// An effect that these data can't show apart from others, and that could be what is missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotLookedFor {
    /// Its name.
    pub effect: String,
    /// Why it could not be looked for.
    pub why: String,
}

/// Effects that could not be looked for and whose absence matters: those of the mechanism of a named effect or of one in its class, and all where the verdict is
/// *unknown*. Where the model explains the data, nothing is wanting.
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
        // Of one specimen, a difference between specimens explains nothing.
        card.needs != Needs::Specimens
            && match diagnosis.verdict {
                Verdict::Unknown => true,
                Verdict::Missing => named.contains(&card.mechanism),
                Verdict::Adequate | Verdict::CannotTell => false,
            }
    };
    let wanting = |why: &str| why.starts_with("needs ");
    diagnosis
        .candidates
        .iter()
        .filter(|c| c.status == "not-testable" && matters(&c.effect))
        .filter_map(|c| {
            let why = c.why.clone().filter(|why| wanting(why))?;
            Some(NotLookedFor { effect: c.effect.clone(), why })
        })
        .collect()
}
