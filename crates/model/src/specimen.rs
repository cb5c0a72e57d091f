//! One specimen as a muscle of its own, with the effects that the muscle states.

use bulge_effects::{Known, Stage, learnt};
use bulge_fibre::{Jet, Parts};
use bulge_muscles::Muscle;
use bulge_numerics::Real;

use crate::error::ModelError;

/// The muscle of one specimen, and the effects of the muscle with the specimen's parameters.
///
/// Some effects set a number of the muscle (`radius-error` sets the radius, not its error). They set the
/// number of the muscle as stated. A specimen with another value of that number keeps its ratio to the
/// muscle, as in a model of all specimens ([`crate::Model::for_specimens`]).
///
/// ```
/// use bulge_effects::{Catalogue, known};
///
/// let text = "name = \"hose\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n
/// [effects.radius-error]\nradius = \"10.5 mm\"\n\n[specimens.thin]\nradius = \"8 mm\"\n";
/// let hose = bulge_muscles::from_toml(text, "hose.toml")?;
/// let (thin, known) = bulge_model::specimen(&hose, "thin", &known(&hose, &Catalogue::builtin())?)?;
/// assert!((known[0].1[0] - 0.0084).abs() < 1e-12);
/// assert!((thin.learnt()[0].values()[0].si - 0.0084).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the numbers of the specimen don't fit the muscle, or not together with the effects.
pub fn specimen(muscle: &Muscle, name: &str, known: &[Known]) -> Result<(Muscle, Vec<Known>), ModelError> {
    let about = |source| ModelError::Specimen { specimen: name.to_owned(), source: Box::new(source) };
    let mut own = muscle.of_specimen(name).map_err(about)?;
    let mut all = known.to_vec();
    for (effect, numbers) in all.iter_mut().filter(|(effect, _)| effect.stage() == Stage::Shape) {
        let theta: Vec<Jet> = numbers.iter().enumerate().map(|(i, v)| Jet::variable(*v, i)).collect();
        let reshape = |parts: &Parts| {
            let mut changed = parts.still();
            effect.reshape(&theta, &mut changed).map(|()| changed.numbers())
        };
        let [muscle, own_parts] = [Parts::of(muscle), Parts::of(&own)];
        let (of_muscle, of_own) = (reshape(&muscle).map_err(about)?, reshape(&own_parts).map_err(about)?);
        let value = |numbers: &[(&str, f64)], name: &str| {
            numbers.iter().find(|(other, _)| *other == name).map_or(0.0, |(_, number)| *number)
        };
        let mut changed = false;
        for ((name, set), (_, found)) in of_muscle.iter().zip(&of_own) {
            let (stated, own) = (value(&muscle.numbers(), name), value(&own_parts.numbers(), name));
            // Equal values mean that the effect sets the number itself.
            let same = set.value().to_bits() == found.value().to_bits();
            if stated == 0.0 || stated.to_bits() == own.to_bits() || !same {
                continue;
            }
            for (number, _) in numbers.iter_mut().zip(set.gradient()).filter(|(_, slope)| **slope != 0.0) {
                *number *= own / stated;
                changed = true;
            }
        }
        if changed {
            own = own.with_learnt(learnt(effect.as_ref(), numbers, &[]).map_err(about)?);
        }
    }
    Ok((own, all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::{Catalogue, known};
    use bulge_muscles::from_toml;

    /// A learnt radius keeps its ratio to the stated one: 10.5 of 10 mm, and 8.4 of 8 mm or 12.6 of 12 mm.
    #[test]
    fn a_learnt_radius_is_that_of_the_specimen() {
        let text = "name = \"hose\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n\
                    [effects.radius-error]\nradius = \"10.5 mm\"\n[specimens.thin]\nradius = \"8 mm\"\n\
                    [specimens.wide]\nradius = \"12 mm\"\n[specimens.short]\nlength = \"100 mm\"\n";
        let hose = from_toml(text, "hose.toml").unwrap();
        let known = known(&hose, &Catalogue::builtin()).unwrap();
        for (name, radius) in [("thin", 0.0084), ("wide", 0.0126), ("short", 0.0105)] {
            let (own, numbers) = specimen(&hose, name, &known).unwrap();
            assert!((numbers[0].1[0] - radius).abs() < 1e-12, "{name}: {}", numbers[0].1[0]);
            assert!((own.learnt()[0].values()[0].si - radius).abs() < 1e-12, "{name}");
        }
    }
}
