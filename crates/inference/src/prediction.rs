//! Prediction of the force at new rows by a muscle, which may have been fitted, with its uncertainty.

pub(crate) mod document;
pub(crate) mod predict;
pub(crate) mod uncertain;
