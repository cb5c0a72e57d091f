//! Shooting on the equilibrium ODE against the closed form, over the whole range of the pleated muscle.

use bulge_fibre::{Approach, Problem, Response};
use bulge_muscles::{Length, Muscle, Parameter, Pressure, Quantity};

use crate::check::{Check, Claim, Tally, Trouble};
use crate::specimen::pleated;

const SLENDERNESS: [f64; 10] = [0.5, 1.0, 2.0, 4.0, 6.875, 15.0, 40.0, 120.0, 400.0, 1000.0];
const RADIUS: Length = Length::mm(10.0);
const PRESSURE: Pressure = Pressure::bar(1.5);

/// Inextensible fibres.
pub(crate) fn inextensible() -> Check {
    Claim {
        group: "shooting",
        name: "force, volume and radius against the closed form, inextensible fibres",
        source: "elliptic integrals",
        tolerance: 1e-10,
        why: "the integrator keeps 4e-12 a step; the force counts against at least 0.01 p (l0^2 + R^2) near the limit",
    }
    .run(|tally| each_inextensible(|muscle, contraction| compare(tally, muscle, contraction, &WHOLE)))
}

fn each_inextensible(mut visit: impl FnMut(&Muscle, f64) -> Result<(), Trouble>) -> Result<(), Trouble> {
    for slenderness in SLENDERNESS {
        let muscle = pleated(Length::m(slenderness * RADIUS.to_m()), RADIUS, Some(24))?;
        let limit = Problem::new(&muscle, PRESSURE)?.contraction_limit(Approach::ClosedForm)?;
        for part in [1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.99] {
            visit(&muscle, part * limit)?;
        }
    }
    Ok(())
}

/// Elastic fibres, including muscles longer than at rest.
pub(crate) fn elastic() -> Check {
    Claim {
        group: "shooting",
        name: "force, volume and radius against the closed form, elastic fibres, also stretched",
        source: "elliptic integrals",
        tolerance: 1e-10,
        why: "the integrator keeps 4e-12 a step; the force counts against at least 0.01 p (l0^2 + R^2) near the limit",
    }
    .run(|tally| each_elastic(|muscle, contraction| compare(tally, muscle, contraction, &WHOLE)))
}

/// Quantities that vary along the fibre.
pub(crate) fn along_the_fibre() -> Check {
    Claim {
        group: "shooting",
        name: "tension, strain and end slope against the closed form",
        source: "elliptic integrals",
        tolerance: 1e-10,
        why: "the integrator keeps 4e-12 a step; an angle counts in radians",
    }
    .run(|tally| {
        each_inextensible(|muscle, contraction| compare(tally, muscle, contraction, &LOCAL))?;
        each_elastic(|muscle, contraction| compare(tally, muscle, contraction, &LOCAL))
    })
}

fn each_elastic(mut visit: impl FnMut(&Muscle, f64) -> Result<(), Trouble>) -> Result<(), Trouble> {
    for slenderness in SLENDERNESS {
        let plain = pleated(Length::m(slenderness * RADIUS.to_m()), RADIUS, Some(24))?;
        // The group p sin(2 pi/n) l0^2/(4 EA), about the cube of the strain divided by that of the slope.
        for group in [1e-6, 1e-4, 1e-3, 1e-2] {
            let width = (std::f64::consts::TAU / 24.0).sin();
            let stiffness = PRESSURE.to_pa() * width * plain.length().si().powi(2) / (4.0 * group);
            let muscle = plain.with(Parameter::FibreStiffness, stiffness)?;
            for contraction in elastic_contractions(&muscle)? {
                visit(&muscle, contraction)?;
            }
        }
    }
    Ok(())
}

