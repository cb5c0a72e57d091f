//! Certified tables. They turn a field of smooth outputs, of a family of muscles or of a joint, into the
//! bytes that `bulge_table` looks up, and these into other forms ([`export`]).
//!
//! Chebyshev polynomials first follow the solver, in coordinates that fit the domain. Splines or shorter
//! polynomials of any size are derived from them. The smallest ones that meet the tolerance are then measured
//! against the solver.

mod bound;
mod build;
mod certificate;
mod coordinate;
mod domain;
mod edge;
mod encode;
pub mod export;
mod field;
mod joint;
mod muscle_field;
mod polynomial;
mod tabulate;

pub use build::{BuildError, Built, Requirements, build};
pub use encode::EncodeError;
pub use field::{Field, FieldAxis, FieldOutput, NoValue};
pub use joint::{JointField, JointOutput, JointTable};
pub use muscle_field::MuscleField;
pub use tabulate::{
    AxisDescription, OutputDescription, TableDescription, TabulateError, table_text, tabulate,
};
