//! The pleated muscle of S1 against its measured force (S1 eq. 31, Table 1): how the error falls as effects
//! are fitted one after the other.

use bulge_fibre::{Approach, Parts, Problem};
use bulge_muscles::{Fibre, Force, Length, Muscle, Parameter, Pressure};
use bulge_numerics::least_squares::{Bounds, Options, Residuals, minimise};
use std::ops::Range;

use crate::check::{Check, Claim, Trouble};
use crate::reference::values;
use crate::specimen::{pleated, ppam};

const FITS: &str = include_str!("../reference/pleated_measured_fits.csv");
/// Coefficients f4 to f0 of S1 Table 1: F in N, p in bar, l0 in m, contraction in per cent.
const TABLE_1: [f64; 5] = [-2.0413, 171.623, -7_178.93, 128_611.6, 146_099.0];
const LENGTH: f64 = 0.11;
/// Range of the measurements in S1: the tests ran from 100 to 3000 N.
const FORCES: [f64; 2] = [100.0, 3000.0];
const FIBRES: f64 = 40.0;
/// Start of a search, far from all bounds.
const START: [(Parameter, f64); 4] = [
    (Parameter::Radius, 0.018),
    (Parameter::FibreStiffness, 15e3),
    (Parameter::HoopStiffness, 60e3),
    (Parameter::UnfoldedRadius, 0.052),
];

/// One point on the fit of S1: pressure \[bar\], contraction, force \[N\].
type Point = (f64, f64, f64);

/// Contractions of 0.5, 1, 1.5, ... % at 1, 2 and 3 bar, where the force is within the measured range.
fn points() -> Vec<Point> {
    let [f4, f3, f2, f1, f0] = TABLE_1;
    let mut points = Vec::new();
    for bar in [1.0, 2.0, 3.0] {
        for half in 1..=73 {
            let percent = 0.5 * f64::from(half);
            let fit = ((f4 * percent + f3) * percent + f2) * percent + f1 + f0 / percent;
            let force = bar * LENGTH * LENGTH * fit;
            if (FORCES[0]..=FORCES[1]).contains(&force) {
                points.push((bar, 0.01 * percent, force));
            }
        }
    }
    points
}

/// Errors of the force in per cent of 3 kN, as functions of some numbers of the muscle, each relative to its
/// start.
struct Misfit {
    points: Vec<Point>,
    muscle: Muscle,
    free: Vec<(Parameter, f64)>,
}

impl Misfit {
    fn new(muscle: Muscle, free: &[(Parameter, f64)]) -> Self {
        Self { points: points(), muscle, free: free.to_vec() }
    }

    fn rms(&self, theta: &[f64]) -> Result<f64, Trouble> {
        let mut errors = vec![0.0; self.rows()];
        self.evaluate(theta, 0..self.rows(), &mut errors, None)?;
        Ok((errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt())
    }
}

impl Residuals for Misfit {
    type Error = String;

    fn rows(&self) -> usize {
        self.points.len()
    }

    fn parameters(&self) -> usize {
        self.free.len()
    }

    fn block(&self) -> usize {
        25
    }

    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), String> {
        let scale = 100.0 / FORCES[1];
        let mut muscle = self.muscle.clone();
        for ((parameter, start), part) in self.free.iter().zip(theta) {
            muscle = muscle.with(*parameter, part * start).map_err(|error| error.to_string())?;
        }
        let asked = if jacobian.is_some() { &self.free[..] } else { &[] };
        let parameters: Vec<_> = asked.iter().map(|(parameter, _)| *parameter).collect();
        let moving = Parts::seeded(&muscle, &parameters);
        for (i, &(bar, contraction, force)) in self.points[rows].iter().enumerate() {
            let found = Problem::new(&muscle, Pressure::bar(bar))
                .and_then(|problem| problem.linearised(contraction, &moving, Approach::Auto))
                .map_err(|error| error.to_string())?;
            residuals[i] = scale * (found.force_n.value - force);
            if let Some(jacobian) = jacobian.as_deref_mut() {
                let row = &mut jacobian[i * self.free.len()..][..self.free.len()];
                for ((out, slope), (_, start)) in row.iter_mut().zip(found.force_n.by_lane).zip(&self.free) {
                    *out = scale * slope * start;
                }
            }
        }
        Ok(())
    }
}

/// The dimensions of the drawing, and the radius that fits better according to S1.
pub(crate) fn stated_radii() -> Check {
    Claim {
        group: "published",
        name: "error against the measured force of the second-generation PPAM: 6.7 % with R = 11.5 mm, 2.9 % with R = 16 mm",
        source: "S1 eq. 31 and Table 1 (100 to 3000 N at 1, 2, 3 bar, every 0.5 %), elliptic integrals by SciPy; rms in % of 3 kN",
        tolerance: 1e-8,
        why: "eight printed digits",
    }
    .run(|tally| {
        for (radius, expected) in [(11.5, 6.675_933_254), (16.0, 2.926_177_427)] {
            let muscle = pleated(Length::m(LENGTH), Length::mm(radius), Some(40))?;
            let rms = Misfit::new(muscle, &[]).rms(&[])?;
            tally.relative(rms, expected, || format!("{rms:.4} % with {radius} mm"));
        }
        Ok(())
    })
}

/// Adds the radius, then the stretch of the fibres, then cloth that stops the unfolding: 1.51, 0.84 and 0.44
/// %.
pub(crate) fn fits() -> Check {
    Claim {
        group: "published",
        name: "the same with the radius fitted (1.51 %), the fibres' stretch (0.84 %) and taut cloth (0.44 %): parameters and error",
        source: "S1 eq. 31 and Table 1, fitted by SciPy with a quadrature of the first integral",
        tolerance: 1e-5,
        why: "six printed digits of the cloth's stiffness, which a flat valley leaves at 1e-6",
    }
    .run(|tally| {
        let elastic = ppam()?.with_fibre(Fibre::new(Force::n(START[1].1))?)?;
        let cloth = [(Parameter::HoopStiffness, 60e3), (Parameter::UnfoldedRadius, 0.052)];
        let muscles = [ppam()?, elastic.clone(), elastic.with_all(&cloth)?];
        let options = Options { tolerance: 1e-8, check_curvature: false, ..Options::default() };
        for ((muscle, row), free) in muscles.into_iter().zip(values::<5>(FITS)?).zip([1, 2, 4]) {
            let misfit = Misfit::new(muscle, &START[..free]);
            let found = minimise(&misfit, &vec![1.0; free], &Bounds::none(free), &options)?;
            if !found.certificate.converged {
                return Err(format!("{free} parameters: {:?}", found.certificate.reason).into());
            }
            let rms = (found.cost / misfit.rows() as f64).sqrt();
            tally.relative(rms, row[4], || format!("{rms:.4} % with {free} parameters"));
            // The file has millimetres and kilonewtons, and the total stiffness of all fibres.
            let units = [1e3, 1e-3 * FIBRES, 1e-3, 1e3];
            for (i, (part, (parameter, start))) in found.theta.iter().zip(&misfit.free).enumerate() {
                let value = part * start * units[i];
                tally.relative(value, row[i], || format!("{} = {value:.4} of {free}", parameter.name()));
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_table_1() {
        let points = points();
        assert_eq!(points.len(), 175);
        for (contraction, force) in [(0.05, 1524.0), (0.10, 1047.0), (0.20, 540.0), (0.30, 211.0)] {
            assert!(points.iter().any(|point| {
                point.0 < 1.5 && (point.1 - contraction).abs() < 1e-9 && (point.2 - force).abs() < 0.5
            }));
        }
    }
}
