//! Draws a barrel with the profile r = R + a sin(pi x/l): pleated, braided, and an animation of a pleated
//! one.
//!
//! `cargo run -p bulge-vtk --example barrel -- FOLDER` writes `pleated.vtp`, `braided.vtp`, `film.pvd` and
//! its members. Open them in ParaView, or check and render them with `validation/vtk_check.py`.

use bulge_fibre::{Convergence, MeridianPoint, Method, Response, Shape};
use bulge_vtk::{Bulge, Style, VtkError, write_series, write_vtp};
use std::f64::consts::PI;
use std::path::PathBuf;

/// Barrel of radius 16 mm at the ends, contracted to `length`, with fibres of 110 mm that turn by `turn`.
fn barrel(length: f64, bulging: f64, turn: f64) -> Shape {
    let (radius, pressure, fibres) = (0.016, 2e5, 25.0);
    let meridian: Vec<MeridianPoint> = (0..=120)
        .map(|i| {
            let t = f64::from(i) / 120.0;
            let (sin, cos) = (PI * t).sin_cos();
            let r = radius + bulging * sin;
            let slope = (bulging * PI / length * cos).atan();
            // Equilibrium of a straight fibre net along the axis: N cos(slope) = F + p pi r^2.
            let tension = (300.0 + pressure * PI * r * r) / slope.cos();
            MeridianPoint {
                x_m: length * t,
                r_m: r,
                slope_rad: slope,
                braid_angle_rad: (turn * r / length).atan(),
                fibre_tension_n: tension / fibres,
                fibre_strain: tension / fibres / 12e3,
                membrane_force_n_per_m: tension / (2.0 * PI * r),
                fibre_length_m: 0.11 * t,
                turn_rad: turn * t,
            }
        })
        .collect();
    Shape { response: response(length, pressure, &meridian), meridian }
}

fn response(length: f64, pressure: f64, meridian: &[MeridianPoint]) -> Response {
    let steps = meridian.windows(2);
    let volume =
        steps.map(|p| PI / 2.0 * (p[0].r_m.powi(2) + p[1].r_m.powi(2)) * (p[1].x_m - p[0].x_m)).sum();
    let middle = meridian[meridian.len() / 2];
    Response {
        pressure_pa: pressure,
        force_n: 300.0,
        length_m: length,
        contraction: 1.0 - length / 0.11,
        volume_m3: volume,
        volume_polygon_m3: volume,
        max_radius_m: middle.r_m,
        mid_radius_m: middle.r_m,
        fibre_tension_n: middle.fibre_tension_n,
        fibre_strain: middle.fibre_strain,
        stiffness_n_per_m: 1e4,
        volume_slope_m2: 0.0,
        stiffness_isothermal_n_per_m: 1e4,
        stiffness_adiabatic_n_per_m: 1e4,
        end_slope_rad: meridian[0].slope_rad,
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

fn main() -> Result<(), VtkError> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let pleats = Style::Pleats { cloth_circumference: Some(0.24) };
    let draw = |shape, fibres, style: Style| Bulge { shape, fibres, style, facets: style.default_facets() };

    let shapes: Vec<Shape> = (0..=10)
        .map(|i| f64::from(i) / 10.0)
        .map(|t| barrel(0.11 - 0.022 * t, 0.021 * t.sqrt(), 0.0))
        .collect();
    let members: Vec<_> =
        shapes.iter().map(|shape| (shape.response.contraction, draw(shape, 25, pleats))).collect();
    // The series creates the folder, so it comes first.
    write_series(&folder, "film", &members)?;
    write_vtp(folder.join("pleated.vtp"), &draw(&shapes[10], 25, pleats))?;
    let braid = barrel(0.09, 0.008, 3.0);
    write_vtp(folder.join("braided.vtp"), &draw(&braid, 48, Style::Revolution))
}
