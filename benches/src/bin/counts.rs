//! Cost of an equilibrium: iterations, evaluations and steps of each method, with the resulting error.
//!
//! The error is that of the force. It is relative to the closed form (shooting of the pleated muscle) or to
//! the reference values of `validation/reference` (energy minimisation for the braids, 12 digits of elliptic
//! integrals for the closed form).

use bulge_benches::{Failure, SLENDERNESS, bladder, braid, cylinder, median_us, pleated, solve};
use bulge_fibre::{Approach, Problem};
use std::hint::black_box;

const PLEATED: &str = include_str!("../../../validation/reference/pleated_inelastic.csv");
const BRAIDED: &str = include_str!("../../../validation/reference/braided_clamped_net.csv");

/// The value in the column `wanted` of the first row with the given values in other columns.
fn look_up(table: &str, keys: &[(&str, f64)], wanted: &str) -> Option<f64> {
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next()?.split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name);
    let wanted = column(wanted)?;
    let keys: Vec<(usize, f64)> =
        keys.iter().filter_map(|(name, value)| Some((column(name)?, *value))).collect();
    lines
        .filter_map(|line| line.split(',').map(|cell| cell.parse().ok()).collect::<Option<Vec<f64>>>())
        .find(|row| keys.iter().all(|(column, value)| (row[*column] - value).abs() < 1e-9))
        .map(|row| row[wanted])
}

/// Reference force of the clamped braid \[N\] at 3 bar.
fn braid_reference(length: f64, contraction: f64) -> Option<f64> {
    let keys = [("r0_m", 0.01), ("l0_m", length), ("braid_angle_deg", 25.0), ("contraction", contraction)];
    look_up(BRAIDED, &keys, "force_over_pressure_m2").map(|force| force * 3e5)
}

/// Reference force of the pleated muscle \[N\] at 1 bar.
fn pleated_reference(contraction: f64) -> Option<f64> {
    let keys = [("slenderness_l0_over_R", SLENDERNESS), ("contraction", contraction)];
    let polygon = 40.0 / std::f64::consts::TAU * (std::f64::consts::TAU / 40.0).sin();
    look_up(PLEATED, &keys, "force_f").map(|f| f * 1e5 * polygon * 0.11 * 0.11)
}

fn row(
    name: &str,
    problem: &Problem,
    approach: Approach,
    contraction: f64,
    reference: Option<f64>,
) -> Result<(), Failure> {
    let found = solve(problem, contraction, approach)?;
    let calls = if found.convergence.steps == 0 { 1000 } else { 20 };
    let time = median_us(9, calls, || {
        for _ in 0..calls {
            let _ = black_box(solve(black_box(problem), black_box(contraction), approach));
        }
    });
    let count = found.convergence;
    let error = reference
        .map_or_else(|| "-".to_owned(), |force| format!("{:.0e}", (found.force_n / force - 1.0).abs()));
    println!(
        "{name:<26} {:>6.4} {:>11} {:>12} {:>6} {:>9.0e} {:>15.0e} {:>12} {:>8.2}",
        100.0 * contraction,
        count.iterations,
        count.evaluations,
        count.steps,
        count.residual,
        count.first_integral,
        error,
        time,
    );
    Ok(())
}

fn main() -> Result<(), Failure> {
    println!(
        "{:<26} {:>6} {:>11} {:>12} {:>6} {:>9} {:>15} {:>12} {:>8}",
        "case",
        "eps/%",
        "iterations",
        "evaluations",
        "steps",
        "residual",
        "first integral",
        "force error",
        "us"
    );
    let inelastic = pleated(None)?;
    for contraction in [1e-6, 0.05, 0.1, 0.2, 0.3, 0.4] {
        row("closed form", &inelastic, Approach::ClosedForm, contraction, pleated_reference(contraction))?;
    }
    let elastic = pleated(Some(12e3))?;
    for contraction in [-0.001, 0.0, 0.1, 0.3] {
        row("closed form, elastic", &elastic, Approach::ClosedForm, contraction, None)?;
    }
    for contraction in [1e-6, 0.05, 0.1, 0.2, 0.3, 0.4] {
        let exact = solve(&inelastic, contraction, Approach::ClosedForm)?.force_n;
        row("shooting, pleated", &inelastic, Approach::Shooting, contraction, Some(exact))?;
    }
    for contraction in [-0.001, 0.0, 0.1, 0.3] {
        let exact = solve(&elastic, contraction, Approach::ClosedForm)?.force_n;
        row("shooting, pleated elastic", &elastic, Approach::Shooting, contraction, Some(exact))?;
    }
    for (slenderness, length, most) in [(3.0, 0.03, 0.25), (25.0, 0.25, 0.3), (100.0, 1.0, 0.3)] {
        let problem = braid(slenderness)?;
        for contraction in [0.02, 0.05, 0.1, 0.2, most] {
            let name = format!("shooting, braid l0/r0 {slenderness}");
            row(&name, &problem, Approach::Shooting, contraction, braid_reference(length, contraction))?;
        }
    }
    let rubber = bladder()?;
    for contraction in [0.02, 0.1, 0.2] {
        row("shooting, braid + bladder", &rubber, Approach::Shooting, contraction, None)?;
    }
    let long = braid(25.0)?;
    for contraction in [0.02, 0.1, 0.2, 0.3] {
        let exact = solve(&long, contraction, Approach::Shooting)?.force_n;
        row("quadrature, braid l0/r0 25", &long, Approach::Auto, contraction, Some(exact))?;
    }
    for contraction in [0.02, 0.1, 0.2] {
        let exact = solve(&rubber, contraction, Approach::Shooting)?.force_n;
        row("quadrature, bladder", &rubber, Approach::Auto, contraction, Some(exact))?;
    }
    let cylinder = cylinder()?;
    let exact = |contraction: f64| {
        // F = p pi r0^2 (a (1 - eps)^2 - b), a = 3/tan^2(alpha0), b = 1/sin^2(alpha0): S2 eq. 12.
        let alpha = 25.0_f64.to_radians();
        let (a, b) = (3.0 / alpha.tan().powi(2), 1.0 / alpha.sin().powi(2));
        3e5 * std::f64::consts::PI * 1e-4 * (a * (1.0 - contraction).powi(2) - b)
    };
    for contraction in [0.02, 0.1, 0.2] {
        row("cylinder", &cylinder, Approach::Auto, contraction, Some(exact(contraction)))?;
    }
    Ok(())
}
