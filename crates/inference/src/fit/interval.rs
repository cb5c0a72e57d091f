//! Intervals of fitted parameters: from the covariance, or from the profile likelihood if the covariance
//! can't be trusted.

use bulge_numerics::least_squares::{Bounds, Minimum, Options, ProfileEnd, profile};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::fit::loss::Loss;
use crate::fit::problem::FitProblem;

/// The 95 % interval of one parameter, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) ends: [f64; 2],
    pub(crate) method: &'static str,
    /// Whether no value within the bounds is excluded.
    pub(crate) is_everything: bool,
}

/// Scales unit covariances to intervals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    /// Variance of a weighted residual (at least 1 if the noise is known) times rows per independent row.
    variance: f64,
    /// Quantile 0.975 of Student's t.
    quantile: f64,
}

impl Scale {
    /// For a minimum over `rows` rows, `effective` of which are independent.
    pub(crate) fn new(minimum: &Minimum, rows: usize, effective: f64, loss: Loss) -> Self {
        let freedom = (rows as f64 - minimum.certificate.rank as f64).max(1.0);
        // Of the rows alone: the priors behind them say nothing about the noise.
        let spread = loss.spread(&minimum.residuals[..rows.min(minimum.residuals.len())], freedom);
        let independent = (effective - minimum.certificate.rank as f64).max(1.0);
        let quantile = quantile(independent);
        Self { variance: spread * (rows as f64 / effective).max(1.0), quantile }
    }

    /// Variance of the residuals that stands behind the intervals.
    pub(crate) fn variance(&self) -> f64 {
        self.variance
    }

    /// Covariance in the coordinates of the search.
    pub(crate) fn covariance(&self, minimum: &Minimum) -> Vec<f64> {
        minimum.covariance(self.variance)
    }

    /// For known noise: `variance` is that of the whitened residuals, `freedom` the degrees of freedom of the
    /// law.
    pub(crate) fn known(variance: f64, freedom: f64) -> Self {
        Self { variance, quantile: quantile(freedom) }
    }
}

/// Quantile 0.975 of Student's t. With infinite degrees of freedom it is that of the normal distribution,
/// because the search for Student's quantile would not end there.
pub(crate) fn quantile(freedom: f64) -> f64 {
    if !freedom.is_finite() {
        return 1.959_964;
    }
    StudentsT::new(0.0, 1.0, freedom.max(1.0))
        .map_or(1.959_964, |t| t.inverse_cdf(0.975))
        .clamp(1.959_964, 12.71)
}

/// Cosine between two columns of the Jacobian from which a bound that holds one parameter narrows the interval of the
/// other by more than a seventh.
const LEANING: f64 = 0.5;

/// Most rows for which a profile is affordable: it costs about forty more fits.
const MOST_ROWS: usize = 20_000;

/// The interval of the free parameter `place`. It comes from the covariance. If that can't be trusted
/// (`flagged`), it comes from the profile likelihood: its ends are where the sum of squares, minimised over
/// all other parameters, has risen by the square of Student's quantile.
pub(crate) fn of(
    problem: &FitProblem<'_>,
    minimum: &Minimum,
    place: usize,
    scale: &Scale,
    flagged: bool,
) -> Interval {
    let bounds = problem.bounds();
    let back = |x: f64| if problem.is_logarithmic(place) { x.exp() } else { x };
    let profiled = if flagged && problem.measured() <= MOST_ROWS {
        profiled(problem, minimum, &bounds, place, scale)
    } else {
        None
    };
    let is_everything = |ends: [f64; 2]| ends[0] <= bounds.lower[place] && ends[1] >= bounds.upper[place];
    if let Some(ends) = profiled {
        return Interval { ends: ends.map(back), method: "profile", is_everything: is_everything(ends) };
    }
    let x = minimum.theta[place];
    let sd = minimum.standard_deviations(scale.variance)[place];
    let ends = match sd {
        Some(sd) => [x - scale.quantile * sd, x + scale.quantile * sd],
        None => [bounds.lower[place], bounds.upper[place]],
    };
    let ends = [ends[0].max(bounds.lower[place]), ends[1].min(bounds.upper[place])];
    Interval { ends: ends.map(back), method: "covariance", is_everything: is_everything(ends) }
}

