//! Nuisance parameters: rig errors within the data sheets and stated widths of the muscle, fitted along as
//! noise.

use bulge_effects::{Catalogue, Effect, Known};
use bulge_model::{Model, ModelError};
use bulge_muscles::{Instrument, Muscle, Parameter, Quantity};
use std::sync::Arc;

/// A parameter that is known up to a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Width {
    effect: &'static str,
    parameter: &'static str,
    /// Mean and standard deviation, in SI units.
    prior: (f64, f64),
}

/// A model with its nuisance parameters, and the priors of all its parameters.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub(crate) model: Model,
    /// One entry for each parameter of the model.
    pub(crate) priors: Vec<Option<(f64, f64)>>,
    /// Whether the parameter is a nuisance.
    pub(crate) nuisance: Vec<bool>,
}

impl Prepared {
    /// The start of a fit: nuisance parameters start at their stated values.
    pub(crate) fn start(&self) -> Vec<f64> {
        let mut start = self.model.start();
        let stated = self.nuisance_priors();
        for ((value, p), prior) in start.iter_mut().zip(self.model.parameters()).zip(stated) {
            if let Some((mean, _)) = prior.filter(|_| !p.fixed) {
                // Bounds stated by the user may be narrower than the data sheet.
                *value = mean.max(p.low).min(p.high);
            }
        }
        self.model.with_ties(&start).into_owned()
    }

    /// The priors of data sheets and widths. Sizes of effects are free in the fit of a diagnosis; their priors
    /// enter the evidence.
    pub(crate) fn nuisance_priors(&self) -> Vec<Option<(f64, f64)>> {
        let both = self.priors.iter().zip(&self.nuisance);
        both.map(|(prior, nuisance)| prior.filter(|_| *nuisance)).collect()
    }
}

/// Adds nuisance parameters for what `[instruments]` and stated widths leave open. An effect that was
/// requested by name keeps its own prior and is then no nuisance.
pub(crate) fn with_nuisances(model: &Model, catalogue: &Catalogue) -> Result<Prepared, ModelError> {
    let asked = model.parameters().len();
    let mut prepared = Prepared {
        model: model.clone(),
        priors: model.parameters().iter().map(|p| p.prior).collect(),
        nuisance: vec![false; asked],
    };
    for width in widths(model.muscle()) {
        let taken =
            |effects: &[bulge_model::Chosen]| effects.iter().any(|c| c.effect.card().name == width.effect);
        if taken(prepared.model.effects())
            && prepared.model.parameters()[..asked].iter().any(|p| p.effect == width.effect)
        {
            continue;
        }
        let Some(effect) = known(catalogue, width.effect) else { continue };
        if effect.card().kind.is_some_and(|kind| kind != model.muscle().kind()) {
            continue;
        }
        if !taken(prepared.model.effects()) {
            prepared.model = prepared.model.with(effect, None)?;
        }
        let added = prepared.model.parameters().len() - prepared.priors.len();
        prepared.priors.extend(std::iter::repeat_n(None, added));
        prepared.nuisance.extend(std::iter::repeat_n(true, added));
        let is_it = |p: &bulge_model::ModelParameter| p.effect == width.effect && p.name == width.parameter;
        // An error of the mounting is another one for each specimen.
        for (prior, _) in
            prepared.priors.iter_mut().zip(prepared.model.parameters()).filter(|(_, p)| is_it(p))
        {
            *prior = Some(width.prior);
        }
    }
    Ok(prepared)
}

/// A muscle with its known effects, for some specimens.
pub(crate) fn known_model(
    muscle: &Muscle,
    known: &[Known],
    specimens: &[String],
) -> Result<Model, ModelError> {
    let model = Model::new(muscle).for_specimens(specimens)?;
    known.iter().try_fold(model, |model, (effect, values)| model.with(effect, Some(values)))
}

/// Geometrical parameters for which a stated width adds a nuisance parameter.
pub(crate) const fn is_geometry(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::Length | Parameter::Radius | Parameter::BraidAngle | Parameter::Wall)
}

fn known<'c>(catalogue: &'c Catalogue, name: &str) -> Option<&'c Arc<dyn Effect>> {
    catalogue.find(name).ok()
}

