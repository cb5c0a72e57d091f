//! Rig: what sensors, frame and valves add between the muscle and the numbers in the file.

mod force_offset;
mod frame_compliance;
mod length_zero_error;
mod pressure_gain;

use crate::effect::Effect;
use std::sync::Arc;

/// All of them.
pub(crate) fn all() -> Vec<Arc<dyn Effect>> {
    vec![
        Arc::new(force_offset::ForceOffset),
        Arc::new(pressure_gain::PressureGain),
        Arc::new(length_zero_error::LengthZeroError),
        Arc::new(frame_compliance::FrameCompliance),
    ]
}