/// Part of the rise of the sum of squares that moves an end by a two-thousandth of its distance.
const READ: f64 = 1e-3;

/// The ends of the profile; none if the minimisations over the other parameters fail.
fn profiled(
    problem: &FitProblem<'_>,
    minimum: &Minimum,
    bounds: &Bounds,
    place: usize,
    scale: &Scale,
) -> Option<[f64; 2]> {
    let rise = scale.quantile * scale.quantile * scale.variance;
    // Nobody reads the ends more accurately than to a thousandth of a standard deviation.
    let enough = READ * rise;
    let tolerance = (enough / minimum.cost).sqrt().clamp(1e-4, 1e-2);
    let options = Options { tolerance, check_curvature: false, max_evaluations: 60, least_decrease: enough };
    let found = profile(problem, minimum, bounds, &options, place, rise).ok()?;
    let end = |end| match end {
        ProfileEnd::Crossed(value)
        | ProfileEnd::AtBound { value, .. }
        | ProfileEnd::Unbounded { value, .. }
        | ProfileEnd::Undefined { value, .. } => value,
    };
    Some([end(found.lower), end(found.upper)])
}

/// Whether a parameter would move with another one that a bound holds, as the factors of a product do. Its
/// covariance takes the other one as known.
pub(crate) fn leans_on_a_bound(minimum: &Minimum, place: usize) -> bool {
    let count = minimum.theta.len();
    let column = |j: usize| (0..count).map(move |i| minimum.r[i * count + j]);
    let product = |i: usize, j: usize| column(i).zip(column(j)).map(|(a, b)| a * b).sum::<f64>();
    let cosine = |j: usize| product(place, j).abs() / (product(place, place) * product(j, j)).sqrt();
    let at_bound = &minimum.certificate.at_bound;
    (0..count).any(|j| j != place && at_bound[j].is_some() && cosine(j) > LEANING)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::least_squares::{Residuals, minimise};
    use std::ops::Range;

    /// x + y = 3 twice, with a little curvature, and z = 1.
    struct Sum;

    impl Residuals for Sum {
        type Error = ();

        fn rows(&self) -> usize {
            3
        }

        fn parameters(&self) -> usize {
            3
        }

        fn evaluate(
            &self,
            theta: &[f64],
            rows: Range<usize>,
            residuals: &mut [f64],
            mut jacobian: Option<&mut [f64]>,
        ) -> Result<(), ()> {
            let all = [[1.0, 1.0, 0.0, 3.0], [1.0, 1.1, 0.0, 3.2], [0.0, 0.0, 1.0, 1.0]];
            for (place, row) in rows.enumerate() {
                let [a, b, c, sum] = all[row];
                residuals[place] = a * theta[0] + b * theta[1] + c * theta[2] - sum;
                if let Some(jacobian) = jacobian.as_deref_mut() {
                    jacobian[3 * place..3 * place + 3].copy_from_slice(&[a, b, c]);
                }
            }
            Ok(())
        }
    }

    /// Unbounded, y is 2. A bound that holds y narrows the interval of x, and not that of z.
    #[test]
    fn a_bound_narrows_what_moves_with_it() {
        let at = |most: f64| {
            let bounds = Bounds { lower: vec![-10.0; 3], upper: vec![10.0, most, 10.0] };
            minimise(&Sum, &[0.0; 3], &bounds, &Options::default()).unwrap()
        };
        let (held, free) = (at(1.0), at(5.0));
        assert!(held.certificate.at_bound[1].is_some() && free.certificate.at_bound[1].is_none());
        assert!(leans_on_a_bound(&held, 0) && !leans_on_a_bound(&held, 2));
        assert!((0..3).all(|place| !leans_on_a_bound(&free, place)));
        let sd = |minimum: &Minimum| minimum.standard_deviations(1.0)[0].unwrap();
        assert!(sd(&held) < 0.1 * sd(&free), "{} {}", sd(&held), sd(&free));
    }
}
