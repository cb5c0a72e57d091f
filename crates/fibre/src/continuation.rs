//! Continuation, for contractions without a good enough start. An equilibrium that is easy to find is moved
//! in adaptive steps to the one asked for.

use bulge_numerics::Real;

use crate::FibreError;
use crate::meridian::{SHORTENING, trajectory};
use crate::net::Net;
use crate::quadrature;
use crate::shooting::{Effort, Ending, TOLERANCE, USUAL, newton, straight_contraction};
use crate::start::{drawn_out, linear_start, start};
use crate::unknowns::{Kind, Unknowns, is_limited};

/// Ending and first tolerance of the solves on the way to the equilibrium asked for.
const ON_THE_WAY: (Ending, f64) = (USUAL, USUAL.first);

/// Smallest growth factor from one equilibrium to the next.
const SMALLEST: f64 = 1.0005;

/// Solves at the same contraction with a soft bladder and a soft cloth first, then stiffens both in adaptive
/// steps. The starts know nothing of bladder and cloth.
pub(crate) fn stiffening(
    net: &Net<f64>,
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    along(|part| net.with_walls(part), |_, at, _| Some(at), [1e-2, 0.1, 1e-9], contraction, effort)
}

/// Solves at the same contraction with stiff fibres first, then softens them in adaptive steps. Soft fibres of
/// a braid carry the pressure where it bulges, but may not as a cylinder between its fittings, from which the
/// starts begin.
pub(crate) fn softening(
    net: &Net<f64>,
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let softer = |part: f64| Net { compliance: part * net.compliance, ..net.clone() };
    let by_tension = |net: &Net<f64>, at: Unknowns, effort: &mut Effort| {
        newton(net, contraction, at.by_tension(net)?, ON_THE_WAY, effort).ok()
    };
    along(softer, by_tension, [0.5, 0.5, 1e-4], contraction, effort)
}

/// Solves for a part of what makes a net hard to solve, and lets it grow to the whole in adaptive steps. The
/// part begins with `first` and shrinks by `factor` until a start converges, down to `least`. `other` changes
/// what the unknowns stand for on the way.
fn along(
    with_part: impl Fn(f64) -> Net<f64>,
    other: impl Fn(&Net<f64>, Unknowns, &mut Effort) -> Option<Unknowns>,
    [first, factor, least]: [f64; 3],
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let failed = |effort: &Effort| FibreError::NotConverged {
        contraction,
        residual: f64::INFINITY,
        iterations: effort.iterations,
    };
    let mut part = first;
    let mut at = loop {
        let easy = with_part(part);
        if let Some(start) = start(&easy, contraction)
            && let Ok(found) = newton(&easy, contraction, start, ON_THE_WAY, effort)
            && let Some(found) = other(&easy, found, effort)
        {
            break found;
        }
        part *= factor;
        if part < least || effort.is_spent() {
            return Err(failed(effort));
        }
    };
    let mut rate = [0.0, 0.0]; // d(unknowns)/d ln(part)
    let mut grow: f64 = 3.0;
    // Predict along the last secant and correct by Newton's method; adapt the step to success or failure.
    while part < 1.0 {
        let next = (part * grow).min(1.0);
        let jump = (next / part).ln();
        let guess = Unknowns { logs: [at.logs[0] + rate[0] * jump, at.logs[1] + rate[1] * jump], ..at };
        if let Ok(found) = newton(&with_part(next), contraction, guess, ON_THE_WAY, effort) {
            rate = [(found.logs[0] - at.logs[0]) / jump, (found.logs[1] - at.logs[1]) / jump];
            (at, part) = (found, next);
            grow = (1.0 + (grow - 1.0) * 1.5).min(10.0);
        } else {
            grow = 1.0 + (grow - 1.0) * 0.4;
            if grow < SMALLEST || effort.is_spent() {
                return Err(failed(effort));
            }
        }
    }
    Ok(at)
}

/// Tensions of a drawn-out braid, as multiples of the tension that pressure and rubber cause. The multiple
/// falls with the distance from the contraction at which the fibres are straight.
const TAUT: [f64; 4] = [1e3, 1e2, 1e1, 3.0];
/// Largest strain to which elastic fibres are drawn out.
const DRAWN: f64 = 0.1;
/// Newton iterations for the radius of a drawn-out braid.
const RADIUS_ITERATIONS: u32 = 20;
/// Step of ln|B| at which these iterations end: that of a start.
const CLOSE: f64 = 1e-7;

