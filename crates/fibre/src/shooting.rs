//! Shooting: the two unknowns at mid-length (radius and curvature) from the two conditions at the fitting (fibre length and end distance).
//!
//! A trajectory starts at mid-length with the bulge B = r_mid - r_fitting and the curvature k, and runs until its radius is that of the
//! fitting; there its fibre length and its shortening are compared with those asked for:
//!
//! ```text
//! g1 = ln(S/S_half) = 0            g2 = (d - d_asked)/scale = 0           unknowns ln|B|, ln|k|
//! ```
//!
//! In these variables the problem is nearly linear at both ends: for a shallow bulge S = sqrt(2 B/k), and in a long braid S grows with -ln k.
//! Newton's method takes exact derivatives from the integration of dual numbers, loosely at first.

use bulge_numerics::{Dual, Real, gauss, root::illinois};

use crate::FibreError;
use crate::meridian::{SHORTENING, Trajectory, VOLUME, trajectory};
use crate::net::Net;

/// Tolerance of the last integrations, relative to the scale of each component.
pub(crate) const TOLERANCE: f64 = 1e-11;
/// Newton iterations after which the solve is given up.
const MAX_ITERATIONS: u32 = 40;
/// Largest steps of ln|B| and ln|k|.
const MAX_STEP: [f64; 2] = [0.8, 4.0];
/// Residual below which Newton's method is trusted not to need backtracking (early residuals are integrated loosely).
const NEAR: f64 = 1e-2;
/// Largest step of the last integration: what the derivatives are exact to.
const DERIVATIVES: f64 = 1e-8;
/// Difference of the contraction from that of a straight meridian up to which the start is taken from the linear solution.
const SHALLOW: f64 = 1e-4;
/// Smallest difference of the contraction from that of a straight meridian.
const STRAIGHT: f64 = 1e-7;
/// After a step of this size the quadratic convergence has done its work.
const LAST_STEP: f64 = 1e-6;

/// Which side of the fitting's radius the middle lies on, and the two logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unknowns {
    /// +1: bulge, -1: waist.
    pub(crate) side: f64,
    /// ln|B|, ln|k|.
    pub(crate) logs: [f64; 2],
}

impl Unknowns {
    /// B and k, with the unknowns as variables number 0 and 1 if `D` carries derivatives.
    ///
    /// The curvature of a waist is bounded: as k -> -q^2 r/sigma^2 the tension grows without limit. There the second unknown is the
    /// logarithm of k only for a shallow waist, and of the distance to that bound for a deep one.
    pub(crate) fn bulge_and_curvature<D: Real>(
        &self,
        net: &Net<D>,
        variable: impl Fn(f64, usize) -> D,
    ) -> [D; 2] {
        let bulge = variable(self.logs[0], 0).exp() * self.side;
        let second = variable(self.logs[1], 1);
        if self.side > 0.0 {
            return [bulge, second.exp()];
        }
        let share = D::from(1.0) / ((-second).exp() + 1.0);
        [bulge, -(share * steepest(net, net.end_radius + bulge))]
    }

    fn seeded<const N: usize>(&self, net: &Net<Dual<N>>) -> [Dual<N>; 2] {
        self.bulge_and_curvature(net, Dual::variable)
    }
}

/// Bound on the curvature of a waist of inextensible fibres, q^2 r/sigma^2.
fn steepest<D: Real>(net: &Net<D>, r: D) -> D {
    let angle2 = (net.turn * r).squared();
    angle2 / (r * (-angle2 + 1.0))
}

/// Counters of a solve.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Effort {
    pub(crate) iterations: u32,
    pub(crate) evaluations: u32,
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

/// The shortening of straight inextensible fibres is all due to the bulge: its ratio counts, however small it is.
fn counts_by_ratio<D: Real>(net: &Net<D>, contraction: f64, trajectory: &Trajectory<D>) -> bool {
    let straight = net.turn.value() == 0.0 && net.compliance.value() == 0.0;
    straight && contraction > 0.0 && trajectory.end[SHORTENING].value() > 0.0
}

/// In a braid or with elastic fibres a shortening near zero means nothing by itself: it counts against a part of the length.
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

/// Solves for a contraction, from a start of its own or the one given.
pub(crate) fn solve(
    net: &Net<f64>,
    contraction: f64,
    from: Option<Unknowns>,
) -> Result<(Unknowns, Effort), FibreError> {
    let mut effort = Effort::default();
    let contraction = beside_straight(net, contraction);
    if let Some(start) = from
        && let Ok(found) = newton(net, contraction, start, &mut effort)
    {
        return Ok((found, effort));
    }
    let direct = start(net, contraction).and_then(|start| newton(net, contraction, start, &mut effort).ok());
    if let Some(found) = direct {
        return Ok((found, effort));
    }
    let found = continuation(net, contraction, &mut effort)?;
    Ok((found, effort))
}

