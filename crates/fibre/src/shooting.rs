//! Shooting: the two end conditions at the fitting (fibre length and end distance) determine the two unknowns
//! at mid-length (radius and curvature).
//!
//! A trajectory starts at mid-length with the bulge B = r_mid - r_fitting and the curvature k. It ends where
//! its radius is that of the fitting. Its fibre length and its shortening there are compared with the
//! prescribed ones:
//!
//! ```text
//! g1 = ln(S/S_half) = 0            g2 = (d - d_asked)/scale = 0           unknowns ln|B|, ln|k|
//! ```
//!
//! The problem is nearly linear in these variables at both extremes: a shallow bulge has S = sqrt(2 B/k), and
//! in a long braid S grows with -ln k. Where lobes or cloth limit the radius, B is nearly the same for all
//! equilibria, and N = push/k is a ratio of two numbers near 0 (push: A' less the hoop term of the cloth).
//! The first unknown is then ln(push/(k B)), and push(r_mid) = k B (N/B) fixes B. Where an angle of the
//! fibres carries a part, the first unknown is ln(push/B). With a bladder it is asinh(push/(2 B)), because a
//! bladder that is narrower than at rest pushes outwards itself.
//!
//! Where fibres of a braid are so soft that the bulge may reach beyond unstretched ones, the unknowns are its tension and
//! the gap to a cylinder of that tension ([`Unknowns::by_tension`]).
//!
//! Newton's method takes exact derivatives from the integration of dual numbers, which is loose at first.
//! Where the meridian is a quadrature (see `quadrature`), the derivatives come from that instead, at a tenth
//! of the cost.

use bulge_numerics::{Dual, Real};

use crate::FibreError;
use crate::both_ways::values_of_ode;
use crate::continuation::{continuation, softening, stiffening};
use crate::meridian::{NoTrajectory, SHORTENING, Trajectory, VOLUME, trajectory};
use crate::net::Net;
use crate::outcome::{BURSTING, SOFT};
use crate::quadrature;
use crate::start::start;
use crate::unknowns::{FLAT, Unknowns};

/// Tolerance of the last integrations, relative to the scale of each component.
pub(crate) const TOLERANCE: f64 = 4e-12;
/// The same where the first integral shows that this is not enough.
const FINER: f64 = 4e-13;
/// Newton iterations after which the solve is given up.
const MAX_ITERATIONS: u32 = 40;
/// Limit on the evaluations of the right-hand side (or of the integrands). A search for an equilibrium that
/// may not exist ends there (after some 3 ms). The longest braid takes under 5000.
const MOST_EVALUATIONS: u32 = 30_000;
/// Largest steps of the first unknown, ln|B| or ln T, and of the second one.
const MAX_STEP: [f64; 2] = [0.8, 4.0];
/// Largest step of ln|k| in the middle of a long cylinder, as a fraction of ln|k|.
const CYLINDER: f64 = 0.3;
/// Newton's method does not backtrack below this residual. (Early residuals are integrated loosely.)
const NEAR: f64 = 1e-2;
/// The iterations have stalled when a residual exceeds this fraction of the last one.
const STALLED: f64 = 0.3;
/// Largest Newton step at the last integration. The derivatives are exact to this size.
const DERIVATIVES: f64 = 1e-9;
/// The same step times the force in p R^2 where something stores energy. dF/dp is then the small difference of
/// F/p and of what the softer fibres or rubber make of a higher pressure: at 10^5 p R^2 it loses five digits.
const DIFFERENCE: f64 = 1e-7;
/// Steps that are rounding, hardly to be made smaller.
const ROUNDING: f64 = 1e-13;
/// Smallest allowed difference of the contraction from that of a straight meridian.
const STRAIGHT: f64 = 1e-9;
/// Largest accepted departure of a solution from the first integral. It is far above the integration error
/// and far below any departure that matters.
pub(crate) const FIRST_INTEGRAL: f64 = 1e-9;
/// Largest last step of an accepted solution. [`finish`] corrects the values by this step to second order.
const ACCEPTED: f64 = 1e-6;
/// When Newton's method stops and leaves the rest to [`finish`]. That function has to integrate once anyway
/// and takes the next step itself, which saves a third of the time of a braid. It takes one more if that step
/// is not below [`DERIVATIVES`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ending {
    /// After a step of this size the next one is usually small enough: it is about the square.
    step: f64,
    /// The trajectory must have been integrated to this tolerance at least. Otherwise the next step is the
    /// integration error.
    tolerance: f64,
    /// First tolerance if a start is given.
    pub(crate) first: f64,
    /// Loosest tolerance of the iteration that is expected to be the last.
    last_but_one: f64,
    /// Where the meridian is a quadrature, which has no tolerance, the iterations end when the next step is expected to
    /// be below [`DERIVATIVES`] by this factor. Steps shrink as C times their squares; after long steps, the C that two
    /// of them tell is too small by up to 7.
    surely: f64,
    /// Limit on the evaluations of a search.
    most: u32,
    /// Whether a given start is the only one that is tried.
    alone: bool,
}

