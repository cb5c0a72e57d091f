//! One equilibrium at a given contraction by whichever method applies, dimensionless, with total derivatives.

use bulge_numerics::{Dual, Real};

use crate::FibreError;
use crate::branches;
use crate::closed_form::{self, ClosedForm, Graded};
use crate::cylinder;
use crate::groups::Groups;
use crate::meridian::{COS, SIN, TENSION};
use crate::net::{Net, OWN_NUMBERS};
use crate::problem::{MOST_STRAIN, Problem};
use crate::shape::{Convergence, Method};
use crate::shooting::{self, Ending, Total, Way};
use crate::unknowns::Unknowns;

/// The group of [`FibreError::TooSoft`] beyond which straight fibres balloon:
/// `F(phi_R|m)/(L y) = 1 + kappa/y^2` has a solution in y up to kappa L^2 = F^2/4, and F is at most 1.854
/// where the force vanishes (m = 1/2).
const BALLOONING: f64 = 0.859;

/// The same for a long net. Its hoop term T q^2 r/((1 + e) sigma), with sigma about 1 + e, carries 2 pi p r
/// up to e/(1 + e)^2 = 1/4 (at e = 1).
pub(crate) const BURSTING: f64 = 0.25;

/// Part of the limit from which on fibres count as soft.
pub(crate) const SOFT: f64 = 0.7;

/// Contraction below 0 up to which a muscle doesn't count as longer than at rest. Rounding of a length makes
/// as much.
const AT_REST: f64 = 1e-9;

/// Which method computes an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Approach {
    /// The closed form where there is one, else shooting; the meridian is a quadrature where it can be.
    #[default]
    Auto,
    /// The closed form, or an error.
    ClosedForm,
    /// Shooting that ends with an integration of the equilibrium ODE: an answer that is independent of closed
    /// forms and quadratures. Its derivatives are those of a quadrature, where there is one.
    Shooting,
}

/// The way to an equilibrium that an [`Approach`] selects for a muscle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// Elliptic integrals, or the algebraic cylinder.
    ClosedForm,
    /// Shooting with this last trajectory.
    Shooting(Way),
}

/// The data that drawing the meridian needs in addition.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Solution {
    ClosedForm(ClosedForm),
    Shooting(Unknowns),
    Cylinder { radius: f64, tension: f64 },
}

impl Solution {
    /// Start for a neighbour's shooting.
    pub(crate) fn unknowns(self) -> Option<Unknowns> {
        if let Self::Shooting(unknowns) = self { Some(unknowns) } else { None }
    }
}

/// An equilibrium; dimensionless.
#[derive(Debug, Clone)]
pub(crate) struct Outcome<const N: usize> {
    pub(crate) force: Total<N>,
    /// Whole volume with circular sections.
    pub(crate) volume: Total<N>,
    pub(crate) mid_radius: Total<N>,
    /// Largest tension of all fibres.
    pub(crate) tension: f64,
    /// Angle at the left fitting, positive where the muscle widens.
    pub(crate) end_slope: f64,
    pub(crate) method: Method,
    pub(crate) convergence: Convergence,
    pub(crate) solution: Solution,
    /// How the unknowns of the shooting follow, if many derivatives were asked for.
    pub(crate) follow: Option<Follow>,
}

/// How the two unknowns of a shooting follow the contraction and the numbers of the net, without those of
/// formulas. The derivatives by the numbers are known as far as the variables moved the numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Follow {
    pub(crate) by_contraction: [f64; 2],
    pub(crate) by_number: [[f64; OWN_NUMBERS]; 2],
}

impl<const N: usize> Outcome<N> {
    /// Adds the derivatives by other variables at the same equilibrium.
    fn add_derivatives(&mut self, other: &Self) {
        let add = |to: &mut [f64], more: &[f64]| to.iter_mut().zip(more).for_each(|(sum, by)| *sum += by);
        for (total, more) in [&mut self.force, &mut self.volume, &mut self.mid_radius].into_iter().zip([
            &other.force,
            &other.volume,
            &other.mid_radius,
        ]) {
            add(&mut total.by_parameter, &more.by_parameter);
        }
        if let (Some(follow), Some(more)) = (&mut self.follow, &other.follow) {
            follow.by_number.iter_mut().zip(&more.by_number).for_each(|(by, more)| add(by, more));
        }
    }
}

impl Problem {
    /// Whether an equilibrium takes a search by shooting, because there is no closed form.
    #[must_use]
    pub fn shoots(&self) -> bool {
        matches!(self.unchecked(Approach::Auto), Ok(Scheme::Shooting(_)))
    }

    /// The scheme that `approach` selects for this muscle, whose fibres can be at its fittings.
    pub(crate) fn scheme(&self, approach: Approach) -> Result<Scheme, FibreError> {
        if !self.is_cylinder() {
            self.check_turn()?;
        }
        self.unchecked(approach)
    }