/// Where the meridian is exactly straight, bulge and curvature are zero and their logarithms don't exist: a contraction within `STRAIGHT` of it is
/// moved that far, and [`finish`] comes back along the derivatives (an error of the second order).
fn beside_straight(net: &Net<f64>, contraction: f64) -> f64 {
    match straight_contraction(net) {
        Some(straight) if (contraction - straight).abs() < STRAIGHT => straight + STRAIGHT,
        _ => contraction,
    }
}

/// Newton's method with backtracking from `start`.
fn newton(
    net: &Net<f64>,
    contraction: f64,
    start: Unknowns,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let lifted = net.lift::<2>();
    let mut at = start;
    // Near the straight meridian the shortening that counts is a small difference.
    let excess = straight_contraction(net).map_or(1.0, |straight| (contraction - straight).abs());
    let mut tolerance = (1e-2 * excess).clamp(TOLERANCE, 1e-4);
    let mut previous = f64::INFINITY;
    let mut last_step = [0.0, 0.0];
    let mut halvings = 0;
    for iteration in 1..=MAX_ITERATIONS {
        effort.iterations += 1;
        let [bulge, curvature] = at.seeded(&lifted);
        let run = trajectory(&lifted, bulge, curvature, tolerance);
        let found = run.map(|run| {
            effort.evaluations += run.evaluations;
            residuals(&lifted, Dual::from(contraction), &run)
        });
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
        previous = size;
        halvings = 0;
        let step = solve_two([*g[0].gradient(), *g[1].gradient()], [g[0].value(), g[1].value()]);
        let damping = (MAX_STEP[0] / step[0].abs()).min(MAX_STEP[1] / step[1].abs()).min(1.0);
        last_step = step.map(|s| damping * s);
        at.logs = [at.logs[0] - last_step[0], at.logs[1] - last_step[1]];
        let moved = step[0].abs().max(step[1].abs());
        if !moved.is_finite() {
            break;
        }
        if moved < LAST_STEP {
            return Ok(at);
        }
        // The next residual will be about the square of this step: no point in integrating it more exactly than that.
        tolerance = (1e-2 * moved * moved).clamp(TOLERANCE, 1e-5);
    }
    Err(FibreError::NotConverged { contraction, residual: previous, iterations: MAX_ITERATIONS })
}

/// From a shallow bulge (or waist), where the start is good, towards the asked contraction in steps that adapt.
fn continuation(net: &Net<f64>, contraction: f64, effort: &mut Effort) -> Result<Unknowns, FibreError> {
    let straight = straight_contraction(net).unwrap_or(0.0);
    let failed =
        FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations: effort.iterations };
    let whole = contraction - straight;
    let mut part = 0.02;
    let mut at = loop {
        let there = straight + part * whole;
        if let Some(start) = start(net, there)
            && let Ok(found) = newton(net, there, start, effort)
        {
            break found;
        }
        part *= 0.2;
        if part < 1e-7 {
            return Err(failed);
        }
    };
    let mut rate = [0.5, 0.5]; // d ln|B| / d ln(part) of a shallow bulge
    let mut grow: f64 = 2.0;
    while part < 1.0 {
        let next = (part * grow).min(1.0);
        let jump = (next / part).ln();
        let guess = Unknowns { logs: [at.logs[0] + rate[0] * jump, at.logs[1] + rate[1] * jump], ..at };
        match newton(net, straight + next * whole, guess, effort) {
            Ok(found) => {
                rate = [(found.logs[0] - at.logs[0]) / jump, (found.logs[1] - at.logs[1]) / jump];
                (at, part) = (found, next);
                grow = (1.0 + (grow - 1.0) * 1.5).min(2.0);
            }
            Err(error) => {
                grow = 1.0 + (grow - 1.0) * 0.4;
                if grow < 1.002 {
                    return Err(match error {
                        FibreError::NotConverged { residual, iterations, .. } => {
                            FibreError::NotConverged { contraction, residual, iterations }
                        }
                        other => other,
                    });
                }
            }
        }
    }
    Ok(at)
}

/// The 2 x 2 system J x = g.
pub(crate) fn solve_two(jacobian: [[f64; 2]; 2], g: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = jacobian;
    let det = a * d - b * c;
    [(g[0] * d - b * g[1]) / det, (a * g[1] - c * g[0]) / det]
}

