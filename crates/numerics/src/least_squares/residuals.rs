//! A nonlinear least-squares problem: residuals with derivatives, evaluated in blocks of rows, and bounds of
//! the parameters.

use super::LeastSquaresError;
use std::ops::Range;

/// Residuals `r_i(theta)` with their derivatives, `i` in `0..rows`.
///
/// The minimiser requests one block of rows after the other, from several threads at once. It only keeps a
/// triangular factor of a block's derivatives, so that a thread needs memory for one block, whatever the
/// number of rows.
pub trait Residuals: Sync {
    /// Why the residuals can't be evaluated at some parameters.
    type Error: Send;

    /// Number of residuals.
    fn rows(&self) -> usize;

    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// Number of rows that are evaluated together; only the last block may have fewer.
    ///
    /// The default makes a block of about 256 KiB. Return [`Residuals::rows`] for all rows at once, or a
    /// multiple of the rows that share work. Results don't depend on the number of threads, but their last
    /// bits depend on this number. 0 counts as 1.
    fn block(&self) -> usize {
        let width = self.parameters() + 1;
        (32_768 / width).max(4 * width)
    }

    /// Whether the derivatives cost little compared with the residuals. The search then requests both at
    /// every trial: most trials are accepted, and the residuals of an accepted point aren't evaluated twice.
    fn joint(&self) -> bool {
        false
    }

    /// Writes the residuals of `rows` into `residuals` and, if requested, the derivatives `dr_i/dtheta_j`
    /// into `jacobian`, one row of [`Residuals::parameters`] numbers after the other. Apart from rounding
    /// errors, residuals must not depend on whether derivatives are requested.
    ///
    /// # Errors
    /// If the residuals have no value at these parameters. During a search, such a point only shortens the
    /// step, as does one with a value that isn't finite.
    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) -> Result<(), Self::Error>;
}

/// An end of a parameter's range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The lower bound.
    Lower,
    /// The upper bound.
    Upper,
}

/// Ranges of the parameters: `lower[j] <= theta[j] <= upper[j]`. Either end may be infinite; equal ends fix
/// the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// Least values.
    pub lower: Vec<f64>,
    /// Greatest values.
    pub upper: Vec<f64>,
}

impl Bounds {
    /// No bounds for this many parameters.
    #[must_use]
    pub fn none(parameters: usize) -> Self {
        Self { lower: vec![f64::NEG_INFINITY; parameters], upper: vec![f64::INFINITY; parameters] }
    }

    /// The bounds with parameter number `index` (from 0) held at `value`.
    ///
    /// # Panics
    /// If there is no such parameter.
    #[must_use]
    pub fn with_fixed(mut self, index: usize, value: f64) -> Self {
        self.lower[index] = value;
        self.upper[index] = value;
        self
    }

    /// Whether the ends of a parameter's range are equal.
    ///
    /// # Panics
    /// If there is no such parameter.
    #[must_use]
    pub fn is_fixed(&self, index: usize) -> bool {
        self.lower[index] >= self.upper[index]
    }
}

/// Refuses lists of the wrong length, crossed bounds, and starts outside them.
pub(super) fn check_start<E>(k: usize, start: &[f64], bounds: &Bounds) -> Result<(), LeastSquaresError<E>> {
    let lists = [
        ("the start", start),
        ("the list of lower bounds", &bounds.lower),
        ("the list of upper bounds", &bounds.upper),
    ];
    let wrong = |what: String| Err(LeastSquaresError::Request(what));
    for (what, list) in lists {
        if list.len() != k {
            return wrong(format!("{what} has {} entries; the problem has {k} parameters", list.len()));
        }
    }
    for (parameter, value) in start.iter().copied().enumerate() {
        let (lower, upper) = (bounds.lower[parameter], bounds.upper[parameter]);
        if lower.is_nan() || upper.is_nan() || lower > upper {
            return wrong(format!(
                "the bounds of parameter {parameter} are [{lower}, {upper}]; the first must be at most the second, and neither NaN"
            ));
        }
        if !value.is_finite() || value < lower || value > upper {
            return wrong(format!(
                "the start of parameter {parameter} is {value}, outside its bounds [{lower}, {upper}]"
            ));
        }
    }
    Ok(())
}
