//! Test benches: what they do, what they would measure, and the effects hidden in simulated measurements.

pub(crate) mod bench;
pub(crate) mod file;
pub(crate) mod hidden;
pub(crate) mod like;
pub(crate) mod planned;
pub(crate) mod simulation;
pub(crate) mod truth;
pub(crate) mod write;
