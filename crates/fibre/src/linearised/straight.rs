//! Straight fibres in closed form, solved many times: only pressure and contraction change.
//!
//! With f, v and rho = 1/cos(phi_R) of the closed form, all functions of (eps, L, kappa), with kappa
//! proportional to p, and with the depth h of the pleats:
//!
//! ```text
//! F = p A f     N = F + p B rho^2     r = C rho - h     V = W v             A = a l0^2,  B = a pi (R + h)^2,  C = R + h,  W = a l0^3
//! ```

use bulge_numerics::Real;
use std::f64::consts::{FRAC_PI_2, PI};

use super::{Found, Linear, Linearised, Start};
use crate::closed_form::{Graded, Near, solve_near};
use crate::outcome::{Approach, Scheme};
use crate::parts::{Jet, LANES, Parts};
use crate::problem::Problem;
use crate::shape::Convergence;

/// The numbers that don't depend on pressure and contraction.
#[derive(Debug, Clone)]
pub(super) struct Straight {
    slenderness: Jet,
    /// kappa/p \[1/Pa\].
    compliance: Jet,
    /// A, B, C, h and W of the equations above.
    force: Jet,
    section: Jet,
    crest: Jet,
    depth: Jet,
    volume: Jet,
}

impl Straight {
    /// Made from the parts of a problem with derivatives. `None` if there is no closed form.
    pub(super) fn of(problem: &Problem, moving: &Parts<Jet>) -> Option<Self> {
        if problem.is_cylinder() || problem.scheme(Approach::Auto) != Ok(Scheme::ClosedForm) {
            return None;
        }
        let net = moving.net(Jet::from(problem.pressure));
        let crest = net.depth + 1.0;
        let length = net.half_fibre * 2.0;
        let kappa = net.area_factor * net.compliance * crest * crest * FRAC_PI_2;
        let wide = crest * moving.radius;
        let long = length * moving.radius;
        Some(Self {
            slenderness: length / crest,
            compliance: kappa / problem.pressure,
            force: net.area_factor * long * long,
            section: net.area_factor * wide * wide * PI,
            crest: wide,
            depth: net.depth * moving.radius,
            volume: net.volume_factor() * long * long * long,
        })
    }

    /// The answer, started from a neighbour. `None` if it needs a closer look.
    pub(super) fn at(&self, start: Option<&Start>, pressure: f64, contraction: f64) -> Option<Linearised> {
        let kappa = pressure * self.compliance.value();
        let usual =
            pressure > 0.0 && pressure.is_finite() && (contraction > 0.0 || kappa > 0.0) && contraction < 1.0;
        if !usual {
            return None;
        }
        let near = match start.map(|start| &start.0) {
            Some(Found::ClosedForm(near)) => Some(near),
            _ => None,
        };
        let of = [contraction, self.slenderness.value(), kappa];
        let found = solve_near(near, of).ok()?;
        if found.strain > 1.0 {
            return None;
        }
        // N cos(psi) = F + p A(R) at the fitting, where N = p B/(2 y^2); all over p.
        let tension = 0.5 * self.section.value() / (found.y * found.y);
        let cos = 1.0 - 2.0 * found.m * found.t * found.t / (1.0 + found.t * found.t);
        let integral = tension * cos - self.section.value() - self.force.value() * found.force.value;
        let graded = |g: &Graded, scale: &Jet| self.scaled(g, scale, pressure);
        let mut force = graded(&found.force, &self.force);
        let rho = found.radius;
        let square = Graded {
            value: rho.value * rho.value,
            by_contraction: 2.0 * rho.value * rho.by_contraction,
            by_slenderness: 2.0 * rho.value * rho.by_slenderness,
            by_compliance: 2.0 * rho.value * rho.by_compliance,
        };
        let mut equator = graded(&square, &self.section);
        under_pressure(&mut force, pressure);
        under_pressure(&mut equator, pressure);
        equator.value += force.value;
        equator.by_contraction += force.by_contraction;
        equator.by_pressure += force.by_pressure;
        for (by, of_force) in equator.by_lane.iter_mut().zip(force.by_lane) {
            *by += of_force;
        }
        let mut mid = graded(&rho, &self.crest);
        mid.value -= self.depth.value();
        for (by, of_depth) in mid.by_lane.iter_mut().zip(self.depth.gradient()) {
            *by -= of_depth;
        }
        Some(Linearised {
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
        })
    }

    /// `scale g`, where g depends on the variables through slenderness and kappa.
    #[inline]
    fn scaled(&self, g: &Graded, scale: &Jet, pressure: f64) -> Linear {
        let [by_scale, by_slenderness, by_compliance] =
            [scale, &self.slenderness, &self.compliance].map(Jet::gradient);
        let by = |lane: usize| {
            let through =
                g.by_slenderness * by_slenderness[lane] + g.by_compliance * pressure * by_compliance[lane];
            by_scale[lane] * g.value + scale.value() * through
        };
        Linear {
            value: scale.value() * g.value,
            by_contraction: scale.value() * g.by_contraction,
            by_pressure: scale.value() * g.by_compliance * self.compliance.value(),
            by_lane: std::array::from_fn::<f64, LANES, _>(by),
        }
    }
}

/// Multiplies a number by p.
#[inline]
fn under_pressure(linear: &mut Linear, pressure: f64) {
    linear.by_pressure = linear.value + pressure * linear.by_pressure;
    linear.value *= pressure;
    linear.by_contraction *= pressure;
    for by in &mut linear.by_lane {
        *by *= pressure;
    }
}
