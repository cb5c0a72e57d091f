//! A model: a muscle (or a force law) with chosen effects, and the list of its parameters.

use bulge_effects::law::{Coefficient, Law, LawGeometry, Role};
use bulge_effects::{Effect, Group, Moment, Setting, Stage};
use bulge_fibre::{Jet, Parts, Problem};
use bulge_muscles::{Muscle, Pressure};
use bulge_numerics::Real;
use serde::Serialize;
use std::sync::Arc;

use crate::base::Shaped;
use crate::error::ModelError;
use crate::parameter::ModelParameter;
use crate::restriction::Restriction;
use crate::solved::Solved;

/// The coarsest refinement at which the lattice still follows the force.
const COARSEST: f64 = 0.25;

/// Step away from 0, as a fraction of a parameter's usual size, at which a part exists that is absent at 0.
/// Derivatives change by about the same fraction.
const BESIDE: f64 = 1e-7;

/// An effect in a model.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// The effect.
    pub effect: Arc<dyn Effect>,
    /// Whether its parameters are known.
    pub fixed: bool,
    /// Index of its first parameter in the model's list, and the number of its parameters per specimen.
    pub(crate) place: usize,
    pub(crate) count: usize,
    /// Whether each specimen has its own parameters.
    pub(crate) each_specimen: bool,
}

/// The law that gives the force before effects are added.
#[derive(Debug, Clone)]
pub(crate) enum Base {
    Equilibrium,
    Law { law: &'static Law },
}

/// One of the distinct muscles among the specimens.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) muscle: Muscle,
    /// The parts of the muscle before effects.
    pub(crate) parts: Parts,
    pub(crate) setting: Setting,
    pub(crate) geometry: LawGeometry,
}

impl Body {
    fn of(muscle: Muscle) -> Self {
        let (setting, geometry) = (Setting::of(&muscle), LawGeometry::from(&muscle));
        Self { parts: Parts::of(&muscle), muscle, setting, geometry }
    }
}

/// A base law with effects.
#[derive(Debug, Clone)]
pub struct Model {
    pub(crate) muscle: Muscle,
    pub(crate) base: Base,
    /// The distinct muscles among the specimens, and the index into them for each specimen.
    pub(crate) bodies: Vec<Body>,
    pub(crate) body_of: Vec<usize>,
    pub(crate) effects: Vec<Chosen>,
    pub(crate) specimens: Vec<String>,
    pub(crate) parameters: Vec<ModelParameter>,
    /// Restrictions on parameters, including those of effects that are not added yet.
    pub(crate) restrictions: Arc<[Restriction]>,
    /// The steps of the lattice are divided by this number.
    pub(crate) refinement: f64,
    /// Lattices that were solved by this model and the models made from it.
    pub(crate) solved: Arc<Solved>,
}

/// Force of a muscle at rest at three stages.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtRest {
    /// Force of the equilibrium, or of the law \[N\].
    pub equilibrium_n: f64,
    /// Force including the load effects \[N\].
    pub force_n: f64,
    /// Reading of the load cell \[N\].
    pub reading_n: f64,
}

impl Model {
    /// The equilibrium of a muscle, without effects other than those that the muscle itself contains.
    #[must_use]
    pub fn new(muscle: &Muscle) -> Self {
        Self {
            muscle: muscle.clone(),
            base: Base::Equilibrium,
            bodies: vec![Body::of(muscle.clone().without_specimens())],
            body_of: vec![0],
            effects: Vec::new(),
            specimens: vec!["1".to_owned()],
            parameters: Vec::new(),
            restrictions: Arc::from([]),
            refinement: 1.0,
            solved: Arc::default(),
        }
    }

    /// Replaces the parts by parts that were changed outside the model.
    pub(crate) fn of_parts(mut self, parts: &Parts) -> Self {
        for body in &mut self.bodies {
            body.parts = parts.clone();
        }
        self
    }

    /// A model with a force law in place of the equilibrium. The coefficients of the law are parameters of
    /// the model and start at `values`. They are fixed unless `free`.
    #[must_use]
    pub fn from_law(muscle: &Muscle, law: &'static Law, values: &[f64], free: bool) -> Self {
        let mut model = Self::new(muscle);
        let geometry = LawGeometry::from(muscle);
        model.parameters = law_parameters(law, &geometry, values, free);
        model.base = Base::Law { law };
        model
    }

