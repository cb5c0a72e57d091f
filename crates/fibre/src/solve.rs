//! The questions: given the pressure and one of contraction, length, force or volume, find the rest. Also the
//! contraction limit and exact derivatives.

use bulge_muscles::{Muscle, Parameter};
use bulge_numerics::Dual;

use crate::FibreError;
use crate::follow::is_lost;
use crate::outcome::{Approach, Outcome, Scheme, Solution};
use crate::parts::{OWN_PARTS, PARTS, Parts};
use crate::problem::Problem;
use crate::search::{FAR, Goal, LEAST_ROOM, Seen};
use crate::shape::Response;
use crate::shooting::{EXACT, Ending, Total, USUAL};
use crate::start::longest;
use crate::unknowns::Unknowns;

/// Ambient pressure for the stiffness at constant gas amount \[Pa\] (standard atmosphere).
pub const AMBIENT_PRESSURE: f64 = 101_325.0;
/// Exponent of adiabatic air.
pub const ADIABATIC: f64 = 1.4;

/// The quantity that is given besides the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    /// Contraction (l0 - l)/l0 \[-\].
    Contraction(f64),
    /// Distance between the fittings \[m\].
    Length(f64),
    /// Axial force \[N\], pull positive.
    Force(f64),
    /// Enclosed volume with circular cross-sections of the fibre radius \[m^3\].
    Volume(f64),
}

/// Where the equilibria that pull end as a muscle contracts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RangeEnd {
    /// The contraction at which the force vanishes.
    ForceVanishes(f64),
    /// The contraction at which the fibres slacken, if that comes first. From there on the bladder carries
    /// more than the pressure.
    FibresSlacken(f64),
}

impl RangeEnd {
    /// The contraction.
    #[must_use]
    pub fn contraction(self) -> f64 {
        match self {
            Self::ForceVanishes(contraction) | Self::FibresSlacken(contraction) => contraction,
        }
    }

    /// Why there is no pulling equilibrium at a contraction beyond it.
    #[must_use]
    pub fn beyond(self, contraction: f64) -> FibreError {
        match self {
            Self::ForceVanishes(limit) => FibreError::BeyondLimit { contraction, limit },
            Self::FibresSlacken(limit) => FibreError::Slack { contraction, limit: Some(limit) },
        }
    }
}

/// Exact derivatives of force and volume at an equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// dF/d(contraction) \[N\], dV/d(contraction) \[m^3\].
    pub by_contraction: [f64; 2],
    /// dF/dp \[N/Pa\], dV/dp \[m^3/Pa\], at constant contraction.
    pub by_pressure: [f64; 2],
    /// dF/da and dV/da for each number of the muscle's [`Parts`] by its name, per SI unit, at constant
    /// contraction.
    pub by_part: Vec<(&'static str, [f64; 2])>,
}

impl Gradient {
    /// dF/da and dV/da for a parameter of the muscle whose parts were solved, by the chain rule. `None` if
    /// the muscle doesn't state it. The radius of a pleated muscle is that at its fittings.
    #[must_use]
    pub fn by(&self, muscle: &Muscle, parameter: Parameter) -> Option<[f64; 2]> {
        if !muscle.is_stated(parameter) || parameter == Parameter::FittingRadius && muscle.is_pleated() {
            return None;
        }
        let (mut sum, mut by_part) = ([0.0; 2], self.by_part.iter());
        Parts::seeded(muscle, &[parameter]).map(|_, part| {
            if let Some((_, by)) = by_part.next() {
                sum.iter_mut().zip(by).for_each(|(sum, by)| *sum += by * part.gradient()[0]);
            }
        });
        Some(sum)
    }
}

/// An equilibrium with the data needed to go on from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) response: Response,
    pub(crate) solution: Solution,
}

impl Found {
    /// Start for a neighbour's shooting.
    pub(crate) fn unknowns(&self) -> Option<Unknowns> {
        self.solution.unknowns()
    }
}

