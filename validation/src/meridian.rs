//! The drawn meridian: it must obey the first integral, and its points, slopes, lengths and volume must be
//! consistent.

use bulge_fibre::{Approach, Given, MeridianPoint, Problem, Shape};
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity};
use std::f64::consts::PI;

use crate::check::{Check, Claim, Trouble};
use crate::difference::order;
use crate::sample::Sampler;
use crate::section::area;
use crate::specimen::every_kind;

/// Number of random muscles whose meridian is drawn. One in fifty of them may end in an error.
const MUSCLES: usize = 150;
const PRESSURE: Pressure = Pressure::bar(2.0);

/// `N cos(psi) = F + p A(r)` from the values reported at each point.
pub(crate) fn first_integral() -> Check {
    Claim {
        group: "meridian",
        name: "first integral N cos(psi) = F + p A(r) along meridians of random muscles",
        source: "theory, relative to N at mid-length",
        tolerance: 1e-9,
        why: "tolerance 1e-11 of the integrator, which does not use it",
    }
    .run(|tally| {
        let mut sampler = Sampler::new(7);
        let mut unanswered = Vec::new();
        for i in 0..MUSCLES {
            let (muscle, pressure) = (sampler.muscle()?, sampler.pressure());
            let part = sampler.between(0.02, 0.98);
            let shape = match pulling(&muscle, pressure, part, 61) {
                Ok(shape) => shape,
                Err(error) => {
                    unanswered.push(format!("number {i}, {part} of the limit, {pressure}: {error}"));
                    continue;
                }
            };
            let departure = shape.response.convergence.first_integral;
            tally.absolute(departure, 0.0, || format!("reported, number {i}: {}", muscle.name()));
            let middle = shape.meridian.get(30).ok_or("a short meridian")?;
            let scale = meridional_force(middle);
            let integral = |point: &MeridianPoint| {
                meridional_force(point) * point.slope_rad.cos() - pressure.si() * area(&muscle, point.r_m)
            };
            // The force is corrected by the last Newton step (up to 1e-8), but the drawn meridian is not.
            let case = || format!("a tenth of the departure from the force, number {i}: {}", muscle.name());
            tally.add(0.1 * (integral(middle) - shape.response.force_n) / scale, case);
            for point in &shape.meridian {
                let departure = (integral(point) - integral(middle)) / scale;
                tally.add(departure, || format!("number {i}: {} at x = {}", muscle.name(), point.x_m));
            }
        }
        if unanswered.len() > MUSCLES / 50 {
            return Err(format!("{} without an answer, such as {}", unanswered.len(), unanswered[0]).into());
        }
        Ok(())
    })
}

/// A shape at a fraction of the contraction limit, but never where inextensible fibres would be too short.
fn pulling(muscle: &Muscle, pressure: Pressure, part: f64, points: usize) -> Result<Shape, Trouble> {
    let problem = Problem::new(muscle, pressure)?;
    let limit = problem.contraction_limit(Approach::Auto)?;
    // A stiff bladder in a steep braid pulls only if it is stretched.
    let contraction = if limit > 0.0 { part * limit } else { (2.0 - part) * limit };
    Ok(problem.shape(Given::Contraction(contraction), Approach::Auto, points)?)
}

fn meridional_force(point: &MeridianPoint) -> f64 {
    point.membrane_force_n_per_m * 2.0 * PI * point.r_m
}

/// The length of the drawn polyline of one fibre in space tends to the stretched length of the fibre with the
/// square of the spacing.
pub(crate) fn fibre_length() -> Check {
    Claim {
        group: "meridian",
        name: "length of the drawn fibre in space -> its stretched length, order 2 in the spacing",
        source: "chords of a smooth curve",
        tolerance: 0.01,
        why: "the next term is of fourth order in the spacing: (pi/100)^2 for a half circle; cloth has a kink",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            if name.starts_with("cylinder") {
                continue;
            }
            let problem = Problem::new(&muscle, PRESSURE)?;
            let mut last = None;
            for points in [101, 201, 401] {
                let shape = problem.shape(Given::Contraction(contraction), Approach::Auto, points)?;
                let gap = polyline(&shape.meridian) / stretched(&shape.meridian) - 1.0;
                if let Some(coarse) = last.replace(gap) {
                    tally.absolute(order(coarse, gap, 2.0), 2.0, || format!("{points} points, {name}"));
                }
            }
        }
        Ok(())
    })
}

