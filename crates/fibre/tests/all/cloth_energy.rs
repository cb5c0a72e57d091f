//! Taut cloth stores the energy that its stiffness says.

use bulge_fibre::{Approach, Given, Problem};
use bulge_muscles::{Parameter, Pressure, preset};
use std::f64::consts::PI;

/// With the potential U - p V at its minimum, dF/dK = d(dU/dK)/dl: only the explicit dependence counts. Here
/// U = K times the integral of (2 pi (r - r_u))^2/(4 pi r_u) along the part of the meridian on which the cloth
/// is taut.
#[test]
fn force_follows_the_stiffness_as_its_energy_says() {
    let (radius, stiffness, contraction) = (0.022, 4e3, 0.15);
    let problem = |stiffness: f64| {
        let cloth = [(Parameter::HoopStiffness, stiffness), (Parameter::UnfoldedRadius, radius)];
        Problem::new(&preset("ppam-2-r16").unwrap().with_all(&cloth).unwrap(), Pressure::bar(2.0)).unwrap()
    };
    let force = |stiffness: f64| problem(stiffness).follow(contraction, Approach::Auto).unwrap().force_n;
    let by_stiffness = (force(1.001 * stiffness) - force(0.999 * stiffness)) / (2e-3 * stiffness);
    let middle = problem(stiffness);
    let per_stiffness = |contraction: f64| {
        let shape = middle.shape(Given::Contraction(contraction), Approach::Auto, 4001).unwrap();
        let density = |r: f64| (2.0 * PI * (r - radius).max(0.0)).powi(2) / (4.0 * PI * radius);
        let pairs = shape.meridian.windows(2).map(|pair| {
            let way = (pair[1].x_m - pair[0].x_m).hypot(pair[1].r_m - pair[0].r_m);
            0.5 * (density(pair[0].r_m) + density(pair[1].r_m)) * way
        });
        (pairs.sum::<f64>(), shape.response.length_m)
    };
    let [(more, long), (less, short)] = [contraction - 1e-3, contraction + 1e-3].map(per_stiffness);
    let expected = (more - less) / (long - short);
    assert!((by_stiffness / expected - 1.0).abs() < 1e-3, "{by_stiffness} {expected}");
}