/// The contraction at which the meridian is straight at the radius of the fitting (a cylinder), if the net has one: beyond it the
/// muscle bulges, before it the muscle has a waist. Straight fibres (theta = 0) always bulge.
pub(crate) fn straight_contraction(net: &Net<f64>) -> Option<f64> {
    if net.turn == 0.0 {
        return None;
    }
    let tension = net.acting_at(net.end_radius).tension_at_equator(net.end_radius, 0.0)?;
    Some(1.0 - net.sigma(net.end_radius, tension) / net.cos_rest)
}

/// Values to start from, some per cent to some ten per cent off.
pub(crate) fn start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    // Fibres that hardly turn bulge as straight ones do.
    let straight = net.turn == 0.0
        || (straight_contraction(net)? < contraction - SHALLOW
            && net.turn * net.turn * net.half_fibre < 0.02);
    if straight { arc_start(net, contraction) } else { net_start(net, contraction) }
}

/// Straight fibres: a circular arc of the stretched fibre length, half-angle K: `sin(K)/K` is the end distance over the fibre length,
/// and the tension that its curvature asks for stretches the fibres.
fn arc_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    let arc = |angle: f64| {
        let straight = net.half_fibre;
        let radius = |length: f64| net.end_radius + length * (1.0 - angle.cos()) / angle;
        let mut strain: f64 = 0.0;
        if net.compliance > 0.0 {
            // T = A'/k; A' grows with the stretched length: a contraction unless the fibres balloon.
            for _ in 0..6 {
                let length = straight * (1.0 + strain);
                strain = (net.compliance * net.area_r(radius(length)) * length / angle).min(2.0);
            }
        }
        let length = straight * (1.0 + strain);
        let end_distance =
            (1.0 + strain) * if angle < 1e-4 { 1.0 - angle * angle / 6.0 } else { angle.sin() / angle };
        (end_distance, length, strain)
    };
    let angle = if net.compliance > 0.0 {
        let mismatch = |ln: f64| arc(ln.exp()).0 - (1.0 - contraction);
        illinois(mismatch, 1e-7_f64.ln(), 2.6_f64.ln(), 1e-3).exp()
    } else if contraction > 0.0 {
        let x = 6.0 * contraction; // K^2 = 6 eps (1 + 3 eps/10 + ...), bent up towards the Mylar balloon
        (x * (1.0 + 0.3 * contraction + 1.2 * contraction * contraction)).sqrt()
    } else {
        return None;
    };
    let (_, length, _) = arc(angle);
    Some(Unknowns {
        side: 1.0,
        logs: [(length * 0.5 * angle * (1.0 - angle * angle / 12.0)).ln(), (angle / length).ln()],
    })
}

/// Nets with an angle: the trial meridian `r = r_mid - B (cosh(kappa S) - 1)/(cosh(kappa S_half) - 1)` of the linearised equation about
/// the mid radius, with the bulge that gives the asked end distance.
fn net_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    let straight = straight_contraction(net)?;
    let side = if contraction >= straight { 1.0 } else { -1.0 };
    let asked = (1.0 - contraction) * net.cos_rest * net.half_fibre;
    let half = net.half_fibre;
    // kappa^2 = 3 q^4 r^2/sigma^2 of the plain net; bladder and strain change it little enough for a start.
    let rate = |r: f64| {
        let angle = (net.turn * r).min(0.98);
        3.0_f64.sqrt() * net.turn * angle / (1.0 - angle * angle).sqrt()
    };
    let strain = net
        .acting_at(net.end_radius)
        .tension_at_equator(net.end_radius, 0.0)
        .map_or(0.0, |t| net.compliance * t);
    let end_distance = |bulge: f64| {
        let mid = net.end_radius + side * bulge;
        let kappa = rate(mid);
        let whole = shape(kappa * half);
        gauss::integrate(|tau| {
            let r = mid - side * bulge * shape(kappa * half * tau) / whole;
            let slope = bulge * shape_slope(kappa * half * tau) * kappa / whole;
            let square = (1.0 + strain).powi(2) - (net.turn * r).powi(2) - slope * slope;
            square.max(1e-4).sqrt() * half
        }) - asked
    };
    let most = if side > 0.0 { (0.999 / net.turn - net.end_radius).min(half) } else { 0.9 * net.end_radius };
    // The square root of the bulge is nearer to linear in the end distance than the bulge itself is for a shallow one. A waist first
    // lengthens the muscle, then its slope shortens it again: the root is on the first branch.
    let (mut low, mut high) = (1e-9, most.max(1e-8).sqrt());
    if side < 0.0 {
        let mut probe = low;
        while probe < high && end_distance(probe * probe) < 0.0 {
            low = probe;
            probe *= 2.0;
        }
        high = probe.min(high);
    }
    let bulge = if (contraction - straight).abs() < SHALLOW {
        // First order in the bulge: d(sigma)/dr = -q^2 r/sigma.
        let kappa = rate(net.end_radius);
        let mean = gauss::integrate(|tau| 1.0 - shape(kappa * half * tau) / shape(kappa * half));
        let sigma = net.cos_rest * (1.0 - straight);
        (contraction - straight).abs() * net.cos_rest * sigma / (net.turn * net.turn * net.end_radius * mean)
    } else {
        illinois(|b| end_distance(b * b), low, high, 1e-4 * high).powi(2)
    };
    let mid = net.end_radius + side * bulge;
    let kappa = rate(mid);
    let sigma2 = ((1.0 + strain).powi(2) - (net.turn * mid).powi(2)).max(1e-3);
    let ln_curvature = bulge.ln() + 2.0 * kappa.ln() - sigma2.ln() - ln_shape(kappa * half);
    let second = if side > 0.0 {
        ln_curvature
    } else {
        let share = (ln_curvature.exp() / steepest(net, mid)).min(0.98);
        (share / (1.0 - share)).ln()
    };
    Some(Unknowns { side, logs: [bulge.ln(), second] })
}

