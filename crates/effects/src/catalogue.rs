//! The list of all effects, built in or added by the user. Fits, rankings, help and reports use it.

use bulge_muscles::shown::shortened;
use std::sync::Arc;

use crate::effect::Effect;
use crate::law::LAWS;
use crate::{geometry, load, material, rig, specimen};

/// The reason why an effect isn't in the catalogue, or can't be added to it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CatalogueError {
    /// An unknown name.
    #[error("there is no effect `{}`; {instead}", shortened(name))]
    Unknown {
        /// The name asked for.
        name: String,
        /// A hint at the name to write instead.
        instead: String,
    },
    /// A name that is already taken.
    #[error("an effect or a law `{name}` is in the catalogue already; give yours another name")]
    Taken {
        /// The name.
        name: String,
    },
}

/// All effects, by name.
#[derive(Debug, Clone)]
pub struct Catalogue {
    effects: Vec<Arc<dyn Effect>>,
}

impl Default for Catalogue {
    fn default() -> Self {
        Self::builtin()
    }
}

impl Catalogue {
    /// All built-in effects, in the order of their groups.
    #[must_use]
    pub fn builtin() -> Self {
        let groups = [geometry::all(), material::all(), load::all(), rig::all(), specimen::all()];
        Self { effects: groups.into_iter().flatten().collect() }
    }

    /// Adds an effect.
    ///
    /// # Errors
    /// If its name is taken.
    pub fn with(mut self, effect: impl Effect + 'static) -> Result<Self, CatalogueError> {
        let name = effect.card().name.to_owned();
        let is_law = || LAWS.iter().any(|law| law.name == name || law.aliases.contains(&name.as_str()));
        if self.effects.iter().any(|other| other.card().name == name) || is_law() {
            return Err(CatalogueError::Taken { name });
        }
        self.effects.push(Arc::new(effect));
        Ok(self)
    }

    /// All effects.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<dyn Effect>> {
        self.effects.iter()
    }

    /// The effect with this name.
    ///
    /// # Errors
    /// If there is none. The message lists the nearest names.
    pub fn find(&self, name: &str) -> Result<&Arc<dyn Effect>, CatalogueError> {
        self.effects.iter().find(|effect| effect.card().name == name).ok_or_else(|| {
            let plain = |text: &str| text.to_lowercase().replace(['_', ' '], "-");
            let slips = |other: &str| strsim::damerau_levenshtein(other, &plain(name));
            let names = || self.effects.iter().map(|effect| effect.card().name);
            let near =
                names().min_by_key(|other| slips(other)).filter(|other| slips(other) <= name.len() / 3);
            let part = || names().filter(|other| plain(name).len() >= 3 && other.contains(&plain(name)));
            let instead = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None if part().next().is_some() => {
                    format!(
                        "did you mean {}?",
                        part().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(" or ")
                    )
                }
                None => "`bulge effects` lists them all".to_owned(),
            };
            CatalogueError::Unknown { name: name.chars().take(40).collect(), instead }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load cell and a length sensor are zeroed when a muscle is mounted; what belongs to the muscle or to a range stays.
    #[test]
    fn zeros_change_with_each_mounting() {
        let catalogue = Catalogue::builtin();
        let changing =
            catalogue.iter().filter(|effect| effect.is_of_mounting()).map(|effect| effect.card().name);
        assert_eq!(changing.collect::<Vec<_>>(), ["length-zero-error", "force-offset"]);
    }
}
