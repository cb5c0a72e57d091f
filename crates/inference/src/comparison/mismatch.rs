//! Data and muscle that belong to different worlds: a wrong unit is no physics.

use bulge_measurements::Data;

use crate::error::InferenceError;

/// Factors between these are gains, geometry, or effects.
const USUAL: (f64, f64) = (0.55, 1.8);
/// Part of the error that may be left after the factor, if the factor is the trouble.
const LEFT: f64 = 0.3;
/// Factors that units differ by, with what to check.
const UNITS: [(f64, &str); 6] = [
    (14.504, "psi read as bar, or bar as psi"),
    (6.895, "psi read as kPa, or kPa as psi"),
    (10.0, "bar read as 100 kPa, or MPa as bar"),
    (100.0, "kPa read as bar, or bar as kPa"),
    (9.807, "force in kgf read as N, or N as kgf"),
    (4.448, "force in lbf read as N, or N as lbf"),
];

/// Whether measured and computed forces differ by one large factor, as they do with a wrong unit.
pub(crate) fn check_scale(data: &Data, model: &[f64], used: &[bool]) -> Result<(), InferenceError> {
    let rows = || (0..data.len()).filter(|row| used[*row] && model[*row].is_finite());
    let force = data.force();
    let square: f64 = rows().map(|row| model[row] * model[row]).sum();
    let along: f64 = rows().map(|row| model[row] * force[row]).sum();
    if square <= 0.0 || rows().count() < 5 {
        return Ok(());
    }
    let factor = along / square;
    let error =
        |factor: f64| rows().map(|row| (force[row] - factor * model[row]).powi(2)).sum::<f64>().sqrt();
    let (before, after) = (error(1.0), error(factor));
    if (USUAL.0..=USUAL.1).contains(&factor) || factor <= 0.0 || after > LEFT * before {
        return Ok(());
    }
    let near = |unit: f64| (factor / unit).ln().abs().min((factor * unit).ln().abs());
    let unit = UNITS.iter().min_by(|a, b| near(a.0).total_cmp(&near(b.0))).filter(|unit| near(unit.0) < 0.35);
    let check = unit.map_or_else(
        || "the units of pressure and force in the header, and the radius of the muscle".to_owned(),
        |(_, what)| format!("the units in the header ({what}?) and the radius of the muscle"),
    );
    Err(InferenceError::OtherScale { factor, check })
}
