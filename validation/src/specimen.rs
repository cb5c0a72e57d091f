//! The muscles that the checks use, and functions that solve them.

use bulge_fibre::{Approach, Given, Problem, Response};
use bulge_muscles::{
    Angle, Braided, Construction, Ends, Fibre, FibreCount, Force, Length, Muscle, Parameter, Pleated,
    Pressure,
};

use crate::check::Trouble;

/// Pleated muscle with straight inextensible fibres; without a count they are continuous.
pub(crate) fn pleated(length: Length, radius: Length, fibres: Option<u32>) -> Result<Muscle, Trouble> {
    let count = fibres.map_or(FibreCount::Continuous, FibreCount::Discrete);
    Ok(Muscle::new("pleated", length, Construction::Pleated(Pleated::new(radius, count)?))?)
}

/// Pleated muscle of S1: l0 = 110 mm, R = 16 mm, n = 40.
pub(crate) fn ppam() -> Result<Muscle, Trouble> {
    pleated(Length::mm(110.0), Length::mm(16.0), Some(40))
}

/// Braid with clamped ends.
pub(crate) fn braid(length: Length, radius: Length, angle: Angle) -> Result<Muscle, Trouble> {
    Ok(Muscle::new("braid", length, Construction::Braided(Braided::new(radius, angle)?))?)
}

/// Braid of r0 = 10 mm and 25 degrees, with clamped ends.
pub(crate) fn braid_25(length: Length) -> Result<Muscle, Trouble> {
    braid(length, Length::mm(10.0), Angle::deg(25.0))
}

/// Braid of r0 = 10 mm and 25 degrees as the textbook cylinder.
pub(crate) fn cylinder_25(length: Length) -> Result<Muscle, Trouble> {
    let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0))?.with_ends(Ends::Cylinder);
    Ok(Muscle::new("cylinder", length, Construction::Braided(braided))?)
}

/// Braid of r0 = 10 mm and 25 degrees with 60 fibres, 250 mm or shorter, on fittings of another radius.
fn counted(length: Length, fitting: Length) -> Result<Muscle, Trouble> {
    let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0))?.with_fibres(60)?;
    let muscle = Muscle::new("braid", length, Construction::Braided(braided))?;
    Ok(muscle.with(Parameter::FittingRadius, fitting.to_m())?)
}

/// Muscles of inextensible fibres loaded by pressure alone, each with a contraction within its range.
pub(crate) fn pressure_only() -> Result<Vec<(&'static str, Muscle, f64)>, Trouble> {
    let (length, radius) = (Length::mm(110.0), Length::mm(16.0));
    Ok(vec![
        ("pleated, n = 40", ppam()?, 0.2),
        ("pleated, n = 3", pleated(length, radius, Some(3))?, 0.1),
        ("pleated, continuous", pleated(length, radius, None)?, 0.3),
        ("pleated, l0/R = 1", pleated(radius, radius, Some(12))?, 0.05),
        ("pleated, l0/R = 200", pleated(Length::m(2.0), Length::mm(10.0), Some(60))?, 0.4),
        ("misaligned by 6 deg", ppam()?.with(Parameter::Misalignment, 6.0_f64.to_radians())?, 0.2),
        ("pleats 3 mm deep", ppam()?.with(Parameter::PleatDepth, 0.003)?, 0.15),
        ("lobes", ppam()?.with(Parameter::ClothCircumference, 0.33)?, 0.2),
        ("lobes that touch", ppam()?.with(Parameter::ClothCircumference, 0.52)?, 0.15),
        ("lobes, nearly open", ppam()?.with(Parameter::ClothCircumference, 0.3)?, 0.28),
        ("lobes, n = 6", pleated(length, radius, Some(6))?.with(Parameter::ClothCircumference, 0.26)?, 0.12),
        (
            "lobes of misaligned fibres",
            ppam()?.with(Parameter::ClothCircumference, 0.3)?.with(Parameter::Misalignment, 0.08)?,
            0.22,
        ),
        (
            "braid, gas on the inner wall",
            braid_25(Length::mm(120.0))?.with(Parameter::GasWall, 0.0015)?,
            0.15,
        ),
        (
            "cylinder, gas on the inner wall",
            cylinder_25(Length::mm(250.0))?.with(Parameter::GasWall, 0.002)?,
            0.2,
        ),
        ("braid, 250 mm", braid_25(Length::mm(250.0))?, 0.2),
        ("braid, 30 mm", braid_25(Length::mm(30.0))?, 0.1),
        ("braid, l0/r0 = 90", braid_25(Length::m(0.9))?, 0.25),
        ("braid, drawn out", braid_25(Length::mm(100.0))?, -0.02),
        ("braid, 40 deg", braid(Length::mm(150.0), Length::mm(12.0), Angle::deg(40.0))?, 0.15),
        ("braid on thin fittings", counted(Length::mm(120.0), Length::mm(7.0))?, 0.15),
        ("cylinder", cylinder_25(Length::mm(250.0))?, 0.2),
    ])
}

