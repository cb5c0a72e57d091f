//! The force as a derivative of energy. Every equilibrium obeys this, whatever carries the load.

use bulge_fibre::{Approach, Given, MeridianPoint, Problem, Shape};
use bulge_muscles::{Construction, Muscle, Parameter, Pressure, Quantity};
use std::f64::consts::PI;

use crate::check::{Check, Claim, Trouble};
use crate::difference::derivative;
use crate::section::area;
use crate::specimen::{at, every_kind, pressure_only, stride};

const PRESSURE: Pressure = Pressure::bar(2.0);

/// F = -p dV/dl.
pub(crate) fn virtual_work() -> Check {
    Claim {
        group: "energy",
        name: "F = -p dV/dl, inextensible fibres, by differences and by the reported slope",
        source: "virtual work",
        tolerance: 1e-8,
        why: "volumes are exact to 1e-11 and differ by some per cent",
    }
    .run(|tally| {
        for (name, muscle, contraction) in pressure_only()? {
            let found = at(&muscle, PRESSURE, contraction)?;
            let volume = |eps| at(&muscle, PRESSURE, eps).map(|found| [found.volume_polygon_m3]);
            let [slope] = derivative(volume, contraction, 0.015 * stride(&muscle) * contraction.abs())?;
            let p = PRESSURE.to_pa();
            tally
                .relative(found.force_n, p * slope / muscle.length().si(), || format!("differences, {name}"));
            tally.relative(found.force_n, -p * found.volume_slope_m2, || format!("reported slope, {name}"));
        }
        Ok(())
    })
}

/// `dF/dp = -dV/dl`, because both are second derivatives of one potential `G(l, p)` with `dG = F dl - V dp`.
pub(crate) fn maxwell() -> Check {
    Claim {
        group: "energy",
        name: "dF/dp = -dV/dl with stored energy of fibres, bladder and cloth",
        source: "Maxwell relation of dG = F dl - V dp",
        tolerance: 1e-8,
        why: "both sides are exact derivatives of solutions to 1e-11; the last Newton step leaves up to 1e-8",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            let problem = Problem::new(&muscle, PRESSURE)?;
            let gradient = problem.gradient(contraction, Approach::Auto)?;
            let [force, _] = gradient.by_pressure;
            let found = problem.follow(contraction, Approach::Auto)?;
            let polygon = found.volume_polygon_m3 / found.volume_m3;
            let volume = polygon * gradient.by_contraction[1] / muscle.length().si();
            tally.relative(force, volume, || name.into());
            tally.relative(force, -found.volume_slope_m2, || format!("reported slope, {name}"));
        }
        Ok(())
    })
}

/// F = dG/dl. The potential is integrated along the drawn meridian from the definitions of the energies.
pub(crate) fn potential() -> Check {
    Claim {
        group: "energy",
        name: "F = d(U - pV)/dl, U and V integrated along the drawn meridian",
        source: "definitions of the stored energies, Simpson's rule",
        tolerance: 1e-7,
        why: "Simpson's rule loses an order where the cloth becomes taut; potentials differ by some per cent",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            // Simpson's rule needs points that are equally spaced in fibre length: by shooting, or along the
            // straight cylinder.
            let problem = Problem::new(&muscle, PRESSURE)?;
            let approach = if name.starts_with("cylinder") { Approach::Auto } else { Approach::Shooting };
            let energy = |eps| -> Result<[f64; 2], Trouble> {
                let shape = problem.shape(Given::Contraction(eps), approach, POINTS)?;
                integrate(&muscle, &shape)
            };
            let [_, volume] = energy(contraction)?;
            let found = problem.follow(contraction, approach)?;
            tally.add(1e2 * (volume / found.volume_polygon_m3 - 1.0), || format!("volume x 100, {name}"));
            let potential = |eps| energy(eps).map(|[potential, _]| [potential]);
            let [slope] = derivative(potential, contraction, 0.03 * stride(&muscle) * contraction.abs())?;
            tally.relative(found.force_n, -slope / muscle.length().si(), || name.into());
        }
        Ok(())
    })
}

/// Points of a drawn meridian. The number is odd, so that Simpson's rule fits each half.
const POINTS: usize = 4001;

/// Potential U - pV and the volume of the cross-sections that carry the pressure.
fn integrate(muscle: &Muscle, shape: &Shape) -> Result<[f64; 2], Trouble> {
    let points = &shape.meridian;
    let (first, last) = points.first().zip(points.last()).ok_or("an empty meridian")?;
    let h = (last.fibre_length_m - first.fibre_length_m) / (points.len() - 1) as f64;
    let mut sum = [0.0; 2];
    for (i, point) in points.iter().enumerate() {
        let weight = match i {
            _ if i == 0 || i + 1 == points.len() => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let (stored, volume) = densities(muscle, point);
        sum[0] += weight * h / 3.0 * (stored - PRESSURE.to_pa() * volume);
        sum[1] += weight * h / 3.0 * volume;
    }
    Ok(sum)
}

/// Stored energy and volume per unstretched length of fibre.
fn densities(muscle: &Muscle, point: &MeridianPoint) -> (f64, f64) {
    let r = point.r_m;
    // Meridional length per unstretched fibre length.
    let sigma = (1.0 + point.fibre_strain) * point.braid_angle_rad.cos();
    let fibres = muscle.fibres().map_or(1.0, f64::from);
    let mut stored = 0.5 * fibres * point.fibre_tension_n * point.fibre_strain;
    let rest = match muscle.construction() {
        Construction::Pleated(_) => 1.0,
        Construction::Braided(braided) => braided.braid_angle().si().cos(),
    };
    let get = |parameter| muscle.get(parameter);
    if let (Some(wall), Some(c10), Some(c01)) =
        (muscle.bladder_wall(), get(Parameter::C10), get(Parameter::C01))
    {
        let (a, b) = ((sigma / rest).powi(2), (r / muscle.radius().si()).powi(2));
        let (i1, i2) = (a + b + 1.0 / (a * b), 1.0 / a + 1.0 / b + a * b);
        let w = c10 * (i1 - 3.0) + c01 * (i2 - 3.0);
        // Area of the section of the wall at rest, times the axial length at rest of this piece of fibre.
        stored += 2.0 * PI * muscle.radius().si() * wall.si() * rest * w;
    }
    if let (Some(stiffness), Some(radius)) = (get(Parameter::HoopStiffness), get(Parameter::UnfoldedRadius)) {
        let taut = (r - radius).max(0.0);
        let developed = 2.0 * PI * radius;
        stored += sigma * stiffness * (2.0 * PI * taut).powi(2) / (2.0 * developed);
    }
    (stored, area(muscle, r) * sigma * point.slope_rad.cos())
}
