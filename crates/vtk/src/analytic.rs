//! Shapes with known surfaces, for the tests.

use bulge_fibre::{Convergence, MeridianPoint, Method, Response, Shape};

/// Shape over x = 0 ..= length in `intervals` equal steps. `profile` gives radius and slope; the fibres turn
/// by `turn` in all.
pub(crate) fn shape(length: f64, intervals: u32, turn: f64, profile: impl Fn(f64) -> (f64, f64)) -> Shape {
    let meridian: Vec<_> = (0..=intervals)
        .map(|i| {
            let t = f64::from(i) / f64::from(intervals);
            let (r, slope) = profile(length * t);
            MeridianPoint {
                x_m: length * t,
                r_m: r,
                slope_rad: slope.atan(),
                braid_angle_rad: turn * r / length,
                fibre_tension_n: 20.0,
                fibre_strain: 0.01 * t,
                membrane_force_n_per_m: 100.0 / r,
                fibre_length_m: length * t,
                turn_rad: turn * t,
            }
        })
        .collect();
    Shape { response: response(length, &meridian), meridian }
}

fn response(length: f64, meridian: &[MeridianPoint]) -> Response {
    Response {
        pressure_pa: 2e5,
        force_n: 321.5,
        length_m: length,
        contraction: 0.2,
        volume_m3: 1e-4,
        volume_polygon_m3: 1e-4,
        max_radius_m: meridian.iter().map(|p| p.r_m).fold(0.0, f64::max),
        mid_radius_m: meridian[meridian.len() / 2].r_m,
        fibre_tension_n: 20.0,
        fibre_strain: 0.01,
        stiffness_n_per_m: 1e4,
        volume_slope_m2: 0.0,
        stiffness_isothermal_n_per_m: 1e4,
        stiffness_adiabatic_n_per_m: 1e4,
        end_slope_rad: meridian[0].slope_rad,
        method: Method::ClosedForm,
        convergence: Convergence {
            iterations: 1,
            evaluations: 1,
            steps: 0,
            residual: 0.0,
            first_integral: 0.0,
        },
    }
}

/// Cylinder of radius 20 mm and length 100 mm.
pub(crate) fn cylinder(intervals: u32) -> Shape {
    shape(0.1, intervals, 0.0, |_| (0.02, 0.0))
}

/// Cone frustum from 10 mm to 30 mm over 100 mm.
pub(crate) fn cone(intervals: u32) -> Shape {
    shape(0.1, intervals, 0.0, |x| (0.01 + 0.2 * x, 0.2))
}

/// Zone of a sphere of radius 30 mm, 40 mm high, symmetric about the equator.
pub(crate) fn sphere(intervals: u32) -> Shape {
    shape(0.04, intervals, 0.0, |x| {
        let r = (9e-4 - (x - 0.02) * (x - 0.02)).sqrt();
        (r, (0.02 - x) / r)
    })
}

/// Barrel r = R + a sin(pi x/l) with straight or turning fibres.
pub(crate) fn barrel(intervals: u32, turn: f64) -> Shape {
    let wave = std::f64::consts::PI / 0.09;
    shape(0.09, intervals, turn, move |x| (0.016 + 0.02 * (wave * x).sin(), 0.02 * wave * (wave * x).cos()))
}
