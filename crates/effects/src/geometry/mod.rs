//! Geometry: dimensions and directions of the muscle that differ from the stated ones.

#[cfg(test)]
pub(crate) mod bench;
mod braid_angle_error;
mod end_factor;
mod end_radius;
mod end_taper;
mod fibre_count;
mod fibre_length;
mod fibre_misalignment;
mod lobes;
mod pleat_depth;
mod radius_error;
mod uneven_fibres;
mod wall_thickness;

use crate::effect::Effect;
use std::sync::Arc;

/// All geometry effects.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(end_radius::EndRadius),
        Arc::new(pleat_depth::PleatDepth),
        Arc::new(fibre_length::FibreLength),
        Arc::new(fibre_count::FibreCount),
        Arc::new(fibre_misalignment::FibreMisalignment),
        Arc::new(uneven_fibres::UnevenFibres),
        Arc::new(lobes::Lobes),
        Arc::new(end_taper::EndTaper),
        Arc::new(end_factor::EndFactor),
        Arc::new(radius_error::RadiusError),
        Arc::new(braid_angle_error::BraidAngleError),
        Arc::new(wall_thickness::WallThickness),
    ]
}
