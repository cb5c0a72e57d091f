//! Specimen: differences between muscles of the same make.

mod specimen_spread;

use crate::effect::Effect;
use std::sync::Arc;

/// All specimen effects.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![Arc::new(specimen_spread::SpecimenSpread)]
}
