//! Isobaric characteristics: force, volume and the rest over the contraction at several pressures.

use bulge_muscles::{Muscle, Pressure};
use rayon::prelude::*;
use serde::Serialize;

use crate::FibreError;
use crate::outcome::Approach;
use crate::problem::Problem;
use crate::shape::Response;
use crate::solve::{ADIABATIC, closed_stiffness};
use crate::unknowns::Unknowns;

/// Contractions solved one after the other, each from its neighbour. A fixed number, so that results don't depend on the number of threads.
const CHUNK: usize = 64;

/// The characteristic at one pressure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Isobar {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction at which the force vanishes, if it was found.
    pub contraction_limit: Option<f64>,
    /// Equilibria in the order of the contractions asked for; those that don't exist are left out.
    pub points: Vec<Response>,
    /// What was left out, and why.
    #[serde(skip)]
    pub without: Vec<(f64, FibreError)>,
}

/// The characteristics at `pressures`, each at all `contractions`, on all cores. The same bytes whatever the number of threads.
///
/// Where nothing but pressure acts on inextensible fibres, the shape doesn't depend on the pressure and is computed once.
///
/// # Errors
/// What [`Problem::new`] says, or an approach that doesn't fit the muscle. A contraction without
/// equilibrium is no error: it is listed in [`Isobar::without`].
pub fn isobars(
    muscle: &Muscle,
    pressures: &[Pressure],
    contractions: &[f64],
    approach: Approach,
) -> Result<Vec<Isobar>, FibreError> {
    let mut found: Vec<Isobar> = Vec::with_capacity(pressures.len());
    for pressure in pressures {
        let problem = Problem::new(muscle, *pressure)?;
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
        let limit = self.contraction_limit(approach).ok();
        let method = self.method(approach)?;
        let solve = |chunk: &[f64]| {
            let mut last = [None, None];
            let solved = chunk.iter().map(|&contraction| {
                if let Some(limit) = limit.filter(|limit| contraction > *limit) {
                    return (contraction, Err(FibreError::BeyondLimit { contraction, limit }));
                }
                let found = self.at(method, contraction, extrapolate(last, contraction));
                if let Ok(found) = &found {
                    last = [last[1], found.unknowns().map(|unknowns| (contraction, unknowns))];
                }
                let pulling = found.and_then(|found| match found.response {
                    response if self.pulls(&response) => Ok(response),
                    response => Err(FibreError::WouldPush { contraction, force_n: response.force_n }),
                });
                (contraction, pulling)
            });
            solved.collect::<Vec<_>>()
        };
        let solved: Vec<Vec<_>> = contractions.par_chunks(CHUNK).map(solve).collect();
        let mut isobar = Isobar {
            pressure_pa: self.pressure,
            contraction_limit: limit,
            points: Vec::new(),
            without: Vec::new(),
        };
        for (contraction, response) in solved.into_iter().flatten() {
            match response {
                Ok(response) => isobar.points.push(response),
                Err(error) => isobar.without.push((contraction, error)),
            }
        }
        Ok(isobar)
    }

    /// The characteristic of a scale-free muscle at this pressure from that at another: forces are proportional to the pressure.
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

/// A start from the last two solutions on the same side: linear in the contraction.
fn extrapolate(last: [Option<(f64, Unknowns)>; 2], contraction: f64) -> Option<Unknowns> {
    let (x1, one) = last[1]?;
    let Some((x0, zero)) = last[0] else { return Some(one) };
    let ratio = (contraction - x1) / (x1 - x0);
    if zero.side * one.side < 0.0 || !ratio.is_finite() || ratio.abs() > 2.0 {
        return Some(one);
    }
    Some(Unknowns {
        logs: std::array::from_fn(|i| one.logs[i] + ratio * (one.logs[i] - zero.logs[i])),
        ..one
    })
}
