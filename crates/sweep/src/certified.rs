//! Certified tables: from a field of smooth outputs to the bytes that `bulge_table` looks up.
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
mod field;
mod polynomial;

pub use build::{BuildError, Built, Requirements, build};
pub use encode::EncodeError;
pub use field::{Field, FieldAxis, FieldOutput, NoValue};
