//! Commercial fluidic muscles, with the force law that S4 uses for sizing.

use bulge_effects::law::Law;
use bulge_muscles::preset;

use super::SizeError;
use super::family::{Family, Limits};

/// Names and inner diameters \[m\].
const FLUIDIC: [(&str, f64); 3] = [("dmsp-10", 0.01), ("dmsp-20", 0.02), ("dmsp-40", 0.04)];
/// The law, its coefficients, and the muscle to which they belong.
const MEASURED: [&str; 3] = ["sarosi-6", "DMSP-20-400N, S4", "dmsp-20-400"];

/// Festo fluidic muscles of 10, 20 and 40 mm. That of 20 mm is as measured in S4; the others are taken as
/// similar in their cross-section and were not measured.
///
/// # Errors
/// None, as long as the law of that name exists.
pub fn fluidic_muscles() -> Result<Vec<Family>, SizeError> {
    let [law, table, muscle] = MEASURED;
    let gone = |why: String| SizeError::Muscle { family: muscle.to_owned(), length_m: 0.4, why };
    let law = Law::find(law).ok_or_else(|| gone(format!("there is no law {law}")))?;
    let muscle = preset(muscle).map_err(|error| gone(error.to_string()))?;
    FLUIDIC
        .iter()
        .map(|(name, diameter_m)| {
            let family = Family::of_law(name, law, law.table(table), &muscle, Limits::FLUIDIC)?;
            let is_measured = (family.diameter_m() - diameter_m).abs() < 1e-9;
            Ok(if is_measured { family } else { family.scaled(name, *diameter_m) })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forces of the muscles of 10 and 40 mm are a quarter and four times that of 20 mm.
    #[test]
    fn forces_go_with_the_square_of_the_diameter() {
        let families = fluidic_muscles().unwrap();
        let force = |i: usize| families[i].at(0.4).unwrap().force_n(4e5, 0.125).unwrap();
        assert_eq!(families.iter().map(Family::name).collect::<Vec<_>>(), ["dmsp-10", "dmsp-20", "dmsp-40"]);
        assert!((force(1) - 489.0).abs() < 0.5, "S4, eq. 1 at 4 bar and 12.5 %");
        assert!((force(0) / force(1) - 0.25).abs() < 1e-12 && (force(2) / force(1) - 4.0).abs() < 1e-12);
        assert!(families[0].basis().contains("scaled") && !families[1].basis().contains("scaled"));
    }
}