/// A braid drawn out by a tension far larger than the one that pressure and rubber cause, with its
/// contraction. The radius at mid-length follows from the length of the fibres, starting at the radius of an
/// infinite tension. This equilibrium exists whatever else the braid carries.
pub(crate) fn drawn_taut(net: &Net<f64>) -> Option<(f64, Unknowns)> {
    if net.turn == 0.0 {
        return None;
    }
    let radius = drawn_out(&Net { compliance: 0.0, ..net.clone() }).0;
    let end = net.acting_at(radius);
    let cylinder = end.balance(radius, end.push(radius), 0.0)?.tension;
    // Tension of a cylinder without rubber.
    let alone = end.push(radius) / end.local(radius, cylinder).hoop_t;
    let least = 1.0 + (cylinder / alone).abs();
    let lifted = net.lift::<2>();
    TAUT.iter().filter(|factor| net.compliance * *factor * least * alone < DRAWN).find_map(|factor| {
        let mut at =
            Unknowns { kind: Kind::Waist, logs: [(net.end_radius - radius).ln(), (factor * least).ln()] };
        for _ in 0..RADIUS_ITERATIONS {
            let middle = at.seeded(&lifted)?;
            let run = if quadrature::suits(&lifted) {
                quadrature::trajectory(&lifted, middle)
            } else {
                trajectory(&lifted, middle, TOLERANCE)
            };
            let run = run.ok()?;
            let length = (run.half_fibre / net.half_fibre).ln();
            let step = length.value() / length.gradient()[0];
            if step.abs() < CLOSE {
                return Some((run.end[SHORTENING].value() / (net.cos_rest * net.half_fibre), at));
            }
            at.logs[0] -= step.clamp(-0.3, 0.3);
        }
        None
    })
}

/// Goes from a shallow bulge (or waist), where the start is good, to the contraction asked for in adaptive
/// steps.
pub(crate) fn continuation(
    net: &Net<f64>,
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let straight = straight_contraction(net).unwrap_or(0.0);
    let failed =
        FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations: effort.iterations };
    let whole = contraction - straight;
    let slack = |at: &Unknowns| at.is_slack(net).then_some(FibreError::Slack { contraction, limit: None });
    let mut part = 0.02;
    // Closer to the straight meridian, until a start converges.
    let mut at = loop {
        let there = straight + part * whole;
        let starts = [start(net, there), linear_start(net, there)];
        let found =
            starts.into_iter().flatten().find_map(|start| newton(net, there, start, ON_THE_WAY, effort).ok());
        if let Some(found) = found {
            break found;
        }
        part *= 0.2;
        if part < 1e-7 || effort.is_spent() {
            return Err(failed);
        }
    };
    if let Some(error) = slack(&at) {
        return Err(error);
    }
    // d(unknowns)/d ln(part) of a shallow bulge: B, k and 1/T grow with the root of the contraction.
    let first = match (is_limited(net, at.kind.side()), net.turn == 0.0) {
        (true, _) if net.has_wall() => 0.0,
        (true, true) => -1.0,
        (true, false) => -0.5,
        (false, _) => 0.5,
    };
    let mut rate = [first, 0.5];
    let mut grow: f64 = 2.0;
    // Predict along the last secant and correct by Newton's method; adapt the step to success or failure.
    while part < 1.0 {
        let next = (part * grow).min(1.0);
        let jump = (next / part).ln();
        let guess = Unknowns { logs: [at.logs[0] + rate[0] * jump, at.logs[1] + rate[1] * jump], ..at };
        match newton(net, straight + next * whole, guess, ON_THE_WAY, effort) {
            Ok(found) => {
                rate = [(found.logs[0] - at.logs[0]) / jump, (found.logs[1] - at.logs[1]) / jump];
                (at, part) = (found, next);
                // Fibres that are slack here are slack further on, too.
                if let Some(error) = slack(&at) {
                    return Err(error);
                }
                grow = (1.0 + (grow - 1.0) * 1.5).min(2.0);
            }
            Err(error) => {
                grow = 1.0 + (grow - 1.0) * 0.4;
                if grow < SMALLEST || effort.is_spent() {
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