    fn unchecked(&self, approach: Approach) -> Result<Scheme, FibreError> {
        if self.is_cylinder() {
            return match approach {
                Approach::Shooting => Err(FibreError::NothingToShoot),
                _ => Ok(Scheme::ClosedForm),
            };
        }
        let obstacle = self.obstacle_to_closed_form();
        match (approach, obstacle) {
            (Approach::Shooting, _) => Ok(Scheme::Shooting(Way::Ode)),
            (Approach::Auto, Some(_)) => Ok(Scheme::Shooting(Way::Quadrature)),
            (Approach::ClosedForm, Some(why)) => Err(FibreError::NoClosedForm { why }),
            (_, None) => Ok(Scheme::ClosedForm),
        }
    }

    /// Refuses a formula that turns the fibres more than they can at the fittings: l1^2 = (1 + T/EA)^2 - q^2 r^2 > 0.
    fn check_turn(&self) -> Result<(), FibreError> {
        if self.parts.twist.is_none() {
            return Ok(());
        }
        let turned = self.net.turn.abs() * self.net.end_radius;
        if turned.is_nan() {
            return Err(FibreError::FormulaWithoutValue { what: "twist", value: turned });
        }
        let stretched = if self.net.compliance > 0.0 { 1.0 + MOST_STRAIN } else { 1.0 };
        if turned < stretched {
            return Ok(());
        }
        let end_m = self.net.end_radius * self.parts.radius;
        Err(FibreError::FittingTooWide { end_m, widest_m: stretched * end_m / turned })
    }

    fn obstacle_to_closed_form(&self) -> Option<&'static str> {
        let net = &self.net;
        if net.turn != 0.0 {
            Some("its fibres run at an angle")
        } else if net.has_wall() {
            Some("its wall stores energy")
        } else if net.has_area() {
            Some("its area is a formula")
        } else if net.cloth.is_some() {
            Some("its cloth stops unfolding")
        } else if net.lobes.is_some() {
            Some("its cloth bulges in lobes")
        } else {
            None
        }
    }

    /// The equilibrium at a contraction. `net` is that of the problem, with derivatives by variables in the
    /// places 2 .. of the dual numbers. `from` is a start for the shooting, such as a neighbour's solution, or the closed form
    /// if it is solved already.
    pub(crate) fn outcome<const N: usize>(
        &self,
        scheme: Scheme,
        contraction: f64,
        net: &Net<Dual<N>>,
        (from, ending): (Option<Solution>, Ending),
    ) -> Result<Outcome<N>, FibreError> {
        let plain = &self.net;
        self.judged(contraction, || match (scheme, from) {
            _ if self.is_cylinder() => by_cylinder(net, contraction),
            (Scheme::ClosedForm, Some(Solution::ClosedForm(found))) => Ok(of_closed_form(net, found)),
            (Scheme::ClosedForm, _) => by_closed_form(plain, net, contraction),
            (Scheme::Shooting(way), from) => {
                let from = from.and_then(Solution::unknowns);
                by_shooting(plain, net, contraction, from, (ending, way)).map(|(outcome, _)| outcome)
            }
        })
    }

    /// What the closed form depends on at a contraction: (contraction, slenderness, elastic group). `None` where another way
    /// leads to the equilibrium.
    pub(crate) fn asks_closed_form(&self, scheme: Scheme, contraction: f64) -> Option<[f64; 3]> {
        (scheme == Scheme::ClosedForm && !self.is_cylinder()).then(|| {
            let [slenderness, kappa] = groups_of_closed_form(&self.net);
            [contraction, slenderness, kappa]
        })
    }

    /// The same for many variables.
    pub(crate) fn outcome_of_many<const N: usize>(
        &self,
        scheme: Scheme,
        contraction: f64,
        net: &Net<Dual<N>>,
        from: Option<Unknowns>,
        ending: Ending,
    ) -> Result<Outcome<N>, FibreError> {
        self.judged(contraction, || match scheme {
            _ if self.is_cylinder() => by_cylinder(net, contraction),
            Scheme::ClosedForm => by_closed_form(&self.net, net, contraction),
            Scheme::Shooting(_) => {
                let groups = Groups::of(net);
                let plain = &self.net;
                match groups.count() {
                    0..=2 => by_groups::<N, 4>(plain, net, &groups, contraction, (from, ending)),
                    3..=4 => by_groups::<N, 6>(plain, net, &groups, contraction, (from, ending)),
                    // More take further integrations, and are rare: each size is compiled by itself.
                    _ => by_groups::<N, 8>(plain, net, &groups, contraction, (from, ending)),
                }
            }
        })
    }

    /// Refuses questions that no method can answer, and explains answers that can't be equilibria.
    fn judged<const N: usize>(
        &self,
        contraction: f64,
        outcome: impl FnOnce() -> Result<Outcome<N>, FibreError>,
    ) -> Result<Outcome<N>, FibreError> {
        has_length(contraction)?;
        if self.is_singular() && contraction <= 0.0 {
            return Err(FibreError::TooLong { contraction, limit: 0.0 });
        }
        let (group, limit) = self.elastic_group();
        match outcome() {
            Err(FibreError::NotConverged { .. }) if group > SOFT * limit => {
                Err(FibreError::TooSoft { group, limit })
            }
            Err(FibreError::NotConverged { .. }) if self.net.undulates(contraction) => {
                Err(FibreError::Undulates { contraction })
            }
            Err(unsolved @ FibreError::NotConverged { .. }) => {
                Err(branches::obstacle(&self.net, self.is_cylinder(), contraction).unwrap_or(unsolved))
            }
            Ok(outcome)
                if group > 0.0 && self.net.compliance * outcome.tension > 1.0 && contraction > -0.5 =>
            {
                Err(FibreError::TooSoft { group, limit })
            }
            // Drawn out to many times its length, the muscle holds the pressure by its rubber alone.
            Ok(outcome) if outcome.tension < 0.0 => Err(FibreError::Slack { contraction, limit: None }),
            Ok(outcome) if contraction < -AT_REST && self.net.compliance * outcome.tension > MOST_STRAIN => {
                Err(FibreError::Overstretched { contraction, strain: self.net.compliance * outcome.tension })
            }
            other => other,
        }
    }

    /// The group that decides whether fibres are too soft, with its limit: p sin(2 pi/n) l0^2/(4 EA) of one
    /// straight fibre, 2 pi p r0^2/(n EA sin^2(alpha0)) of a net.
    fn elastic_group(&self) -> (f64, f64) {
        let net = &self.net;
        if net.turn != 0.0 {
            return (net.softness(), BURSTING);
        }
        let size = net.half_fibre * net.half_fibre;
        (net.area_factor * net.compliance * std::f64::consts::TAU * size, BALLOONING)
    }
}

