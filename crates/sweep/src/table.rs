//! Certified tables: from a field of smooth outputs, of a family of muscles or of a joint, to the bytes that `bulge_table` looks up, and from these to other
//! forms ([`export`]).
//!
//! The solver is followed by Chebyshev polynomials in coordinates that fit the domain; from these come splines or shorter polynomials of any
//! size, and the smallest that meets the tolerance is measured against the solver.

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
