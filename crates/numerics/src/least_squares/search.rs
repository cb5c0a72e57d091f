//! The search: Levenberg-Marquardt steps in a trust region that is scaled by the norms of the columns of the Jacobian.
//!
//! J. J. Moré, *The Levenberg-Marquardt algorithm: implementation and theory*, Lecture Notes in Mathematics 630, Springer 1978,
//! p. 105, with bounds exact in each step, and with steps that are bent along curved valleys before they are shortened. Near a
//! minimum, where the sum of squares is blunted by rounding, steps are judged by the gradient.

use super::curvature::{self, Probe};
use super::linear::{Linear, Linearisation, decrease, linearise, values};
use super::minimum::{End, Minimum, RANK_TOLERANCE, Reason, gradient_cosine, held_at};
use super::residuals::{Bounds, Residuals, Side, check_start};
use super::second::Second;
use super::step::{Step, StepBox, damped, of_length};
use super::triangle::Triangle;
use super::{LeastSquaresError, Options};
use crate::vector::{difference, norm};

/// A step is accepted if it achieves this fraction of the predicted decrease (Moré's value).
const ENOUGH: f64 = 1e-4;
/// Below this cosine between residuals and tangent space, a step may be judged by the gradient: the decrease
/// that it predicts is 1e-8 of the sum of squares.
const POLISH: f64 = 1e-4;
/// Most trials of one iteration, each at most half as long as the one before.
const TRIALS: usize = 100;
/// A damping that keeps the triangle regular if norms are zero, but is too small to have an effect.
pub(super) const LEAST_DAMPING: f64 = (1e-2 * RANK_TOLERANCE) * (1e-2 * RANK_TOLERANCE);
/// A gradient of this cosine is none: with curvatures as large as the squares of the columns, it would lower the sum of squares by
/// less than its rounding error.
const NO_GRADIENT: f64 = 2e-8;
/// Most times that the search leaves a saddle.
const ESCAPES: usize = 10;

/// Least sum of squares of the residuals within the bounds, from a start.
///
/// ```
/// use bulge_numerics::least_squares::{Bounds, Options, Residuals, minimise};
/// use std::convert::Infallible;
///
/// /// `r = (10 (y - x^2), 1 - x)`.
/// struct Rosenbrock;
///
/// impl Residuals for Rosenbrock {
///     type Error = Infallible;
///     fn rows(&self) -> usize {
///         2
///     }
///     fn parameters(&self) -> usize {
///         2
///     }
///     fn evaluate(
///         &self,
///         theta: &[f64],
///         rows: std::ops::Range<usize>,
///         residuals: &mut [f64],
///         jacobian: Option<&mut [f64]>,
///     ) -> Result<(), Infallible> {
///         let [x, y] = [theta[0], theta[1]];
///         residuals.copy_from_slice(&[10.0 * (y - x * x), 1.0 - x][rows.clone()]);
///         if let Some(jacobian) = jacobian {
///             jacobian.copy_from_slice(&[-20.0 * x, 10.0, -1.0, 0.0][2 * rows.start..2 * rows.end]);
///         }
///         Ok(())
///     }
/// }
///
/// let minimum = minimise(&Rosenbrock, &[-1.2, 1.0], &Bounds::none(2), &Options::default())?;
/// assert!(minimum.certificate.converged);
/// assert!((minimum.theta[0] - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LeastSquaresError`] for a start outside the bounds or without finite residuals and derivatives, crossed bounds, lists of the
/// wrong length, or an option out of range. A search that ends without a minimum is no error: see [`super::Certificate::converged`].
pub fn minimise<P: Residuals>(
    problem: &P,
    start: &[f64],
    bounds: &Bounds,
    options: &Options,
) -> Result<Minimum, LeastSquaresError<P::Error>> {
    options.check()?;
    check_start(problem.parameters(), start, bounds)?;
    Ok(Search::new(problem, bounds, options, Linearisation::at(problem, start)?).run())
}

/// As [`minimise`], from a start at which this problem was linearised before.
///
/// # Errors
/// As [`minimise`], and if the linearisation has another number of rows.
pub fn minimise_from<P: Residuals>(
    problem: &P,
    start: Linearisation,
    bounds: &Bounds,
    options: &Options,
) -> Result<Minimum, LeastSquaresError<P::Error>> {
    options.check()?;
    check_start(problem.parameters(), &start.theta, bounds)?;
    if start.residuals.len() != problem.rows() {
        let what =
            format!("the start has {} rows; the problem has {}", start.residuals.len(), problem.rows());
        return Err(LeastSquaresError::Request(what));
    }
    Ok(Search::new(problem, bounds, options, start).run())
}

