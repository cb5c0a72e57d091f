//! A model: a muscle (or a force law) with chosen effects, and the list of its numbers.

use bulge_effects::law::{Coefficient, Law, LawGeometry, Role};
use bulge_effects::{Effect, Group, Moment, Reshaped, Setting, Stage};
use bulge_muscles::{Muscle, MuscleError, Parameter};
use serde::Serialize;
use std::sync::Arc;

use crate::base::{Equilibrium, ShapeVariable};
use crate::error::ModelError;
use crate::parameter::ModelParameter;
use crate::restriction::Restriction;
use crate::solved::Solved;

/// Coarsest lattice that follows the force at all.
const COARSEST: f64 = 0.25;

/// Part of a parameter's usual size at which a number exists that doesn't at 0; derivatives change by about as much on the way.
const BESIDE: f64 = 1e-7;
/// The same for differences: the third power of it is left.
const STEP: f64 = 2e-3;

/// A parameter, and the numbers of the muscle that it moves with d(number)/d(parameter).
type Moved = (usize, Vec<(Parameter, f64)>);

/// An effect of a model.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// The effect.
    pub effect: Arc<dyn Effect>,
    /// Whether its numbers are taken as known.
    pub fixed: bool,
    /// Where its numbers start in the model's list, and how many it has for each specimen.
    pub(crate) place: usize,
    pub(crate) count: usize,
    /// Whether each specimen has its own.
    pub(crate) each_specimen: bool,
}

/// What gives the force before effects are added.
#[derive(Debug, Clone)]
pub(crate) enum Base {
    Equilibrium,
    Law { law: &'static Law },
}

/// One of the muscles that the specimens are.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) muscle: Muscle,
    /// Numbers that are not those of the muscle as stated.
    own: Vec<Parameter>,
    pub(crate) setting: Setting,
    pub(crate) geometry: LawGeometry,
}

impl Body {
    fn of(muscle: Muscle, own: Vec<Parameter>) -> Self {
        let (setting, geometry) = (Setting::of(&muscle), LawGeometry::from(&muscle));
        Self { muscle, own, setting, geometry }
    }
}

/// A base law with effects.
#[derive(Debug, Clone)]
pub struct Model {
    pub(crate) muscle: Muscle,
    pub(crate) base: Base,
    /// The muscles that the specimens are, each once, and which of them each specimen is.
    pub(crate) bodies: Vec<Body>,
    pub(crate) body_of: Vec<usize>,
    pub(crate) effects: Vec<Chosen>,
    pub(crate) specimens: Vec<String>,
    pub(crate) parameters: Vec<ModelParameter>,
    /// What is stated of numbers, also of those that effects still bring.
    pub(crate) restrictions: Arc<[Restriction]>,
    /// Steps of the lattice are divided by this.
    pub(crate) refinement: f64,
    /// Lattices that this model and those made from it have solved.
    pub(crate) solved: Arc<Solved>,
}

/// Force of a muscle at rest, part by part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtRest {
    /// Of the equilibrium, or the law \[N\].
    pub equilibrium_n: f64,
    /// With what effects of the load add \[N\].
    pub force_n: f64,
    /// What the load cell reads \[N\].
    pub reading_n: f64,
}

impl Model {
    /// The equilibrium of a muscle, without effects beyond what the muscle itself states.
    #[must_use]
    pub fn new(muscle: &Muscle) -> Self {
        Self {
            muscle: muscle.clone(),
            base: Base::Equilibrium,
            bodies: vec![Body::of(muscle.clone().without_specimens(), Vec::new())],
            body_of: vec![0],
            effects: Vec::new(),
            specimens: vec!["1".to_owned()],
            parameters: Vec::new(),
            restrictions: Arc::from([]),
            refinement: 1.0,
            solved: Arc::default(),
        }
    }

    /// A force law instead of the equilibrium. Its coefficients are numbers of the model, fixed unless `free`; `values` are where they
    /// start.
    #[must_use]
    pub fn from_law(muscle: &Muscle, law: &'static Law, values: &[f64], free: bool) -> Self {
        let mut model = Self::new(muscle);
        let geometry = LawGeometry::from(muscle);
        model.parameters = law_parameters(law, &geometry, values, free);
        model.base = Base::Law { law };
        model
    }

