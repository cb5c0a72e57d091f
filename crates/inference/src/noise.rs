//! Noise of readings: its law, found from what a saturated model leaves, and how it is taken out.

pub(crate) mod error;
pub(crate) mod estimate;
pub(crate) mod inputs;
pub(crate) mod law;
pub(crate) mod offset_belief;
pub(crate) mod orthonormal;
pub(crate) mod restricted_likelihood;
pub(crate) mod simplex;
pub(crate) mod whitening;
