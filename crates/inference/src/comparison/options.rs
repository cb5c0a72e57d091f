//! Options of a comparison: effects, what is known of them, and what is left out.

use bulge_effects::law::Law;
use bulge_effects::{Catalogue, Effect};
use bulge_model::Restriction;
use std::sync::Arc;

use crate::fit::loss::Loss;

/// Options of a comparison, besides muscle and data.
#[derive(Debug, Clone)]
pub struct Options {
    /// Effects to add, in this order.
    pub effects: Vec<Arc<dyn Effect>>,
    /// Effects that the muscle file states, with their parameters.
    pub known: Vec<(Arc<dyn Effect>, Vec<f64>)>,
    /// Catalogue from which nuisance effects are taken.
    pub catalogue: Catalogue,
    /// Parameters that are held, bounded or tied. Restrictions of effects that aren't in the model are
    /// ignored, see [`crate::check_restrictions`].
    pub restrictions: Vec<Restriction>,
    /// A force law as the base instead of the equilibrium: the law, its coefficients, and whether they are
    /// fitted.
    pub law: Option<(&'static Law, Vec<f64>, bool)>,
    /// Rows that the user leaves out.
    pub excluded: Vec<usize>,
    /// What a reading contributes to the sum that fits minimise. A diagnosis has its own noise law and takes
    /// squares.
    pub loss: Loss,
    /// Whether errors on held-out data are computed.
    pub held_out: bool,
    /// Whether published force laws are fitted to the same data.
    pub rivals: bool,
}

impl Options {
    /// The equilibrium with some effects, with held-out errors and without rivals.
    #[must_use]
    pub fn new(catalogue: Catalogue, effects: Vec<Arc<dyn Effect>>) -> Self {
        Self {
            effects,
            known: Vec::new(),
            catalogue,
            restrictions: Vec::new(),
            law: None,
            excluded: Vec::new(),
            loss: Loss::Squares,
            held_out: true,
            rivals: false,
        }
    }
}
