//! Plots the textbook braided muscle, F = p pi r0^2 (a (1 - eps)^2 - b) with a = 3/tan^2(alpha0), b = 1/sin^2(alpha0).
//!
//! `cargo run -p bulge-report --example characteristics > characteristics.svg`

use bulge_fibre::{Convergence, Method, Response};
use bulge_report::{Curve, PlotError, characteristics_svg};
use std::f64::consts::PI;

/// Cylinder of rest radius 10 mm, length 200 mm and braid angle 25 deg.
fn cylinder(pressure: f64, contraction: f64) -> Response {
    let (radius, rest_length, alpha) = (0.01_f64, 0.2, 25_f64.to_radians());
    let (a, b) = (3.0 / alpha.tan().powi(2), 1.0 / alpha.sin().powi(2));
    let cos = (1.0 - contraction) * alpha.cos();
    let r = radius * (1.0 - cos * cos).sqrt() / alpha.sin();
    let length = rest_length * (1.0 - contraction);
    Response {
        pressure_pa: pressure,
        force_n: pressure * PI * radius * radius * (a * (1.0 - contraction).powi(2) - b),
        length_m: length,
        contraction,
        volume_m3: PI * r * r * length,
        volume_polygon_m3: PI * r * r * length,
        max_radius_m: r,
        mid_radius_m: r,
        fibre_tension_n: 0.0,
        fibre_strain: 0.0,
        stiffness_n_per_m: pressure * PI * radius * radius * 2.0 * a * (1.0 - contraction) / rest_length,
        volume_slope_m2: 0.0,
        stiffness_isothermal_n_per_m: 0.0,
        stiffness_adiabatic_n_per_m: 0.0,
        end_slope_rad: 0.0,
        method: Method::ClosedForm,
        convergence: Convergence {
            iterations: 0,
            evaluations: 0,
            steps: 0,
            residual: 0.0,
            first_integral: 0.0,
        },
    }
}

fn main() -> Result<(), PlotError> {
    let pressures = [1e5, 2e5, 3e5, 4e5, 5e5];
    let isobars = pressures.map(|p| (0..=70).map(|i| cylinder(p, 0.005 * f64::from(i))).collect::<Vec<_>>());
    let curves: Vec<_> =
        pressures.iter().zip(&isobars).map(|(p, points)| Curve { pressure_pa: *p, points }).collect();
    println!("{}", characteristics_svg("braided cylinder, 25 deg", &curves)?);
    Ok(())
}
