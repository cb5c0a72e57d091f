//! Bounded nonlinear least squares for many residuals and few parameters: `min sum r_i(theta)^2`, `lower <= theta <= upper`.
//!
//! [`minimise`] searches from one start, [`minimise_from_many`] from several ([`starts_in_box`] makes them), [`profile()`] finds
//! how far one parameter can go before the sum of squares rises by a given amount. The normal equations are never formed: the Jacobian is reduced to a triangle block by block, so that
//! a million rows need the memory of one block.

mod curvature;
mod error;
mod linear;
mod minimum;
mod options;
mod residuals;
mod search;
mod singular;
mod step;
mod triangle;

pub use error::LeastSquaresError;
pub use minimum::{Certificate, Minimum, Reason};
pub use options::Options;
pub use residuals::{Bounds, Residuals, Side};
pub use search::minimise;
