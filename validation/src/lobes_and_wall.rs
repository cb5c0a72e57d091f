//! Lobes between the fibres and walls with a thickness: values of an independent program, and the limits in
//! which they vanish or fill the muscle.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{
    Angle, Braided, Construction, Ends, Length, Muscle, MuscleError, Parameter, Pressure, Quantity,
};
use std::f64::consts::PI;

use crate::check::{Check, Claim, Trouble};
use crate::reference::values;
use crate::specimen::{at, braid_25, pleated, ppam, shot};

const LOBES: &str = include_str!("../reference/pleated_lobes.csv");
const GAS_WALL: &str = include_str!("../reference/braided_gas_wall.csv");
const PRESSURE: Pressure = Pressure::bar(3.0);

/// Lobes that touch, lobes that separate within the muscle, and lobes that are nearly open.
pub(crate) fn lobes() -> Check {
    Claim {
        group: "lobes",
        name: "force, volume and mid radius of 6, 12 and 40 lobes, up to a muscle that pushes",
        source: "SciPy: first integral by quadrature, area by the opening of the arc",
        tolerance: 2e-9,
        why: "10 to 11 printed digits; quadrature across the radius at which lobes part; against at least 0.1 p l0^2",
    }
    .run(|tally| {
        let pressure = Pressure::bar(2.0);
        for [fibres, cloth, contraction, force, volume, mid] in values::<6>(LOBES)? {
            let muscle = ppam()?.with(Parameter::Fibres, fibres)?.with(Parameter::ClothCircumference, cloth)?;
            let found = at(&muscle, pressure, contraction)?;
            let case = |what: &str| format!("{what}, n = {fibres}, {cloth} m of cloth, contraction {contraction}");
            let scale = 0.1 * pressure.to_pa() * 0.11 * 0.11;
            tally.scaled(found.force_n, force, scale, || case("force"));
            tally.relative(found.volume_polygon_m3, volume, || case("volume"));
            tally.relative(found.mid_radius_m, mid, || case("mid radius"));
        }
        Ok(())
    })
}

/// Cloth of a constant circumference in more and more lobes tends to a smooth membrane. The fibres of this
/// membrane are free of the cloth as long as it isn't taut. The cloth stops them at the radius of its circle
/// when smooth.
pub(crate) fn many_lobes() -> Check {
    Claim {
        group: "limits",
        name: "n lobes of one circumference -> smooth membrane; never beyond the circle of that circumference",
        source: "theory: the lobes' depth is of the order C/n; extrapolated from n = 70, 140, 280",
        tolerance: 1e-4,
        why: "the terms 1/n and 1/n^2 are taken out, (C/(2 n R))^3 = 1e-4 stays",
    }
    .run(|tally| {
        let (length, radius) = (Length::mm(110.0), Length::mm(16.0));
        let cloth = 0.45;
        for contraction in [0.02, 0.1, 0.2] {
            let smooth = shot(&pleated(length, radius, None)?, PRESSURE, contraction)?;
            let mut lobed = Vec::new();
            for n in [70, 140, 280] {
                let muscle =
                    pleated(length, radius, Some(n))?.with(Parameter::ClothCircumference, cloth)?;
                let found = at(&muscle, PRESSURE, contraction)?;
                lobed.push([found.force_n, found.volume_polygon_m3]);
            }
            for (i, (what, expected)) in
                [("force", smooth.force_n), ("volume", smooth.volume_polygon_m3)].into_iter().enumerate()
            {
                // This combination eliminates the terms 1/n and 1/n^2.
                let limit = (8.0 * lobed[2][i] - 6.0 * lobed[1][i] + lobed[0][i]) / 3.0;
                let gap = lobed[2][i] / expected - 1.0;
                tally.relative(limit, expected, || {
                    format!("{what} at contraction {contraction}, {gap:.1e} away with 280")
                });
            }
        }
        // Beyond this radius the cloth would have to stretch. The muscle approaches it and stays inside.
        for circumference in [0.2, 0.25, 0.3] {
            let muscle = ppam()?.with(Parameter::ClothCircumference, circumference)?;
            let open = circumference / (2.0 * PI);
            let limit = Problem::new(&muscle, PRESSURE)?.contraction_limit(Approach::Auto)?;
            let reached = at(&muscle, PRESSURE, limit)?.max_radius_m / open;
            tally.add((reached - 1.0).max(0.0) + (0.9 - reached).max(0.0), || {
                format!("{reached:.4} of the open radius at {circumference} m")
            });
        }
        Ok(())
    })
}

