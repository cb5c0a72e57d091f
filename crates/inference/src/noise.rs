//! Noise of the readings: its law, estimated from the residuals of a saturated model, and whitening.

pub(crate) mod error;
pub(crate) mod estimate;
pub(crate) mod inputs;
pub(crate) mod law;
pub(crate) mod offset_belief;
pub(crate) mod orthonormal;
pub(crate) mod restricted_likelihood;
pub(crate) mod simplex;
pub(crate) mod whitening;