/// The search at its current point.
pub(super) struct Search<'a, P> {
    pub(super) problem: &'a P,
    pub(super) bounds: &'a Bounds,
    pub(super) options: &'a Options,
    pub(super) theta: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    pub(super) linear: Linear,
    /// Largest norm of each column so far: the scale of the trust region.
    pub(super) scale: Vec<f64>,
    pub(super) radius: f64,
    pub(super) damping: f64,
    second: Second,
    iterations: usize,
    pub(super) evaluations: usize,
    pub(super) linearisations: usize,
}

/// A trial point.
pub(super) struct Trial {
    pub(super) theta: Vec<f64>,
    /// Length of the step in the scale of the trust region.
    pub(super) length: f64,
    pub(super) predicted: f64,
    /// Whether it is the minimum of the model that it comes from.
    pub(super) full: bool,
    /// Whether that model has second derivatives of the residuals.
    by_second: bool,
}

/// A point at which the residuals are known.
pub(super) struct Point {
    pub(super) theta: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    /// The linearisation, if it was computed together with the residuals.
    linear: Option<Linear>,
}

/// How an iteration ended.
enum Progress {
    Moved,
    Stuck,
    /// Further trials would be too short to be worthwhile.
    Kink,
    Budget,
}

impl<'a, P: Residuals> Search<'a, P> {
    fn new(
        problem: &'a P,
        bounds: &'a Bounds,
        options: &'a Options,
        Linearisation { theta, residuals, linear }: Linearisation,
    ) -> Self {
        let (scale, second) = (linear.norms.clone(), Second::none(linear.norms.len()));
        let size = norm(&product(&scale, &theta));
        // At the origin, the residuals are the only measure of a step.
        let radius = if size > 0.0 { size } else { linear.cost.sqrt() };
        Self {
            problem,
            bounds,
            options,
            theta,
            residuals,
            linear,
            scale,
            radius,
            damping: 0.0,
            second,
            iterations: 0,
            evaluations: 0,
            linearisations: 1,
        }
    }

    fn run(mut self) -> Minimum {
        let mut escapes = 0;
        let mut least_curvature = None;
        let reason = loop {
            let reason = self.descend();
            if !reason.is_converged() || !self.options.check_curvature {
                break reason;
            }
            match curvature::probe(&mut self) {
                Probe::Minimum(curvature) => {
                    least_curvature = curvature;
                    break reason;
                }
                Probe::Lower { curvature, .. } if escapes == ESCAPES => {
                    least_curvature = Some(curvature);
                    break Reason::Saddle;
                }
                Probe::Lower { theta, length, .. } => {
                    escapes += 1;
                    if !self.move_to(theta) {
                        break Reason::Saddle;
                    }
                    self.radius = length;
                }
            }
        };
        let newton = self.newton();
        let end = End {
            bounds: self.bounds,
            reason,
            newton: &newton,
            least_curvature,
            iterations: self.iterations,
            evaluations: self.evaluations,
            linearisations: self.linearisations,
        };
        end.minimum(self.theta, self.residuals, &self.linear)
    }

    /// Iterates until one of the stopping criteria holds.
    fn descend(&mut self) -> Reason {
        if (0..self.theta.len()).all(|j| self.bounds.is_fixed(j)) {
            return Reason::NothingFree;
        }
        loop {
            let newton = self.newton();
            if let Some(reason) = self.stationary(&newton) {
                return reason;
            }
            let (before, gradient) = (self.theta.clone(), self.linear.gradient());
            match self.advance(&newton) {
                Progress::Moved => {
                    self.iterations += 1;
                    self.second.learn(&gradient, &self.linear, &difference(&self.theta, &before));
                }
                Progress::Budget => return Reason::Budget,
                Progress::Stuck | Progress::Kink
                    if newton.predicted <= self.rounding().max(self.options.least_decrease)
                        || self.has_no_gradient(&newton) =>
                {
                    return Reason::DecreaseTooSmall;
                }
                Progress::Stuck => return Reason::Stagnated,
                Progress::Kink => return Reason::Kink,
            }
        }
    }

    /// The step to the linearised minimum within the bounds, scaled by the current norms, without a component
    /// in flat directions.
    pub(super) fn newton(&self) -> Step {
        let norms = &self.linear.norms;
        let (a, b) = self.scaled_by(norms, &self.linear.q);
        damped(&a, &b, LEAST_DAMPING, &self.limits(norms, &self.theta))
    }

    fn stationary(&self, newton: &Step) -> Option<Reason> {
        let cost = self.linear.cost;
        if cost == 0.0 {
            return Some(Reason::ExactFit);
        }
        if newton.predicted <= self.options.tolerance.powi(2) * cost {
            return Some(Reason::Orthogonal);
        }
        (newton.predicted.sqrt() <= self.rounding_of_parameters()).then_some(Reason::StepBelowRounding)
    }