/// For solves in which repeating the last integration costs as much as the iteration that it saves.
pub(crate) const USUAL: Ending = Ending {
    step: 1e-4,
    tolerance: 1e-7,
    first: 1e-4,
    last_but_one: 1e-5,
    surely: 0.3,
    most: MOST_EVALUATIONS,
    alone: false,
};
/// Solves from a neighbour's solution or not at all.
pub(crate) const ALONE: Ending = Ending { alone: true, ..USUAL };
/// For solves whose last integration carries many derivatives and must not be repeated. A given start lies
/// near.
pub(crate) const EXACT: Ending = Ending {
    step: 3e-5,
    tolerance: 2.5e-10,
    first: 2.5e-10,
    last_but_one: 2.5e-10,
    surely: 0.1,
    most: MOST_EVALUATIONS,
    alone: false,
};
/// The same in a fit, which asks thousands of times and may ask far from sensible values. No equilibrium that
/// is found takes more evaluations.
pub(crate) const FITTED: Ending = Ending { most: 15_000, ..EXACT };
/// The same beside a known equilibrium. One that is found neither from there nor by a new search hardly
/// exists.
pub(crate) const BESIDE: Ending = Ending { most: 7_500, ..FITTED };
/// Newton iterations from a given start after which the search begins anew. A good start takes two or three.
const MOST_FROM_NEAR: u32 = 8;
/// C before two steps have told it, and the largest step for which it is believed.
const SQUARES: f64 = 3.0;
const TOLD: f64 = 1e-3;
/// Steps below this one that no longer shrink are rounding.
const FLOOR: f64 = 1e-5;
/// Step after which the next one is expected to be the last.
const LAST_BUT_ONE: f64 = 1e-2;

/// Counters of a solve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    pub(crate) iterations: u32,
    pub(crate) evaluations: u32,
    /// Limit on the evaluations of the search.
    most: u32,
}

impl Effort {
    pub(crate) const fn of_at_most(most: u32) -> Self {
        Self { iterations: 0, evaluations: 0, most }
    }

    /// Whether the evaluations are used up.
    pub(crate) fn is_spent(&self) -> bool {
        self.evaluations > self.most
    }
}

/// Residuals of the end conditions.
fn residuals<D: Real>(net: &Net<D>, contraction: D, trajectory: &Trajectory<D>) -> [D; 2] {
    let asked = net.cos_rest * net.half_fibre * contraction;
    let found = trajectory.end[SHORTENING];
    let length = (trajectory.half_fibre / net.half_fibre).ln();
    if counts_by_ratio(net, contraction.value(), trajectory) {
        return [length, (found / asked).ln()];
    }
    [length, (found - asked) / shortening_scale(net, contraction.value())]
}

