//! Lobes between the fibres, against the closed form if all of them touch, and against quadratures of the
//! first integral.

use bulge_fibre::{Approach, Problem, closed_form};
use bulge_muscles::{Length, Muscle, Parameter, Pressure, Quantity};
use bulge_numerics::gauss;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::check::{Check, Claim, Trouble};
use crate::section::area;
use crate::specimen::{pleated, ppam};

const PRESSURE: Pressure = Pressure::bar(2.0);

/// With plenty of cloth, A = n tan(pi/n) (r + s/2)^2/(1 + v tan(pi/n)), v = pi/2 + pi/n, is the area of a
/// muscle of the radius R + s/2.
pub(crate) fn touching() -> Check {
    Claim {
        group: "lobes",
        name: "force, volume and radius of lobes that touch everywhere: a pleated muscle of the radius R + C/(2n)",
        source: "elliptic integrals",
        tolerance: 1e-10,
        why: "the integrator keeps 4e-12 a step",
    }
    .run(|tally| {
        let (radius, cloth) = (0.016, 1.2);
        for (n, count) in [(6.0, 6), (15.0, 15), (40.0, 40_u32)] {
            for slenderness in [1.0, 4.0, 6.875] {
                let length = slenderness * radius;
                let muscle = pleated(Length::m(length), Length::m(radius), Some(count))?
                    .with(Parameter::ClothCircumference, cloth)?;
                let crest = radius + 0.5 * cloth / n;
                let (tan, contact) = (f64::tan(PI / n), FRAC_PI_2 + PI / n);
                // Relative to pi r^2, the circle for which the closed form has f and v.
                let share = n * tan / (1.0 + contact * tan) / PI;
                for contraction in [1e-4, 0.01, 0.05, 0.15] {
                    let exact = closed_form::solve(contraction, length / crest, 0.0)?;
                    let found = Problem::new(&muscle, PRESSURE)?.follow(contraction, Approach::Shooting)?;
                    let case = |what: &str| format!("{what}, n = {n}, l0/R = {slenderness}, contraction {contraction}");
                    let force = PRESSURE.to_pa() * share * length * length * exact.force.value;
                    let scale = 0.01 * PRESSURE.to_pa() * (length * length + radius * radius);
                    tally.scaled(found.force_n, force, scale, || case("force"));
                    let volume = share * length.powi(3) * exact.volume.value;
                    tally.relative(found.volume_polygon_m3, volume, || case("volume"));
                    let mid = crest * exact.radius.value - 0.5 * cloth / n;
                    tally.relative(found.mid_radius_m, mid, || case("radius"));
                }
            }
        }
        Ok(())
    })
}

/// With n T = F + p A(r_mid), straight fibres obey `cos(psi) = 1 - p (A(r_mid) - A(r))/(n T)`. Their length
/// and the distance between the ends are integrals over the radius.
pub(crate) fn quadrature() -> Check {
    Claim {
        group: "lobes",
        name: "fibre length and end distance from the first integral, with force and radius as found",
        source: "Gauss-Legendre quadrature, area by bisection",
        tolerance: 1e-8,
        why: "the area's fourth derivative jumps where lobes cease to touch; a radius near the open one counts a hundredfold",
    }
    .run(|tally| {
        let six = pleated(Length::mm(110.0), Length::mm(16.0), Some(6))?;
        for (muscle, cloth, contractions) in [
            (ppam()?, 0.33, [0.01, 0.1, 0.2, 0.3]),
            (ppam()?, 0.3, [0.01, 0.1, 0.2, 0.24]),
            (ppam()?, 0.45, [0.01, 0.1, 0.25, 0.35]),
            (six, 0.3, [0.01, 0.05, 0.1, 0.14]),
        ] {
            let muscle = muscle.with(Parameter::ClothCircumference, cloth)?;
            for contraction in contractions {
                let [fibre, distance] = lengths(&muscle, contraction)?;
                let l0 = muscle.length().si();
                let case = |what: &str| format!("{what}, {cloth} m of cloth, contraction {contraction}");
                tally.relative(2.0 * fibre, l0, || case("fibre length"));
                tally.relative(2.0 * distance, l0 * (1.0 - contraction), || case("end distance"));
            }
        }
        Ok(())
    })
}

/// Half the fibre length and half the distance between the ends.
fn lengths(muscle: &Muscle, contraction: f64) -> Result<[f64; 2], Trouble> {
    let found = Problem::new(muscle, PRESSURE)?.follow(contraction, Approach::Auto)?;
    let (end, mid) = (muscle.radius().si(), found.mid_radius_m);
    let whole = area(muscle, mid);
    let tension = found.force_n / PRESSURE.to_pa() + whole;
    let panels = 100;
    let mut sums = [0.0; 2];
    for panel in 0..panels {
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum += gauss::integrate(|part| {
                // The substitution r = r_mid - (r_mid - R) t^2 removes the square root at mid-length.
                let t = (f64::from(panel) + part) / f64::from(panels);
                let missing = (whole - area(muscle, mid - (mid - end) * t * t)) / tension;
                let (sin, cos) = ((missing * (2.0 - missing)).sqrt(), 1.0 - missing);
                2.0 * (mid - end) * t / f64::from(panels) * if i == 0 { 1.0 } else { cos } / sin
            });
        }
    }
    Ok(sums)
}
