//! Profiles and draws of the posterior: how sure the parameters of a fit are beyond a normal distribution.
//!
//! ```text
//! p(theta | data) ~ exp(-S(theta)/(2 s^2)) within the bounds,   S: the sum that the fit minimises
//! ```
//! s^2 is the variance behind the intervals: scatter of the residuals times rows per independent row. The
//! prior is flat in the coordinates of the search (the logarithm of numbers that are fitted over it); numbers
//! within data sheets or stated widths have theirs in S.
//!
//! Draws come from a random walk whose steps adapt while it warms up (H. Haario, E. Saksman, J. Tamminen,
//! *Bernoulli* 7 (2001) 223); the equilibria of a braid are linearised about the minimum in the numbers of its
//! shape, as within a round of the fit. Profiles solve them anew.

use bulge_model::ModelError;
use bulge_numerics::Random;
use bulge_numerics::least_squares::{Minimum, Options as Search, ProfileEnd, Residuals, profile};
use nalgebra::DMatrix;
use rayon::prelude::*;
use serde::Serialize;

use crate::comparison::analysis::{Analysis, Climbed};
use crate::fit::document::{Fit, Fitted};
use crate::fit::interval::Scale;
use crate::fit::problem::FitProblem;
use crate::fit::search::{Task, settle, some_of_long, weights};
use crate::fit::weights::Noise;

/// Chains of the walk, each from its own place.
const CHAINS: usize = 4;
/// Steps of a chain to warm up, in rounds after each of which its steps adapt.
const ROUNDS: usize = 8;
const ROUND: usize = 250;
/// Draws of a chain that are kept, and steps between two.
const KEPT: usize = 500;
const BETWEEN: usize = 8;
/// Standard deviations at which a profile is computed: between them its root is nearly straight.
const LEVELS: [f64; 3] = [1.0, 2.0, 3.0];
/// Probabilities of the quantiles: the interval of 95 %, that of 68 %, the median.
const QUANTILES: [f64; 5] = [0.025, 0.16, 0.5, 0.84, 0.975];

/// The posterior of the fitted parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Posterior {
    /// The parameters, in the order of the fit.
    pub parameters: Vec<PosteriorParameter>,
    /// Draws, each with a value for every parameter in its unit.
    #[serde(skip)]
    pub draws: Vec<Vec<f64>>,
    /// Number of draws.
    pub count: usize,
    /// Part of the steps of the walk that were accepted.
    pub accepted: f64,
    /// Covariance behind the intervals, as in [`Fit::covariance`].
    #[serde(skip)]
    pub covariance: Vec<f64>,
}

/// The posterior of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PosteriorParameter {
    /// The effect (or law).
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// The specimen, if each has its own parameter.
    pub specimen: Option<String>,
    /// The unit of all values.
    pub unit: String,
    /// Whether it is a nuisance parameter, see [`Fitted::nuisance`].
    pub nuisance: bool,
    /// The fitted value.
    pub value: f64,
    /// Points of the profile in rising order: value, and twice the fall of the log likelihood, minimised over
    /// the other parameters. A side ends where the parameter reaches a bound or has no state.
    pub profile: Vec<[f64; 2]>,
    /// Quantiles 2.5, 16, 50, 84 and 97.5 % of the draws.
    pub quantiles: [f64; 5],
    /// Potential scale reduction of the chains, split in halves: 1 where they agree; above 1.05 the draws are
    /// too few for this parameter.
    pub r_hat: f64,
}

