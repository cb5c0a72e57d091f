//! A published force law as the base of a comparison, by its name.

use bulge_effects::law::{LAWS, Law, LawGeometry};
use bulge_effects::{Effect, Stage};
use bulge_muscles::Muscle;
use std::sync::Arc;

use crate::comparison::options::Options;

impl Options {
    /// The options with a published force law as the base instead of the equilibrium. Its coefficients are
    /// fitted; otherwise they are those printed for this muscle, if there are any.
    ///
    /// # Errors
    /// In a sentence: if there is no such law, or if it doesn't suit the muscle or the effects.
    pub fn with_law(mut self, name: &str, muscle: &Muscle, fitted: bool) -> Result<Self, String> {
        let law = suited_law(name, muscle, &self.effects)?;
        let table = law.table_for(muscle.name());
        self.law = Some((law, law.start(&LawGeometry::from(muscle), table), fitted));
        Ok(self)
    }
}

/// The law with this name, if it suits the muscle and the effects.
fn suited_law(name: &str, muscle: &Muscle, effects: &[Arc<dyn Effect>]) -> Result<&'static Law, String> {
    let law = Law::find(name).ok_or_else(|| no_law(name))?;
    if let Some(kind) = law.kind.filter(|_| !law.suits(muscle.kind())) {
        return Err(format!(
            "`{}` is a law of {} muscles, and this one is {}",
            law.name,
            kind.name(),
            muscle.kind().name()
        ));
    }
    if let Some(shape) = effects.iter().find(|effect| effect.stage() == Stage::Shape) {
        return Err(format!(
            "`{}` changes the shape of the muscle, and a law has none; leave out the effect or the law",
            shape.card().name
        ));
    }
    Ok(law)
}

/// The error for an unknown law, with similar names.
fn no_law(name: &str) -> String {
    let plain = |text: &str| text.to_lowercase().replace(['_', ' ', '-'], "");
    let near: Vec<String> = LAWS
        .iter()
        .filter(|law| plain(law.name).contains(&plain(name)) || plain(name).contains(&plain(law.name)))
        .map(|law| format!("`{}`", law.name))
        .collect();
    let instead = if near.is_empty() {
        "`bulge effects --laws` lists them".to_owned()
    } else {
        format!("did you mean {}?", near.join(" or "))
    };
    format!("there is no force law `{name}`; {instead}")
}
