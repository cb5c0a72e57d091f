//! Numbers that stand in print.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Angle, Braided, Construction, Ends, Length, Muscle, Pressure, Quantity, preset};

use crate::check::{Check, Claim};
use crate::specimen::{at, braid_25, cylinder_25, pleated, ppam};

/// S1: force of both second-generation muscles at 1 bar, volume of one.
pub(crate) fn second_generation() -> Check {
    Claim {
        group: "published",
        name: "second-generation PPAM at 1 bar: force (R = 16 and 11.5 mm), volume (16 mm)",
        source: "S1 (Verrelst et al.), sections 2.3 and 3",
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

/// Contraction limits of the pleated muscles.
pub(crate) fn contraction_limits() -> Check {
    Claim {
        group: "published",
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

/// The clamps take a part of the force, the more the shorter the muscle.
pub(crate) fn clamped_braids() -> Check {
    Claim {
        group: "published",
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

/// What S1 measured, and how far the stated end radius is from explaining it.
pub(crate) fn measured() -> Check {
    Claim {
        group: "published",
        name: "measured force of the second-generation PPAM, l0 = 110 mm, within 3 % of 3 kN with R = 16 mm",
        source: "S1 table 1: 1524, 1047, 540, 211 N/bar at 5, 10, 20, 30 %",
        tolerance: 0.03,
        why: "friction, unfolding and the fibres' stretch are not modelled here",
    }
    .run(|tally| {
        for (contraction, force) in [(0.05, 1524.0), (0.10, 1047.0), (0.20, 540.0), (0.30, 211.0)] {
            let found = at(&ppam()?, Pressure::bar(1.0), contraction)?;
            tally.add((found.force_n - force) / 3000.0, || format!("contraction {contraction}"));
        }
        Ok(())
    })
}