impl Problem {
    /// Solves for a given quantity. A contraction, force or volume beyond the limit at which the force
    /// vanishes is an error.
    ///
    /// # Errors
    /// See [`FibreError`]; every variant carries the numbers.
    pub fn solve(&self, given: Given, approach: Approach) -> Result<Response, FibreError> {
        self.find(given, approach).map(|found| found.response)
    }

    /// The contraction at which the force vanishes.
    ///
    /// # Errors
    /// [`FibreError::NotConverged`], or [`FibreError::Slack`] with its limit where the fibres become slack
    /// before.
    pub fn contraction_limit(&self, approach: Approach) -> Result<f64, FibreError> {
        self.at_limit(self.scheme(approach)?, &mut { Seen::NOTHING }).map(|found| found.response.contraction)
    }

    /// Where the equilibria that pull end as the muscle contracts. This is the one limit that every message
    /// and table names.
    ///
    /// # Errors
    /// [`FibreError::NotConverged`], or that there is no equilibrium at all.
    pub fn range_end(&self, approach: Approach) -> Result<RangeEnd, FibreError> {
        match self.contraction_limit(approach) {
            Ok(limit) => Ok(RangeEnd::ForceVanishes(limit)),
            Err(FibreError::Slack { limit: Some(limit), .. }) => Ok(RangeEnd::FibresSlacken(limit)),
            Err(error) => Err(error),
        }
    }

    /// The equilibrium at which the force vanishes.
    pub(crate) fn at_limit(&self, scheme: Scheme, seen: &mut Seen) -> Result<Found, FibreError> {
        let way = [self.contraction_start(), FAR];
        match self.root(scheme, way, seen, |found| found.response.force_n) {
            Err(error @ (FibreError::NotConverged { .. } | FibreError::TooSoft { .. })) => {
                let slack = |limit| FibreError::Slack { contraction: limit, limit: Some(limit) };
                self.limit_on_a_path(scheme, seen).map_or(Err(error), |end| end.map_err(slack))
            }
            other => other,
        }
    }

    /// Exact derivatives of force and volume with respect to the contraction, the pressure and every number
    /// of the muscle's parts, by dual numbers and the implicit function theorem. The number of fibres counts
    /// as continuous.
    ///
    /// # Errors
    /// See [`FibreError`].
    pub fn gradient(&self, contraction: f64, approach: Approach) -> Result<Gradient, FibreError> {
        if self.parts.has_formulas() {
            self.gradient_of::<{ 3 + PARTS }>(contraction, approach)
        } else {
            self.gradient_of::<{ 3 + OWN_PARTS }>(contraction, approach)
        }
    }

    fn gradient_of<const N: usize>(
        &self,
        contraction: f64,
        approach: Approach,
    ) -> Result<Gradient, FibreError> {
        let (mut names, mut place) = (Vec::with_capacity(PARTS), 2);
        let parts: Parts<Dual<N>> = self.parts.map(|name, number| {
            names.push(name);
            place += 1;
            Dual::variable(number, place)
        });
        let pressure = Dual::variable(self.pressure, 2);
        let net = parts.net(pressure);
        let scheme = self.scheme(approach)?;
        let outcome = self.outcome_of_many(scheme, contraction, &net, None, EXACT).or_else(|error| {
            // A cold start doesn't lead everywhere that a walk does.
            let from = if is_lost(&error) {
                self.followed(scheme, contraction, approach, None)?.unknowns()
            } else {
                None
            };
            match from {
                Some(_) => self.outcome_of_many(scheme, contraction, &net, from, EXACT),
                None => Err(error),
            }
        })?;
        let radius = parts.radius;
        let out = |scale: Dual<N>, total: &Total<N>| {
            let mut gradient = total.by_parameter;
            gradient[0] = total.by_contraction;
            *(scale * Dual::new(total.value, gradient)).gradient()
        };
        let force = out(pressure * radius * radius, &outcome.force);
        let volume = out(radius * radius * radius, &outcome.volume);
        let by_part = names.into_iter().enumerate().map(|(i, name)| (name, [force[3 + i], volume[3 + i]]));
        Ok(Gradient {
            by_contraction: [force[0], volume[0]],
            by_pressure: [force[2], volume[2]],
            by_part: by_part.collect(),
        })
    }

