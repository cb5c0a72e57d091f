//! Profile intervals: how far one parameter can go before the sum of squares, minimised over the others, rises by a given amount.
//!
//! D. M. Bates, D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley 1988, section 6.1. With `zeta =
//! sqrt(cost - minimum)`, nearly linear in the parameter, the ends are the roots of `zeta = sqrt(rise)`; `d zeta/d theta_j = (J^T
//! r)_j / zeta`, as the others are at their minimum.

use super::minimum::Minimum;
use super::residuals::{Bounds, Residuals, Side, check_start};
use super::search::minimise;
use super::{LeastSquaresError, Options};
use crate::root::{RootError, newton_bracketed};

/// Number of outward steps after which a side counts as open; each goes up to four times as far as the one
/// before.
const STEPS: usize = 30;
/// Halvings of a step after which its direction counts as undefined.
const HALVINGS: usize = 20;
/// A decrease below the given minimum by up to this fraction of the rise is rounding, or inaccuracy of that
/// minimum.
const SLACK: f64 = 1e-6;
/// Relative length of the last Newton step towards an end; the end itself is far more accurate.
const ROOT: f64 = 1e-4;

/// One end of a profile interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProfileEnd {
    /// The sum of squares has risen by the given amount at this value.
    Crossed(f64),
    /// The interval is open: at the parameter's bound the sum of squares has risen by less.
    AtBound {
        /// The bound.
        value: f64,
        /// Rise of the sum of squares there.
        rise: f64,
    },
    /// The interval is open: however far the parameter went, the sum of squares rose by less.
    Unbounded {
        /// How far it went.
        value: f64,
        /// Rise of the sum of squares there.
        rise: f64,
    },
    /// The interval is open: a little beyond this value the residuals can't be evaluated.
    Undefined {
        /// The last value with residuals.
        value: f64,
        /// Rise of the sum of squares there.
        rise: f64,
    },
}

/// The profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The lower end.
    pub lower: ProfileEnd,
    /// The upper end.
    pub upper: ProfileEnd,
}

/// The interval of `parameter` in which the sum of squares, minimised over the others within `bounds`, exceeds that of `minimum`
/// by at most `rise`.
///
/// For residuals in units of their standard deviation, `rise` is a quantile of the chi-square distribution with one degree of
/// freedom.
///
/// # Errors
/// [`LeastSquaresError::Request`] if the parameter doesn't exist or is fixed; [`LeastSquaresError::Profile`] if `minimum` turns
/// out not to be one, or a search over the other parameters doesn't converge; those of [`minimise`].
pub fn profile<P: Residuals>(
    problem: &P,
    minimum: &Minimum,
    bounds: &Bounds,
    options: &Options,
    parameter: usize,
    rise: f64,
) -> Result<Profile, LeastSquaresError<P::Error>> {
    options.check()?;
    check_start(problem.parameters(), &minimum.theta, bounds)?;
    let parameters = minimum.theta.len();
    if parameter >= parameters || bounds.is_fixed(parameter) {
        return Err(LeastSquaresError::Request(format!(
            "parameter {parameter} cannot be profiled: the problem has {parameters} parameters, and this one must not be fixed"
        )));
    }
    if !(rise > 0.0 && rise < f64::INFINITY) {
        return Err(LeastSquaresError::option("rise", rise, "positive and finite"));
    }
    let walk = |side| {
        let start = Visit { distance: 0.0, zeta: 0.0, slope: f64::INFINITY, theta: minimum.theta.clone() };
        let options = Options { check_curvature: false, ..*options };
        Walk { problem, minimum, bounds, options, parameter, rise, side, visits: vec![start] }
    };
    let (lower, upper) = (walk(Side::Lower).end()?, walk(Side::Upper).end()?);
    Ok(Profile { lower, upper })
}

/// One way out of the minimum.
struct Walk<'a, P> {
    problem: &'a P,
    minimum: &'a Minimum,
    bounds: &'a Bounds,
    options: Options,
    parameter: usize,
    rise: f64,
    side: Side,
    visits: Vec<Visit>,
}