/// Straight inextensible fibres shorten only because of the bulge. The ratio of the shortenings therefore
/// counts, however small they are.
fn counts_by_ratio<D: Real>(net: &Net<D>, contraction: f64, trajectory: &Trajectory<D>) -> bool {
    let straight = net.turn.value() == 0.0 && net.compliance.value() == 0.0;
    straight && contraction > 0.0 && trajectory.end[SHORTENING].value() > 0.0
}

/// In a braid or with elastic fibres a shortening near zero has no meaning by itself. Its error is relative
/// to a fraction of the length.
fn shortening_scale<D: Real>(net: &Net<D>, contraction: f64) -> f64 {
    net.half_fibre.value() * (contraction.abs() * net.cos_rest.value() + 0.02)
}

/// Derivative of the second residual with respect to the contraction.
fn residual_by_contraction<D: Real>(net: &Net<D>, contraction: f64, trajectory: &Trajectory<D>) -> f64 {
    if counts_by_ratio(net, contraction, trajectory) {
        return -1.0 / contraction;
    }
    -net.cos_rest.value() * net.half_fibre.value() / shortening_scale(net, contraction)
}

/// Solves for a contraction, from the given start or from one of its own.
pub(crate) fn solve(
    net: &Net<f64>,
    contraction: f64,
    from: Option<Unknowns>,
    ending: Ending,
) -> Result<(Unknowns, Effort), FibreError> {
    let mut effort = Effort::of_at_most(ending.most);
    let contraction = beside_straight(net, contraction);
    if let Some(start) = from {
        let near =
            newton_within(net, contraction, start, (ending, ending.first), &mut effort, MOST_FROM_NEAR);
        if near.is_ok() || ending.alone {
            return near.map(|found| (found, effort));
        }
    }
    // Without a start, or after a failed one, the search begins anew.
    let cold = (ending, USUAL.first);
    let direct =
        start(net, contraction).and_then(|start| newton(net, contraction, start, cold, &mut effort).ok());
    let mut found = direct.map_or_else(|| continuation(net, contraction, &mut effort), Ok);
    let failed = |found: &Result<_, _>| matches!(found, Err(FibreError::NotConverged { .. }));
    // The starts ignore bladder and cloth: soften both and let them stiffen step by step.
    if failed(&found) && (net.cloth.is_some() || net.has_wall()) {
        found = afresh(stiffening, net, contraction, &mut effort);
    }
    if failed(&found) && net.turn != 0.0 && net.softness() > SOFT * BURSTING {
        found = afresh(softening, net, contraction, &mut effort);
    }
    Ok((found?, effort))
}

/// A search with an effort of its own, which is added to that of the earlier ones.
fn afresh(
    search: fn(&Net<f64>, f64, &mut Effort) -> Result<Unknowns, FibreError>,
    net: &Net<f64>,
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let mut more = Effort::of_at_most(effort.most);
    let found = search(net, contraction, &mut more);
    effort.iterations += more.iterations;
    effort.evaluations += more.evaluations;
    found
}

/// Keeps a contraction away from that of an exactly straight meridian, where bulge and curvature are zero and
/// their logarithms don't exist. A contraction within `STRAIGHT` of it is moved that far. [`finish`] comes
/// back along the derivatives (an error of the second order).
fn beside_straight(net: &Net<f64>, contraction: f64) -> f64 {
    match straight_contraction(net) {
        Some(straight) if (contraction - straight).abs() < STRAIGHT => {
            straight + STRAIGHT.copysign(contraction - straight)
        }
        _ => contraction,
    }
}

/// Newton's method with backtracking from `start`, integrating to the tolerance `first` to begin with.
pub(crate) fn newton(
    net: &Net<f64>,
    contraction: f64,
    start: Unknowns,
    tolerances: (Ending, f64),
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    newton_within(net, contraction, start, tolerances, effort, MAX_ITERATIONS)
}