/// The posterior about a fit.
pub(crate) fn posterior_of(
    analysis: &Analysis<'_>,
    climbed: &Climbed,
    fit: &Fit,
    seed: u64,
) -> Result<Posterior, ModelError> {
    if fit.parameters.is_empty() {
        return Ok(Posterior {
            parameters: Vec::new(),
            draws: Vec::new(),
            count: 0,
            accepted: 0.0,
            covariance: Vec::new(),
        });
    }
    let counting = with_force(&analysis.used.mask, &climbed.force);
    // The rows of the fit: another choice would have its minimum elsewhere.
    let thin = some_of_long(&analysis.record);
    let (record, used) = match &thin {
        Some((record, kept)) => (record, kept.iter().map(|row| counting[*row]).collect()),
        None => (&*analysis.record, counting),
    };
    let task = Task {
        record,
        used: &used,
        noise: Noise { force_n: fit.sd_n, ..analysis.noise },
        loss: analysis.options.loss,
        known: &[],
        is_near: true,
        quick: false,
    };
    let prepared = &climbed.prepared;
    let sd = weights(&prepared.model, &climbed.theta, &task)?;
    let problem_of = || {
        FitProblem::new(&prepared.model, record, &used, sd.clone(), climbed.theta.clone(), &prepared.priors)
            .with_loss(task.loss)
    };
    let problem = problem_of();
    let minimum = settle(&problem, &climbed.theta, false)?;
    let scale = Scale::new(&minimum, problem.measured(), fit.effective_rows, task.loss);
    let variance = scale.variance();
    let count = minimum.theta.len();
    let shown = |coordinates: &[f64]| -> Vec<f64> {
        let theta = problem.theta(coordinates);
        problem
            .places()
            .iter()
            .map(|index| prepared.model.parameters()[*index].shown(theta[*index]))
            .collect()
    };
    let profiles: Vec<Vec<[f64; 2]>> = (0..count)
        .into_par_iter()
        .map(|place| {
            let own = problem_of();
            let one = |value: f64| {
                let mut at = minimum.theta.clone();
                at[place] = value;
                shown(&at)[place]
            };
            profiled(&own, &minimum, place, variance).into_iter().map(|[x, rise]| [one(x), rise]).collect()
        })
        .collect();
    let widths: Vec<f64> = (0..count).map(|place| width(&problem, &fit.parameters[place], place)).collect();
    let start = proposal(&minimum, variance, &widths);
    let chains: Vec<Chain> = (0..CHAINS)
        .into_par_iter()
        .map(|chain| walk(&problem_of(), &minimum, variance, &start, Random::new(seed, chain as u64)))
        .collect::<Result<_, _>>()?;
    let parameters = fit.parameters.iter().zip(profiles).enumerate().map(|(place, (found, profile))| {
        let column = |chain: &Chain| chain.draws.iter().map(|draw| shown(draw)[place]).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = chains.iter().map(column).collect();
        one_parameter(found, profile, &columns)
    });
    let parameters: Vec<PosteriorParameter> = parameters.collect();
    let draws: Vec<Vec<f64>> = chains.iter().flat_map(|chain| &chain.draws).map(|draw| shown(draw)).collect();
    let accepted = chains.iter().map(|chain| chain.accepted).sum::<f64>() / CHAINS as f64;
    Ok(Posterior { parameters, count: draws.len(), draws, accepted, covariance: fit.covariance.clone() })
}

/// Rows that count and have a state in the fit.
fn with_force(used: &[bool], force: &[f64]) -> Vec<bool> {
    used.iter().zip(force).map(|(used, force)| *used && force.is_finite()).collect()
}

/// Half a standard deviation or so of a parameter in the coordinates of the search, from its interval.
fn width(problem: &FitProblem<'_>, fitted: &Fitted, place: usize) -> f64 {
    let [low, high] = [fitted.low, fitted.high];
    let width = if problem.is_logarithmic(place) && low > 0.0 {
        (high / low).ln()
    } else {
        (high - low) * problem.unit(place)
    };
    (0.1 * width).abs()
}

