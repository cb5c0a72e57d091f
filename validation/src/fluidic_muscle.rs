//! The measured braid of S5: its force from fibre length and turns (eqs. 11, 12, Table 2), and the
//! contribution of its rubber when it is stretched.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Angle, Braided, Construction, Ends, Length, Muscle, Parameter, Pressure, preset};
use std::f64::consts::PI;

use crate::check::{Check, Claim, Trouble};
use crate::specimen::at;

/// S5 Table 2: length l0, fibre length b \[m\], turns N.
const LENGTH: f64 = 0.25;
const FIBRE: f64 = 0.275_85;
const TURNS: f64 = 1.73;
const PRESSURE: Pressure = Pressure::bar(3.0);

/// The cylinder whose fibres have the length b and make N turns: cos(alpha0) = l0/b, r0 = b sin(alpha0)/(2 pi
/// N).
fn braid() -> Result<Muscle, Trouble> {
    let angle = (LENGTH / FIBRE).acos();
    let radius = FIBRE * angle.sin() / (2.0 * PI * TURNS);
    let braided = Braided::new(Length::m(radius), Angle::rad(angle))?.with_ends(Ends::Cylinder);
    Ok(Muscle::new("DMSP-20-250", Length::m(LENGTH), Construction::Braided(braided))?)
}

/// Force from fibre length and turns.
pub(crate) fn fibre_length_and_turns() -> Check {
    Claim {
        group: "published",
        name: "cylinder: F = p (3 l0^2 (1 - kappa)^2 - b^2)/(4 pi N^2) = pi D_M^2 p (3 cos^2(alpha) - 1)/4, D_M = b/(pi N); none at 54.7 deg",
        source: "S5 eqs. 11, 12 and Table 2: b = 275.85 mm, N = 1.73",
        tolerance: 1e-12,
        why: "rounding; the force counts against at least 0.1 pi r0^2 p",
    }
    .run(|tally| {
        let muscle = braid()?;
        for contraction in [-0.02, 0.0, 0.05, 0.15, 0.25, 0.36, 0.4] {
            let length = LENGTH * (1.0 - contraction);
            let pressure = PRESSURE.to_pa();
            let by_turns =
                pressure * (3.0 * length * length - FIBRE * FIBRE) / (4.0 * PI * TURNS * TURNS);
            let widest = FIBRE / (PI * TURNS);
            let by_angle =
                PI * widest * widest * pressure / 4.0 * (3.0 * (length / FIBRE).powi(2) - 1.0);
            let found = at(&muscle, PRESSURE, contraction)?.force_n;
            let floor = 0.1 * PI * 0.01 * 0.01 * pressure;
            tally.scaled(found, by_turns, floor, || format!("eq. 11 at contraction {contraction}"));
            tally.scaled(found, by_angle, floor, || format!("eq. 12 at contraction {contraction}"));
        }
        // At the limit, cos^2(alpha) = 1/3.
        let limit = Problem::new(&muscle, PRESSURE)?.contraction_limit(Approach::Auto)?;
        tally.relative(limit, 1.0 - FIBRE / (3.0_f64.sqrt() * LENGTH), || format!("largest contraction {limit:.4}"));
        Ok(())
    })
}

/// The shipped muscle has the printed angle and a rounded radius.
pub(crate) fn shipped_muscle() -> Check {
    Claim {
        group: "published",
        name: "the shipped DMSP-20-250, without its ends, pulls with 296.2 N at 1 bar at rest",
        source: "S5 eq. 11 and Table 2",
        tolerance: 2e-4,
        why: "half a unit of 296.2 N; the radius is rounded to 10.725 mm, the angle to 25 deg",
    }
    .run(|tally| {
        let shipped = preset("dmsp-20-250")?;
        let Construction::Braided(braided) = shipped.construction() else {
            return Err("the shipped DMSP-20-250 is no braid".into());
        };
        let bare =
            Muscle::new("bare", shipped.length(), Construction::Braided(braided.with_ends(Ends::Cylinder)))?;
        let found = at(&bare, Pressure::bar(1.0), 0.0)?.force_n;
        tally.relative(found, 296.2, || format!("{found:.2} N"));
        Ok(())
    })
}

/// Rubber pushes if the muscle is shortened and pulls if it is stretched. In the latter case S5 measured more
/// than the theoretical force.
pub(crate) fn drawn_out() -> Check {
    Claim {
        group: "published",
        name: "neo-Hookean bladder of 290 kPa: +284, +154, +64 N at -3, -2, -1 %, none at rest, -47 N at 1 %, at 3 and 6 bar",
        source: "S5 Fig. 9 (more than the theoretical force when drawn out), Table 2; W of the cylinder by hand",
        tolerance: 1e-4,
        why: "half a unit of the last digit, 0.01 N, of 64 N",
    }
    .run(|tally| {
        let bladder = [(Parameter::Wall, 0.002), (Parameter::C10, 290e3)];
        // At the printed radius and angle; expected values from W at 10.725 mm and 25 deg.
        let braided = Braided::new(Length::mm(10.725), Angle::deg(25.0))?.with_ends(Ends::Cylinder);
        let bare = Muscle::new("bare", Length::m(LENGTH), Construction::Braided(braided))?;
        let rubber = bare.with_all(&bladder)?.with_gas_wall(Some(Length::mm(0.0)))?;
        // At 1 bar and 20 % the rubber alone would carry the pressure, and the fibres nothing.
        for pressure in [Pressure::bar(3.0), Pressure::bar(6.0)] {
            for (contraction, expected) in [
                (-0.03, 284.28),
                (-0.02, 154.23),
                (-0.01, 64.40),
                (0.0, 0.0),
                (0.01, -47.53),
                (0.05, -149.82),
                (0.2, -218.83),
            ] {
                let force = at(&rubber, pressure, contraction)?.force_n - at(&bare, pressure, contraction)?.force_n;
                tally.scaled(force, expected, 50.0, || format!("{force:.2} N at contraction {contraction}"));
            }
        }
        Ok(())
    })
}
