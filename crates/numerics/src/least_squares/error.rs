//! Errors for problems that can't be minimised at all.

/// An invalid problem, start or request. Parameters and rows are counted from 0.
///
/// A search that ends without a minimum isn't an error; its [`super::Certificate`] says so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LeastSquaresError<E> {
    /// The residuals can't be evaluated at the start.
    #[error("the residuals cannot be evaluated at the start: {0}")]
    Start(E),
    /// A residual or a derivative at the start isn't a finite number, or the sum of squares overflows.
    #[error("{0}")]
    NotFinite(String),
    /// A start, bounds, an option or a parameter that doesn't suit the problem.
    #[error("{0}")]
    Request(String),
    /// A profile along which there is no minimum, or a lower one than that from which it started.
    #[error("{0}")]
    Profile(String),
}

impl<E> LeastSquaresError<E> {
    /// An option is out of its range.
    pub(super) fn option(name: &str, value: f64, range: &str) -> Self {
        Self::Request(format!("the option {name} is {value}; it must be {range}"))
    }

    /// The sum of squares overflows.
    pub(super) fn overflow() -> Self {
        let what = "the sum of squares of the residuals, or of their derivatives by one parameter, overflows at the start; scale them to below 1e150";
        Self::NotFinite(what.to_owned())
    }
}

/// Bounds that aren't a finite box.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "starts in a box need finite bounds, the lower at most the upper; those of parameter {parameter} are [{lower}, {upper}]"
)]
pub struct NotABox {
    /// The parameter, counted from 0.
    pub parameter: usize,
    /// Its lower bound.
    pub lower: f64,
    /// Its upper bound.
    pub upper: f64,
}
