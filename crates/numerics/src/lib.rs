//! Dual numbers, adaptive Runge-Kutta integration, elliptic integrals, bracketed roots, least squares and random numbers for membrane equilibria.
//!
//! How to compute; knows no muscle, no file and no unit. Everything is `f64`; only the integrator and what runs through it
//! is generic over [`Real`], so that it can carry exact derivatives ([`Dual`]).

pub mod dop853;
mod dop853_coefficients;
mod dual;
pub mod elliptic;
pub mod gauss;
pub mod least_squares;
pub mod minimum;
mod random;
mod real;
pub mod root;

pub use dop853::Dop853;
pub use dual::Dual;
pub use random::Random;
pub use real::Real;
