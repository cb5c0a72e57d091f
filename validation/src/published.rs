//! Published results, and worked numbers that a correct program must reproduce.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{
    Angle, Braided, Construction, Ends, Length, Muscle, Parameter, Pressure, Quantity, preset,
};

use crate::check::{Check, Claim};
use crate::specimen::{at, braid_25, cylinder_25, pleated, ppam};

/// The muscles of S1, which prints their dimensions but only draws their forces: the force of both at 1 bar,
/// and the volume of one.
pub(crate) fn second_generation() -> Check {
    Claim {
        group: "worked numbers",
        name: "second-generation PPAM at 1 bar: force (R = 16 and 11.5 mm), volume (16 mm)",
        source: "S1 eqs. 24 to 30 by elliptic integrals, worked independently of this program",
        tolerance: 0.051,
        why: "half a unit of the last printed digit, 0.1 N and 0.1 ml",
    }
    .run(|tally| {
        let pressure = Pressure::bar(1.0);
        for (contraction, wide, volume, narrow) in [
            (0.05, 1438.0, 228.7, 1238.7),
            (0.10, 994.5, 294.4, 895.1),
            (0.20, 544.0, 376.9, 525.3),
            (0.30, 254.0, 420.1, 276.0),
        ] {
            for approach in [Approach::ClosedForm, Approach::Shooting] {
                let case = |what: &str| format!("{what} at contraction {contraction}, {approach:?}");
                let found = Problem::new(&preset("ppam-2-r16")?, pressure)?.follow(contraction, approach)?;
                tally.absolute(found.force_n, wide, || case("force, 16 mm"));
                tally.absolute(1e6 * found.volume_m3, volume, || case("volume, 16 mm"));
                let found =
                    Problem::new(&preset("ppam-2-r11.5")?, pressure)?.follow(contraction, approach)?;
                tally.absolute(found.force_n, narrow, || case("force, 11.5 mm"));
            }
        }
        Ok(())
    })
}

/// Contraction limits of pleated muscles.
pub(crate) fn contraction_limits() -> Check {
    Claim {
        group: "worked numbers",
        name: "contraction limit of pleated muscles, l0/R = 6.875 and 9.5652",
        source: "elliptic integrals at m = 1/2, 14 digits",
        tolerance: 1e-12,
        why: "rounding",
    }
    .run(|tally| {
        for (radius, expected, widest) in [
            (Length::mm(16.0), 0.418_497_072_842_92, 3.385_329_044_336_3),
            (Length::mm(11.5), 0.451_069_016_033_61, 4.410_942_957_188_6),
        ] {
            let muscle = pleated(Length::mm(110.0), radius, None)?;
            let problem = Problem::new(&muscle, Pressure::bar(1.0))?;
            let limit = problem.contraction_limit(Approach::ClosedForm)?;
            tally.relative(limit, expected, || format!("limit, {radius}"));
            let found = problem.follow(limit, Approach::ClosedForm)?;
            tally.relative(found.max_radius_m / radius.si(), widest, || format!("radius, {radius}"));
        }
        Ok(())
    })
}

/// The clamps reduce the force, by a larger fraction for shorter muscles.
pub(crate) fn clamped_braids() -> Check {
    Claim {
        group: "worked numbers",
        name: "braid of 25 deg, r0 = 10 mm, 3 bar, 20 %: cylinder, 250, 60 and 30 mm",
        source: "independent energy method",
        tolerance: 0.051,
        why: "half a unit of the last digit, 0.1 N",
    }
    .run(|tally| {
        let pressure = Pressure::bar(3.0);
        let found = at(&cylinder_25(Length::mm(250.0))?, pressure, 0.2)?;
        tally.absolute(found.force_n, 304.5, || "cylinder".into());
        for (length, expected) in [(250.0, 265.7), (60.0, 159.3), (30.0, 60.7)] {
            let found = at(&braid_25(Length::mm(length))?, pressure, 0.2)?;
            tally.absolute(found.force_n, expected, || format!("{length} mm"));
        }
        Ok(())
    })
}

/// The textbook formula itself.
pub(crate) fn cylinder_formula() -> Check {
    Claim {
        group: "published",
        name: "cylinder: F = pi r0^2 p (3 (1 - eps)^2/tan^2 alpha0 - 1/sin^2 alpha0), and the radius",
        source: "S2 eq. 12, S5 eq. 11",
        tolerance: 1e-12,
        why: "rounding; the force counts against at least pi r0^2 p",
    }
    .run(|tally| {
        let (radius, length, pressure) = (0.009, 0.2, 2.5e5);
        for degrees in [10.0, 20.0, 25.0, 35.0, 45.0] {
            let angle = f64::to_radians(degrees);
            let braided = Braided::new(Length::m(radius), Angle::rad(angle))?.with_ends(Ends::Cylinder);
            let muscle = Muscle::new("cylinder", Length::m(length), Construction::Braided(braided))?;
            for contraction in [-0.01, 0.0, 0.05, 0.15, 0.25, 0.4] {
                let area = std::f64::consts::PI * radius * radius * pressure;
                let stretch = 1.0 - contraction;
                let force = area * (3.0 * (stretch / angle.tan()).powi(2) - 1.0 / angle.sin().powi(2));
                let wide = radius * (1.0 - (stretch * angle.cos()).powi(2)).sqrt() / angle.sin();
                let found = at(&muscle, Pressure::pa(pressure), contraction)?;
                let case = |what: &str| format!("{what} at {degrees} deg, contraction {contraction}");
                tally.scaled(found.force_n, force, area, || case("force"));
                tally.relative(found.max_radius_m, wide, || case("radius"));
            }
        }
        Ok(())
    })
}

