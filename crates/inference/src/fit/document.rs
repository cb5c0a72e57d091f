//! A fit as a value: numbers with intervals, and what is to be said about them.

use serde::Serialize;

/// A fit of some numbers of a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// The fitted numbers, in the order of the model.
    pub parameters: Vec<Fitted>,
    /// All numbers of the model, fitted or not, in SI.
    #[serde(skip)]
    pub theta: Vec<f64>,
    /// RMS error \[N\].
    pub rmse_n: f64,
    /// Sum of squares of the weighted residuals and priors.
    pub cost: f64,
    /// Standard deviation of a single force reading on which the weights are based \[N\].
    pub sd_n: f64,
    /// Rows that count as independent: residuals of a sweep are correlated.
    pub effective_rows: f64,
    /// Correlations of the fitted numbers, row by row.
    pub correlations: Vec<f64>,
    /// How the search ended.
    pub convergence: Convergence,
    /// Wrong cures, numbers at a bound, pairs that can't be told apart, in sentences.
    pub warnings: Vec<String>,
}

/// One fitted number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// The effect (or law).
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// The specimen, where each has its own.
    pub specimen: Option<String>,
    /// Value in `unit`.
    pub value: f64,
    /// Lower end of the 95 % interval, in `unit`; the bound if the interval reaches it.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The unit.
    pub unit: String,
    /// `covariance` or `profile`.
    pub interval: &'static str,
    /// `lower` or `upper`, where the value lies on a bound of the search.
    pub at_bound: Option<&'static str>,
    /// Whether the value is one that a muscle (or rig) can have; if not, it is a wrong cure.
    pub plausible: bool,
    /// The plausible range, in `unit`.
    pub plausible_range: [f64; 2],
    /// Whether the data say anything about it.
    pub determined: bool,
    /// Whether it is a rig error within the data sheets of `[instruments]`, or a stated width, which is fitted along as noise.
    pub nuisance: bool,
    /// The value shown as its reciprocal: name, value and unit.
    pub also: Option<(String, f64, String)>,
    /// What it is.
    pub about: String,
}

/// How a search ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    /// Whether the best point is a minimum within the bounds.
    pub converged: bool,
    /// Why the search stopped.
    pub reason: String,
    /// Largest cosine between the residuals and a derivative: 0 at a minimum.
    pub gradient_cosine: f64,
    /// Iterations of the last search.
    pub iterations: usize,
    /// How many starting points were tried.
    pub starts: usize,
    /// How many of them ended in the best minimum.
    pub agreeing: usize,
    /// How many different minima were seen.
    pub minima: usize,
    /// Numbers that the data determine, of those fitted.
    pub rank: usize,
}
