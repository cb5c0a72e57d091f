//! Errors for problems that can't be minimised at all.

use super::Reason;

/// An invalid problem, start or request. Parameters and rows are counted from 0.
///
/// A search that ends without a minimum isn't an error; its [`super::Certificate`] says so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LeastSquaresError<E> {
    /// The residuals can't be evaluated at the start.
    #[error("the residuals cannot be evaluated at the start: {0}")]
    Start(E),
    /// A residual at the start isn't a finite number.
    #[error("residual {row} is {value} at the start; choose a start where all residuals are finite")]
    Residual {
        /// The row.
        row: usize,
        /// Its residual.
        value: f64,
    },
    /// A derivative at the start isn't a finite number.
    #[error(
        "the derivative of residual {row} by parameter {parameter} is {value} at the start; choose a start where all derivatives are finite"
    )]
    Derivative {
        /// The row.
        row: usize,
        /// The parameter.
        parameter: usize,
        /// The derivative.
        value: f64,
    },
    /// The sum of squares overflows.
    #[error(
        "the sum of squares of the residuals, or of their derivatives by one parameter, overflows at the start; scale them to below 1e150"
    )]
    Overflow,
    /// A list doesn't have an entry for each parameter.
    #[error("{what} has {found} entries; the problem has {parameters} parameters")]
    Length {
        /// The name of the list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// The start is outside the bounds or not finite.
    #[error("the start of parameter {parameter} is {value}, outside its bounds [{lower}, {upper}]")]
    Outside {
        /// The parameter.
        parameter: usize,
        /// Its start.
        value: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// The bounds are contradictory.
    #[error(
        "the bounds of parameter {parameter} are [{lower}, {upper}]; the first must be at most the second, and neither NaN"
    )]
    Crossed {
        /// The parameter.
        parameter: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// An option is out of its range.
    #[error("the option {name} is {value}; it must be {range}")]
    Option {
        /// Name of the field.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values.
        range: &'static str,
    },
    /// No starts are given.
    #[error("no start was given; give at least one")]
    NoStart,
    /// The parameter doesn't exist or is fixed, so it can't be profiled.
    #[error(
        "parameter {parameter} cannot be profiled: the problem has {parameters} parameters, and this one must not be fixed"
    )]
    NotProfiled {
        /// The parameter.
        parameter: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// The minimisation over the other parameters failed on the profile.
    #[error(
        "with parameter {parameter} held at {value} the search over the others ended without a minimum ({reason:?})"
    )]
    ProfileUnsolved {
        /// The parameter.
        parameter: usize,
        /// The value at which it was held.
        value: f64,
        /// Why the search ended.
        reason: Reason,
    },
    /// The profile reached a lower sum of squares than the minimum from which it started.
    #[error(
        "with parameter {parameter} at {value} the sum of squares is {cost}, below that of the given minimum, {minimum}; minimise again from there"
    )]
    LowerCost {
        /// The parameter.
        parameter: usize,
        /// The value at which it was held.
        value: f64,
        /// Sum of squares there.
        cost: f64,
        /// Sum of squares of the given minimum.
        minimum: f64,
        /// All parameters of the lower point.
        theta: Vec<f64>,
    },
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