fn newton_within(
    net: &Net<f64>,
    contraction: f64,
    start: Unknowns,
    (ending, first): (Ending, f64),
    effort: &mut Effort,
    most: u32,
) -> Result<Unknowns, FibreError> {
    let lifted = net.lift::<2>();
    let exact = quadrature::suits(net);
    let mut at = start;
    // Near the straight meridian the relevant shortening is a small difference, so the tolerance starts
    // tighter.
    let excess = straight_contraction(net).map_or(1.0, |straight| (contraction - straight).abs());
    let mut tolerance = (1e-2 * excess).clamp(TOLERANCE, first);
    let (mut previous, mut before) = (f64::INFINITY, f64::INFINITY);
    let mut last_step = [0.0, 0.0];
    let mut halvings = 0;
    let mut loosest = first;
    for iteration in 1..=most {
        effort.iterations += 1;
        let nothing = NoTrajectory { evaluations: 1 };
        let run = at.seeded(&lifted).ok_or(nothing).and_then(|middle| {
            if exact {
                quadrature::trajectory(&lifted, middle)
            } else {
                trajectory(&lifted, middle, tolerance)
            }
        });
        effort.evaluations += run.as_ref().map_or_else(|none| none.evaluations, |run| run.evaluations);
        if effort.is_spent() {
            break;
        }
        let found = run.map(|run| residuals(&lifted, Dual::from(contraction), &run));
        let size = found.as_ref().map_or(f64::INFINITY, |g| g[0].value().abs().max(g[1].value().abs()));
        // Worse than before, or no trajectory at all: go back half-way.
        if !size.is_finite() || (size > 2.0 * previous && size > NEAR) {
            halvings += 1;
            if halvings > 10 || (iteration == 1 && !size.is_finite()) {
                return Err(FibreError::NotConverged {
                    contraction,
                    residual: previous,
                    iterations: iteration,
                });
            }
            last_step = last_step.map(|s: f64| 0.5 * s);
            at.logs = [at.logs[0] + last_step[0], at.logs[1] + last_step[1]];
            continue;
        }
        let Ok(g) = found else { continue };
        // A residual that the iterations no longer reduce is the integration error: tighten the tolerance.
        if size < NEAR && size > STALLED * previous {
            loosest = (1e-2 * loosest).max(TOLERANCE);
        }
        previous = size;
        halvings = 0;
        let step = solve_two([*g[0].gradient(), *g[1].gradient()], [g[0].value(), g[1].value()]);
        // Along a cylinder the conditions are linear in ln|k|, so longer steps are allowed.
        let most_second =
            if at.logs[1] < FLAT { MAX_STEP[1].max(CYLINDER * at.logs[1].abs()) } else { MAX_STEP[1] };
        let damping = (MAX_STEP[0] / step[0].abs()).min(most_second / step[1].abs()).min(1.0);
        last_step = step.map(|s| damping * s);
        at.logs = [at.logs[0] - last_step[0], at.logs[1] - last_step[1]];
        let moved = step[0].abs().max(step[1].abs());
        if !moved.is_finite() {
            break;
        }
        let squares = if before.is_finite() { moved / (before * before) } else { SQUARES };
        let ends = if exact {
            moved < TOLD && squares * moved * moved < ending.surely * DERIVATIVES
                || moved < FLOOR && moved > STALLED * before
        } else {
            moved < ending.step && tolerance <= ending.tolerance
        };
        if ends {
            return Ok(at);
        }
        before = moved;
        // The next residual will be about the square of this step. A more exact integration would be wasted.
        let most = if moved < LAST_BUT_ONE { ending.last_but_one } else { 1e-5 };
        tolerance = (1e-2 * moved * moved).clamp(TOLERANCE, most.min(loosest));
    }
    Err(FibreError::NotConverged { contraction, residual: previous, iterations: most })
}

