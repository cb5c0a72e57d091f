//! From a solution to its meridian in metres, and to the dimensionless numbers of the pleated muscle.

use serde::Serialize;

use crate::FibreError;
use crate::meridian::{Station, stations};
use crate::outcome::{Approach, Solution};
use crate::problem::Problem;
use crate::shape::{MeridianPoint, Response, Shape};
use crate::shooting::TOLERANCE;
use crate::solve::{Found, Given};

/// The dimensionless numbers of a pleated muscle with straight fibres (S1 eqs. 19 to 30).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PleatedNumbers {
    /// Parameter m of the elliptic integrals.
    pub m: f64,
    /// Amplitude at the fitting, cos(phi_R) = R/(largest radius) \[rad\].
    pub phi_r: f64,
    /// f = F/(p (n/2 pi) sin(2 pi/n) l0^2).
    pub force_f: f64,
    /// v = V/l0^3.
    pub volume_v: f64,
}

impl Problem {
    /// One equilibrium with its meridian at `points` points (made odd, so that the middle is one of them; at
    /// least 3), equally spaced in fibre length (shooting) or amplitude (closed form).
    ///
    /// # Errors
    /// See [`FibreError`].
    pub fn shape(&self, given: Given, approach: Approach, points: usize) -> Result<Shape, FibreError> {
        let found = self.find(given, approach)?;
        self.drawn(&found, points)
    }

    /// S1's numbers for a response of this problem. `None` if the fibres are not straight or if anything but
    /// pressure acts.
    #[must_use]
    pub fn pleated_numbers(&self, response: &Response) -> Option<PleatedNumbers> {
        let net = &self.net;
        if net.turn != 0.0 || net.cloth.is_some() || net.lobes.is_some() || net.depth != 0.0 {
            return None;
        }
        let l0 = self.parts.length;
        let radius = self.parts.radius;
        let cos = radius / response.mid_radius_m;
        // c3 = F/(n T) = 1 - 2m (eqs. 18 and 20).
        let all = response.fibre_tension_n * self.parts.fibre_number();
        Some(PleatedNumbers {
            m: 0.5 * (1.0 - response.force_n / all),
            phi_r: cos.acos(),
            force_f: response.force_n / (self.pressure * net.area_factor * l0 * l0),
            volume_v: response.volume_m3 / (l0 * l0 * l0),
        })
    }

    fn drawn(&self, found: &Found, points: usize) -> Result<Shape, FibreError> {
        let mut response = found.response;
        let pieces = (points.max(3) - 1).div_ceil(2);
        let failed = FibreError::NotConverged {
            contraction: response.contraction,
            residual: f64::INFINITY,
            iterations: response.convergence.iterations,
        };
        let half = match found.solution {
            Solution::ClosedForm(closed) => {
                // The closed form describes the crests, in units of their radius at the fittings.
                let crest = 1.0 + self.net.depth;
                let tension = found.response.fibre_tension_n * self.parts.fibre_number()
                    / (self.pressure * self.parts.radius.powi(2));
                (0..=pieces)
                    .map(|i| {
                        let [x, r, slope, fibre] = closed.point(closed.phi_r() * i as f64 / pieces as f64);
                        let r = crest * r - self.net.depth;
                        Station { fibre: crest * fibre, x: crest * x, r, chi: -slope, tension }
                    })
                    .collect()
            }
            Solution::Cylinder { radius, tension } => {
                let half = self.net.half_fibre;
                let x = 0.5 * response.length_m / self.parts.radius;
                (0..=pieces)
                    .map(|i| {
                        let part = i as f64 / pieces as f64;
                        Station { fibre: part * half, x: part * x, r: radius, chi: 0.0, tension }
                    })
                    .collect()
            }
            Solution::Shooting(unknowns) => {
                let middle = unknowns.middle(&self.net, |value, _| value).ok_or_else(|| failed.clone())?;
                let (half, departure) = stations(&self.net, middle, self.net.half_fibre, TOLERANCE, pieces)
                    .map_err(|_| failed)?;
                response.convergence.first_integral = departure.max(response.convergence.first_integral);
                half
            }
        };
        let left = half.iter().rev().map(|s| self.point(s, -1.0, response.length_m));
        let right = half.iter().skip(1).map(|s| self.point(s, 1.0, response.length_m));
        let meridian = left.chain(right).collect();
        Ok(Shape { response, meridian })
    }

    /// A station on the left (-1) or right (+1) half.
    fn point(&self, station: &Station, side: f64, length: f64) -> MeridianPoint {
        let net = &self.net.acting_at(station.r);
        let radius = self.parts.radius;
        let local = net.local(station.r, station.tension);
        let fibre = net.half_fibre + side * station.fibre;
        let force = self.pressure * radius * radius;
        let stretch = 1.0 + net.compliance * station.tension;
        MeridianPoint {
            x_m: 0.5 * length + side * radius * station.x,
            r_m: radius * station.r,
            slope_rad: -side * station.chi,
            braid_angle_rad: (net.turn * station.r / stretch).clamp(-1.0, 1.0).asin(),
            fibre_tension_n: force * station.tension / self.parts.fibre_number(),
            fibre_strain: net.compliance * station.tension,
            membrane_force_n_per_m: force * local.force / (2.0 * std::f64::consts::PI * radius * station.r),
            fibre_length_m: radius * fibre,
            turn_rad: net.turn * fibre,
        }
    }
}
