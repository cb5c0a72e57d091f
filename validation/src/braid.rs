//! The clamped braid, with and without bladder, against an independent energy method.

use bulge_fibre::{Approach, Problem, Response};
use bulge_muscles::{Angle, Braided, Construction, Ends, Length, Muscle, Parameter, Pressure};

use crate::check::{Check, Claim};
use crate::reference::{self, CLAMPED_NET, NET_BLADDER, NET_LIMITS, NET_TENSIONS};
use crate::specimen::{at, braid, braid_25, cylinder_25, pleated};

const PRESSURE: Pressure = Pressure::mpa(0.3);

/// Force, volume and radius of six geometries, and the cylinder formula for comparison.
pub(crate) fn clamped_net() -> Check {
    Claim {
        group: "braid",
        name: "force, volume and mid radius with clamped ends; force of the cylinder",
        source: "reference/braided_clamped_net.csv",
        tolerance: 1e-9,
        why: "11 to 12 digits in the table",
    }
    .run(|tally| {
        for [r0, l0, angle, contraction, force, volume, mid, cylinder] in reference::values(CLAMPED_NET)? {
            let (length, radius) = (Length::m(l0), Length::m(r0));
            let clamped = braid(length, radius, Angle::deg(angle))?;
            let found = at(&clamped, PRESSURE, contraction)?;
            let case = |what: &str| {
                format!("{what} at r0 = {r0}, l0 = {l0}, {angle} deg, contraction {contraction}")
            };
            tally.relative(found.force_n / PRESSURE.to_pa(), force, || case("force"));
            tally.relative(found.volume_m3, volume, || case("volume"));
            tally.relative(found.mid_radius_m, mid, || case("mid radius"));
            let textbook = Braided::new(radius, Angle::deg(angle))?.with_ends(Ends::Cylinder);
            let textbook = Muscle::new("cylinder", length, Construction::Braided(textbook))?;
            let found = at(&textbook, PRESSURE, contraction)?;
            tally.relative(found.force_n / PRESSURE.to_pa(), cylinder, || case("cylinder force"));
        }
        Ok(())
    })
}

/// Force, its ratio to the cylinder, radius, volume, tensions at both ends of half a fibre, and end slope.
pub(crate) fn tensions() -> Check {
    Claim {
        group: "braid",
        name: "force, radius, volume, tensions and end slope with clamped ends",
        source: "reference/braided_net_tensions.csv",
        tolerance: 1e-9,
        why: "beyond one unit of the last printed digit, of which there are 7 to 12",
    }
    .run(|tally| {
        for [l0, contraction, force, ratio, mid, volume, tension_mid, tension_end, slope] in
            reference::rows(NET_TENSIONS)?
        {
            let length = Length::mm(l0.value);
            let problem = Problem::new(&braid_25(length)?, PRESSURE)?;
            let case =
                |what: &str| format!("{what} at l0 = {} mm, contraction {}", l0.value, contraction.value);
            let found = problem.follow(contraction.value, Approach::Auto)?;
            let cylinder = at(&cylinder_25(length)?, PRESSURE, contraction.value)?;
            tally.add(force.unexplained(found.force_n), || case("force"));
            tally.add(ratio.unexplained(found.force_n / cylinder.force_n), || {
                case("force over cylinder force")
            });
            tally.add(mid.unexplained(1e3 * found.mid_radius_m), || case("mid radius"));
            tally.add(volume.unexplained(1e9 * found.volume_m3), || case("volume"));
            tally.add(tension_mid.unexplained(found.fibre_tension_n), || case("largest tension"));
            tally.add(slope.unexplained(found.end_slope_rad.to_degrees()), || case("end slope"));
            // A meridian is drawn only if the muscle pulls.
            if found.force_n > 0.0 {
                let given = bulge_fibre::Given::Contraction(contraction.value);
                let shape = problem.shape(given, Approach::Auto, 21)?;
                let end = shape.meridian.first().ok_or("an empty meridian")?;
                let middle = shape.meridian.get(10).ok_or("a short meridian")?;
                tally.add(tension_end.unexplained(end.fibre_tension_n), || case("tension at the end"));
                tally.add(tension_mid.unexplained(middle.fibre_tension_n), || case("tension at mid-length"));
                tally.add(slope.unexplained(end.slope_rad.to_degrees()), || case("slope of the first point"));
            }
        }
        Ok(())
    })
}

/// The contraction at which the force vanishes.
pub(crate) fn limits() -> Check {
    Claim {
        group: "braid",
        name: "contraction at which the force vanishes, clamped and cylinder",
        source: "reference/braided_net_limits.csv",
        tolerance: 1e-11,
        why: "12 digits in the table",
    }
    .run(|tally| {
        for [l0, clamped, cylinder] in reference::values(NET_LIMITS)? {
            let length = Length::mm(l0);
            for (muscle, expected) in [(braid_25(length)?, clamped), (cylinder_25(length)?, cylinder)] {
                let found = Problem::new(&muscle, PRESSURE)?.contraction_limit(Approach::Auto)?;
                tally.relative(found, expected, || format!("{} of {l0} mm", muscle.name()));
            }
        }
        Ok(())
    })
}

/// The clamped braid around a rubber tube.
pub(crate) fn bladder() -> Check {
    Claim {
        group: "braid",
        name: "force, radius and volume with a neo-Hookean bladder",
        source: "reference/braided_net_bladder.csv",
        tolerance: 1e-8,
        why: "beyond one unit of the last printed digit, of which there are 9 to 13",
    }
    .run(|tally| {
        let rubber = [(Parameter::Wall, 0.001), (Parameter::C10, 2e5)];
        for [l0, contraction, force, mid, volume] in reference::rows(NET_BLADDER)? {
            let muscle = braid_25(Length::mm(l0.value))?.with_all(&rubber)?;
            let found: Response = at(&muscle, PRESSURE, contraction.value)?;
            let case =
                |what: &str| format!("{what} at l0 = {} mm, contraction {}", l0.value, contraction.value);
            tally.add(force.unexplained(found.force_n), || case("force"));
            tally.add(mid.unexplained(1e3 * found.mid_radius_m), || case("mid radius"));
            tally.add(volume.unexplained(1e9 * found.volume_m3), || case("volume"));
        }
        Ok(())
    })
}

/// A pleated muscle whose fibres are misaligned by 25 degrees equals that braid.
pub(crate) fn misaligned() -> Check {
    Claim {
        group: "braid",
        name: "force, radius and volume of a pleated membrane misaligned by 25 deg: the same net",
        source: "reference/braided_net_tensions.csv",
        tolerance: 1e-9,
        why: "beyond one unit of the last printed digit",
    }
    .run(|tally| {
        for [l0, contraction, force, _, mid, volume, ..] in reference::rows::<9>(NET_TENSIONS)? {
            let straight = pleated(Length::mm(l0.value), Length::mm(10.0), None)?;
            let muscle = straight.with(Parameter::Misalignment, 25.0_f64.to_radians())?;
            let found = at(&muscle, PRESSURE, contraction.value)?;
            let case =
                |what: &str| format!("{what} at l0 = {} mm, contraction {}", l0.value, contraction.value);
            tally.add(force.unexplained(found.force_n), || case("force"));
            tally.add(mid.unexplained(1e3 * found.mid_radius_m), || case("mid radius"));
            tally.add(volume.unexplained(1e9 * found.volume_m3), || case("volume"));
        }
        Ok(())
    })
}
