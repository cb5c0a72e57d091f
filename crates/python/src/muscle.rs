//! A muscle with its effects, quantities with units, and what a muscle file may say.

use bulge_effects::user::UserEffect;
use bulge_effects::{Catalogue, known, user};
use bulge_fibre::{Approach, Given};
use bulge_model::{Equilibrium, MuscleWithEffects};
use bulge_muscles::{self as muscles, PRESETS, Parameter, Pressure, units};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::error::{OrRaise, input};
use crate::evaluate::{self, AxisValues};
use crate::shape::Shape;
use crate::task::beside;

/// Most points of a meridian.
const MOST_POINTS: usize = 100_001;

/// A muscle, with the effects that its file states and the user's own among them.
#[pyclass(frozen, module = "bulge._bulge")]
#[derive(Debug, Clone)]
pub(crate) struct Muscle {
    pub(crate) muscle: muscles::Muscle,
    /// The user's own effects, as the text of an effect file.
    pub(crate) own: String,
}

/// Effects of the text of an effect file; none of an empty one.
pub(crate) fn own_effects(own: &str) -> PyResult<Vec<UserEffect>> {
    if own.trim().is_empty() { Ok(Vec::new()) } else { user::from_toml(own, "own effects").or_raise() }
}

/// The built-in effects, and those of the text of an effect file.
pub(crate) fn catalogue(own: &str) -> PyResult<Catalogue> {
    let mut catalogue = Catalogue::builtin();
    for effect in own_effects(own)? {
        catalogue = catalogue.with(effect).or_raise()?;
    }
    Ok(catalogue)
}

/// How equilibria are computed.
pub(crate) fn approach(method: &str) -> PyResult<Approach> {
    match method {
        "auto" => Ok(Approach::Auto),
        "closed-form" => Ok(Approach::ClosedForm),
        "shooting" => Ok(Approach::Shooting),
        other => Err(input(format!(
            "method: there is no `{other}`; write \"auto\", \"closed-form\" or \"shooting\" (membrane elements: `bulge shape --method membrane`)"
        ))),
    }
}

impl Muscle {
    pub(crate) fn extended(&self) -> PyResult<MuscleWithEffects> {
        let known = known(&self.muscle, &catalogue(&self.own)?).or_raise()?;
        MuscleWithEffects::new(&self.muscle, &known).or_raise()
    }
}

#[pymethods]
impl Muscle {
    /// From the text of a muscle file; `origin` is what messages call it.
    #[staticmethod]
    fn from_text(text: &str, origin: &str, own: &str) -> PyResult<Self> {
        Self::checked(muscles::from_toml(text, origin).or_raise()?, own)
    }

    /// From a file.
    #[staticmethod]
    fn from_file(path: std::path::PathBuf, own: &str) -> PyResult<Self> {
        Self::checked(muscles::read(path).or_raise()?, own)
    }

    /// A shipped muscle.
    #[staticmethod]
    fn preset(name: &str, own: &str) -> PyResult<Self> {
        Self::checked(muscles::preset(name).or_raise()?, own)
    }

    /// The muscle file.
    fn to_toml(&self) -> String {
        muscles::to_toml(&self.muscle)
    }

    /// The text of the user's own effects.
    #[getter]
    fn own(&self) -> &str {
        &self.own
    }

    #[getter]
    fn name(&self) -> &str {
        self.muscle.name()
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.muscle.kind().name()
    }

    /// Names of the effects that the file states.
    #[getter]
    fn effects(&self) -> Vec<String> {
        // Those that shape the muscle are numbers of it, and tables of effects in its file alone; whose name may have lines of its own.
        let plain = self.muscle.clone().with_name("muscle");
        let text = muscles::to_toml(plain.as_ref().unwrap_or(&self.muscle));
        let named = |line: &str| {
            line.strip_prefix("[effects.").and_then(|rest| rest.strip_suffix(']')).map(str::to_owned)
        };
        text.lines().filter_map(named).collect()
    }

    /// Names of the specimens that have numbers of their own.
    #[getter]
    fn specimens(&self) -> Vec<String> {
        self.muscle.specimens().iter().map(|specimen| specimen.name().to_owned()).collect()
    }

    /// The muscle that a specimen is.
    fn specimen(&self, name: &str) -> PyResult<Self> {
        let names = self.specimens();
        if !names.iter().any(|own| own == name) {
            let stated = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(input(format!("there is no specimen `{name}`: {} states {stated}", self.name())));
        }
        let known = known(&self.muscle, &catalogue(&self.own)?).or_raise()?;
        let (muscle, _) = bulge_model::specimen(&self.muscle, name, &known).or_raise()?;
        Ok(Self { muscle, own: self.own.clone() })
    }

    /// A number of the muscle in SI, if it has it.
    fn get(&self, parameter: &str) -> PyResult<Option<f64>> {
        Ok(self.muscle.get(parameter_named(parameter)?))
    }

    /// The muscle with another number, in SI.
    fn with_number(&self, parameter: &str, value: f64) -> PyResult<Self> {
        let parameter = parameter_named(parameter)?;
        let muscle = self.muscle.clone().with(parameter, value).or_raise()?;
        Ok(Self { muscle, own: self.own.clone() })
    }

