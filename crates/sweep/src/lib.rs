//! Parallel, resumable parameter sweeps of pneumatic muscles, and certified tables from them.

mod certified;
mod design;
mod family;
mod file;
mod muscle_field;
mod output;
mod permutation;
pub mod plan;
mod sobol;

pub use certified::{BuildError, Built, EncodeError, Field, FieldAxis, FieldOutput, NoValue, Wish, build};
pub use design::{Coordinate, Layout};
pub use family::{Family, FamilyError, Member};
pub use file::SWEEP_EXAMPLE;
pub use muscle_field::MuscleField;
pub use output::Output;
pub use plan::Plan;