/// A solved point of the profile.
#[derive(Debug, Clone)]
struct Visit {
    /// Distance of the parameter from the minimum, not negative.
    distance: f64,
    /// Square root of the rise.
    zeta: f64,
    /// Its derivative by the distance.
    slope: f64,
    theta: Vec<f64>,
}

impl<P: Residuals> Walk<'_, P> {
    /// Distance of the bound on this side.
    fn limit(&self) -> f64 {
        let (j, centre) = (self.parameter, self.minimum.theta[self.parameter]);
        match self.side {
            Side::Lower => centre - self.bounds.lower[j],
            Side::Upper => self.bounds.upper[j] - centre,
        }
    }

    /// Value of the parameter at a distance; the bound itself from there on.
    fn value(&self, distance: f64) -> f64 {
        let (j, centre) = (self.parameter, self.minimum.theta[self.parameter]);
        match self.side {
            Side::Lower if distance >= self.limit() => self.bounds.lower[j],
            Side::Upper if distance >= self.limit() => self.bounds.upper[j],
            Side::Lower => centre - distance,
            Side::Upper => centre + distance,
        }
    }

    /// Where the linearised profile has risen enough.
    fn first_distance(&self) -> f64 {
        let (j, k) = (self.parameter, self.minimum.theta.len());
        let variance = self.minimum.covariance(1.0)[j * k + j];
        let column: f64 = (0..k).map(|i| self.minimum.r[i * k + j].powi(2)).sum();
        let square = if variance > 0.0 { 1.0 / variance } else { column };
        // square d^2 + 2 |g| d = rise; the slope matters where the parameter leaves a bound.
        let slope =
            if self.minimum.certificate.at_bound[j].is_some() { self.minimum.gradient[j].abs() } else { 0.0 };
        let distance = self.rise / (slope + (slope * slope + square * self.rise).sqrt());
        let size = self.minimum.theta[j].abs();
        if distance.is_finite() { distance } else { 1e-2 * if size > 0.0 { size } else { 1.0 } }
    }

    /// Walks out until the rise is bracketed, then finds the root.
    fn end(&mut self) -> Result<ProfileEnd, LeastSquaresError<P::Error>> {
        let target = self.rise.sqrt();
        let limit = self.limit();
        let mut inside = self.visits[0].clone();
        if limit <= 0.0 {
            return Ok(ProfileEnd::AtBound { value: inside.theta[self.parameter], rise: 0.0 });
        }
        let mut distance = self.first_distance().min(limit);
        for _ in 0..STEPS {
            let Some(visit) = self.visit_or_shorten(&inside, distance)? else {
                return Ok(ProfileEnd::Undefined {
                    value: inside.theta[self.parameter],
                    rise: inside.zeta * inside.zeta,
                });
            };
            if visit.zeta >= target {
                return self.root(&inside, &visit).map(ProfileEnd::Crossed);
            }
            if visit.distance >= limit {
                let value = visit.theta[self.parameter];
                return Ok(ProfileEnd::AtBound { value, rise: visit.zeta * visit.zeta });
            }
            distance = (visit.distance * (1.05 * target / visit.zeta).clamp(1.25, 4.0)).min(limit);
            inside = visit;
        }
        Ok(ProfileEnd::Unbounded { value: inside.theta[self.parameter], rise: inside.zeta * inside.zeta })
    }

    /// The point at a distance or, if the residuals can't be evaluated there, nearer to `inside`.
    fn visit_or_shorten(
        &mut self,
        inside: &Visit,
        mut distance: f64,
    ) -> Result<Option<Visit>, LeastSquaresError<P::Error>> {
        for _ in 0..HALVINGS {
            match self.visit(distance) {
                Ok(visit) => return Ok(Some(visit)),
                Err(LeastSquaresError::Start(_) | LeastSquaresError::NotFinite(_)) => {
                    distance = 0.5 * (distance + inside.distance);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// The root of `sqrt(rise) - zeta` between two points.
    fn root(&mut self, inside: &Visit, outside: &Visit) -> Result<f64, LeastSquaresError<P::Error>> {
        let target = self.rise.sqrt();
        let part = (target - inside.zeta) / (outside.zeta - inside.zeta);
        let start = inside.distance + part * (outside.distance - inside.distance);
        let f = |distance: f64| {
            let visit = self.visit(distance)?;
            Ok((target - visit.zeta, -visit.slope))
        };
        match newton_bracketed(f, inside.distance, outside.distance, start, [0.0, ROOT]) {
            Ok(distance) => Ok(self.value(distance)),
            Err(RootError::Function(error)) => Err(error),
            // The bracket of a hundred halvings is as narrow as the numbers are.
            Err(RootError::Budget { at, .. }) => Ok(self.value(at)),
        }
    }

    /// Minimises over the other parameters at a distance, starting from the nearest point visited.
    fn visit(&mut self, distance: f64) -> Result<Visit, LeastSquaresError<P::Error>> {
        let (j, value) = (self.parameter, self.value(distance));
        let bounds = self.bounds.clone().with_fixed(j, value);
        let predicted = minimise(self.problem, &self.predict(distance, value), &bounds, &self.options);
        let solved = match predicted {
            Ok(solved) => solved,
            // The straight prediction may leave the domain where the last parameters don't.
            Err(_) => minimise(self.problem, &self.nearest(distance, value), &bounds, &self.options)?,
        };
        if !solved.certificate.converged {
            let reason = solved.certificate.reason;
            return Err(LeastSquaresError::Profile(format!(
                "with parameter {j} held at {value} the search over the others ended without a minimum ({reason:?})"
            )));
        }
        let (cost, minimum) = (solved.cost, self.minimum.cost);
        let risen = cost - minimum;
        if risen < -SLACK * self.rise - 1e-12 * minimum {
            return Err(LeastSquaresError::Profile(format!(
                "with parameter {j} at {value} the sum of squares is {cost}, below that of the given minimum, {minimum}; minimise again from there"
            )));
        }
        let zeta = risen.max(0.0).sqrt();
        let outward = match self.side {
            Side::Lower => -solved.gradient[j],
            Side::Upper => solved.gradient[j],
        };
        let visit = Visit { distance, zeta, slope: outward / zeta, theta: solved.theta };
        self.visits.push(visit.clone());
        Ok(visit)
    }

    /// The visited point nearest to a distance.
    fn last(&self, distance: f64) -> &Visit {
        let gap = |v: &Visit| (v.distance - distance).abs();
        let nearer = |a, b| if gap(b) < gap(a) { b } else { a };
        self.visits.iter().fold(&self.visits[0], nearer)
    }

    /// Parameters of the nearest point, this one moved.
    fn nearest(&self, distance: f64, value: f64) -> Vec<f64> {
        let mut theta = self.last(distance).theta.clone();
        theta[self.parameter] = value;
        theta
    }

    /// Parameters of the nearest point, moved along the secant from the minimum or, at the minimum, by the regression on this parameter.
    fn predict(&self, distance: f64, value: f64) -> Vec<f64> {
        let (j, k) = (self.parameter, self.minimum.theta.len());
        let near = self.last(distance);
        let covariance = self.minimum.covariance(1.0);
        let variance = covariance[j * k + j];
        let moved = value - near.theta[j];
        let place = |i: usize| {
            let run = near.theta[j] - self.minimum.theta[j];
            let slope = if run != 0.0 {
                (near.theta[i] - self.minimum.theta[i]) / run
            } else if variance > 0.0 {
                covariance[i * k + j] / variance
            } else {
                0.0
            };
            if i == j {
                value
            } else {
                (near.theta[i] + slope * moved).clamp(self.bounds.lower[i], self.bounds.upper[i])
            }
        };
        (0..k).map(place).collect()
    }
}