fn widths(muscle: &Muscle) -> Vec<Width> {
    let instruments = muscle.instruments();
    let mut widths = Vec::new();
    let mut add = |effect, parameter, mean: f64, sd: f64| {
        if sd > 0.0 {
            widths.push(Width { effect, parameter, prior: (mean, sd) });
        }
    };
    let zero = |instrument: Option<Instrument>| instrument.map_or(0.0, |i| i.zero());
    let gain = |instrument: Option<Instrument>| instrument.map_or(0.0, |i| i.gain().si());
    add("force-offset", "offset", 0.0, zero(instruments.force));
    add("force-gain", "gain", 0.0, gain(instruments.force));
    add("pressure-offset", "offset", 0.0, zero(instruments.pressure));
    add("pressure-gain", "gain", 0.0, gain(instruments.pressure));
    add("length-zero-error", "offset", 0.0, zero(instruments.length));
    add("displacement-gain", "gain", 0.0, gain(instruments.length));
    for (parameter, sd) in muscle.widths() {
        let stated = muscle.get(*parameter).unwrap_or(0.0);
        match parameter {
            Parameter::Length => add("fibre-length", "excess", 0.0, sd / stated),
            Parameter::Radius if muscle.is_pleated() => add("end-radius", "radius", stated, *sd),
            Parameter::Radius => add("radius-error", "radius", stated, *sd),
            Parameter::BraidAngle => add("braid-angle-error", "error", 0.0, *sd),
            // The wall's thickness changes the force in two ways: the gas acts on its inner face where the
            // file says so, and the rubber's stored energy is proportional to modulus times thickness.
            Parameter::Wall => {
                if muscle.get(Parameter::GasWall).is_some() && !muscle.is_stated(Parameter::GasWall) {
                    add("wall-thickness", "thickness", stated, *sd);
                }
                if let Some(c10) = muscle.get(Parameter::C10) {
                    add("bladder-elasticity", "modulus", c10, c10 * sd / stated);
                }
            }
            Parameter::GasWall => add("wall-thickness", "thickness", stated, *sd),
            _ => {}
        }
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::{from_toml, preset};

    fn priors(muscle: &Muscle) -> Vec<(String, f64, f64)> {
        let prepared = with_nuisances(&Model::new(muscle), &Catalogue::builtin()).unwrap();
        assert!(prepared.nuisance.iter().all(|nuisance| *nuisance));
        let numbers = prepared.model.parameters().iter().zip(&prepared.priors).zip(prepared.start());
        numbers
            .map(|((p, prior), start)| {
                let (mean, sd) = prior.unwrap();
                assert!((start - mean).abs() <= 0.0, "{} starts at {start}", p.effect);
                (p.effect.clone(), mean, sd)
            })
            .collect()
    }

    fn are(found: &[(String, f64, f64)], expected: &[(&str, f64, f64)]) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for ((name, mean, sd), (wanted, at, width)) in found.iter().zip(expected) {
            assert_eq!(name, wanted);
            assert!((mean - at).abs() <= 1e-12 && (sd / width - 1.0).abs() < 1e-12, "{name}: {mean} +- {sd}");
        }
    }

    #[test]
    fn usual_widths_are_priors_of_the_geometry() {
        let (pleated, _) = preset("ppam-2-r16").unwrap().with_usual_widths();
        are(&priors(&pleated), &[("fibre-length", 0.0, 0.5 / 110.0), ("end-radius", 0.016, 0.03 * 0.016)]);
        let (braided, _) = preset("dmsp-20-250").unwrap().with_usual_widths();
        let geometry = [
            ("fibre-length", 0.0, 0.5 / 250.0),
            ("radius-error", 0.010_725, 0.03 * 0.010_725),
            ("braid-angle-error", 0.0, 2.0_f64.to_radians()),
        ];
        // Without either, the wall changes nothing: only its rubber and the gas on its inner face do.
        are(&priors(&braided), &geometry);
        let stated =
            preset("dmsp-20-250").unwrap().with(Parameter::C10, 3e5).unwrap().with_gas_wall(None).unwrap();
        let [length, radius, angle] = geometry;
        let wall = [("wall-thickness", 0.002, 0.15 * 0.002), ("bladder-elasticity", 3e5, 0.15 * 3e5)];
        are(&priors(&stated.with_usual_widths().0), &[length, radius, angle, wall[0], wall[1]]);
    }

    /// An error of the mounting is another one for each specimen, and a radius is that of all.
    #[test]
    fn specimens_that_differ_have_errors_of_mounting_each() {
        let file = "name = \"m\"\nkind = \"braided\"\nlength = \"250 mm +- 0\"\nradius = \"10 mm +- 0.2 mm\"\nbraid_angle = \"25 deg +- 0\"\n[instruments]\nforce = { zero = \"2 N\" }\n[specimens.A]\n[specimens.B]\nradius = \"12 mm\"\n";
        let muscle = from_toml(file, "m").unwrap();
        let model = Model::new(&muscle).for_specimens(&["A".to_owned(), "B".to_owned()]).unwrap();
        let prepared = with_nuisances(&model, &Catalogue::builtin()).unwrap();
        let mut found: Vec<(f64, f64)> = prepared.priors.iter().flatten().copied().collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(found, [(0.0, 2.0), (0.0, 2.0), (0.01, 2e-4)]);
    }

    #[test]
    fn exact_numbers_have_no_priors() {
        let file = "name = \"m\"\nkind = \"braided\"\nlength = \"250 mm +- 0\"\nradius = \"10 mm +- 0\"\nbraid_angle = \"25 deg +- 0\"\nwall = \"1 mm +- 0\"\n";
        let muscle = from_toml(file, "m").unwrap();
        are(&priors(&muscle.clone().with_usual_widths().0), &[]);
        let thin = muscle.with_width(Parameter::Radius, 1e-4).unwrap();
        are(&priors(&thin), &[("radius-error", 0.01, 1e-4)]);
    }
}
