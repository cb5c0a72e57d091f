//! Isobars against equilibria that are solved one by one.

use bulge_fibre::{Approach, Given, Problem, Response, isobars};
use bulge_muscles::Pressure;

use crate::check::{Check, Claim};
use crate::specimen::every_kind;

/// Isobars take neighbours as starts and scale pressures. Neither may affect the result.
pub(crate) fn one_by_one() -> Check {
    Claim {
        group: "characteristics",
        name: "isobars at 1, 2 and 5 bar against equilibria solved one by one",
        source: "the same equations from another start",
        tolerance: 1e-8,
        why: "derivatives are as exact as the last Newton step is small, at most 1e-8",
    }
    .run(|tally| {
        let pressures = [1.0, 2.0, 5.0].map(Pressure::bar);
        for (name, muscle, contraction) in every_kind()? {
            let contractions = [0.2, 0.5, 0.8, 1.0].map(|part| part * contraction);
            for isobar in isobars(&muscle, &pressures, &contractions, Approach::Auto)? {
                let problem = Problem::new(&muscle, Pressure::pa(isobar.pressure_pa))?;
                let limit = problem.contraction_limit(Approach::Auto)?;
                tally.relative(isobar.contraction_limit.unwrap_or(f64::NAN), limit, || {
                    format!("limit, {name}")
                });
                for point in &isobar.points {
                    let alone = problem.solve(Given::Contraction(point.contraction), Approach::Auto)?;
                    for (what, read) in OUTPUTS {
                        let case =
                            || format!("{what}, {name}, {} Pa, {}", point.pressure_pa, point.contraction);
                        // Forces vanish at the limit, and so does their contribution to the tension.
                        tally.scaled(read(point), read(&alone), floor(what, &alone), case);
                    }
                }
                let answered = isobar.points.len() + isobar.without.len();
                tally.absolute(answered as f64, contractions.len() as f64, || {
                    format!("number of answers, {name}")
                });
            }
        }
        Ok(())
    })
}

type Output = (&'static str, fn(&Response) -> f64);

const OUTPUTS: [Output; 9] = [
    ("pressure", |r| r.pressure_pa),
    ("force", |r| r.force_n),
    ("length", |r| r.length_m),
    ("volume", |r| r.volume_m3),
    ("largest radius", |r| r.max_radius_m),
    ("tension", |r| r.fibre_tension_n),
    ("stiffness", |r| r.stiffness_n_per_m),
    ("isothermal stiffness", |r| r.stiffness_isothermal_n_per_m),
    ("adiabatic stiffness", |r| r.stiffness_adiabatic_n_per_m),
];

/// Smallest size to which a difference is related.
fn floor(what: &str, alone: &Response) -> f64 {
    match what {
        "force" => alone.pressure_pa * alone.max_radius_m * alone.max_radius_m,
        _ => 0.0,
    }
}