/// The 2 x 2 system J x = g.
pub(crate) fn solve_two(jacobian: [[f64; 2]; 2], g: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = jacobian;
    let det = a * d - b * c;
    [(g[0] * d - b * g[1]) / det, (a * g[1] - c * g[0]) / det]
}

/// The contraction at which the meridian is straight at the radius of the fitting (a cylinder), if the net
/// has one: beyond it the muscle bulges, before it the muscle has a waist. Straight fibres (theta = 0) always
/// bulge.
pub(crate) fn straight_contraction(net: &Net<f64>) -> Option<f64> {
    if net.turn == 0.0 {
        return None;
    }
    let end = net.acting_at(net.end_radius);
    let tension = end.at_equator(end.end_radius, end.push(end.end_radius), 0.0)?.tension;
    Some(1.0 - net.sigma(net.end_radius, tension) / net.cos_rest)
}

/// The solution at the final unknowns, with exact derivatives.
pub(crate) struct Solved<const N: usize> {
    pub(crate) force: Total<N>,
    pub(crate) half_volume: Total<N>,
    pub(crate) mid_radius: Total<N>,
    pub(crate) unknowns: Unknowns,
    pub(crate) evaluations: u32,
    pub(crate) trajectory: Trajectory<Dual<N>>,
    pub(crate) residual: f64,
    /// Total derivatives of the two unknowns.
    pub(crate) follow: [Total<N>; 2],
    /// The last Newton step: the distance of the trajectory from the solution in the unknowns.
    step: [f64; 2],
}

impl<const N: usize> Solved<N> {
    /// A value of the trajectory, corrected by the last Newton step.
    pub(crate) fn corrected(&self, out: Dual<N>) -> f64 {
        let o = out.gradient();
        out.value() - o[0] * self.step[0] - o[1] * self.step[1]
    }
}

/// A value with its total derivatives by the contraction and by the parameters. The parameters are the
/// variables 2 .. of the net. (The first two places belong to the unknowns and are zero.)
#[derive(Debug, Clone, Copy)]
pub(crate) struct Total<const N: usize> {
    pub(crate) value: f64,
    pub(crate) by_contraction: f64,
    pub(crate) by_parameter: [f64; N],
}

/// How the last trajectory is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// By the equilibrium ODE, which checks everything before. Derivatives are a quadrature's where the net allows it.
    Ode,
    /// By quadrature where the net allows it, ten times faster.
    Quadrature,
}

