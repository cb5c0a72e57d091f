//! The result of a fit: parameters with intervals, and warnings.

use serde::Serialize;

use crate::fit::loss::Loss;

/// A fit of some parameters of a model.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Fit {
    /// The fitted parameters, in the order of the model.
    pub parameters: Vec<Fitted>,
    /// All parameters of the model, fitted or not, in SI units.
    #[serde(skip)]
    pub theta: Vec<f64>,
    /// RMS error \[N\].
    pub rmse_n: f64,
    /// Sum of squares of the weighted residuals and of the priors.
    pub cost: f64,
    /// Standard deviation of a single force reading that the weights are based on \[N\].
    pub sd_n: f64,
    /// Effective number of independent rows; the residuals of a sweep are correlated.
    pub effective_rows: f64,
    /// Correlation matrix of the fitted parameters, row by row.
    pub correlations: Vec<f64>,
    /// Their covariance matrix, row by row, in products of the units of the parameters. It contains what the
    /// intervals contain: the scatter of the residuals and their correlation. NaN (null in the document) where
    /// a parameter isn't determined.
    pub covariance: Vec<f64>,
    /// The loss that was minimised.
    pub loss: Loss,
    /// Number of readings that keep less than half of their influence under this loss.
    pub downweighted: usize,
    /// How the search ended.
    pub convergence: Convergence,
    /// Implausible values, parameters at a bound, and pairs that can't be separated, in sentences.
    pub warnings: Vec<String>,
}

/// One fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// The effect (or law).
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// The specimen, if each has its own parameter.
    pub specimen: Option<String>,
    /// Value in `unit`.
    pub value: f64,
    /// Lower end of the 95 % interval, in `unit`; the bound if the interval reaches it.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Unit in which the parameter is shown.
    pub unit: String,
    /// How the interval was found: `covariance` or `profile`.
    pub interval: &'static str,
    /// `lower` or `upper`, if the value lies on a bound of the search.
    pub at_bound: Option<&'static str>,
    /// Whether the value is physically plausible for a muscle (or rig). An implausible value means that the
    /// wrong effect fits the data.
    pub plausible: bool,
    /// The plausible range, in `unit`.
    pub plausible_range: [f64; 2],
    /// Whether the data determine the parameter.
    pub determined: bool,
    /// Whether it is a nuisance parameter: a rig error within the data sheets of `[instruments]`, or a number
    /// of the muscle stated with a width. Such parameters are fitted along as noise.
    pub nuisance: bool,
    /// Name, value and unit of the reciprocal, if it is shown as well.
    pub also: Option<(String, f64, String)>,
    /// Description.
    pub about: String,
}

/// How a search ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Convergence {
    /// Whether the best point is a minimum within the bounds.
    pub converged: bool,
    /// Why the search stopped.
    pub reason: String,
    /// Largest cosine of the angle between the residuals and a column of the Jacobian: 0 at a minimum.
    pub gradient_cosine: f64,
    /// Iterations of the last search.
    pub iterations: usize,
    /// Number of starting points that were tried.
    pub starts: usize,
    /// Number of starts that ended in the best minimum.
    pub agreeing: usize,
    /// Number of distinct minima that were found.
    pub minima: usize,
    /// Number of fitted parameters that the data determine.
    pub rank: usize,
}