/// Clamped braids with the gas at the inner face of the wall.
pub(crate) fn gas_wall() -> Check {
    Claim {
        group: "braid",
        name: "force, volume and mid radius with the gas 0, 1.5 and 5 mm inside the braid, clamped ends",
        source: "SciPy: first integral by quadrature",
        tolerance: 1e-9,
        why: "10 to 11 printed digits",
    }
    .run(|tally| {
        for [length, wall, contraction, force, volume, mid] in values::<6>(GAS_WALL)? {
            let muscle = braid_25(Length::mm(length))?.with(Parameter::GasWall, 1e-3 * wall)?;
            let found = at(&muscle, PRESSURE, contraction)?;
            let case = |what: &str| format!("{what}, {wall} mm, contraction {contraction}");
            tally.relative(found.force_n, force, || case("force"));
            tally.relative(found.volume_polygon_m3, volume, || case("volume"));
            tally.relative(found.mid_radius_m, mid, || case("mid radius"));
        }
        Ok(())
    })
}

/// A cylinder of 9 mm with the given angle.
fn cylinder(angle: f64) -> Result<Muscle, Trouble> {
    let braided = Braided::new(Length::mm(9.0), Angle::rad(angle))?.with_ends(Ends::Cylinder);
    Ok(Muscle::new("cylinder", Length::mm(200.0), Construction::Braided(braided))?)
}

/// Without a wall nothing changes; a wall up to the axis leaves no force at rest.
pub(crate) fn thin_and_thick_wall() -> Check {
    Claim {
        group: "limits",
        name: "gas on the inner wall: no wall -> the braid; wall -> r0 at rest: F = 2 pi p r0 (r0 - t)/tan^2(alpha0)",
        source: "theory: V = pi (r - t)^2 l, F = -p dV/dl",
        tolerance: 1e-5,
        why: "the next term of a gap of a millionth of the radius, over tan^2(alpha0)",
    }
    .run(|tally| {
        for degrees in [15.0, 25.0, 40.0_f64] {
            let angle = degrees.to_radians();
            let bare = cylinder(angle)?;
            let radius = bare.radius().si();
            let gap = 1e-6 * radius;
            let force = at(&bare.with(Parameter::GasWall, radius - gap)?, PRESSURE, 0.0)?.force_n;
            let theory = 2.0 * PI * PRESSURE.to_pa() * radius * gap / angle.tan().powi(2);
            tally.relative(force, theory, || format!("thick wall, {degrees} deg"));
        }
        for muscle in [cylinder(0.4)?, braid_25(Length::mm(120.0))?] {
            for contraction in [0.0, 0.1, 0.25] {
                let bare = at(&muscle, PRESSURE, contraction)?;
                let found = at(&muscle.with(Parameter::GasWall, 0.0)?, PRESSURE, contraction)?;
                // Errors are multiplied by a million: only the last digits may change.
                tally.add(1e6 * (found.force_n / bare.force_n - 1.0), || {
                    format!("no wall x 1e6, contraction {contraction}")
                });
            }
        }
        match braid_25(Length::mm(120.0))?.with(Parameter::GasWall, 0.01) {
            Err(MuscleError::WallTooThick { .. }) => tally.add(0.0, || "full".into()),
            other => return Err(format!("a wall of the whole radius: {other:?}").into()),
        }
        Ok(())
    })
}
