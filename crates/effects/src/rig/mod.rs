//! Rig: errors of sensors, frame and valves between the muscle and the numbers in the file.

mod displacement_gain;
mod end_slip;
mod force_drift;
mod force_filter;
mod force_gain;
mod force_lag;
mod force_nonlinearity;
mod force_offset;
mod frame_compliance;
mod ideal_volume;
mod length_zero_error;
mod line_drop;
mod load_misalignment;
pub(crate) mod lowered_pressure;
mod pressure_droop;
mod pressure_gain;
mod pressure_hysteresis;
mod pressure_lag;
mod pressure_offset;
mod regulator_lag;
mod valve_hysteresis;
mod weight;

use crate::effect::Effect;
use std::sync::Arc;

/// All rig effects, in the order in which they act: from the readings to the muscle, then from the force to
/// its reading. A sensor reads true (1 + gain) + zero. The zero of an input therefore comes before its gain,
/// and that of the output after it.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(force_lag::ForceLag),
        Arc::new(displacement_gain::DisplacementGain),
        Arc::new(length_zero_error::LengthZeroError),
        Arc::new(frame_compliance::FrameCompliance),
        Arc::new(end_slip::EndSlip),
        Arc::new(pressure_offset::PressureOffset),
        Arc::new(pressure_gain::PressureGain),
        Arc::new(line_drop::LineDrop),
        Arc::new(pressure_droop::PressureDroop),
        Arc::new(regulator_lag::RegulatorLag),
        Arc::new(valve_hysteresis::ValveHysteresis),
        Arc::new(pressure_hysteresis::PressureHysteresis),
        Arc::new(pressure_lag::PressureLag),
        Arc::new(load_misalignment::LoadMisalignment),
        Arc::new(weight::Weight),
        Arc::new(force_nonlinearity::ForceNonlinearity),
        Arc::new(force_gain::ForceGain),
        Arc::new(force_drift::ForceDrift),
        Arc::new(force_offset::ForceOffset),
        Arc::new(force_filter::ForceFilter),
    ]
}
