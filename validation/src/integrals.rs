//! Equilibria from the two first integrals, apart from all that `bulge-fibre` does: no differential equation, no Newton's method in its unknowns, no starts.
//!
//! ```text
//! N cos(psi) = F + A(r)        sigma N - w = H        1 - cos(psi) = (N - F - A)/N
//! S = integral dr/(sigma sin(psi))        x = integral dr/tan(psi)        V = integral A dr/tan(psi)
//! ```
//!
//! The radius at mid-length and the curvature (the tension) there give F and H, and these the whole meridian.

mod meridian;
mod net;
mod search;

pub use search::{State, can_exclude, states};