/// Refuses a contraction that leaves no length, whatever the muscle.
pub(crate) fn has_length(contraction: f64) -> Result<(), FibreError> {
    if !contraction.is_finite() {
        return Err(FibreError::NotFinite { what: "contraction", value: contraction });
    }
    if contraction >= 1.0 {
        return Err(FibreError::NoLength { contraction });
    }
    Ok(())
}

fn by_cylinder<const N: usize>(net: &Net<Dual<N>>, contraction: f64) -> Result<Outcome<N>, FibreError> {
    // The contraction takes place 0, which no variable uses.
    let found = cylinder::solve(net, Dual::variable(contraction, 0))?;
    let total = |d: Dual<N>| {
        let mut by_parameter = *d.gradient();
        let by_contraction = std::mem::take(&mut by_parameter[0]);
        Total { value: d.value(), by_contraction, by_parameter }
    };
    let (radius, tension) = (found.radius.value(), found.tension.value());
    Ok(Outcome {
        force: total(found.force),
        volume: total(found.volume),
        mid_radius: total(found.radius),
        tension,
        end_slope: 0.0,
        method: Method::ClosedForm,
        convergence: Convergence {
            iterations: found.iterations,
            evaluations: found.iterations,
            steps: 0,
            residual: found.residual,
            first_integral: 0.0,
        },
        solution: Solution::Cylinder { radius, tension },
        follow: None,
    })
}

/// Slenderness and elastic group of the closed form. Pleats of depth h give A = a pi (r + h)^2: the muscle of radius R + h,
/// whose fibres lie h inside.
fn groups_of_closed_form<D: Real>(net: &Net<D>) -> [D; 2] {
    let crest = net.depth + 1.0;
    // kappa = p sin(2 pi/n) R^2/(4 EA) of one fibre = (area factor) (2 pi)/4 * p R^2/(n EA).
    let kappa = net.area_factor * net.compliance * crest * crest * std::f64::consts::FRAC_PI_2;
    [net.half_fibre * 2.0 / crest, kappa]
}

fn by_closed_form<const N: usize>(
    plain: &Net<f64>,
    net: &Net<Dual<N>>,
    contraction: f64,
) -> Result<Outcome<N>, FibreError> {
    let [slenderness, kappa] = groups_of_closed_form(plain);
    closed_form::solve(contraction, slenderness, kappa).map(|found| of_closed_form(net, found))
}

