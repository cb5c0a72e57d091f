//! Why a plot couldn't be drawn.

/// Why a plot couldn't be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// There is nothing to draw.
    #[error("a plot needs at least one curve")]
    NoCurves,
    /// The curve has fewer than two points.
    #[error("the curve at {pressure_pa} Pa has {found} point(s): it needs at least 2")]
    TooFewPoints {
        /// Pressure of the curve \[Pa\].
        pressure_pa: f64,
        /// Number of points.
        found: usize,
    },
    /// The pressure of a curve is infinite or not a number.
    #[error("the pressure of curve {curve} is {value} Pa: it must be finite")]
    Pressure {
        /// Index of the curve.
        curve: usize,
        /// The value found \[Pa\].
        value: f64,
    },
    /// A value is infinite or not a number.
    #[error(
        "{quantity} is {value} at point {point} of the curve at {pressure_pa} Pa: only finite values can be drawn"
    )]
    NotFinite {
        /// The quantity, with its unit.
        quantity: &'static str,
        /// Index of the point.
        point: usize,
        /// Pressure of the curve \[Pa\].
        pressure_pa: f64,
        /// The value found.
        value: f64,
    },
    /// A number of a comparison is infinite or not a number.
    #[error("{quantity} is {value}: only finite values can be drawn; leave the rows out that gave it")]
    Value {
        /// The quantity.
        quantity: String,
        /// The value found.
        value: f64,
    },
    /// Corresponding lists have different lengths.
    #[error("{found} {what} where {expected} are needed")]
    Lengths {
        /// What is listed.
        what: &'static str,
        /// Length of the axis.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// The template of a page can't be filled in.
    #[error("the page can't be written: {reason}")]
    Page {
        /// Message of the template engine.
        reason: String,
    },
    /// The difference between two values overflows.
    #[error("{quantity} from {low} to {high} is more than an axis can span")]
    Span {
        /// The quantity, with its unit.
        quantity: &'static str,
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
}

impl PlotError {
    /// The error of values whose range overflows.
    pub(crate) fn span(quantity: &'static str, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = crate::axis::range(values).unwrap_or((f64::MIN, f64::MAX));
        Self::Span { quantity, low, high }
    }
}