    fn has_no_gradient(&self, newton: &Step) -> bool {
        let held = held_at(self.bounds, &self.theta, newton);
        gradient_cosine(&self.linear, (0..held.len()).filter(|j| held[*j].is_none())) <= NO_GRADIENT
    }

    /// Change of the residuals from rounding the parameters.
    fn rounding_of_parameters(&self) -> f64 {
        f64::EPSILON * norm(&product(&self.linear.norms, &self.theta))
    }

    /// Change of the sum of squares from rounding the residuals and the sum.
    fn rounding(&self) -> f64 {
        let (length, change) = (self.linear.cost.sqrt(), 8.0 * self.rounding_of_parameters());
        8.0 * f64::EPSILON * self.linear.cost + 2.0 * length * change + change * change
    }

    /// The triangle with columns divided by a scale, and a right-hand side for it.
    pub(super) fn scaled_by(&self, scale: &[f64], rhs: &[f64]) -> (Triangle, Vec<f64>) {
        let (a, b) = self.linear.regular(rhs, RANK_TOLERANCE);
        let ratio = |(norm, scale): (&f64, &f64)| if *scale > 0.0 { norm / scale } else { 0.0 };
        let ratios: Vec<f64> = self.linear.norms.iter().zip(scale).map(ratio).collect();
        (a.scaled(&ratios), b)
    }

    /// The box of scaled steps from a point. Parameters without influence don't move.
    pub(super) fn limits(&self, scale: &[f64], from: &[f64]) -> StepBox {
        let reach = |ends: &[f64]| -> Vec<f64> {
            (0..scale.len())
                .map(|j| if self.linear.norms[j] > 0.0 { (ends[j] - from[j]) * scale[j] } else { 0.0 })
                .collect()
        };
        StepBox { lower: reach(&self.bounds.lower), upper: reach(&self.bounds.upper) }
    }

    /// The point after a scaled step; it lies exactly on the bounds that hold the step.
    pub(super) fn point(&self, from: &[f64], step: &Step, scale: &[f64]) -> Vec<f64> {
        let moved = |j: usize| match step.held[j] {
            _ if scale[j] == 0.0 || step.z[j] == 0.0 => from[j],
            Some(Side::Lower) => self.bounds.lower[j],
            Some(Side::Upper) => self.bounds.upper[j],
            None => (from[j] + step.z[j] / scale[j]).clamp(self.bounds.lower[j], self.bounds.upper[j]),
        };
        (0..from.len()).map(moved).collect()
    }

    /// The trial within the trust region.
    fn trial(&mut self, newton: &Step, newton_length: f64) -> Trial {
        let limits = self.limits(&self.scale, &self.theta);
        if let Some((a, b)) = self.second.triangle(&self.linear, &self.scale) {
            let step = damped(&a, &b, LEAST_DAMPING, &limits);
            let full = norm(&step.z) <= self.radius;
            let step = if full { step } else { self.of_radius(&a, &b, &limits) };
            let theta = self.point(&self.theta, &step, &self.scale);
            return Trial { theta, length: norm(&step.z), predicted: step.predicted, full, by_second: true };
        }
        if newton_length <= self.radius {
            let theta = self.point(&self.theta, newton, &self.linear.norms);
            let predicted = newton.predicted;
            return Trial { theta, length: newton_length, predicted, full: true, by_second: false };
        }
        let (a, b) = self.scaled_by(&self.scale, &self.linear.q);
        let step = self.of_radius(&a, &b, &limits);
        let theta = self.point(&self.theta, &step, &self.scale);
        Trial { theta, length: norm(&step.z), predicted: step.predicted, full: false, by_second: false }
    }

    /// The step as long as the radius; keeps its damping.
    fn of_radius(&mut self, a: &Triangle, b: &[f64], limits: &StepBox) -> Step {
        let (step, damping) = of_length(a, b, self.radius, self.damping, limits);
        self.damping = damping;
        step
    }

