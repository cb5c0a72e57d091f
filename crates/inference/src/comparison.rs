//! Model against measurement: the ladder of errors, and where the model fails.

pub(crate) mod analysis;
mod base_law;
mod buckled;
pub(crate) mod clock;
pub(crate) mod compare;
pub(crate) mod document;
pub(crate) mod doubt;
pub(crate) mod floor;
pub(crate) mod isotonic;
pub(crate) mod levels;
pub(crate) mod loops;
pub(crate) mod mismatch;
pub(crate) mod options;
mod other_length;
pub(crate) mod other_units;
mod recent;
pub(crate) mod requirements;
pub(crate) mod residuals;
pub(crate) mod rivals;
pub(crate) mod row_by_row;
pub(crate) mod rows;
mod shifted;
pub(crate) mod specimens;
pub(crate) mod stack;
pub(crate) mod stated;
pub(crate) mod tails;
pub(crate) mod warnings;
