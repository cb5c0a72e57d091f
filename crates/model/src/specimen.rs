//! One specimen as a muscle of its own, with the effects that the muscle states.

use bulge_effects::{Known, Stage, learnt};
use bulge_muscles::{Muscle, Parameter};

use crate::error::ModelError;

/// The muscle that a specimen is, and the effects of the muscle with their numbers for it.
///
/// An effect that says what a number of the muscle is (`radius-error`: the radius, not its error) says so of the muscle as stated; a specimen with
/// another such number keeps its ratio to that of the muscle, as in a model of all specimens ([`crate::Model::for_specimens`]).
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
/// If the muscle can't have the numbers of the specimen, or not with the effects.
pub fn specimen(muscle: &Muscle, name: &str, known: &[Known]) -> Result<(Muscle, Vec<Known>), ModelError> {
    let about = |source| ModelError::Specimen { specimen: name.to_owned(), source: Box::new(source) };
    let mut own = muscle.of_specimen(name).map_err(about)?;
    let mut all = known.to_vec();
    for (effect, numbers) in all.iter_mut().filter(|(effect, _)| effect.stage() == Stage::Shape) {
        let [of_muscle, of_own] = [effect.reshape(muscle, numbers), effect.reshape(&own, numbers)];
        let (of_muscle, of_own) = (of_muscle.map_err(about)?, of_own.map_err(about)?);
        let bits = |muscle: &Muscle, p: Parameter| muscle.get(p).map(f64::to_bits);
        let is_set = |p: Parameter| {
            bits(muscle, p) != bits(&own, p) && bits(&of_muscle.muscle, p) == bits(&of_own.muscle, p)
        };
        let mut changed = false;
        for (i, parameter, _) in of_muscle.moves.iter().filter(|(_, p, _)| is_set(*p)) {
            if let (Some(stated), Some(own)) =
                (muscle.get(*parameter).filter(|v| *v != 0.0), own.get(*parameter))
            {
                numbers[*i] *= own / stated;
                changed = true;
            }
        }
        if changed {
            own = own.with_learnt(learnt(effect.as_ref(), numbers, &[]).map_err(about)?);
        }
    }
    Ok((own, all))
}
