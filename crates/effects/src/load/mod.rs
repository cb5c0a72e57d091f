//! Load: friction, hysteresis, rate, time, temperature and thresholds.

#[cfg(test)]
mod along_paths;
mod asymmetric_friction;
mod bladder_hysteresis;
mod bladder_relaxation;
mod bouc_wen;
mod contact_friction;
mod coulomb_friction;
mod creep;
mod crossing_friction;
pub(crate) mod dragged;
mod fibre_creep;
mod filled_bladder;
mod force_friction;
mod generalised_maxwell;
mod low_load_slack;
mod maxwell_slip;
mod presliding_hysteresis;
mod pressure_creep;
mod pressure_friction;
mod pressure_presliding;
mod pressure_threshold;
mod pressure_viscosity;
pub(crate) mod relaxed;
mod self_heating;
mod standard_linear_solid;
mod stress_softening;
mod stribeck_friction;
mod temperature;
mod tension_friction;
mod viscous_damping;

use crate::effect::Effect;
use std::sync::Arc;

/// All load effects.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(coulomb_friction::CoulombFriction),
        Arc::new(asymmetric_friction::AsymmetricFriction),
        Arc::new(stribeck_friction::StribeckFriction),
        Arc::new(pressure_friction::PressureFriction),
        Arc::new(pressure_presliding::PressurePresliding),
        Arc::new(crossing_friction::CrossingFriction),
        Arc::new(contact_friction::ContactFriction),
        Arc::new(force_friction::ForceFriction),
        Arc::new(tension_friction::TensionFriction),
        Arc::new(presliding_hysteresis::PreslidingHysteresis),
        Arc::new(maxwell_slip::MaxwellSlip),
        Arc::new(bouc_wen::BoucWen),
        Arc::new(bladder_hysteresis::BladderHysteresis),
        Arc::new(bladder_relaxation::BladderRelaxation),
        Arc::new(viscous_damping::ViscousDamping),
        Arc::new(pressure_viscosity::PressureViscosity),
        Arc::new(creep::Creep),
        Arc::new(pressure_creep::PressureCreep),
        Arc::new(fibre_creep::FibreCreep),
        Arc::new(standard_linear_solid::StandardLinearSolid),
        Arc::new(generalised_maxwell::GeneralisedMaxwell),
        Arc::new(stress_softening::StressSoftening),
        Arc::new(pressure_threshold::PressureThreshold),
        Arc::new(temperature::Temperature),
        Arc::new(self_heating::SelfHeating),
        Arc::new(low_load_slack::LowLoadSlack),
    ]
}
