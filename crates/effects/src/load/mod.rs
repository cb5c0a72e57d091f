//! Load: friction, hysteresis, rate, time, temperature and thresholds.

mod coulomb_friction;
mod presliding_hysteresis;

use crate::effect::Effect;
use std::sync::Arc;

/// All of them.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(coulomb_friction::CoulombFriction),
        Arc::new(presliding_hysteresis::PreslidingHysteresis),
    ]
}
