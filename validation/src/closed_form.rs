//! The closed form of the pleated muscle against tables of elliptic integrals.

use bulge_fibre::{Approach, Given, Problem, closed_form};
use bulge_muscles::{Length, Parameter, Pressure};
use bulge_numerics::{elliptic, gauss};
use std::f64::consts::PI;

use crate::check::{Check, Claim, Tally, Trouble};
use crate::reference::{self, PLEATED_ELASTIC, PLEATED_INELASTIC};
use crate::specimen::pleated;

const FIBRES: f64 = 40.0;
const RADIUS: Length = Length::mm(10.0);
const PRESSURE: Pressure = Pressure::bar(2.0);

/// Force, volume, m, `phi_R` and radius of inextensible fibres.
pub(crate) fn inelastic() -> Check {
    Claim {
        group: "closed form",
        name: "force, volume, m, phi_R and radius of inextensible fibres",
        source: "reference/pleated_inelastic.csv",
        tolerance: 1e-10,
        why: "12 digits in the table; f counts against at least 0.01, where it vanishes",
    }
    .run(|tally| {
        for [slenderness, contraction, m, phi, f, v, radius] in reference::values(PLEATED_INELASTIC)? {
            compare(tally, [slenderness, contraction, 0.0], [m, phi, f, v, radius, 0.0])?;
        }
        Ok(())
    })
}

/// Force, volume, m, `phi_R` and radius of elastic fibres, and their strain.
pub(crate) fn elastic() -> Check {
    Claim {
        group: "closed form",
        name: "force, volume, m, phi_R, radius and strain of elastic fibres",
        source: "reference/pleated_elastic.csv",
        tolerance: 1e-10,
        why: "12 digits in the table; f counts against at least 0.01, where it vanishes",
    }
    .run(|tally| {
        for [slenderness, group, contraction, m, phi, f, v, radius, strain] in
            reference::values(PLEATED_ELASTIC)?
        {
            compare(tally, [slenderness, contraction, group], [m, phi, f, v, radius, strain])?;
        }
        Ok(())
    })
}

/// Compares one row, computed as a user does (through a muscle) and directly.
fn compare(
    tally: &mut Tally,
    [slenderness, contraction, group]: [f64; 3],
    [m, phi, f, v, radius, strain]: [f64; 6],
) -> Result<(), Trouble> {
    let mut muscle = pleated(Length::m(slenderness * RADIUS.to_m()), RADIUS, Some(40))?;
    if group > 0.0 {
        let stiffness = PRESSURE.to_pa() * (2.0 * PI / FIBRES).sin() * RADIUS.to_m().powi(2) / group;
        muscle = muscle.with(Parameter::FibreStiffness, stiffness)?;
    }
    let problem = Problem::new(&muscle, PRESSURE)?;
    let found = problem.solve(Given::Contraction(contraction), Approach::ClosedForm)?;
    let numbers = problem.pleated_numbers(&found).ok_or("a pleated muscle has no pleated numbers")?;
    let case =
        |what: &str| format!("{what} at l0/R = {slenderness}, group {group}, contraction {contraction}");
    let area = FIBRES / (2.0 * PI) * (2.0 * PI / FIBRES).sin();
    let l0 = slenderness * RADIUS.to_m();
    for (what, got, expected, floor) in [
        ("m", numbers.m, m, 0.0),
        ("phi_R", numbers.phi_r, phi, 0.0),
        ("f", numbers.force_f, f, 1e-2),
        ("v", numbers.volume_v, v, 0.0),
        ("force", found.force_n, PRESSURE.to_pa() * area * l0 * l0 * f, PRESSURE.to_pa() * l0 * l0 * 1e-2),
        ("volume", found.volume_m3, l0.powi(3) * v, 0.0),
        ("polygon volume", found.volume_polygon_m3, area * l0.powi(3) * v, 0.0),
        ("radius", found.max_radius_m / RADIUS.to_m(), radius, 0.0),
        // A strain of 0 is compared absolutely.
        ("strain", found.fibre_strain, strain, if strain == 0.0 { 1.0 } else { 0.0 }),
    ] {
        tally.scaled(got, expected, floor, || case(what));
    }
    let direct = closed_form::solve(contraction, slenderness, group / 4.0)?;
    for (what, got, expected, floor) in [
        ("m (direct)", direct.m, m, 0.0),
        ("phi_R (direct)", direct.phi_r(), phi, 0.0),
        ("f (direct)", direct.force.value, f, 1e-2),
        ("v (direct)", direct.volume.value, v, 0.0),
        ("radius (direct)", direct.max_radius(), radius, 0.0),
        ("strain (direct)", direct.strain, strain, if strain == 0.0 { 1.0 } else { 0.0 }),
    ] {
        tally.scaled(got, expected, floor, || case(what));
    }
    Ok(())
}

/// The elliptic integrals themselves against their definition.
pub(crate) fn elliptic_integrals() -> Check {
    Claim {
        group: "closed form",
        name: "elliptic integrals F and D against quadrature of their definition",
        source: "composite Gauss-Legendre quadrature of order 12",
        tolerance: 2e-14,
        why: "rounding of some hundred sums",
    }
    .run(|tally| {
        for phi in [1e-3, 0.1, 0.3, 0.55, 0.8, 1.0, 1.2, 1.35, 1.45] {
            for m in [0.0, 1e-6, 0.01, 0.1, 0.25, 0.4, 0.5, 0.6] {
                const PIECES: u32 = 64;
                let h = phi / f64::from(PIECES);
                let integral = |g: &dyn Fn(f64) -> f64| -> f64 {
                    (0..PIECES).map(|i| h * gauss::integrate(|x| g(h * (f64::from(i) + x)))).sum()
                };
                let delta = |angle: f64| (1.0 - m * angle.sin().powi(2)).sqrt();
                let pair = elliptic::incomplete(f64::tan(phi), m);
                let (f, d) = (integral(&|a| 1.0 / delta(a)), integral(&|a| a.sin().powi(2) / delta(a)));
                tally.relative(pair.f, f, || format!("F({phi}|{m})"));
                tally.relative(pair.d, d, || format!("D({phi}|{m})"));
            }
        }
        Ok(())
    })
}