    /// The same with an effect more. Its numbers are where a fit starts, or known if `values` are given.
    ///
    /// # Errors
    /// If the muscle is of the other kind, or the effect is there already.
    pub fn with(&self, effect: &Arc<dyn Effect>, values: Option<&[f64]>) -> Result<Self, ModelError> {
        let card = effect.card();
        if let Some(owner) = card.kind.filter(|kind| *kind != self.muscle.kind()) {
            let kind = self.muscle.kind().name();
            return Err(ModelError::OtherKind { effect: card.name.to_owned(), owner: owner.name(), kind });
        }
        if self.effects.iter().any(|other| other.effect.card().name == card.name) {
            return Err(ModelError::Twice { effect: card.name.to_owned() });
        }
        let mut model = self.clone();
        let each_specimen = self.is_of_each_specimen(effect.as_ref());
        let copies = self.copies(effect.as_ref());
        model.effects.push(Chosen {
            effect: Arc::clone(effect),
            fixed: values.is_some(),
            place: model.parameters.len(),
            count: effect.parameters().len(),
            each_specimen,
        });
        for copy in 0..copies {
            let muscle = if each_specimen { &self.bodies[self.body_of[copy]].muscle } else { &self.muscle };
            for (i, number) in effect.parameters().into_iter().map(|card| card.of(muscle)).enumerate() {
                model.parameters.push(ModelParameter {
                    effect: card.name.to_owned(),
                    name: number.name.to_owned(),
                    key: number.key.to_owned(),
                    specimen: each_specimen.then(|| self.specimens[copy].clone()),
                    value: values.and_then(|values| values.get(i).copied()).unwrap_or(number.typical),
                    low: number.low,
                    high: number.high,
                    off: number.off,
                    prior: number.prior,
                    plausible: number.plausible.unwrap_or((number.low, number.high)),
                    logarithmic: number.logarithmic,
                    unit: number.unit.to_owned(),
                    factor: number.factor,
                    fixed: values.is_some(),
                    held: false,
                    tied: None,
                    about: number.about.to_owned(),
                });
            }
        }
        model.restrict(self.parameters.len());
        Ok(model)
    }

    /// The same for several specimens, by name; to be called before effects are added. Each is the muscle with the numbers that are stated for it.
    ///
    /// # Errors
    /// If the muscle can't have the numbers of a specimen.
    pub fn for_specimens(mut self, specimens: &[String]) -> Result<Self, ModelError> {
        if specimens.is_empty() {
            return Ok(self);
        }
        self.specimens = specimens.to_vec();
        (self.bodies, self.body_of) = (Vec::new(), Vec::new());
        for name in specimens {
            let about = |source| ModelError::Specimen { specimen: name.clone(), source: Box::new(source) };
            let muscle = self.muscle.of_specimen(name).map_err(about)?;
            let same = self.bodies.iter().position(|body| body.muscle == muscle);
            self.body_of.push(same.unwrap_or(self.bodies.len()));
            if same.is_none() {
                let differs = |p: &Parameter| muscle.get(*p) != self.muscle.get(*p);
                let own = Parameter::ALL.into_iter().filter(differs).collect();
                self.bodies.push(Body::of(muscle, own));
            }
        }
        Ok(self)
    }

    /// Whether each specimen has its own numbers of an effect: it differs from specimen to specimen, or comes with the mounting of specimens that
    /// differ.
    fn is_of_each_specimen(&self, effect: &dyn Effect) -> bool {
        effect.card().group == Group::Specimen
            || effect.is_of_mounting() && self.specimens.len() > 1 && !self.muscle.specimens().is_empty()
    }

    /// How many times the numbers of an effect are there: once, or for each specimen.
    #[must_use]
    pub fn copies(&self, effect: &dyn Effect) -> usize {
        if self.is_of_each_specimen(effect) { self.specimens.len() } else { 1 }
    }

    /// Effect and name of a number.
    pub(crate) fn name_of(&self, index: usize) -> (String, String) {
        let parameter = &self.parameters[index];
        (parameter.effect.clone(), parameter.name.clone())
    }

    /// Which of the muscles that the specimens are a specimen is.
    pub(crate) fn body_of(&self, specimen: u32) -> usize {
        self.body_of[(specimen as usize).min(self.body_of.len() - 1)]
    }

    /// Names of the specimens.
    #[must_use]
    pub fn specimens(&self) -> &[String] {
        &self.specimens
    }

    /// The same on a finer lattice, its steps divided by `refinement`, or on a coarser one: at 0.5 forces are right to about 1e-4.
    #[must_use]
    pub fn refined(mut self, refinement: f64) -> Self {
        self.refinement = refinement.max(COARSEST);
        self
    }