/// cosh(x) - 1, scaled by exp(-x) for large x (ratios and logarithms only).
fn shape(x: f64) -> f64 {
    let s = (0.5 * x.min(600.0)).sinh();
    2.0 * s * s
}
fn shape_slope(x: f64) -> f64 {
    x.min(600.0).sinh()
}
fn ln_shape(x: f64) -> f64 {
    if x > 30.0 { x - 2.0_f64.ln() } else { shape(x).ln() }
}

/// The solution at the unknowns with exact derivatives.
pub(crate) struct Solved<const N: usize> {
    pub(crate) force: Total<N>,
    pub(crate) half_volume: Total<N>,
    pub(crate) mid_radius: f64,
    pub(crate) unknowns: Unknowns,
    pub(crate) evaluations: u32,
    pub(crate) trajectory: Trajectory<Dual<N>>,
    pub(crate) residual: f64,
}

/// A value with its total derivatives: with respect to the contraction, and to the parameters that are the variables 2 .. of the net
/// (the first two places, of the unknowns, are zero).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Total<const N: usize> {
    pub(crate) value: f64,
    pub(crate) by_contraction: f64,
    pub(crate) by_parameter: [f64; N],
}

/// One last integration at the unknowns, whose own small Newton step corrects the values to second order, and the implicit function
/// theorem: the unknowns z follow a parameter a by `dz/da = -J^-1 dg/da`, an output o by `do/da + (do/dz) dz/da`.
pub(crate) fn finish<const N: usize>(
    net: &Net<Dual<N>>,
    contraction: f64,
    unknowns: Unknowns,
) -> Result<Solved<N>, FibreError> {
    let failed = FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations: 0 };
    let asked = contraction;
    let contraction = beside_straight(&net.constant(), contraction);
    let mut at = unknowns;
    let mut evaluations = 0;
    let (run, g, jacobian, step, bulge) = loop {
        let [bulge, curvature] = at.seeded(net);
        let run = trajectory(net, bulge, curvature, TOLERANCE).map_err(|_| failed.clone())?;
        let g = residuals(net, Dual::from(contraction), &run);
        let jacobian = g.map(|g| [g.gradient()[0], g.gradient()[1]]);
        let step = solve_two(jacobian, g.map(Real::value));
        evaluations += run.evaluations;
        // The derivatives are as exact as this step is small; a start from loose integrations may need one more round.
        if step[0].abs().max(step[1].abs()) < DERIVATIVES || evaluations > 4 * run.evaluations {
            break (run, g, jacobian, step, bulge);
        }
        at.logs = [at.logs[0] - step[0], at.logs[1] - step[1]];
    };
    let follow: [[f64; 2]; N] = std::array::from_fn(|i| solve_two(jacobian, g.map(|g| g.gradient()[i])));
    let by_contraction = solve_two(jacobian, [0.0, residual_by_contraction(net, contraction, &run)]);
    let total = |out: Dual<N>| {
        let o = out.gradient();
        let along = |z: [f64; 2]| o[0] * z[0] + o[1] * z[1];
        Total {
            value: out.value() - along(step) - along(by_contraction) * (asked - contraction),
            by_contraction: -along(by_contraction),
            by_parameter: std::array::from_fn(|i| if i < 2 { 0.0 } else { o[i] - along(follow[i]) }),
        }
    };
    Ok(Solved {
        force: total(run.force),
        half_volume: total(run.end[VOLUME]),
        mid_radius: net.end_radius.value() + bulge.value() * (1.0 - step[0]),
        unknowns: Unknowns { logs: [at.logs[0] - step[0], at.logs[1] - step[1]], ..at },
        evaluations,
        residual: g[0].value().abs().max(g[1].value().abs()),
        trajectory: run,
    })
}