/// Muscles in which fibres, bladder or cloth store energy, each with a contraction within its range.
pub(crate) fn storing() -> Result<Vec<(&'static str, Muscle, f64)>, Trouble> {
    let rubber = [(Parameter::Wall, 0.0015), (Parameter::C10, 2e5), (Parameter::C01, 5e4)];
    let cloth =
        |radius| [(Parameter::HoopStiffness, 8e3), (Parameter::UnfoldedRadius, Length::mm(radius).to_m())];
    let fibre = |stiffness| Fibre::new(Force::n(stiffness));
    let everything = ppam()?
        .with_fibre(fibre(4e3)?)?
        .with_all(&cloth(34.0))?
        .with(Parameter::Misalignment, 4.0_f64.to_radians())?
        .with(Parameter::PleatDepth, 0.002)?;
    let (length, fitting) = (Length::mm(120.0), Length::mm(9.0));
    Ok(vec![
        ("pleated, elastic", ppam()?.with_fibre(fibre(3e3)?)?, 0.1),
        ("pleated, elastic, stretched", ppam()?.with_fibre(fibre(3e3)?)?, -0.01),
        ("pleated, taut cloth", ppam()?.with_all(&cloth(36.0))?, 0.2),
        ("pleated, everything", everything, 0.15),
        (
            "lobes, elastic, taut cloth",
            ppam()?
                .with(Parameter::ClothCircumference, 0.31)?
                .with_fibre(fibre(6e3)?)?
                .with_all(&cloth(38.0))?,
            0.15,
        ),
        ("cylinder, bladder", cylinder_25(Length::mm(250.0))?.with_all(&rubber)?, 0.15),
        (
            "braid, bladder, gas on its inner face",
            braid_25(length)?.with_all(&rubber)?.with_gas_wall(None)?,
            0.12,
        ),
        ("braid, elastic", counted(length, fitting)?.with_fibre(fibre(200.0)?)?, 0.12),
        ("braid, bladder", braid_25(Length::mm(250.0))?.with_all(&rubber)?, 0.2),
        ("braid, bladder, short", braid_25(Length::mm(50.0))?.with_all(&rubber)?, 0.1),
        ("braid, taut cloth", braid_25(length)?.with_all(&cloth(12.0))?, 0.1),
        (
            "braid, everything",
            counted(length, fitting)?.with_fibre(fibre(300.0)?)?.with_all(&rubber)?.with_all(&cloth(13.0))?,
            0.12,
        ),
    ])
}

/// The muscles of both lists.
pub(crate) fn every_kind() -> Result<Vec<(&'static str, Muscle, f64)>, Trouble> {
    Ok(pressure_only()?.into_iter().chain(storing()?).collect())
}

/// Factor on the usual steps of differences: lobes that are nearly open stiffen within a few per mille of
/// contraction.
pub(crate) fn stride(muscle: &Muscle) -> f64 {
    if muscle.get(Parameter::ClothCircumference).is_some() { 0.1 } else { 1.0 }
}

/// Solves a muscle at a pressure and a contraction by whichever method applies.
pub(crate) fn at(muscle: &Muscle, pressure: Pressure, contraction: f64) -> Result<Response, Trouble> {
    Ok(Problem::new(muscle, pressure)?.follow(contraction, Approach::Auto)?)
}

/// Solves a muscle at a pressure and a contraction by shooting.
pub(crate) fn shot(muscle: &Muscle, pressure: Pressure, contraction: f64) -> Result<Response, Trouble> {
    Ok(Problem::new(muscle, pressure)?.solve(Given::Contraction(contraction), Approach::Shooting)?)
}
