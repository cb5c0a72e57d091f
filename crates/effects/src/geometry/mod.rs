//! Geometry: dimensions and directions of the muscle that are other than stated.

mod end_radius;

use crate::effect::Effect;
use std::sync::Arc;

/// All of them.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![Arc::new(end_radius::EndRadius)]
}