/// The contraction towards which a braid of inextensible fibres can be drawn out, where the tension has no limit.
///
/// The pressure then no longer counts and the end distance is the largest one, `integral of sqrt(1 - q^2 r^2 - r'^2) dS`. With the radius
/// `r_m cosh(w)` its first integral gives, from the middle to the fitting,
///
/// ```text
/// S = sqrt(1 - q^2 r_m^2)/q  integral dw/sqrt(1 - q^2 r_m^2 cosh^2 w)        x = 1/q  integral sqrt(1 - q^2 r_m^2 cosh^2 w) dw
/// ```
pub(crate) fn longest(net: &Net<f64>) -> f64 {
    let q = net.turn.abs();
    let drawn = |ln_mid: f64| {
        let mid = ln_mid.exp();
        let end = (net.end_radius / mid).acosh();
        let panels = end.ceil().max(1.0);
        let (mut fibre, mut distance, mut left) = (0.0, 0.0, 0.0);
        while left < panels {
            let root = |part: f64| {
                let r = mid * (end * (left + part) / panels).cosh();
                (1.0 - q * q * r * r).max(0.0).sqrt()
            };
            fibre += gauss::integrate(|part| 1.0 / root(part)) * end / panels;
            distance += gauss::integrate(root) * end / panels;
            left += 1.0;
        }
        (fibre * (1.0 - q * q * mid * mid).sqrt() / q, distance / q)
    };
    let top = net.end_radius.ln();
    let mismatch = |ln_mid: f64| drawn(ln_mid).0 - net.half_fibre;
    // S grows by 1/q for every factor e of the radius.
    let ln_mid = illinois(mismatch, top - q * net.half_fibre - 3.0, top, 1e-13);
    1.0 - drawn(ln_mid).1 / (net.cos_rest * net.half_fibre)
}

#[cfg(test)]
mod tests {
    use super::*;

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
                let (unknowns, _) = solve(&net, contraction, None)?;
                finish::<2>(&net.lift(), contraction, unknowns).map(|found| found.force.value)
            };
            let forces = [1e-2, 1e-3, 1e-4].map(|part| force(limit * (1.0 - part)).unwrap());
            // F ~ a + b distance^(-1/2): the differences grow by sqrt(10).
            let growth = (forces[2] - forces[1]) / (forces[1] - forces[0]);
            assert!((growth / 10.0_f64.sqrt() - 1.0).abs() < 0.05, "{forces:?}");
            assert!(force(limit * 1.01).is_err());
        }
    }

    /// The saddle: the middle of a long braid differs from the cylinder by exp(-140), and doubling the length adds exactly a cylinder.
    #[test]
    fn a_long_braid_is_two_ends_and_a_cylinder() {
        let at = |length: f64| {
            let net = braid(length, 50.0);
            let (unknowns, _) = solve(&net, 0.05, None).unwrap();
            let found = finish::<2>(&net.lift(), 0.05, unknowns).unwrap();
            (unknowns.logs[1], found.trajectory.first_integral)
        };
        let (half, full) = (at(50.0), at(100.0));
        assert!(full.0 < -130.0 && (full.0 / half.0 - 2.0).abs() < 0.2, "{half:?} {full:?}");
        assert!(full.1 < 1e-10);
    }

    /// A start given by a neighbour leads to the same solution as none.
    #[test]
    fn the_start_does_not_matter() {
        let net = braid(25.0, 25.0);
        let (near, _) = solve(&net, 0.19, None).unwrap();
        let (cold, effort) = solve(&net, 0.2, None).unwrap();
        let (warm, _) = solve(&net, 0.2, Some(near)).unwrap();
        let force = |unknowns| finish::<2>(&net.lift(), 0.2, unknowns).unwrap().force.value;
        assert!((force(cold) / force(warm) - 1.0).abs() < 1e-11);
        assert!(effort.iterations < 8);
    }
}
