//! What is compared: effects, what is known of them, and what is left out.

use bulge_effects::law::Law;
use bulge_effects::{Catalogue, Effect};
use bulge_model::Restriction;
use std::sync::Arc;

/// What is compared, besides muscle and data.
#[derive(Debug, Clone)]
pub struct Options {
    /// Effects to add, in this order.
    pub effects: Vec<Arc<dyn Effect>>,
    /// Effects that a muscle file states, with their numbers.
    pub known: Vec<(Arc<dyn Effect>, Vec<f64>)>,
    /// Where nuisances are looked up.
    pub catalogue: Catalogue,
    /// Numbers held, bounded or tied. Those of effects that aren't in the model say nothing, see [`crate::check_restrictions`].
    pub restrictions: Vec<Restriction>,
    /// A force law as the base instead of the equilibrium: with these coefficients, fitted if so asked.
    pub law: Option<(&'static Law, Vec<f64>, bool)>,
    /// Rows that are left out by hand.
    pub excluded: Vec<usize>,
    /// Whether errors on held-out data are computed.
    pub held_out: bool,
    /// Whether the papers' force laws are fitted to the same data.
    pub rivals: bool,
}

impl Options {
    /// The equilibrium with some effects, held-out errors, no rivals.
    #[must_use]
    pub fn new(catalogue: Catalogue, effects: Vec<Arc<dyn Effect>>) -> Self {
        Self {
            effects,
            known: Vec::new(),
            catalogue,
            restrictions: Vec::new(),
            law: None,
            excluded: Vec::new(),
            held_out: true,
            rivals: false,
        }
    }
}
