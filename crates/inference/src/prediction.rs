//! A (learnt) muscle on new rows: the force of each, and how sure it is.

pub(crate) mod document;
pub(crate) mod predict;
pub(crate) mod uncertain;
