//! Arguments of several commands: the muscle, quantities with units, the method.

use bulge_effects::{Catalogue, Effect, known};
use bulge_fibre::{Approach, FibreError};
use bulge_model::{MuscleWithEffects, MuscleWithEffectsError, specimen};
use bulge_muscles::settings::nearest;
use bulge_muscles::shown::{listed, shortened};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Muscle, PRESETS, Pressure, Specimen, UnitError, preset, read, units};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

use crate::failure::Failure;

/// Units of a time, in seconds.
pub(crate) const TIME: [(&str, f64); 3] = [("s", 1.0), ("ms", 1e-3), ("min", 60.0)];

/// The form of an answer: text, or a document.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Json {
    /// One JSON document on standard output
    #[arg(id = "json", long)]
    pub(crate) wanted: bool,
}

impl Json {
    /// The document if it is wanted, otherwise the text.
    pub(crate) fn or(
        self,
        document: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<String, Failure> {
        if self.wanted { pretty(document) } else { Ok(text()) }
    }
}

/// A document as it is printed and written.
pub(crate) fn pretty(document: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}

/// How to compute.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArgument {
    /// The closed form where there is one, else shooting
    #[default]
    Auto,
    /// Elliptic integrals (straight fibres), or the cylinder formula
    ClosedForm,
    /// Shooting on the equilibrium ODE
    Shooting,
    /// Membrane finite elements of revolution (`bulge shape` only)
    Membrane,
}

impl MethodArgument {
    pub(crate) fn approach(self) -> Approach {
        match self {
            Self::Auto | Self::Membrane => Approach::Auto,
            Self::ClosedForm => Approach::ClosedForm,
            Self::Shooting => Approach::Shooting,
        }
    }
}

/// A muscle file, or a shipped muscle if no file of that name exists.
pub(crate) fn muscle(name: &str) -> Result<Muscle, Failure> {
    let shipped = PRESETS.iter().any(|preset| preset.name == name);
    let looks_like_a_name = !name.contains(['/', '.', '\\']) && !name.is_empty();
    if (shipped || looks_like_a_name) && !Path::new(name).exists() {
        return Ok(preset(name)?);
    }
    Ok(read(name)?)
}

/// A muscle or one of its specimens, with the effects stated in its file, from the built-in ones and the
/// user's own.
pub(crate) fn extended(
    name: &str,
    own: Option<&Path>,
    of: Option<&str>,
) -> Result<(Muscle, MuscleWithEffects), Failure> {
    let mut muscle = muscle(name)?;
    let mut known = known(&muscle, &catalogue(own)?)?;
    if let Some(of) = of {
        check_specimen(&muscle, of)?;
        (muscle, known) = specimen(&muscle, of, &known)?;
    }
    let extended = MuscleWithEffects::new(&muscle, &known)?;
    Ok((muscle, extended))
}

/// Rejects the name of a specimen that the muscle doesn't have.
fn check_specimen(muscle: &Muscle, name: &str) -> Result<(), Failure> {
    let names: Vec<&str> = muscle.specimens().iter().map(Specimen::name).collect();
    if names.contains(&name) {
        return Ok(());
    }
    let stated = match (nearest(name, names.iter().copied()), listed(20, "", &names)) {
        (Some(near), _) => format!("did you mean `{near}`?"),
        (None, all) if all.is_empty() => {
            format!("{} states none, such as `[specimens.short]` with `length = \"60 mm\"`", muscle.name())
        }
        (None, all) => format!("{} states {all}", muscle.name()),
    };
    Err(Failure::Value {
        option: "--specimen",
        what: format!("there is no specimen `{}`: {stated}", shortened(name)),
    })
}

/// The failure of an option whose quantities can't be read.
fn unreadable(option: &'static str) -> impl Fn(UnitError) -> Failure {
    move |error| Failure::Value { option, what: error.to_string() }
}

/// A quantity with its unit.
pub(crate) fn quantity<Q: Quantity>(option: &'static str, text: &str) -> Result<Q, Failure> {
    units::parse(text).map_err(unreadable(option))
}

/// A number with one of the given units, converted to the first one.
pub(crate) fn in_unit(option: &'static str, text: &str, known: &[(&str, f64)]) -> Result<f64, Failure> {
    units::in_one_of(text, known).map_err(|what| Failure::Value { option, what })
}

/// A list of quantities.
pub(crate) fn list<Q: Quantity>(option: &'static str, text: &str) -> Result<Vec<Q>, Failure> {
    units::parse_list(text).map_err(unreadable(option))
}

/// Both ends of a range of quantities, in the order written: either may be the smaller one.
pub(crate) fn range<Q: Quantity>(option: &'static str, text: &str) -> Result<[f64; 2], Failure> {
    let (from, to): (Q, Q) = units::parse_range(text).map_err(unreadable(option))?;
    Ok([from.si(), to.si()])
}

/// Wraps an error of the solver with the muscle and the pressure.
pub(crate) fn about(muscle: &Muscle, pressure: Pressure) -> impl Fn(FibreError) -> Failure {
    let (muscle, pressure) = (muscle.name().to_owned(), pressure.to_string());
    move |source| Failure::Equilibrium {
        muscle: muscle.clone(),
        pressure: pressure.clone(),
        source: Box::new(source),
    }
}

/// As [`about`], for a muscle with its effects.
pub(crate) fn about_extended(
    muscle: &Muscle,
    pressure: Pressure,
) -> impl Fn(MuscleWithEffectsError) -> Failure {
    let about = about(muscle, pressure);
    move |error| match error {
        MuscleWithEffectsError::Equilibrium(source) => about(*source),
        MuscleWithEffectsError::Model(source) => (*source).into(),
        MuscleWithEffectsError::Force { .. } => error.into(),
    }
}

/// The built-in effects, and the user's own if a file is given.
pub(crate) fn catalogue(own: Option<&Path>) -> Result<Catalogue, Failure> {
    let mut catalogue = Catalogue::builtin();
    if let Some(path) = own {
        for effect in bulge_effects::user::read(path)? {
            catalogue = catalogue.with(effect)?;
        }
    }
    Ok(catalogue)
}

/// The effects named in a list, in their order.
pub(crate) fn effects(catalogue: &Catalogue, names: &[String]) -> Result<Vec<Arc<dyn Effect>>, Failure> {
    names.iter().map(|name| Ok(Arc::clone(catalogue.find(name.trim())?))).collect()
}

/// Names of the effects to which a search is restricted; `None` if it isn't.
pub(crate) fn among(catalogue: &Catalogue, names: &[String]) -> Result<Option<Vec<String>>, Failure> {
    let found = effects(catalogue, names)?;
    let names: Vec<String> = found.iter().map(|effect| effect.card().name.to_owned()).collect();
    Ok((!names.is_empty()).then_some(names))
}