/// Sum of the chords of a fibre at (r, turn, x).
fn polyline(points: &[MeridianPoint]) -> f64 {
    let chord = |a: &MeridianPoint, b: &MeridianPoint| {
        // |r_a e^(i turn_a) - r_b e^(i turn_b)|^2
        let across = 4.0 * a.r_m * b.r_m * (0.5 * (b.turn_rad - a.turn_rad)).sin().powi(2);
        ((b.r_m - a.r_m).powi(2) + across + (b.x_m - a.x_m).powi(2)).sqrt()
    };
    points.windows(2).map(|pair| chord(&pair[0], &pair[1])).sum()
}

/// Integral of 1 + strain over the unstretched length.
fn stretched(points: &[MeridianPoint]) -> f64 {
    simpson(points, |point| point.fibre_length_m, |point| 1.0 + point.fibre_strain)
}

/// Integral of `f` over `x`, with a parabola through each pair of intervals (which need not be equal).
fn simpson(
    points: &[MeridianPoint],
    x: impl Fn(&MeridianPoint) -> f64,
    f: impl Fn(&MeridianPoint) -> f64,
) -> f64 {
    let piece = |p: &[MeridianPoint]| {
        let (a, b) = (x(&p[1]) - x(&p[0]), x(&p[2]) - x(&p[1]));
        let sum = (2.0 - b / a) * f(&p[0]) + (a + b).powi(2) / (a * b) * f(&p[1]) + (2.0 - a / b) * f(&p[2]);
        (a + b) / 6.0 * sum
    };
    points.windows(3).step_by(2).map(piece).sum()
}

/// Axial length, radius and volume, computed from the drawn slopes and angles, equal those of the points and
/// of the response.
pub(crate) fn consistency() -> Check {
    Claim {
        group: "meridian",
        name: "end distance, radius at mid-length, fibre length and volume integrated along the drawn meridian",
        source: "dx = cos(psi) ds, dr = sin(psi) ds, ds = (1 + e) cos(theta) dS, dV = pi r^2 dx; Simpson's rule",
        tolerance: 1e-8,
        why: "Simpson's rule with 2001 points, third order where the cloth becomes taut; the last Newton step is up to 1e-8",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            let problem = Problem::new(&muscle, PRESSURE)?;
            // Shooting gives points that are equally spaced in fibre length; the closed form doesn't.
            let approach = if name.starts_with("cylinder") { Approach::Auto } else { Approach::Shooting };
            let shape = problem.shape(Given::Contraction(contraction), approach, 2001)?;
            let points = &shape.meridian;
            let (first, last) = points.first().zip(points.last()).ok_or("an empty meridian")?;
            let middle = &points[points.len() / 2];
            let fibre = |point: &MeridianPoint| point.fibre_length_m;
            let ds = |point: &MeridianPoint| (1.0 + point.fibre_strain) * point.braid_angle_rad.cos();
            let dx = |point: &MeridianPoint| ds(point) * point.slope_rad.cos();
            let response = &shape.response;
            let length = response.length_m;
            let case = |what: &str| format!("{what}, {name}");
            tally.relative(last.x_m - first.x_m, length, || case("last point"));
            tally.relative(simpson(points, fibre, dx), length, || case("end distance from the slopes"));
            let rise = simpson(&points[..=points.len() / 2], fibre, |point| ds(point) * point.slope_rad.sin());
            tally.relative(first.r_m + rise, middle.r_m, || case("mid radius from the slopes"));
            tally.relative(middle.r_m, response.mid_radius_m, || case("mid radius"));
            if !name.starts_with("cylinder") {
                tally.relative(first.r_m, muscle.end_radius().si(), || case("first point"));
                tally.relative(last.r_m, muscle.end_radius().si(), || case("last point's radius"));
            }
            let get = |parameter| muscle.get(parameter);
            let angle = get(Parameter::Misalignment).or(get(Parameter::BraidAngle)).unwrap_or(0.0);
            let whole = muscle.length().si() / angle.cos();
            tally.relative(last.fibre_length_m - first.fibre_length_m, whole, || case("fibre length"));
            let gas = get(Parameter::GasWall).map(|wall| -wall);
            let depth = get(Parameter::PleatDepth).or(gas).unwrap_or(0.0);
            let lobed = muscle.get(Parameter::ClothCircumference).is_some();
            let round = |r: f64| if lobed { area(&muscle, r) } else { PI * (r + depth).powi(2) };
            let volume = simpson(points, fibre, |point| round(point.r_m) * dx(point));
            tally.relative(volume, response.volume_m3, || case("volume"));
            let polygon = simpson(points, fibre, |point| area(&muscle, point.r_m) * dx(point));
            tally.relative(polygon, response.volume_polygon_m3, || case("polygon volume"));
        }
        Ok(())
    })
}