    pub(crate) fn find(&self, given: Given, approach: Approach) -> Result<Found, FibreError> {
        let scheme = self.scheme(approach)?;
        let l0 = self.parts.length;
        match given {
            Given::Contraction(contraction) => self.pulling(scheme, approach, contraction),
            Given::Length(length) => {
                if length <= 0.0 {
                    return Err(FibreError::NotPositive { what: "length", value: length });
                }
                if !length.is_finite() {
                    return Err(FibreError::NotFinite { what: "length", value: length });
                }
                self.pulling(scheme, approach, (l0 - length) / l0)
            }
            Given::Force(force) => self.with_force(scheme, approach, force),
            Given::Volume(volume) => self.with_volume(scheme, volume),
        }
    }

    fn pulling(&self, scheme: Scheme, approach: Approach, contraction: f64) -> Result<Found, FibreError> {
        let error = match self.at(scheme, contraction, None) {
            Ok(found) if self.pulls(&found.response) => return Ok(found),
            Ok(found) => FibreError::WouldPush { contraction, force_n: found.response.force_n },
            Err(error) if is_lost(&error) || matches!(error, FibreError::Slack { .. }) => error,
            Err(error) => return Err(error),
        };
        let error = self.within_limit(error, contraction, approach)?;
        match self.longest() {
            Some(limit) if contraction <= limit => Err(FibreError::TooLong { contraction, limit }),
            // Go step by step from an equilibrium that exists.
            _ if is_lost(&error) => self.walked(scheme, contraction, true).ok_or(error),
            _ => Err(error),
        }
    }

    pub(crate) fn pulls(&self, response: &Response) -> bool {
        response.pulls(self.pressure * self.parts.radius.powi(2))
    }

    fn with_force(&self, scheme: Scheme, approach: Approach, force: f64) -> Result<Found, FibreError> {
        if !force.is_finite() {
            return Err(FibreError::NotFinite { what: "force", value: force });
        }
        if force < 0.0 {
            return Err(FibreError::Pushes { force_n: force, limit: self.contraction_limit(approach)? });
        }
        let mut seen = Seen::NOTHING;
        let way = [self.contraction_start(), FAR];
        match self.root(scheme, way, &mut seen, |found| found.response.force_n - force) {
            Err(error) if is_lost(&error) || matches!(error, FibreError::Overstretched { .. }) => {
                let Seen { force: high_n, contraction, .. } = seen;
                let too_large = (high_n.is_finite() && high_n < force).then_some(FibreError::ForceTooLarge {
                    force_n: force,
                    high_n,
                    contraction,
                });
                // A walk that was lost has not seen the largest force, unless the fibres were as good as straight.
                let is_straight = self.longest().is_some_and(|longest| contraction - longest < LEAST_ROOM);
                if is_lost(&error)
                    && !(is_straight && too_large.is_some())
                    && let Some(found) = self.on_a_path(scheme, Goal::Force(force), true, &seen)
                {
                    return Ok(found);
                }
                if let Some(error) = too_large {
                    return Err(error);
                }
                match self.at_limit(scheme, &mut { Seen::NOTHING }) {
                    // The force is less than where the fibres slacken.
                    Err(slack @ FibreError::Slack { limit: Some(_), .. }) => Err(slack),
                    _ => Err(error),
                }
            }
            other => other,
        }
    }

    /// Whether the force grows without bound as the contraction goes to 0: straight inextensible fibres.
    #[must_use]
    pub fn is_singular(&self) -> bool {
        self.net.turn == 0.0 && self.net.compliance == 0.0
    }

    /// The contraction at which inextensible fibres are drawn straight, if the muscle has one: equilibria lie
    /// beyond it.
    #[must_use]
    pub fn longest(&self) -> Option<f64> {
        if self.net.compliance != 0.0 {
            return None;
        }
        if self.is_singular() {
            return Some(0.0);
        }
        if self.is_cylinder() {
            return Some(1.0 - 1.0 / self.net.cos_rest);
        }
        Some(longest(&self.net))
    }

