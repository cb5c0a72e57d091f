//! Where a start is not good enough: an equilibrium that is easy to find, moved in steps that adapt to the one that is asked for.

use crate::FibreError;
use crate::net::Net;
use crate::shooting::{Effort, Ending, USUAL, Unknowns, is_limited, newton, straight_contraction};
use crate::start::{linear_start, start};

/// On the way to the asked equilibrium.
const ON_THE_WAY: (Ending, f64) = (USUAL, USUAL.first);

/// Least growth of the contraction from one equilibrium to the next.
const SMALLEST: f64 = 1.0005;

/// The same contraction with a bladder and a cloth that are soft at first and stiffen, by steps that adapt: the starts know nothing of them.
pub(crate) fn stiffening(
    net: &Net<f64>,
    contraction: f64,
    effort: &mut Effort,
) -> Result<Unknowns, FibreError> {
    let failed = |effort: &Effort| FibreError::NotConverged {
        contraction,
        residual: f64::INFINITY,
        iterations: effort.iterations,
    };
    let mut part = 1e-2;
    let mut at = loop {
        let soft = net.with_walls(part);
        if let Some(start) = start(&soft, contraction)
            && let Ok(found) = newton(&soft, contraction, start, ON_THE_WAY, effort)
        {
            break found;
        }
        part *= 0.1;
        if part < 1e-9 || effort.is_spent() {
            return Err(failed(effort));
        }
    };
    let mut rate = [0.0, 0.0]; // d(unknowns)/d ln(part)
    let mut grow: f64 = 3.0;
    while part < 1.0 {
        let next = (part * grow).min(1.0);
        let jump = (next / part).ln();
        let guess = Unknowns { logs: [at.logs[0] + rate[0] * jump, at.logs[1] + rate[1] * jump], ..at };
        if let Ok(found) = newton(&net.with_walls(next), contraction, guess, ON_THE_WAY, effort) {
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

/// From a shallow bulge (or waist), where the start is good, towards the asked contraction in steps that adapt.
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
    // d(unknowns)/d ln(part) of a shallow bulge, where B, k and 1/T grow with the root of the contraction.
    let first = match (is_limited(net, at.side), net.turn == 0.0) {
        (true, _) if net.bladder.is_some() => 0.0,
        (true, true) => -1.0,
        (true, false) => -0.5,
        (false, _) => 0.5,
    };
    let mut rate = [first, 0.5];
    let mut grow: f64 = 2.0;
    while part < 1.0 {
        let next = (part * grow).min(1.0);
        let jump = (next / part).ln();
        let guess = Unknowns { logs: [at.logs[0] + rate[0] * jump, at.logs[1] + rate[1] * jump], ..at };
        match newton(net, straight + next * whole, guess, ON_THE_WAY, effort) {
            Ok(found) => {
                rate = [(found.logs[0] - at.logs[0]) / jump, (found.logs[1] - at.logs[1]) / jump];
                (at, part) = (found, next);
                // Once slack, they are so further on.
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
