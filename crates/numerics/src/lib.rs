//! Dual numbers, adaptive Runge-Kutta integration, elliptic integrals, bracketed roots, least squares and random numbers for membrane equilibria.
//!
//! Numerical methods without any knowledge of muscles, files or units. Everything is `f64`; only the
//! integrator and the code that runs in it are generic over [`Real`], so that they can carry exact
//! derivatives ([`Dual`]), and the elliptic integrals over [`Lanes`], so that four can be computed at once.

pub mod dop853;
mod dop853_coefficients;
mod dual;
mod elementary;
pub mod elliptic;
pub mod gauss;
mod lanes;
mod last_digits;
pub mod least_squares;
pub mod minimum;
mod random;
mod real;
pub mod root;
pub mod tape;
pub mod vector;

pub use dop853::Dop853;
pub use dual::Dual;
pub use lanes::Lanes;
pub use last_digits::last_digits;
pub use random::Random;
pub use real::Real;
