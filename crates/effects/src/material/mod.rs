//! Material: elasticity of fibres, bladder and cloth.

mod bladder_axial;
mod bladder_c01;
mod bladder_elasticity;
mod bladder_prestrain;
mod fibre_stretch;
mod hoop_elasticity;
mod limited_unfolding;
mod membrane_axial;
pub(crate) mod tube;

use crate::effect::Effect;
use std::sync::Arc;

/// All material effects.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(fibre_stretch::FibreStretch),
        Arc::new(bladder_elasticity::BladderElasticity),
        Arc::new(bladder_c01::BladderC01),
        Arc::new(hoop_elasticity::HoopElasticity),
        Arc::new(bladder_prestrain::BladderPrestrain),
        Arc::new(membrane_axial::MembraneAxial),
        Arc::new(bladder_axial::BladderAxial),
        Arc::new(limited_unfolding::LimitedUnfolding),
    ]
}
