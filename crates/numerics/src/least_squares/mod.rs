//! Bounded nonlinear least squares for many residuals and few parameters: `min sum r_i(theta)^2`, `lower <= theta <= upper`.
//!
//! [`minimise`] searches from one start ([`starts_in_box`] makes several), [`profile()`] finds
//! how far one parameter can go before the sum of squares rises by a given amount. The normal equations are never formed: the
//! Jacobian is reduced to a triangle block by block, so that a million rows need the memory of one block.

mod bend;
mod curvature;
mod error;
mod linear;
mod minimum;
mod options;
mod profile;
mod residuals;
mod search;
mod second;
mod singular;
mod starts;
mod step;
mod triangle;

#[cfg(test)]
mod tests;

pub use error::{LeastSquaresError, NotABox};
pub use linear::Linearisation;
pub use minimum::{Certificate, Minimum, Reason};
pub use options::Options;
pub use profile::{Profile, ProfileEnd, profile};
pub use residuals::{Bounds, Residuals, Side};
pub use search::{minimise, minimise_from};
pub use starts::starts_in_box;