/// Integrates a last time at the unknowns. The small Newton step of this integration corrects the values to
/// second order. The implicit function theorem gives the derivatives: the unknowns z follow a parameter a by
/// `dz/da = -J^-1 dg/da`, an output o by `do/da + (do/dz) dz/da`.
pub(crate) fn finish<const N: usize>(
    net: &Net<Dual<N>>,
    contraction: f64,
    unknowns: Unknowns,
    way: Way,
) -> Result<Solved<N>, FibreError> {
    let failed = FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations: 0 };
    let asked = contraction;
    let contraction = beside_straight(&net.constant(), contraction);
    let mut at = unknowns;
    let mut evaluations = 0;
    let mut tolerance = TOLERANCE;
    let by_pressure = net.compliance.value() != 0.0 || net.has_wall();
    let (run, g, jacobian, step, bulge) = loop {
        let middle = at.seeded(net).ok_or_else(|| failed.clone())?;
        let run = match way {
            Way::Quadrature if quadrature::suits(net) => quadrature::trajectory(net, middle),
            Way::Ode if quadrature::suits(net) => values_of_ode(net, middle, tolerance),
            _ => trajectory(net, middle, tolerance),
        };
        let run = match run {
            Ok(run) => run,
            // The integration can't follow cloth a thousand times stiffer than the pressure needs; a
            // quadrature can.
            Err(_) if way == Way::Ode && quadrature::suits(net) => {
                return finish(net, asked, unknowns, Way::Quadrature);
            }
            Err(_) => return Err(failed),
        };
        let bulge = middle.bulge;
        let g = residuals(net, Dual::from(contraction), &run);
        let jacobian = g.map(|g| [g.gradient()[0], g.gradient()[1]]);
        let step = solve_two(jacobian, g.map(Real::value));
        evaluations += run.evaluations;
        // The derivatives are as exact as this step is small. A start from loose integrations may need one
        // more round.
        let small = if by_pressure {
            (DIFFERENCE / run.force.value().abs()).clamp(ROUNDING, DERIVATIVES)
        } else {
            DERIVATIVES
        };
        if step[0].abs().max(step[1].abs()) < small || evaluations > 4 * run.evaluations {
            // Next to hundreds of lobes the errors of the integration add up to more.
            if run.first_integral > FIRST_INTEGRAL && tolerance > FINER && !quadrature::suits(net) {
                tolerance = FINER;
                continue;
            }
            break (run, g, jacobian, step, bulge);
        }
        at.logs = [at.logs[0] - step[0], at.logs[1] - step[1]];
    };
    let residual = beyond_rounding(g.map(Real::value), jacobian);
    // In the middle of a long cylinder the fibre length is linear in ln|k|, and rounding is relative to that.
    let rest = step[0].abs().max(step[1].abs() / (at.logs[1] / FLAT).max(1.0));
    if rest > ACCEPTED || run.first_integral > FIRST_INTEGRAL {
        // Next to fittings on which the fibres nearly lie along the circumference the integration loses
        // digits. A quadrature doesn't.
        if way == Way::Ode && quadrature::suits(net) {
            return finish(net, asked, unknowns, Way::Quadrature);
        }
        return Err(FibreError::NotConverged { contraction: asked, residual, iterations: MAX_ITERATIONS });
    }
    let follow: [[f64; 2]; N] = std::array::from_fn(|i| solve_two(jacobian, g.map(|g| g.gradient()[i])));
    let by_contraction = solve_two(jacobian, [0.0, residual_by_contraction(net, contraction, &run)]);
    let total = |out: Dual<N>| {
        let o = out.gradient();
        let along = |z: [f64; 2]| o[0] * z[0] + o[1] * z[1];
        Total {
            // The last term returns from the contraction that `beside_straight` has moved.
            value: out.value() - along(step) - along(by_contraction) * (asked - contraction),
            by_contraction: -along(by_contraction),
            by_parameter: std::array::from_fn(|i| if i < 2 { 0.0 } else { o[i] - along(follow[i]) }),
        }
    };
    let follow = std::array::from_fn(|z| Total {
        value: at.logs[z] - step[z],
        by_contraction: -by_contraction[z],
        by_parameter: follow.map(|along| -along[z]),
    });
    Ok(Solved {
        follow,
        force: total(run.force),
        half_volume: total(run.end[VOLUME]),
        mid_radius: total(net.end_radius + bulge),
        unknowns: Unknowns { logs: [at.logs[0] - step[0], at.logs[1] - step[1]], ..at },
        evaluations,
        residual,
        trajectory: run,
        step,
    })
}