fn of_closed_form<const N: usize>(net: &Net<Dual<N>>, found: ClosedForm) -> Outcome<N> {
    let [slenderness, kappa] = groups_of_closed_form(net);
    let (crest, length) = (net.depth + 1.0, net.half_fibre * 2.0);
    // In units of p R^2 and R^3: F = a (l0/R)^2 f, V = (l0/R)^3 v.
    let total = |scale: Dual<N>, g: &Graded, less: Dual<N>| {
        let carried = (slenderness - slenderness.value()) * g.by_slenderness
            + (kappa - kappa.value()) * g.by_compliance
            + g.value;
        let d = scale * carried - less;
        Total {
            value: d.value(),
            by_contraction: scale.value() * g.by_contraction,
            by_parameter: *d.gradient(),
        }
    };
    let nothing = Dual::from(0.0);
    let a = net.area(Dual::from(1.0)).value();
    // N = T = A(R)/(2 y^2); N cos(psi) - A - F at the fitting.
    let tension = 0.5 * a / (found.y * found.y);
    let force = total(net.area_factor * length.squared(), &found.force, nothing);
    let end_slope = found.end_slope();
    let integral = tension * end_slope.cos() - a - force.value;
    Outcome {
        force,
        volume: total(length.squared() * length, &found.volume, nothing),
        mid_radius: total(crest, &found.radius, net.depth),
        tension,
        end_slope,
        method: Method::ClosedForm,
        convergence: Convergence {
            iterations: found.iterations,
            evaluations: found.evaluations,
            steps: 0,
            residual: found.residual,
            first_integral: (integral / tension).abs(),
        },
        solution: Solution::ClosedForm(found),
        follow: None,
    }
}

fn by_shooting<const N: usize>(
    plain: &Net<f64>,
    net: &Net<Dual<N>>,
    contraction: f64,
    from: Option<Unknowns>,
    (ending, way): (Ending, Way),
) -> Result<(Outcome<N>, [Total<N>; 2]), FibreError> {
    let (unknowns, effort) = shooting::solve(plain, contraction, from, ending)?;
    let slack = FibreError::Slack { contraction, limit: None };
    let found = match shooting::finish(net, contraction, unknowns, way) {
        Err(_) if unknowns.is_slack(plain) => return Err(slack),
        found => found?,
    };
    // At the border the unknowns of a search that has just ended may lie on the wrong side of it.
    if found.unknowns.is_slack(plain) {
        return Err(slack);
    }
    let run = &found.trajectory;
    let volume = Total {
        value: 2.0 * found.half_volume.value,
        by_contraction: 2.0 * found.half_volume.by_contraction,
        by_parameter: found.half_volume.by_parameter.map(|v| 2.0 * v),
    };
    let outcome = Outcome {
        force: found.force,
        volume,
        mid_radius: found.mid_radius,
        tension: found.corrected(run.mid_tension).max(found.corrected(run.end[TENSION])),
        end_slope: found.corrected(run.end[SIN]).atan2(found.corrected(run.end[COS])),
        method: Method::Shooting,
        convergence: Convergence {
            iterations: effort.iterations + 1,
            evaluations: effort.evaluations + found.evaluations,
            steps: run.steps,
            residual: found.residual,
            first_integral: run.first_integral,
        },
        solution: Solution::Shooting(found.unknowns),
        follow: None,
    };
    Ok((outcome, found.follow))
}

/// Shoots with the derivatives by M - 2 groups. The derivatives by N - 2 variables follow from them.
fn by_groups<const N: usize, const M: usize>(
    plain: &Net<f64>,
    net: &Net<Dual<N>>,
    groups: &Groups<N>,
    contraction: f64,
    (from, ending): (Option<Unknowns>, Ending),
) -> Result<Outcome<N>, FibreError> {
    let by_some = |first: usize, from: Option<Unknowns>| -> Result<Outcome<N>, FibreError> {
        let moving = groups.net(net, first);
        let (found, follow) = by_shooting::<M>(plain, &moving, contraction, from, (ending, Way::Quadrature))?;
        Ok(Outcome {
            force: groups.expand(&found.force, first),
            volume: groups.expand(&found.volume, first),
            mid_radius: groups.expand(&found.mid_radius, first),
            tension: found.tension,
            end_slope: found.end_slope,
            method: found.method,
            convergence: found.convergence,
            solution: found.solution,
            follow: Some(Follow {
                by_contraction: [follow[0].by_contraction, follow[1].by_contraction],
                by_number: follow.map(|unknown| groups.by_number(&unknown, first)),
            }),
        })
    };
    let mut outcome = by_some(0, from)?;
    // Groups for which there is no room take another integration, at the same equilibrium.
    for first in (M - 2..groups.count()).step_by(M - 2) {
        let from = outcome.solution.unknowns().or(from);
        outcome.add_derivatives(&by_some(first, from)?);
    }
    Ok(outcome)
}