    /// Adds an effect. Its parameters are known if `values` are given; otherwise they start at their usual
    /// values.
    ///
    /// # Errors
    /// If the effect belongs to the other kind of muscle, or is already in the model.
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

    /// The model for several specimens, by name. Call this before effects are added. Each specimen is the
    /// muscle with the numbers stated for the specimen.
    ///
    /// # Errors
    /// If the numbers of a specimen don't fit the muscle.
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
                self.bodies.push(Body::of(muscle));
            }
        }
        Ok(self)
    }

    /// Whether each specimen has its own parameters of an effect. This is so if the effect describes
    /// differences between specimens, or if it comes with the mounting and the specimens differ.
    fn is_of_each_specimen(&self, effect: &dyn Effect) -> bool {
        effect.card().group == Group::Specimen
            || effect.is_of_mounting() && self.specimens.len() > 1 && !self.muscle.specimens().is_empty()
    }

    /// The number of copies of an effect's parameters: one, or one for each specimen.
    #[must_use]
    pub fn copies(&self, effect: &dyn Effect) -> usize {
        if self.is_of_each_specimen(effect) { self.specimens.len() } else { 1 }
    }

    /// The effect and the name of a parameter.
    pub(crate) fn name_of(&self, index: usize) -> (String, String) {
        let parameter = &self.parameters[index];
        (parameter.effect.clone(), parameter.name.clone())
    }

    /// Index of a specimen's muscle among the distinct muscles.
    pub(crate) fn body_of(&self, specimen: u32) -> usize {
        self.body_of[(specimen as usize).min(self.body_of.len() - 1)]
    }

    /// Names of the specimens.
    #[must_use]
    pub fn specimens(&self) -> &[String] {
        &self.specimens
    }

    /// The model on a lattice whose steps are divided by `refinement`. At 0.5 forces are accurate to about
    /// 1e-4.
    #[must_use]
    pub fn refined(mut self, refinement: f64) -> Self {
        self.refinement = refinement.max(COARSEST);
        self
    }

    /// The muscle as stated, without effects.
    #[must_use]
    pub fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    /// The force law, if the model is based on one.
    #[must_use]
    pub fn law(&self) -> Option<&'static Law> {
        if let Base::Law { law, .. } = self.base { Some(law) } else { None }
    }

    /// The effects in the order in which they were added.
    #[must_use]
    pub fn effects(&self) -> &[Chosen] {
        &self.effects
    }

    /// All parameters, in the order in which [`Model::evaluate`] takes them.
    #[must_use]
    pub fn parameters(&self) -> &[ModelParameter] {
        &self.parameters
    }

    /// The values at which a fit starts.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }

    /// The values at which no effect changes anything.
    #[must_use]
    pub fn off(&self) -> Vec<f64> {
        let coefficient = |p: &ModelParameter| self.law().is_some_and(|law| law.name == p.effect);
        self.parameters.iter().map(|p| if coefficient(p) { p.value } else { p.off }).collect()
    }

    /// The indices of an effect's parameters for a specimen.
    pub(crate) fn range(&self, chosen: &Chosen, specimen: u32) -> std::ops::Range<usize> {
        let copy = if chosen.each_specimen { (specimen as usize).min(self.specimens.len() - 1) } else { 0 };
        let start = chosen.place + copy * chosen.count;
        start..start + chosen.count
    }

    /// The parts of the muscle as changed by the effects of stage [`Stage::Shape`], for drawings and for
    /// other solvers.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle, or not with these values.
    pub fn parts(&self, theta: &[f64]) -> Result<Parts, ModelError> {
        let stated = Body::of(self.muscle.clone().without_specimens());
        self.moving(&stated, &self.with_ties(theta), &[]).map(|parts| parts.values())
    }

    /// The parts of one of the distinct muscles. Ties are already applied to `theta`.
    pub(crate) fn parts_of(&self, body: usize, theta: &[f64]) -> Result<Parts, ModelError> {
        self.moving(&self.bodies[body], theta, &[]).map(|parts| parts.values())
    }

    /// The wanted parameters that belong to shape effects, in the order of the effects.
    pub(crate) fn shapes(&self, wanted: &[usize]) -> Vec<usize> {
        let of_shape = self.effects.iter().filter(|chosen| chosen.effect.stage() == Stage::Shape);
        of_shape.flat_map(|chosen| self.range(chosen, 0)).filter(|index| wanted.contains(index)).collect()
    }

    /// The parts of one of the distinct muscles, with derivatives by the parameters `shapes`, each in its
    /// lane.
    pub(crate) fn shaped(&self, body: usize, theta: &[f64], shapes: &[usize]) -> Result<Shaped, ModelError> {
        let body = &self.bodies[body];
        let parts = self.moving(body, theta, shapes)?;
        let mut beside = Vec::new();
        for (lane, index) in shapes.iter().enumerate() {
            // A parameter by which any number has a derivative needs no other parts.
            if parts.numbers().iter().any(|(_, number)| number.gradient()[lane] != 0.0) {
                continue;
            }
            let mut nudged = theta.to_vec();
            nudged[*index] += BESIDE * self.parameters[*index].typical_step();
            let there = self.moving(body, &nudged, shapes)?;
            if there.values() != parts.values() {
                beside.push((lane, there));
            }
        }
        Ok(Shaped { parts, beside })
    }

    /// The parts of a muscle as changed by the effects, with derivatives by the parameters `shapes`.
    fn moving(&self, body: &Body, theta: &[f64], shapes: &[usize]) -> Result<Parts<Jet>, ModelError> {
        let seeded = |index: usize| match shapes.iter().position(|shape| *shape == index) {
            Some(lane) => Jet::variable(theta[index], lane),
            None => Jet::from(theta[index]),
        };
        let mut parts = body.parts.still();
        // A specimen that differs from the muscle also needs the effects on the stated muscle.
        let all = Parts::of(&self.muscle);
        let mut stated = (body.parts != all).then(|| all.still());
        for chosen in self.effects.iter().filter(|chosen| chosen.effect.stage() == Stage::Shape) {
            let theta: Vec<Jet> = self.range(chosen, 0).map(seeded).collect();
            let before = parts.clone();
            chosen.effect.reshape(&theta, &mut parts).map_err(about(chosen))?;
            if let Some(stated) = &mut stated {
                let stated_before = stated.clone();
                chosen.effect.reshape(&theta, stated).map_err(about(chosen))?;
                parts = in_proportion(&parts, &before, [&stated_before, stated]);
            }
        }
        Ok(parts)
    }

    /// Whether each row takes an integration of the equilibrium ODE.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle, or not with these values.
    pub fn is_costly(&self, theta: &[f64]) -> Result<bool, ModelError> {
        if self.law().is_some() {
            return Ok(false);
        }
        let theta = self.with_ties(theta);
        for body in 0..self.bodies.len() {
            let problem = Problem::new(self.parts_of(body, &theta)?, Pressure::bar(1.0));
            if problem.is_ok_and(|problem| problem.shoots()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The force at rest at a true pressure \[Pa\] and contraction, with zero direction and rate, at the
    /// first moment.
    ///
    /// # Errors
    /// If there is no equilibrium.
    pub fn at_rest(&self, theta: &[f64], pressure: f64, contraction: f64) -> Result<AtRest, ModelError> {
        self.rest(theta, &Moment::at_rest(pressure, contraction))
    }
}

impl ModelParameter {
    /// The size of a usual change of the parameter.
    fn typical_step(&self) -> f64 {
        let usual = (self.value - self.off).abs();
        if usual > 0.0 { usual } else { 1e-2 * (self.high - self.low) }
    }
}

/// Scales a number that an effect sets (a radius, not its error) for a specimen. Such an effect sets the
/// number of the muscle as stated. A specimen with another value of that number keeps its ratio to the
/// muscle. `before` and `found` are the specimen before and after the effect, `stated` and `set` are the
/// muscle before and after it.
fn in_proportion(found: &Parts<Jet>, before: &Parts<Jet>, [stated, set]: [&Parts<Jet>; 2]) -> Parts<Jet> {
    let [before, stated, set] = [before, stated, set].map(Parts::numbers);
    let of = |numbers: &[(&str, Jet)], name: &str| {
        numbers.iter().find(|(other, _)| *other == name).map(|(_, number)| *number)
    };
    let same = |a: Jet, b: Jet| a.value().to_bits() == b.value().to_bits();
    found.map(|name, number| match (of(&before, name), of(&stated, name), of(&set, name)) {
        (Some(own), Some(stated), Some(set))
            if stated.value() != 0.0 && !same(stated, own) && same(set, number) =>
        {
            own * (set / stated)
        }
        _ => number,
    })
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