    /// The muscle with a specimen that has other numbers, in SI.
    fn with_specimen(&self, name: &str, numbers: Vec<(String, f64)>) -> PyResult<Self> {
        let number = |(name, value): (String, f64)| Ok((parameter_named(&name)?, value));
        let numbers = numbers.into_iter().map(number).collect::<PyResult<_>>()?;
        let muscle = self.muscle.clone().with_specimen(name, numbers).or_raise()?;
        Ok(Self { muscle, own: self.own.clone() })
    }

    /// One equilibrium.
    fn shape(
        &self,
        py: Python<'_>,
        pressure: f64,
        given: &str,
        value: f64,
        method: &str,
        points: usize,
    ) -> PyResult<Shape> {
        let given = match given {
            "contraction" => Given::Contraction(value),
            "length" => Given::Length(value),
            "force" => Given::Force(value),
            _ => Given::Volume(value),
        };
        if !(3..=MOST_POINTS).contains(&points) {
            return Err(input(format!("points: {points} points: give 3 to {MOST_POINTS}")));
        }
        let approach = approach(method)?;
        let extended = self.extended()?;
        let muscle = extended.muscle().clone();
        let found = beside(py, None, move |_| {
            Equilibrium::new(&extended, Pressure::pa(pressure), given, approach, points)
        })?;
        let found = found.map_err(|error| self.about(pressure, &error))?;
        Ok(Shape { muscle, found })
    }

    /// The contraction at which the muscle pulls no more, at each pressure.
    fn contraction_limit<'py>(
        &self,
        py: Python<'py>,
        pressure: PyReadonlyArray1<'py, f64>,
        method: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let approach = approach(method)?;
        let extended = self.extended()?;
        let pressures = pressure.as_array().to_vec();
        let found = beside(py, None, move |watch| {
            let one = |p: &f64| {
                watch.look();
                extended.contraction_limit(Pressure::pa(*p), approach).map_err(|error| (*p, error))
            };
            pressures.iter().map(one).collect::<Result<Vec<f64>, _>>()
        })?;
        let limits = found.map_err(|(pressure, error)| self.about(pressure, &error))?;
        Ok(PyArray1::from_vec(py, limits))
    }

    /// Outputs at points; see `evaluate`.
    #[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        outputs: Vec<String>,
        axes: Vec<(String, AxisValues<'py>)>,
        count: usize,
        pressure: Option<f64>,
        method: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<evaluate::Found<'py>> {
        let approach = approach(method)?;
        evaluate::evaluate(py, self, &outputs, axes, count, pressure, approach, progress)
    }
}

impl Muscle {
    /// With effects that exist and can be had.
    fn checked(muscle: muscles::Muscle, own: &str) -> PyResult<Self> {
        let muscle = Self { muscle, own: own.to_owned() };
        muscle.extended()?;
        Ok(muscle)
    }

    /// An error with the muscle and the pressure that it is about, as the command line says it.
    fn about(&self, pressure: f64, error: &bulge_model::MuscleWithEffectsError) -> PyErr {
        let says = format!("{} at {}: {error}", self.muscle.name(), Pressure::pa(pressure));
        crate::error::of_fault(error.fault(), says)
    }
}

fn parameter_named(name: &str) -> PyResult<Parameter> {
    Parameter::named(name).ok_or_else(|| {
        let all: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).collect();
        input(format!("a muscle has no number `{name}`; known: {}", all.join(", ")))
    })
}

/// SI units of the numbers of a muscle, by name: for floats, which are SI.
#[pyfunction]
pub(crate) fn units_of(own: &str) -> PyResult<Vec<(String, String)>> {
    let mut all: Vec<(String, String)> =
        Parameter::ALL.iter().map(|p| (p.name().to_owned(), p.unit().to_owned())).collect();
    for effect in catalogue(own)?.iter() {
        for card in effect.parameters() {
            let unit = units::unit(card.unit)
                .map_or_else(|_| "1".to_owned(), |(_, dimension)| dimension.to_string());
            all.push((format!("{}.{}", effect.card().name, card.key), unit));
        }
    }
    // Last, as it counts: in files, effects that shape the muscle have the keys of its numbers.
    let of_shape = |p: &Parameter| Some((p.key().strip_prefix("effects.")?.to_owned(), p.unit().to_owned()));
    all.extend(Parameter::ALL.iter().filter_map(of_shape));
    all.push(("bladder-elasticity.wall".to_owned(), Parameter::Wall.unit().to_owned()));
    Ok(all)
}

/// A quantity with its unit, in SI; it must have the dimension of `unit`.
#[pyfunction]
pub(crate) fn si(name: &str, text: &str, unit: &str) -> PyResult<f64> {
    let found = units::any(text).map_err(|error| input(format!("{name}: {error}")))?;
    let (_, dimension) = units::unit(unit).map_err(|error| input(error.to_string()))?;
    if found.dimension == dimension {
        return Ok(found.si);
    }
    let (is, must) = (found.dimension.describe(), dimension.describe());
    let example = if unit == "1" { "20 %".to_owned() } else { format!("2 {unit}") };
    Err(input(format!("{name}: `{text}` is {is}, but {name} is {must}; write such as \"{example}\"")))
}

/// How many SI units a unit is.
#[pyfunction]
pub(crate) fn unit_factor(unit: &str) -> PyResult<f64> {
    units::unit(unit).map(|(factor, _)| factor).map_err(|error| input(error.to_string()))
}

/// Shipped muscles: name, what it is, file.
#[pyfunction]
pub(crate) fn presets() -> Vec<(&'static str, &'static str, &'static str)> {
    PRESETS.iter().map(|preset| (preset.name, preset.about, preset.text)).collect()
}
