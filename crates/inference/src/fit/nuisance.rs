//! Rig errors within the data sheets, and stated widths of the muscle: fitted along with everything, as noise.

use bulge_effects::{Catalogue, Effect};
use bulge_model::{Model, ModelError};
use bulge_muscles::{Instrument, Muscle, Parameter, Quantity};
use std::sync::Arc;

/// A number that is known up to a width.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Width {
    effect: &'static str,
    parameter: &'static str,
    /// Mean and standard deviation, in SI.
    prior: (f64, f64),
}

/// A model with its nuisances, and the priors of all its numbers.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub(crate) model: Model,
    /// One for each number of the model.
    pub(crate) priors: Vec<Option<(f64, f64)>>,
    /// Whether the number is a nuisance.
    pub(crate) nuisance: Vec<bool>,
}

/// Adds to a model what `[instruments]` and stated widths leave open. An effect that was asked for by name keeps its own prior: then it is
/// not noise.
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
        // Specimens that differ have each their own.
        for (prior, _) in
            prepared.priors.iter_mut().zip(prepared.model.parameters()).filter(|(_, p)| is_it(p))
        {
            *prior = Some(width.prior);
        }
    }
    Ok(prepared)
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
            _ => {}
        }
    }
    widths
}
