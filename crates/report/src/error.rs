//! Why a plot couldn't be drawn.

/// Why a plot couldn't be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// Nothing to draw.
    #[error("a plot needs at least one curve")]
    NoCurves,
    /// A point is no curve.
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
        /// What it is, with its unit.
        quantity: &'static str,
        /// Index of the point.
        point: usize,
        /// Pressure of the curve \[Pa\].
        pressure_pa: f64,
        /// The value found.
        value: f64,
    },
    /// Values so large that their difference overflows.
    #[error("{quantity} from {low} to {high} is more than an axis can span")]
    Span {
        /// What it is, with its unit.
        quantity: &'static str,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// The drawing library refuses.
    #[error("the plot can't be drawn: {reason}")]
    Drawing {
        /// What it says.
        reason: String,
    },
}
