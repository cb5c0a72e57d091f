//! Meshes of our own muscles, and of simple membranes: for pictures, for sizing, and for verification.
//!
//! All lie about the z axis; a membrane of revolution in the half-plane y = 0. Groups are named for what a case says of them.

mod grid;
mod pleated;
mod revolved;
mod tube;

pub use grid::{Surface, grid};
pub use pleated::Pleated;
pub use revolved::{Grading, revolved};
pub use tube::tube;