/// Correction of Chou and Hannaford for a wall of constant thickness:
/// `dF = pi p (D0 t (2 sin theta - 1/sin theta) - t^2)`, D0 = 2 r0/sin alpha0, on the cylinder with the gas
/// at r0 - t.
pub(crate) fn inner_wall() -> Check {
    Claim {
        group: "published",
        name: "cylinder with the gas on the inner wall: dF = pi p (D0 t (2 sin theta - 1/sin theta) - t^2)",
        source: "C.-P. Chou and B. Hannaford 1996",
        tolerance: 1e-11,
        why: "rounding of the difference of two forces; it counts against at least 0.1 pi r0 t p",
    }
    .run(|tally| {
        let pressure = Pressure::bar(3.0);
        for degrees in [15.0, 25.0, 40.0] {
            let (radius, angle) = (0.01, f64::to_radians(degrees));
            let braided = Braided::new(Length::m(radius), Angle::rad(angle))?.with_ends(Ends::Cylinder);
            let muscle = Muscle::new("cylinder", Length::m(0.3), Construction::Braided(braided))?;
            for wall in [0.0005, 0.002, 0.005] {
                for contraction in [-0.01, 0.0, 0.1, 0.25] {
                    let inner = muscle.with(Parameter::GasWall, wall)?;
                    let difference = at(&inner, pressure, contraction)?.force_n
                        - at(&muscle, pressure, contraction)?.force_n;
                    let sine = (1.0 - ((1.0 - contraction) * angle.cos()).powi(2)).sqrt();
                    let widest = 2.0 * radius / angle.sin();
                    let scale = std::f64::consts::PI * pressure.to_pa();
                    let expected = scale * (widest * wall * (2.0 * sine - 1.0 / sine) - wall * wall);
                    tally.scaled(difference, expected, 0.1 * scale * radius * wall, || {
                        format!("{degrees} deg, {wall} m, contraction {contraction}")
                    });
                }
            }
        }
        Ok(())
    })
}

/// S1's fit to its measurements: `F = p l0^2 (f4 eps^3 + f3 eps^2 + f2 eps + f1 + f0/eps)`, p in bar, eps in
/// per cent.
pub(crate) fn measured_force() -> Check {
    Claim {
        group: "published",
        name: "measured force of the second-generation PPAM, 5 to 30 %, within 3 % of 3 kN with R = 16 mm",
        source: "S1 eq. 31 and table 1, l0 = 110 mm",
        tolerance: 0.03,
        why: "friction, unfolding and the fibres' stretch are not modelled here; the tests ran up to 3 kN",
    }
    .run(|tally| {
        let [f4, f3, f2, f1, f0] = [-2.0413, 171.623, -7_178.93, 128_611.6, 146_099.0];
        for percent in [5.0, 10.0, 15.0, 20.0, 25.0, 30.0_f64] {
            let fit = ((f4 * percent + f3) * percent + f2) * percent + f1 + f0 / percent;
            let found = at(&ppam()?, Pressure::bar(1.0), 0.01 * percent)?;
            tally.add((found.force_n - 0.11_f64.powi(2) * fit) / 3000.0, || {
                format!("contraction {percent} %")
            });
        }
        Ok(())
    })
}

/// S1's fit to its computed volume: `V = l0^3 (v5 eps^5 + ... + v0)` in ml, eps in per cent.
pub(crate) fn computed_volume() -> Check {
    Claim {
        group: "published",
        name: "computed volume of the second-generation PPAM, 5 to 30 %, R = 16 mm",
        source: "S1 eq. 32 and table 2, l0 = 110 mm",
        tolerance: 0.025,
        why: "a polynomial of fifth order in place of a function that starts with a square root",
    }
    .run(|tally| {
        for percent in [5.0, 10.0, 15.0, 20.0, 25.0, 30.0_f64] {
            let coefficients = [0.022_54, -2.6296, 113.82, -2_386.3, 30_080.0, 71_728.0];
            let fit = coefficients.iter().fold(0.0, |sum, v| sum * percent + v);
            let found = at(&ppam()?, Pressure::bar(1.0), 0.01 * percent)?;
            tally.relative(1e6 * found.volume_m3, 0.11_f64.powi(3) * fit, || {
                format!("contraction {percent} %")
            });
        }
        Ok(())
    })
}
