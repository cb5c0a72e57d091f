//! Equilibria from the two first integrals, independent of all methods in `bulge-fibre`: no differential
//! equation, no Newton iteration in its unknowns, and no starting values.
//!
//! ```text
//! N cos(psi) = F + A(r)        sigma N - w = H        1 - cos(psi) = (N - F - A)/N
//! S = integral dr/(sigma sin(psi))        x = integral dr/tan(psi)        V = integral A dr/tan(psi)
//! ```
//!
//! The radius and the curvature (or the tension) at mid-length determine F and H, and these determine the
//! whole meridian.

mod meridian;
mod net;
mod search;

pub use search::{State, can_exclude, states};