    /// One iteration: shorter and shorter trials until one is accepted.
    fn advance(&mut self, newton: &Step) -> Progress {
        let in_region = |j: usize| {
            let norm = self.linear.norms[j];
            if norm > 0.0 { newton.z[j] * (self.scale[j] / norm) } else { 0.0 }
        };
        let newton_length = norm(&(0..self.theta.len()).map(in_region).collect::<Vec<_>>());
        for _ in 0..TRIALS {
            if self.evaluations + self.linearisations >= self.options.max_evaluations {
                return Progress::Budget;
            }
            let trial = self.trial(newton, newton_length);
            if trial.theta == self.theta {
                if trial.by_second {
                    self.second.forget();
                    continue;
                }
                return Progress::Stuck;
            }
            // If the model can't be evaluated there, a shorter step may still succeed.
            let Some(point) = self.at(trial.theta.clone()) else {
                if trial.by_second {
                    self.second.forget();
                    continue;
                }
                if trial.predicted < self.options.least_decrease {
                    return Progress::Kink;
                }
                self.radius = 0.25 * trial.length;
                continue;
            };
            let actual = decrease(&self.residuals, &point.residuals);
            let ratio = actual / trial.predicted;
            self.second.judge(&self.linear, &difference(&trial.theta, &self.theta), actual);
            if ratio >= ENOUGH {
                let slope = self.slope(&trial.theta);
                if self.stay(point) {
                    self.resize(ratio, actual, slope, trial.length, trial.full);
                    return Progress::Moved;
                }
                self.radius = 0.25 * trial.length;
                continue;
            }
            // Second derivatives that led astray say nothing about the step without them.
            if trial.by_second {
                self.second.forget();
                continue;
            }
            let residuals = point.residuals.clone();
            if trial.full
                && trial.predicted <= POLISH.powi(2) * self.linear.cost
                && self.polish(&trial, point)
            {
                return Progress::Moved;
            }
            if trial.predicted > self.rounding() && self.bend(&trial, &residuals) {
                return Progress::Moved;
            }
            if trial.predicted < self.options.least_decrease {
                return Progress::Kink;
            }
            let slope = self.slope(&trial.theta);
            self.resize(ratio, actual, slope, trial.length, trial.full);
        }
        Progress::Stuck
    }

    /// Derivative of the sum of squares along the step to a point; negative.
    fn slope(&self, theta: &[f64]) -> f64 {
        let gradient = self.linear.gradient();
        (0..theta.len()).map(|j| 2.0 * gradient[j] * (theta[j] - self.theta[j])).sum()
    }

    /// The radius after a trial, by the ratio of actual to predicted decrease.
    fn resize(&mut self, ratio: f64, actual: f64, slope: f64, length: f64, full: bool) {
        if ratio <= 0.25 {
            // Minimum of the parabola through both sums of squares with the slope at the first point.
            let part = slope / (2.0 * (slope + actual));
            let part = if part.is_finite() { part.clamp(0.1, 0.5) } else { 0.5 };
            self.radius = part * length;
        } else if full {
            // A short step to a minimum says nothing against a longer one.
            self.radius = self.radius.max(2.0 * length);
        } else if ratio >= 0.75 {
            self.radius = 2.0 * length;
        }
    }

    /// The residuals at a point, with their linearisation if that costs little; none if they can't be
    /// evaluated there.
    pub(super) fn at(&mut self, theta: Vec<f64>) -> Option<Point> {
        let mut residuals = vec![0.0; self.residuals.len()];
        let linear = if self.problem.joint() {
            self.linearisations += 1;
            Some(linearise(self.problem, &theta, &mut residuals).ok()?)
        } else {
            self.evaluations += 1;
            values(self.problem, &theta, &mut residuals).ok()?;
            None
        };
        Some(Point { theta, residuals, linear })
    }

    /// Linearises at a point and moves there; if that fails, returns false and stays.
    pub(super) fn move_to(&mut self, theta: Vec<f64>) -> bool {
        let residuals = vec![0.0; self.residuals.len()];
        self.stay(Point { theta, residuals, linear: None })
    }

    /// Linearises at a point if necessary, and moves there; if that fails, returns false and stays.
    pub(super) fn stay(&mut self, point: Point) -> bool {
        let Point { theta, mut residuals, linear } = point;
        let linear = if let Some(linear) = linear {
            linear
        } else {
            self.linearisations += 1;
            let Ok(linear) = linearise(self.problem, &theta, &mut residuals) else { return false };
            linear
        };
        for (scale, norm) in self.scale.iter_mut().zip(&linear.norms) {
            *scale = scale.max(*norm);
        }
        self.theta = theta;
        self.residuals = residuals;
        self.linear = linear;
        true
    }

    /// Accepts a full step that reduces the distance to the linearised minimum although rounding hides the
    /// decrease of the sum of squares.
    fn polish(&mut self, trial: &Trial, point: Point) -> bool {
        let before = (self.theta.clone(), self.residuals.clone(), self.linear.clone(), self.scale.clone());
        if self.stay(point)
            && self.linear.cost <= before.2.cost * (1.0 + POLISH.powi(2))
            && self.newton().predicted <= 0.81 * trial.predicted
        {
            self.radius = self.radius.max(2.0 * trial.length);
            return true;
        }
        (self.theta, self.residuals, self.linear, self.scale) = before;
        false
    }
}

/// Elementwise products.
pub(super) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}