    /// The equilibrium at a contraction with everything that is reported.
    pub(crate) fn at(
        &self,
        scheme: Scheme,
        contraction: f64,
        from: Option<Unknowns>,
    ) -> Result<Found, FibreError> {
        self.at_with(scheme, contraction, (from.map(Solution::Shooting), USUAL))
    }

    /// The same with a prescribed end of the search.
    pub(crate) fn at_with(
        &self,
        scheme: Scheme,
        contraction: f64,
        from: (Option<Solution>, Ending),
    ) -> Result<Found, FibreError> {
        if self.is_scale_free() {
            let outcome = self.outcome(scheme, contraction, &self.net.lift::<2>(), from)?;
            return Ok(self.found(contraction, &outcome));
        }
        // The pressure is the variable number 2; the dimensionless groups depend on it.
        let parts: Parts<Dual<3>> = self.parts.map(|_, number| Dual::from(number));
        let net = parts.net(Dual::variable(self.pressure, 2));
        let outcome = self.outcome(scheme, contraction, &net, from)?;
        Ok(self.found(contraction, &outcome))
    }

    /// The response in SI. Place 2 of the derivatives, if there is one, belongs to the pressure at constant
    /// p R^2.
    fn found<const N: usize>(&self, contraction: f64, outcome: &Outcome<N>) -> Found {
        let p = self.pressure;
        let radius = self.parts.radius;
        let l0 = self.parts.length;
        let [unit_force, unit_volume] = [p * radius * radius, radius * radius * radius];
        let [force, volume] = [unit_force * outcome.force.value, unit_volume * outcome.volume.value];
        let by_pressure = |total: &Total<N>| total.by_parameter.get(2).copied().unwrap_or(0.0);
        let a = self.net.volume_factor();
        // Per length: l = l0 (1 - eps).
        let stiffness = -unit_force * outcome.force.by_contraction / l0;
        let volume_slope = -a * unit_volume * outcome.volume.by_contraction / l0;
        let polygon = a * volume;
        let force_p = force / p + unit_force * by_pressure(&outcome.force);
        let volume_p = unit_volume * by_pressure(&outcome.volume);
        let closed = |g| closed_stiffness(g, p, [stiffness, force_p], [polygon, volume_slope, a * volume_p]);
        let end_radius = self.net.end_radius;
        let response = Response {
            pressure_pa: p,
            force_n: force,
            length_m: l0 * (1.0 - contraction),
            contraction,
            volume_m3: volume,
            volume_polygon_m3: polygon,
            max_radius_m: radius
                * outcome.mid_radius.value.max(if self.is_cylinder() { 0.0 } else { end_radius }),
            mid_radius_m: radius * outcome.mid_radius.value,
            fibre_tension_n: unit_force * outcome.tension / self.parts.fibre_number(),
            fibre_strain: self.net.compliance * outcome.tension,
            stiffness_n_per_m: stiffness,
            volume_slope_m2: volume_slope,
            stiffness_isothermal_n_per_m: closed(1.0),
            stiffness_adiabatic_n_per_m: closed(ADIABATIC),
            end_slope_rad: outcome.end_slope,
            method: outcome.method,
            convergence: outcome.convergence,
        };
        Found { response, solution: outcome.solution }
    }
}

/// dF/dl with the gas enclosed, (p + pa) V^g constant: dp/dl = -g (p + pa) V_l/(V + g (p + pa) V_p) in
/// F_l + F_p dp/dl.
pub(crate) fn closed_stiffness(
    g: f64,
    pressure: f64,
    [force_l, force_p]: [f64; 2],
    [volume, volume_l, volume_p]: [f64; 3],
) -> f64 {
    let absolute = g * (pressure + AMBIENT_PRESSURE);
    force_l - force_p * absolute * volume_l / (volume + absolute * volume_p)
}
