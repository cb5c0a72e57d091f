//! Effects, options and answers by name, for all of these tests.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bulge_effects::{Catalogue, Effect};
use bulge_inference::{Block, DiagnoseOptions, Diagnosis, Options, Protocol, ReadingNoise};
use bulge_model::Model;
use bulge_muscles::{Muscle, from_toml};
use std::sync::Arc;

/// The file of a braid between cylindrical ends whose numbers are exact.
pub(crate) const CYLINDER: &str = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm +- 0\"\nradius = \"10 mm +- 0\"\nbraid_angle = \"25 deg +- 0\"\nends = \"cylinder\"\n";

/// This braid by another name, with more lines in its file.
pub(crate) fn cylinder(name: &str, more: &str) -> Muscle {
    from_toml(&format!("{}{more}\n", CYLINDER.replace("\"x\"", &format!("\"{name}\""))), "m.toml").unwrap()
}

pub(crate) fn effects(names: &[&str]) -> Vec<Arc<dyn Effect>> {
    let catalogue = Catalogue::builtin();
    names.iter().map(|name| Arc::clone(catalogue.find(name).unwrap())).collect()
}

pub(crate) fn options(names: &[&str]) -> Options {
    Options::new(Catalogue::builtin(), effects(names))
}

/// Options of a diagnosis with these effects in its base.
pub(crate) fn diagnosing(names: &[&str]) -> DiagnoseOptions {
    DiagnoseOptions::new(options(names))
}

/// The missing effects that a diagnosis names.
pub(crate) fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.missing.iter().map(|missing| missing.effect.as_str()).collect()
}

/// A muscle with these effects, and their parameters.
pub(crate) fn truth(muscle: &Muscle, effects_and_values: &[(&str, &[f64])]) -> (Model, Vec<f64>) {
    let names: Vec<&str> = effects_and_values.iter().map(|(name, _)| *name).collect();
    let add = |model: Model, effect: &Arc<dyn Effect>| model.with(effect, None).unwrap();
    let values = effects_and_values.iter().flat_map(|(_, values)| values.iter().copied());
    (effects(&names).iter().fold(Model::new(muscle), add), values.collect())
}

/// A protocol of one block with white noise of the force \[N\].
pub(crate) fn noisy(block: Block, force_n: f64) -> Protocol {
    let noise = ReadingNoise { force_n, ..ReadingNoise::default() };
    Protocol { noise, ..Protocol::new(vec![block]) }
}