    /// The muscle as stated.
    #[must_use]
    pub fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    /// The name of the force law, if that is the base.
    #[must_use]
    pub fn law(&self) -> Option<&'static Law> {
        if let Base::Law { law, .. } = self.base { Some(law) } else { None }
    }

    /// The effects in their order.
    #[must_use]
    pub fn effects(&self) -> &[Chosen] {
        &self.effects
    }

    /// All numbers, in the order in which [`Model::evaluate`] takes them.
    #[must_use]
    pub fn parameters(&self) -> &[ModelParameter] {
        &self.parameters
    }

    /// Where a fit starts.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }

    /// The numbers at which no effect does anything.
    #[must_use]
    pub fn off(&self) -> Vec<f64> {
        let coefficient = |p: &ModelParameter| self.law().is_some_and(|law| law.name == p.effect);
        self.parameters.iter().map(|p| if coefficient(p) { p.value } else { p.off }).collect()
    }

    /// The numbers of an effect for a specimen.
    pub(crate) fn range(&self, chosen: &Chosen, specimen: u32) -> std::ops::Range<usize> {
        let copy = if chosen.each_specimen { (specimen as usize).min(self.specimens.len() - 1) } else { 0 };
        let start = chosen.place + copy * chosen.count;
        start..start + chosen.count
    }

    /// The muscle as the effects of the stage [`Stage::Shape`] change it: for drawings and for other solvers.
    ///
    /// # Errors
    /// If the muscle can't have an effect, or not with these values.
    pub fn reshaped(&self, theta: &[f64]) -> Result<Muscle, ModelError> {
        let stated = Body::of(self.muscle.clone().without_specimens(), Vec::new());
        self.moves(&stated, &self.with_ties(theta), &[]).map(|(muscle, _)| muscle)
    }

    /// The muscle to solve for one of the bodies, and for each of the `wanted` parameters that change it how they do.
    pub(crate) fn reshape(
        &self,
        body: usize,
        theta: &[f64],
        wanted: &[usize],
    ) -> Result<(Muscle, Vec<(usize, ShapeVariable)>), ModelError> {
        let body = &self.bodies[body];
        let (muscle, moves) = self.moves(body, theta, wanted)?;
        let exists = |moved: &[(Parameter, f64)], muscle: &Muscle| {
            let has = |p| muscle.is_stated(p) || muscle.get(p).is_some_and(|v| v != 0.0);
            !moved.is_empty() && moved.iter().all(|(p, _)| has(*p))
        };
        let mut variables = Vec::with_capacity(moves.len());
        for (index, moved) in moves {
            if exists(&moved, &muscle) {
                variables.push((index, ShapeVariable::Numbers(moved)));
                continue;
            }
            let usual = self.parameters[index].typical_step();
            let at = |step: f64| {
                let mut nudged = theta.to_vec();
                nudged[index] += step;
                self.moves(body, &nudged, &[index])
            };
            let (beside, moves) = at(BESIDE * usual)?;
            let moved =
                moves.into_iter().find(|(i, _)| *i == index).map(|(_, moved)| moved).unwrap_or_default();
            let variable = if exists(&moved, &beside) {
                ShapeVariable::Beside { muscle: Box::new(beside), moved }
            } else if beside == muscle {
                ShapeVariable::Numbers(Vec::new())
            } else {
                let step = STEP * usual;
                let [a, b, c] = [at(step)?.0, at(0.5 * step)?.0, at(0.25 * step)?.0];
                ShapeVariable::Difference { muscles: Box::new([a, b, c]), step }
            };
            variables.push((index, variable));
        }
        Ok((muscle, variables))
    }

    /// The muscle to solve, and for each of the `wanted` parameters which of its numbers they move, as far as the effects say.
    fn moves(
        &self,
        body: &Body,
        theta: &[f64],
        wanted: &[usize],
    ) -> Result<(Muscle, Vec<Moved>), ModelError> {
        let mut muscle = body.muscle.clone();
        let mut stated = self.muscle.clone();
        let mut moved = Vec::new();
        for chosen in self.effects.iter().filter(|c| c.effect.stage() == Stage::Shape) {
            let range = self.range(chosen, 0);
            let reshape = |muscle: &Muscle| chosen.effect.reshape(muscle, &theta[range.clone()]);
            let mut reshaped = reshape(&muscle).map_err(about(chosen))?;
            if !body.own.is_empty() {
                let of_stated = reshape(&stated).map_err(about(chosen))?.muscle;
                let own = [&stated, &of_stated, &muscle];
                reshaped = in_proportion(reshaped, &body.own, own).map_err(about(chosen))?;
                stated = of_stated;
            }
            muscle = reshaped.muscle;
            for index in range.clone().filter(|index| wanted.contains(index)) {
                let of_index = reshaped.moves.iter().filter(|(i, _, _)| range.start + i == index);
                moved.push((index, of_index.map(|(_, parameter, factor)| (*parameter, *factor)).collect()));
            }
        }
        Ok((muscle, moved))
    }

    /// Whether each row takes an integration of the equilibrium ODE.
    ///
    /// # Errors
    /// If the muscle can't have an effect, or not with these values.
    pub fn is_costly(&self, theta: &[f64]) -> Result<bool, ModelError> {
        if self.law().is_some() {
            return Ok(false);
        }
        let theta = self.with_ties(theta);
        for body in 0..self.bodies.len() {
            let (muscle, _) = self.reshape(body, &theta, &[])?;
            if Self::equilibrium(&muscle, &[]).is_ok_and(|equilibrium| equilibrium.is_costly()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    pub(crate) fn equilibrium(
        muscle: &Muscle,
        variables: &[(usize, ShapeVariable)],
    ) -> Result<Equilibrium, bulge_fibre::FibreError> {
        Equilibrium::new(muscle, variables.iter().map(|(_, variable)| variable.clone()).collect())
    }

    /// Force at rest at a true pressure \[Pa\] and contraction: no direction, no rate, the first moment.
    ///
    /// # Errors
    /// If there is no equilibrium.
    pub fn at_rest(&self, theta: &[f64], pressure: f64, contraction: f64) -> Result<AtRest, ModelError> {
        self.rest(theta, &Moment::at_rest(pressure, contraction))
    }
}

impl ModelParameter {
    /// A change of the usual size.
    fn typical_step(&self) -> f64 {
        let usual = (self.value - self.off).abs();
        if usual > 0.0 { usual } else { 1e-2 * (self.high - self.low) }
    }
}

/// An effect that says what a number of the muscle is (a radius, not its error) says so of the muscle as stated. A specimen that has another such
/// number keeps its ratio to that of the muscle: `[stated, changed, own]` are the muscle as stated before and after the effect, and the specimen before.
fn in_proportion(
    mut reshaped: Reshaped,
    numbers: &[Parameter],
    [stated, changed, own]: [&Muscle; 3],
) -> Result<Reshaped, MuscleError> {
    for &parameter in numbers {
        let both = stated.get(parameter).filter(|v| *v != 0.0).zip(own.get(parameter));
        let Some((stated, own)) = both.filter(|(stated, own)| stated.to_bits() != own.to_bits()) else {
            continue;
        };
        let (Some(set), Some(found)) = (changed.get(parameter), reshaped.muscle.get(parameter)) else {
            continue;
        };
        if set.to_bits() != found.to_bits() {
            continue;
        }
        reshaped.muscle = reshaped.muscle.with(parameter, own * (set / stated))?;
        // Of a pleated muscle both are the radius that acts.
        let radius =
            |p| reshaped.muscle.is_pleated() && matches!(p, Parameter::Radius | Parameter::FittingRadius);
        for (_, other, factor) in &mut reshaped.moves {
            if *other == parameter || radius(*other) && radius(parameter) {
                *factor *= own / stated;
            }
        }
    }
    Ok(reshaped)
}

pub(crate) fn about(chosen: &Chosen) -> impl Fn(bulge_muscles::MuscleError) -> ModelError {
    let effect = chosen.effect.card().name.to_owned();
    move |source| ModelError::Reshape { effect: effect.clone(), source: Box::new(source) }
}

fn law_parameters(
    law: &'static Law,
    geometry: &LawGeometry,
    values: &[f64],
    free: bool,
) -> Vec<ModelParameter> {
    let number = |(i, coefficient): (usize, &Coefficient)| ModelParameter {
        effect: law.name.to_owned(),
        name: coefficient.name.to_owned(),
        key: coefficient.name.to_owned(),
        specimen: None,
        value: values.get(i).copied().unwrap_or_else(|| coefficient.start(geometry)),
        low: coefficient.bounds[0],
        high: coefficient.bounds[1],
        off: coefficient.typical,
        prior: None,
        plausible: (coefficient.bounds[0], coefficient.bounds[1]),
        logarithmic: false,
        unit: coefficient.unit.to_owned(),
        factor: 1.0,
        fixed: !free || coefficient.role != Role::Fitted,
        held: false,
        tied: None,
        about: coefficient.meaning.to_owned(),
    };
    law.coefficients.iter().enumerate().map(number).collect()
}
