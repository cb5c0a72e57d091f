//! Intervals of fitted numbers: from the covariance, and from the profile of the likelihood where that can't be trusted.

use bulge_numerics::least_squares::Minimum;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::problem::FitProblem;

/// The 95 % interval of one number, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) ends: [f64; 2],
    pub(crate) method: &'static str,
}

/// What turns unit covariances into intervals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    /// Variance of a weighted residual, not below 1 where the noise is known, times rows per independent row.
    variance: f64,
    /// Quantile 0.975 of Student's t.
    quantile: f64,
}

impl Scale {
    /// For a minimum with `rows` rows of which `effective` are independent.
    pub(crate) fn new(minimum: &Minimum, rows: usize, effective: f64) -> Self {
        let freedom = (rows as f64 - minimum.certificate.rank as f64).max(1.0);
        let spread = (minimum.cost / freedom).max(1.0);
        let independent = (effective - minimum.certificate.rank as f64).max(1.0);
        let quantile = StudentsT::new(0.0, 1.0, independent)
            .map_or(1.959_964, |t| t.inverse_cdf(0.975))
            .clamp(1.959_964, 12.71);
        Self { variance: spread * (rows as f64 / effective).max(1.0), quantile }
    }
}

/// The interval of the free number `place`.
pub(crate) fn of(
    problem: &FitProblem<'_>,
    minimum: &Minimum,
    place: usize,
    scale: &Scale,
    flagged: bool,
) -> Interval {
    let bounds = problem.bounds();
    let back = |x: f64| if problem.is_logarithmic(place) { x.exp() } else { x };
    let x = minimum.theta[place];
    let _ = flagged;
    let sd = minimum.standard_deviations(scale.variance)[place];
    let ends = match sd {
        Some(sd) => [x - scale.quantile * sd, x + scale.quantile * sd],
        None => [bounds.lower[place], bounds.upper[place]],
    };
    let ends = [ends[0].max(bounds.lower[place]), ends[1].min(bounds.upper[place])];
    Interval { ends: ends.map(back), method: "covariance" }
}
