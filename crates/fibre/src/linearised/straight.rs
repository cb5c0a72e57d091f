//! Straight fibres in closed form, asked many times: only pressure and contraction change.
//!
//! With the closed form's f, v and rho = 1/cos(phi_R), all functions of (eps, L, kappa), kappa proportional to p, and h the depth of the pleats:
//!
//! ```text
//! F = p A f     N = F + p B rho^2     r = C rho - h     V = W v             A = a l0^2,  B = a pi (R + h)^2,  C = R + h,  W = a l0^3
//! ```

use bulge_muscles::Parameter;
use bulge_numerics::{Dual, Real};
use std::f64::consts::{FRAC_PI_2, PI};

use super::{Found, Linear, Linearised, Start};
use crate::FibreError;
use crate::closed_form::{Graded, Near, solve_near};
use crate::outcome::Approach;
use crate::problem::{Problem, Variable};
use crate::shape::{Convergence, Method};

/// A number with its derivatives by the variables, in the order in which they were asked for.
#[derive(Debug, Clone)]
struct Constant {
    value: f64,
    by: Vec<f64>,
}

/// What doesn't depend on pressure and contraction.
#[derive(Debug, Clone)]
pub(super) struct Straight {
    variables: Vec<Variable>,
    slenderness: Constant,
    /// kappa/p \[1/Pa\].
    compliance: Constant,
    /// A, B, C, h and W of the equations above.
    force: Constant,
    section: Constant,
    crest: Constant,
    depth: Constant,
    volume: Constant,
}

/// Most derivatives of a dual number that holds any question.
const MOST: usize = 2 + Variable::COUNT;

impl Straight {
    /// None if there is no closed form.
    ///
    /// # Errors
    /// [`FibreError::NoVariable`] and [`FibreError::AskedTwice`].
    pub(super) fn of(problem: &Problem, variables: &[Variable]) -> Result<Option<Self>, FibreError> {
        let seeds = problem.seeds(variables)?;
        if problem.is_cylinder() || problem.method(Approach::Auto) != Ok(Method::ClosedForm) {
            return Ok(None);
        }
        let seeded = problem.seeded::<MOST>(|variable| seeds.places[variable.index()]);
        let net = problem.net_of(&seeded);
        let radius = seeded(Variable::Parameter(Parameter::Radius));
        let constant = |dual: Dual<MOST>| Constant {
            value: dual.value(),
            by: variables.iter().map(|v| dual.gradient()[seeds.places[v.index()]]).collect(),
        };
        let crest = net.depth + 1.0;
        let length = net.half_fibre * 2.0;
        let pressure = seeded(Variable::Pressure);
        let kappa = net.area_factor * net.compliance * crest * crest * FRAC_PI_2;
        let wide = crest * radius;
        let long = length * radius;
        Ok(Some(Self {
            variables: variables.to_vec(),
            slenderness: constant(length / crest),
            compliance: constant(kappa / pressure),
            force: constant(net.area_factor * long * long),
            section: constant(net.area_factor * wide * wide * PI),
            crest: constant(wide),
            depth: constant(net.depth * radius),
            volume: constant(net.volume_factor() * long * long * long),
        }))
    }

    /// The answer from a neighbour; none where it has to be looked at more closely.
    pub(super) fn at(&self, start: Option<&Start>, pressure: f64, contraction: f64) -> Option<Linearised> {
        let kappa = pressure * self.compliance.value;
        let usual =
            pressure > 0.0 && pressure.is_finite() && (contraction > 0.0 || kappa > 0.0) && contraction < 1.0;
        if !usual {
            return None;
        }
        let near = match start.map(|start| &start.0) {
            Some(Found::ClosedForm(near)) => Some(near),
            _ => None,
        };
        let of = [contraction, self.slenderness.value, kappa];
        let found = solve_near(near, of).ok()?;
        if found.strain > 1.0 {
            return None;
        }
        let asked = self.variables.len();
        // N cos(psi) = F + p A(R) at the fitting, where N = p B/(2 y^2); all over p.
        let tension = 0.5 * self.section.value / (found.y * found.y);
        let cos = 1.0 - 2.0 * found.m * found.t * found.t / (1.0 + found.t * found.t);
        let integral = tension * cos - self.section.value - self.force.value * found.force.value;
        let graded = |g: &Graded, scale: &Constant| self.scaled(g, scale, pressure);
        let mut force = graded(&found.force, &self.force);
        let rho = found.radius;
        let square = Graded {
            value: rho.value * rho.value,
            by_contraction: 2.0 * rho.value * rho.by_contraction,
            by_slenderness: 2.0 * rho.value * rho.by_slenderness,
            by_compliance: 2.0 * rho.value * rho.by_compliance,
        };
        let mut equator = graded(&square, &self.section);
        under_pressure(&mut force, pressure, asked);
        under_pressure(&mut equator, pressure, asked);
        equator.value += force.value;
        equator.by_contraction += force.by_contraction;
        equator.by_pressure += force.by_pressure;
        for j in 0..asked {
            equator.by_variable[j] += force.by_variable[j];
        }
        let mut mid = graded(&rho, &self.crest);
        mid.value -= self.depth.value;
        for j in 0..asked {
            mid.by_variable[j] -= self.depth.by[j];
        }
        let mut linearised = Linearised {
            contraction,
            force_n: force,
            equator_force_n: equator,
            mid_radius_m: mid,
            volume_polygon_m3: graded(&found.volume, &self.volume),
            convergence: Convergence {
                iterations: found.iterations,
                evaluations: found.evaluations,
                steps: 0,
                residual: found.residual,
                first_integral: (integral / tension).abs(),
            },
            start: Some(Start(Found::ClosedForm(Near::new(&found, of)))),
        };
        for (j, variable) in self.variables.iter().enumerate() {
            if *variable == Variable::Pressure {
                linearised.each(|linear| linear.by_variable[j] = linear.by_pressure);
            }
        }
        Some(linearised)
    }

    /// `scale g`, where g depends on the variables through slenderness and kappa.
    #[inline]
    fn scaled(&self, g: &Graded, scale: &Constant, pressure: f64) -> Linear {
        let mut by_variable = [0.0; Variable::COUNT];
        let by_variables = scale.by.iter().zip(&self.slenderness.by).zip(&self.compliance.by);
        for (slot, ((scale_by, slenderness_by), compliance_by)) in by_variable.iter_mut().zip(by_variables) {
            *slot = scale_by * g.value
                + scale.value
                    * (g.by_slenderness * slenderness_by + g.by_compliance * pressure * compliance_by);
        }
        Linear {
            value: scale.value * g.value,
            by_contraction: scale.value * g.by_contraction,
            by_pressure: scale.value * g.by_compliance * self.compliance.value,
            by_variable,
            asked: self.variables.len(),
        }
    }
}

/// p times a number.
#[inline]
fn under_pressure(linear: &mut Linear, pressure: f64, asked: usize) {
    linear.by_pressure = linear.value + pressure * linear.by_pressure;
    linear.value *= pressure;
    linear.by_contraction *= pressure;
    for by in &mut linear.by_variable[..asked] {
        *by *= pressure;
    }
}

impl Linearised {
    fn each(&mut self, mut change: impl FnMut(&mut Linear)) {
        change(&mut self.force_n);
        change(&mut self.equator_force_n);
        change(&mut self.mid_radius_m);
        change(&mut self.volume_polygon_m3);
    }
}