/// Points of the profile, in the coordinate of the parameter.
fn profiled(problem: &FitProblem<'_>, minimum: &Minimum, place: usize, variance: f64) -> Vec<[f64; 2]> {
    let bounds = problem.bounds();
    let options =
        Search { tolerance: 1e-4, check_curvature: false, max_evaluations: 60, ..Search::default() };
    let mut points = vec![[minimum.theta[place], 0.0]];
    for level in LEVELS {
        let square = level * level;
        let Ok(found) = profile(problem, minimum, &bounds, &options, place, square * variance) else { break };
        for end in [found.lower, found.upper] {
            points.push(match end {
                ProfileEnd::Crossed(value) => [value, square],
                ProfileEnd::AtBound { value, rise }
                | ProfileEnd::Unbounded { value, rise }
                | ProfileEnd::Undefined { value, rise } => [value, rise / variance],
            });
        }
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup_by(|a, b| a[0].total_cmp(&b[0]).is_eq());
    points
}

/// Covariance of the first steps: that of the minimum, and a narrow one of parameters that it doesn't have.
fn proposal(minimum: &Minimum, variance: f64, widths: &[f64]) -> DMatrix<f64> {
    let count = widths.len();
    let mut covariance = DMatrix::from_row_slice(count, count, &minimum.covariance(variance));
    for (place, width) in widths.iter().enumerate() {
        if covariance[(place, place)] <= 0.0 {
            covariance[(place, place)] = width * width;
        }
    }
    covariance
}

/// Draws of one chain, in the coordinates of the search.
struct Chain {
    draws: Vec<Vec<f64>>,
    accepted: f64,
}

/// A random walk from the minimum.
fn walk(
    problem: &FitProblem<'_>,
    minimum: &Minimum,
    variance: f64,
    first: &DMatrix<f64>,
    mut random: Random,
) -> Result<Chain, ModelError> {
    let count = minimum.theta.len();
    let bounds = problem.bounds();
    // With derivatives, from which the equilibria are held.
    problem.hold();
    let (rows, mut residuals) = (problem.rows(), vec![0.0; problem.rows()]);
    problem.evaluate(&minimum.theta, 0..rows, &mut residuals, Some(&mut vec![0.0; rows * count]))?;
    let mut half = |at: &[f64]| -> Result<f64, ModelError> {
        problem.evaluate(at, 0..problem.rows(), &mut residuals, None)?;
        Ok(-0.5 * residuals.iter().map(|r| r * r).sum::<f64>() / variance)
    };
    let mut at = minimum.theta.clone();
    let mut here = half(&at)?;
    // Gelman, Roberts, Gilks (1996): the best scale of a random walk in `count` dimensions.
    let usual = 2.38 / (count as f64).sqrt();
    let mut scale = usual;
    let mut root = factor(first);
    let mut step = |at: &mut Vec<f64>, here: &mut f64, scale: f64, root: &DMatrix<f64>| {
        let normal: Vec<f64> = (0..count).map(|_| random.normal()).collect();
        let chance = random.uniform();
        let moved = |i: usize| at[i] + scale * (0..=i).map(|j| root[(i, j)] * normal[j]).sum::<f64>();
        let trial: Vec<f64> = (0..count).map(moved).collect();
        let is_inside = (0..count).all(|i| (bounds.lower[i]..=bounds.upper[i]).contains(&trial[i]));
        // Numbers without a state have no probability.
        let there = if is_inside { half(&trial).unwrap_or(f64::NEG_INFINITY) } else { f64::NEG_INFINITY };
        let is_accepted = chance.ln() < there - *here;
        if is_accepted {
            *at = trial;
            *here = there;
        }
        is_accepted
    };
    let mut seen: Vec<Vec<f64>> = Vec::new();
    for round in 0..ROUNDS {
        let mut accepted = 0;
        for _ in 0..ROUND {
            accepted += usize::from(step(&mut at, &mut here, scale, &root));
            seen.push(at.clone());
        }
        // Too bold or too timid steps tell nothing of the shape: a tenth to a half should be accepted.
        match accepted as f64 / ROUND as f64 {
            few if few < 0.1 => scale *= 0.4,
            many if many > 0.5 => scale *= 1.6,
            _ => {}
        }
        if round >= 2 {
            // The first rounds are forgotten step by step.
            let recent = &seen[seen.len() / 3..];
            root = factor(&covariance(recent, first));
            scale = if round == 2 { usual } else { scale };
        }
    }
    let mut chain = Chain { draws: Vec::with_capacity(KEPT), accepted: 0.0 };
    for _ in 0..KEPT {
        for _ in 0..BETWEEN {
            chain.accepted +=
                f64::from(u8::from(step(&mut at, &mut here, scale, &root))) / (KEPT * BETWEEN) as f64;
        }
        chain.draws.push(at.clone());
    }
    Ok(chain)
}

/// Covariance of some draws, with a thousandth of that of the first steps so that no direction is lost.
fn covariance(draws: &[Vec<f64>], first: &DMatrix<f64>) -> DMatrix<f64> {
    let (count, n) = (first.nrows(), draws.len() as f64);
    let mean: Vec<f64> = (0..count).map(|i| draws.iter().map(|draw| draw[i]).sum::<f64>() / n).collect();
    let entry =
        |i: usize, j: usize| draws.iter().map(|d| (d[i] - mean[i]) * (d[j] - mean[j])).sum::<f64>() / n;
    DMatrix::from_fn(count, count, |i, j| entry(i, j) + if i == j { 1e-3 * first[(i, i)] } else { 0.0 })
}

/// A triangular root; that of the diagonal where the matrix has none.
fn factor(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    match covariance.clone().cholesky() {
        Some(found) => found.l(),
        None => DMatrix::from_diagonal(&covariance.diagonal().map(|x| x.max(0.0).sqrt())),
    }
}

fn one_parameter(fitted: &Fitted, profile: Vec<[f64; 2]>, chains: &[Vec<f64>]) -> PosteriorParameter {
    let mut sorted: Vec<f64> = chains.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let quantile = |p: f64| {
        let place = p * (sorted.len() - 1) as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let below = (place.floor() as usize).min(sorted.len().saturating_sub(2));
        let part = place - below as f64;
        sorted[below] * (1.0 - part) + sorted[below + 1] * part
    };
    PosteriorParameter {
        effect: fitted.effect.clone(),
        name: fitted.name.clone(),
        specimen: fitted.specimen.clone(),
        unit: fitted.unit.clone(),
        nuisance: fitted.nuisance,
        value: fitted.value,
        profile,
        quantiles: QUANTILES.map(quantile),
        r_hat: r_hat(chains),
    }
}

/// Gelman, Rubin (1992), each chain split in halves: the root of the pooled variance over that within.
fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let halves: Vec<&[f64]> = chains.iter().flat_map(|chain| chain.chunks_exact(chain.len() / 2)).collect();
    let n = halves[0].len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let variance = |values: &[f64]| {
        let middle = mean(values);
        values.iter().map(|x| (x - middle).powi(2)).sum::<f64>() / (values.len() - 1) as f64
    };
    let means: Vec<f64> = halves.iter().map(|half| mean(half)).collect();
    let within = halves.iter().map(|half| variance(half)).sum::<f64>() / halves.len() as f64;
    if within > 0.0 { ((n - 1.0) / n + variance(&means) / within).sqrt() } else { 1.0 }
}