/// The larger residual, less the part that rounding of the radius at mid-length causes. A long braid that is
/// drawn out has a radius there of exp(-q S) times that of the fittings, known only to 1e-16 of theirs.
fn beyond_rounding(g: [f64; 2], jacobian: [[f64; 2]; 2]) -> f64 {
    let beyond = |i: usize| (g[i].abs() - f64::EPSILON * jacobian[i][0].abs()).max(0.0);
    beyond(0).max(beyond(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::start::longest;

    fn braid(length: f64, degrees: f64) -> Net<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let half_fibre = 0.5 * length / cos;
        Net { half_fibre, cos_rest: cos, sin2_rest: sin * sin, turn: sin, ..Net::plain() }
    }

    /// Equilibria exist up to the drawn-out limit, with a force that grows without bound, and not beyond.
    #[test]
    fn the_drawn_out_limit_is_where_the_force_grows_without_bound() {
        for net in [braid(3.0, 25.0), braid(6.0, 25.0), braid(10.0, 45.0)] {
            let limit = longest(&net);
            let force = |contraction: f64| {
                let (unknowns, _) = solve(&net, contraction, None, USUAL)?;
                finish::<2>(&net.lift(), contraction, unknowns, Way::Ode).map(|found| found.force.value)
            };
            let forces = [1e-2, 1e-3, 1e-4].map(|part| force(limit * (1.0 - part)).unwrap());
            // F ~ a + b distance^(-1/2): the differences grow by sqrt(10).
            let growth = (forces[2] - forces[1]) / (forces[1] - forces[0]);
            assert!((growth / 10.0_f64.sqrt() - 1.0).abs() < 0.05, "{forces:?}");
            assert!(force(limit * 1.01).is_err());
        }
    }

    /// The saddle: the middle of a long braid differs from the cylinder by exp(-140), and doubling the length
    /// adds exactly a cylinder.
    #[test]
    fn a_long_braid_is_two_ends_and_a_cylinder() {
        let at = |length: f64| {
            let net = braid(length, 50.0);
            let (unknowns, _) = solve(&net, 0.05, None, USUAL).unwrap();
            let found = finish::<2>(&net.lift(), 0.05, unknowns, Way::Ode).unwrap();
            (unknowns.logs[1], found.trajectory.first_integral)
        };
        let (half, full) = (at(50.0), at(100.0));
        assert!(full.0 < -130.0 && (full.0 / half.0 - 2.0).abs() < 0.2, "{half:?} {full:?}");
        assert!(full.1 < 1e-10);
    }

    /// A check by the ODE has the values of the ODE and the derivatives of the quadrature, to the last bit.
    #[test]
    fn a_check_has_the_values_of_the_ode() {
        let net = braid(10.0, 30.0);
        let (unknowns, _) = solve(&net, 0.1, None, USUAL).unwrap();
        let lifted = net.lift::<2>();
        let middle = unknowns.seeded(&lifted).unwrap();
        let checked = values_of_ode(&lifted, middle, TOLERANCE).unwrap();
        let ode = trajectory(&net, middle.constant(), TOLERANCE).unwrap();
        let quadrature = quadrature::trajectory(&lifted, middle).unwrap();
        let numbers = |run: &Trajectory<Dual<2>>| {
            let [_, shortening, ..] = run.end;
            [run.half_fibre, shortening, run.force, run.mid_tension, run.end[VOLUME]]
        };
        let values = [ode.half_fibre, ode.end[SHORTENING], ode.force, ode.mid_tension, ode.end[VOLUME]];
        let others = numbers(&quadrature);
        for ((found, value), other) in numbers(&checked).into_iter().zip(values).zip(others) {
            assert_eq!(found.value().to_bits(), value.to_bits());
            assert_eq!(found.gradient().map(f64::to_bits), other.gradient().map(f64::to_bits));
        }
        assert!(others[0].value().to_bits() != values[0].to_bits(), "the two ways differ by rounding");
        assert_eq!(checked.evaluations, ode.evaluations + quadrature.evaluations);
    }

    /// A start given by a neighbour leads to the same solution as a search without one.
    #[test]
    fn the_start_does_not_matter() {
        let net = braid(25.0, 25.0);
        let (near, _) = solve(&net, 0.19, None, USUAL).unwrap();
        let (cold, effort) = solve(&net, 0.2, None, USUAL).unwrap();
        let (warm, _) = solve(&net, 0.2, Some(near), USUAL).unwrap();
        let force = |unknowns| finish::<2>(&net.lift(), 0.2, unknowns, Way::Ode).unwrap().force.value;
        assert!((force(cold) / force(warm) - 1.0).abs() < 1e-11);
        assert!(effort.iterations < 8);
    }
}