/// Contractions from a length stretched by a few times the strain at the rest length to 0.99 of the limit.
fn elastic_contractions(muscle: &Muscle) -> Result<Vec<f64>, Trouble> {
    let problem = Problem::new(muscle, PRESSURE)?;
    let limit = problem.contraction_limit(Approach::ClosedForm)?;
    let strain = problem.follow(0.0, Approach::ClosedForm)?.fibre_strain;
    let stretched = [-2.0, -1.0, -0.3].map(|times| times * strain);
    let contracted = [1e-6, 1e-3, 0.05, 0.3, 0.7, 0.99].map(|part| part * limit);
    Ok(stretched.into_iter().chain([0.0]).chain(contracted).collect())
}

/// Pleats with a depth, which changes the radius on which the pressure acts.
pub(crate) fn pleats() -> Check {
    Claim {
        group: "shooting",
        name: "force, volume, radius and tension of pleats with a depth h against the closed form of the radius R + h",
        source: "elliptic integrals",
        tolerance: 1e-10,
        why: "the integrator keeps 4e-12 a step; the force counts against at least 0.01 p (l0^2 + R^2) near the limit",
    }
    .run(|tally| {
        for slenderness in [1.0, 6.875, 60.0] {
            for depth in [0.02, 0.3, 1.5] {
                let plain = pleated(Length::m(slenderness * RADIUS.to_m()), RADIUS, Some(24))?
                    .with(Parameter::PleatDepth, depth * RADIUS.to_m())?;
                let limit = Problem::new(&plain, PRESSURE)?.contraction_limit(Approach::ClosedForm)?;
                let stiffness = 30.0 * PRESSURE.to_pa() * plain.length().si().powi(2);
                let elastic = plain.with(Parameter::FibreStiffness, stiffness)?;
                for part in [0.01, 0.2, 0.6, 0.95] {
                    for muscle in [&plain, &elastic] {
                        compare(tally, muscle, part * limit, &WHOLE)?;
                        compare(tally, muscle, part * limit, &LOCAL)?;
                    }
                }
                compare(tally, &elastic, -1e-3, &WHOLE)?;
            }
        }
        Ok(())
    })
}

/// A compared quantity: its name, its value, and the smallest size to which its error is related: a fraction
/// of p (l0^2 + R^2), of the value itself, or of 1.
type Output = (&'static str, fn(&Response) -> f64, Floor);

#[derive(Clone, Copy)]
enum Floor {
    Force,
    None,
    One,
}

const WHOLE: [Output; 4] = [
    ("force", |r| r.force_n, Floor::Force),
    ("volume", |r| r.volume_m3, Floor::None),
    ("polygon volume", |r| r.volume_polygon_m3, Floor::None),
    ("radius", |r| r.max_radius_m, Floor::None),
];

const LOCAL: [Output; 3] = [
    ("tension", |r| r.fibre_tension_n, Floor::None),
    ("1 + strain", |r| 1.0 + r.fibre_strain, Floor::None),
    ("end slope", |r| r.end_slope_rad, Floor::One),
];

fn compare(tally: &mut Tally, muscle: &Muscle, contraction: f64, outputs: &[Output]) -> Result<(), Trouble> {
    let problem = Problem::new(muscle, PRESSURE)?;
    let exact = problem.follow(contraction, Approach::ClosedForm)?;
    let l0 = muscle.length().si();
    let case = |what: &str| {
        let slenderness = l0 / RADIUS.to_m();
        format!(
            "{what} at l0/R = {slenderness}, contraction {contraction:e}, strain {:.1e}",
            exact.fibre_strain
        )
    };
    let found = problem
        .follow(contraction, Approach::Shooting)
        .map_err(|error| format!("{}: {error}", case("shooting")))?;
    for (what, read, floor) in outputs {
        let floor = match floor {
            Floor::Force => PRESSURE.to_pa() * (l0 * l0 + RADIUS.to_m().powi(2)) * 1e-2,
            Floor::None => 0.0,
            Floor::One => 1.0,
        };
        tally.scaled(read(&found), read(&exact), floor, || case(what));
    }
    Ok(())
}
