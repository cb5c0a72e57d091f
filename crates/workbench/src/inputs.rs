//! The inputs of an analysis, read from the choices: rows, muscle, catalogue.

use bulge_effects::{Catalogue, Effect, Known, known};
use bulge_inference::Options;
use bulge_measurements::{ColumnMap, Data};
use bulge_model::{Restriction, read_options};
use bulge_muscles::{Muscle, from_toml};
use std::sync::Arc;

use crate::choices::{Choices, ChosenEffect};
use crate::refusal::{Place, Refusal};

/// Name of the muscle's file in messages.
pub(crate) const MUSCLE: &str = "the muscle";
/// Name of the user's own effects in messages.
const OWN: &str = "your effects";

/// The model beyond the muscle's file: effects, and restrictions on their parameters.
#[derive(Debug, Clone, Default)]
pub(crate) struct With {
    pub(crate) effects: Vec<Arc<dyn Effect>>,
    pub(crate) restrictions: Vec<Restriction>,
}

impl With {
    /// Key that identifies it.
    pub(crate) fn key(&self) -> String {
        let names: Vec<&str> = self.effects.iter().map(|effect| effect.card().name).collect();
        format!("{names:?} {:?}", self.restrictions)
    }
}

/// Rows, muscle and catalogue of some choices. Two analyses with the same `Arc` of it differ only in their
/// model.
#[derive(Debug)]
pub(crate) struct Inputs {
    pub(crate) data: Arc<Data>,
    pub(crate) muscle: Muscle,
    pub(crate) catalogue: Catalogue,
    known: Vec<Known>,
    excluded: Vec<usize>,
}

impl Inputs {
    /// Reads the files named in the choices. `rows` are reused if other choices gave the same rows.
    pub(crate) fn read(choices: &Choices, rows: Option<Arc<Data>>) -> Result<Self, Refusal> {
        let catalogue = catalogue(choices.own_effects.as_deref())?;
        let muscle = from_toml(&choices.muscle.toml, MUSCLE).map_err(Refusal::at(Place::Muscle))?;
        let known = known(&muscle, &catalogue).map_err(Refusal::at(Place::Muscle))?;
        let data = match rows {
            Some(rows) => rows,
            None => Arc::new(read_rows(choices, &muscle)?),
        };
        let excluded: Vec<usize> = choices.excluded.iter().copied().filter(|row| *row < data.len()).collect();
        Ok(Self { data, muscle, catalogue, known, excluded })
    }

    /// Options of a comparison with these effects.
    pub(crate) fn options(&self, with: With, held_out: bool) -> Options {
        let mut options = Options::new(self.catalogue.clone(), with.effects);
        options.restrictions = with.restrictions;
        options.known.clone_from(&self.known);
        options.excluded.clone_from(&self.excluded);
        options.held_out = held_out;
        options
    }

    /// Effects from the catalogue, with their fixed parameters.
    pub(crate) fn with(&self, effects: &[ChosenEffect]) -> Result<With, Refusal> {
        let find = |name: &str| self.catalogue.find(name).map(Arc::clone);
        let found: Result<Vec<_>, _> = effects.iter().map(|chosen| find(&chosen.name)).collect();
        Ok(With {
            effects: found.map_err(Refusal::at(Place::Effects))?,
            restrictions: restrictions(effects, &self.catalogue, &self.muscle)?,
        })
    }
}

fn read_rows(choices: &Choices, muscle: &Muscle) -> Result<Data, Refusal> {
    let map = choices.columns.as_deref().map(str::parse::<ColumnMap>).transpose();
    let columns = map.map_err(Refusal::at(Place::Columns))?;
    let options = read_options(muscle, columns.as_ref()).map_err(Refusal::at(Place::Muscle))?;
    let files: Vec<_> = choices.data.iter().map(|file| (file.name.clone(), file.path.clone())).collect();
    Data::read_named(&files, &options).map_err(|error| {
        // Unknown columns can be corrected where the columns are shown; any other error is about the file.
        let place = if error.columns().is_empty() { Place::Data } else { Place::Columns };
        Refusal { columns: error.columns().to_vec(), ..Refusal::new(place, error) }
    })
}

/// Each fixed parameter in the notation of the command line: `coulomb-friction.force=14 N`.
pub(crate) fn held(effects: &[ChosenEffect], catalogue: &Catalogue) -> Result<Vec<String>, Refusal> {
    let one = |(effect, number, value): (&str, &str, f64)| {
        let found = catalogue.find(effect).map_err(Refusal::at(Place::Effects))?;
        let unit =
            found.parameters().iter().find(|card| card.name == number).map(|card| card.unit.to_owned());
        // For an unknown parameter the library's message lists the known ones.
        let unit = unit.filter(|unit| unit != "1").map_or_else(String::new, |unit| format!(" {unit}"));
        Ok(format!("{effect}.{number}={value}{unit}"))
    };
    effects.iter().flat_map(ChosenEffect::held).map(one).collect()
}

/// The fixed parameters as restrictions of a fit.
pub(crate) fn restrictions(
    effects: &[ChosenEffect],
    catalogue: &Catalogue,
    muscle: &Muscle,
) -> Result<Vec<Restriction>, Refusal> {
    let mut options = Options::new(catalogue.clone(), Vec::new());
    for text in held(effects, catalogue)? {
        options = options.hold(&text, muscle).map_err(Refusal::at(Place::Effects))?;
    }
    Ok(options.restrictions)
}

/// The built-in effects with the user's own.
pub(crate) fn catalogue(own: Option<&str>) -> Result<Catalogue, Refusal> {
    let mut catalogue = Catalogue::builtin();
    for effect in own
        .map_or_else(|| Ok(Vec::new()), |toml| bulge_effects::user::from_toml(toml, OWN))
        .map_err(Refusal::at(Place::OwnEffects))?
    {
        catalogue = catalogue.with(effect).map_err(Refusal::at(Place::OwnEffects))?;
    }
    Ok(catalogue)
}
