//! Fits of a model to a record, with intervals and warnings.

pub(crate) mod carry_over;
pub(crate) mod document;
pub(crate) mod extension;
pub(crate) mod frozen;
pub(crate) mod held;
pub(crate) mod interval;
pub(crate) mod loss;
pub(crate) mod nuisance;
pub(crate) mod posterior;
pub(crate) mod problem;
pub(crate) mod report;
pub(crate) mod restrictions;
pub(crate) mod search;
pub(crate) mod states;
pub(crate) mod weights;
