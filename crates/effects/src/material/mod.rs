//! Material: elasticity of fibres, bladder and cloth.

mod bladder_elasticity;

use crate::effect::Effect;
use std::sync::Arc;

/// All of them.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![Arc::new(bladder_elasticity::BladderElasticity)]
}
