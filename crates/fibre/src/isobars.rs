//! Isobaric characteristics: force, volume and the other results over the contraction at several pressures.

use bulge_muscles::Pressure;
use rayon::prelude::*;
use serde::Serialize;

use crate::FibreError;
use crate::follow::solved_together;
use crate::outcome::{Approach, Scheme, Solution, has_length};
use crate::parts::Parts;
use crate::problem::Problem;
use crate::shape::Response;
use crate::shooting::USUAL;
use crate::solve::{ADIABATIC, Found, RangeEnd, closed_stiffness};
use crate::unknowns::Unknowns;

/// Contractions solved one after the other, each from its neighbour. The number is fixed, so that results
/// don't depend on the number of threads.
const CHUNK: usize = 64;

/// The characteristic at one pressure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Isobar {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction at which the force vanishes, or at which the fibres slacken if that comes first. `None` if
    /// it was not found.
    pub contraction_limit: Option<f64>,
    /// Whether the fibres slacken there, with a force left.
    pub ends_slack: bool,
    /// Equilibria in the order of the contractions asked for, without those that don't exist.
    pub points: Vec<Response>,
    /// Contractions that were left out, and why.
    #[serde(skip)]
    pub without: Vec<(f64, FibreError)>,
}

/// The characteristics at `pressures`, each at all `contractions`, on all cores. The bytes are the same for
/// any number of threads.
///
/// Where nothing but pressure acts on inextensible fibres, the shape doesn't depend on the pressure and is
/// computed once.
///
/// # Errors
/// Those of [`Problem::new`], an approach that doesn't fit the muscle, or a contraction of 100 % and more. A
/// contraction without equilibrium is no error: it is listed in [`Isobar::without`].
pub fn isobars(
    parts: impl Into<Parts>,
    pressures: &[Pressure],
    contractions: &[f64],
    approach: Approach,
) -> Result<Vec<Isobar>, FibreError> {
    let parts = parts.into();
    let mut found: Vec<Isobar> = Vec::with_capacity(pressures.len());
    for pressure in pressures {
        let problem = Problem::new(&parts, *pressure)?;
        found.push(match found.first() {
            Some(first) if problem.is_scale_free() => problem.rescaled(first),
            _ => problem.isobar(contractions, approach)?,
        });
    }
    Ok(found)
}

impl Problem {
    /// The characteristic at this pressure.
    ///
    /// # Errors
    /// See [`isobars`].
    pub fn isobar(&self, contractions: &[f64], approach: Approach) -> Result<Isobar, FibreError> {
        contractions.iter().try_for_each(|contraction| has_length(*contraction))?;
        let (end, longest) = (self.range_end(approach).ok(), self.longest());
        let scheme = self.scheme(approach)?;
        let solve = |chunk: &[f64]| {
            let mut last = [None, None];
            let closed = solved_together(chunk.iter().map(|at| self.asks_closed_form(scheme, *at)));
            let solved = chunk.iter().zip(closed).map(|(&contraction, closed)| {
                if let Some(end) = end.filter(|end| contraction > end.contraction()) {
                    return (contraction, Err(end.beyond(contraction)));
                }
                if let Some(limit) = longest.filter(|longest| contraction <= *longest) {
                    return (contraction, Err(FibreError::TooLong { contraction, limit }));
                }
                let from = closed.or_else(|| extrapolate(last, contraction).map(Solution::Shooting));
                let found = self.at_with(scheme, contraction, (from, USUAL));
                if let Ok(found) = &found {
                    last = [last[1], found.unknowns().map(|unknowns| (contraction, unknowns))];
                }
                (contraction, found)
            });
            let mut solved: Vec<_> = solved.collect();
            self.backwards(scheme, &mut solved);
            solved
        };
        let solved: Vec<Vec<_>> = contractions.par_chunks(CHUNK).map(solve).collect();
        let mut isobar = Isobar {
            pressure_pa: self.pressure,
            contraction_limit: end.map(RangeEnd::contraction),
            ends_slack: matches!(end, Some(RangeEnd::FibresSlacken(_))),
            points: Vec::new(),
            without: Vec::new(),
        };
        for (contraction, found) in solved.into_iter().flatten() {
            match found {
                Ok(Found { response, .. }) if self.pulls(&response) => isobar.points.push(response),
                Ok(Found { response: Response { force_n, .. }, .. }) => {
                    isobar.without.push((contraction, FibreError::WouldPush { contraction, force_n }));
                }
                Err(error) => isobar.without.push((contraction, error)),
            }
        }
        Ok(isobar)
    }

    /// Solves on the way back what was not found on the way forth. A drawn-out muscle is hard to find without
    /// a neighbour.
    fn backwards(&self, scheme: Scheme, solved: &mut [(f64, Result<Found, FibreError>)]) {
        let mut last = [None, None];
        for (contraction, found) in solved.iter_mut().rev() {
            if let (Err(FibreError::NotConverged { .. } | FibreError::TooSoft { .. }), Some(near)) =
                (&*found, extrapolate(last, *contraction))
                && let Ok(better) = self.at(scheme, *contraction, Some(near))
            {
                *found = Ok(better);
            }
            if let Ok(found) = found {
                last = [last[1], found.unknowns().map(|unknowns| (*contraction, unknowns))];
            }
        }
    }

    /// The characteristic of a scale-free muscle at this pressure, from the one at another pressure. Forces
    /// are proportional to the pressure.
    fn rescaled(&self, other: &Isobar) -> Isobar {
        let p = self.pressure;
        let ratio = p / other.pressure_pa;
        let scaled = |r: &Response| {
            let force = r.force_n * ratio;
            let stiffness = r.stiffness_n_per_m * ratio;
            let closed = |g| {
                closed_stiffness(g, p, [stiffness, force / p], [r.volume_polygon_m3, r.volume_slope_m2, 0.0])
            };
            Response {
                pressure_pa: p,
                force_n: force,
                fibre_tension_n: r.fibre_tension_n * ratio,
                stiffness_n_per_m: stiffness,
                stiffness_isothermal_n_per_m: closed(1.0),
                stiffness_adiabatic_n_per_m: closed(ADIABATIC),
                ..*r
            }
        };
        Isobar { pressure_pa: p, points: other.points.iter().map(scaled).collect(), ..other.clone() }
    }
}

/// A start from the last two solutions of the same kind, linear in the contraction.
fn extrapolate(last: [Option<(f64, Unknowns)>; 2], contraction: f64) -> Option<Unknowns> {
    let (x1, one) = last[1]?;
    let Some((x0, zero)) = last[0] else { return Some(one) };
    let ratio = (contraction - x1) / (x1 - x0);
    if zero.kind != one.kind || !ratio.is_finite() || ratio.abs() > 2.0 {
        return Some(one);
    }
    Some(Unknowns {
        logs: std::array::from_fn(|i| one.logs[i] + ratio * (one.logs[i] - zero.logs[i])),
        ..one
    })
}
