//! Which effect is missing: the screen, the search, classes, confidence, and what to measure next.

pub(crate) mod as_set;
pub(crate) mod averaged;
pub(crate) mod candidates;
pub(crate) mod classes;
pub(crate) mod confidence;
pub(crate) mod confirm;
pub(crate) mod diagnose;
pub(crate) mod document;
mod either;
pub(crate) mod explained;
pub(crate) mod ground;
pub(crate) mod hints;
pub(crate) mod misfit;
pub(crate) mod next;
pub(crate) mod noise;
pub(crate) mod null;
pub(crate) mod plan;
pub(crate) mod pure_error;
pub(crate) mod scene;
pub(crate) mod search;
pub(crate) mod showing;
pub(crate) mod smooth;
pub(crate) mod space;
pub(crate) mod tangents;
mod unanswered;
pub(crate) mod write;
