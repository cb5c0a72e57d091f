//! Settings of the search, with defaults that suit residuals computed to nearly full precision.

use super::LeastSquaresError;

/// Settings of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The search has converged if the linearised residuals can be lowered by at most this fraction of their
    /// norm. This is the cosine between the residuals and the tangent space of the free parameters (D. M.
    /// Bates, D. G. Watts, *Technometrics* 23 (1981) 179). The parameters then have an error of about this
    /// fraction of `sqrt(rows - parameters)` standard deviations. In (0, 1); default 1e-10. If the
    /// derivatives are inexact, choose ten times their relative error.
    pub tolerance: f64,
    /// Most evaluations of all residuals, with or without derivatives, before the search is given up. The
    /// examination of curvature doesn't count. At least 1; default 2000.
    pub max_evaluations: usize,
    /// A decrease of the sum of squares that isn't worth a shorter trial. The search ends if a rejected step
    /// promised less, as at a kink of the residuals, where every step but a tiny one is rejected. At least 0;
    /// default 0.
    pub least_decrease: f64,
    /// Whether a stationary point is examined for directions of negative curvature, along which the search
    /// leaves a saddle. Costs one gradient per free parameter. Default true.
    pub check_curvature: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-10, max_evaluations: 2000, least_decrease: 0.0, check_curvature: true }
    }
}

impl Options {
    pub(super) fn check<E>(&self) -> Result<(), LeastSquaresError<E>> {
        let wrong = |name, value, range| Err(LeastSquaresError::option(name, value, range));
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return wrong("tolerance", self.tolerance, "above 0 and below 1");
        }
        if !(self.least_decrease >= 0.0 && self.least_decrease < f64::INFINITY) {
            return wrong("least_decrease", self.least_decrease, "at least 0 and finite");
        }
        if self.max_evaluations == 0 {
            return wrong("max_evaluations", 0.0, "at least 1");
        }
        Ok(())
    }
}
