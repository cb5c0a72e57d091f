//! Meshes of our own muscles, and of simple membranes: for pictures, for sizing, and for verification.
//!
//! All are placed around the z axis; a membrane of revolution lies in the half-plane y = 0. The names of the
//! groups tell their roles in a case.

mod grid;
mod pleated;
mod revolved;
mod tube;

pub use grid::{Surface, grid};
pub use pleated::Pleated;
pub use revolved::{Grading, revolved};
pub use tube::tube;
