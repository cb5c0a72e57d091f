//! Effects hidden in simulated measurements, as users write them: `coulomb-friction=14 N`.

use bulge_effects::{Catalogue, CatalogueError, Effect, Group, ParameterCard, known};
use bulge_model::{Model, ModelError};
use bulge_muscles::{Fault, FileError, Muscle};
use bulge_numerics::Random;
use std::sync::Arc;

use crate::error::InferenceError;
use crate::fit::nuisance::known_model;
use crate::protocol::bench::Protocol;
use crate::protocol::simulation::{Simulation, simulate};

/// Random stream for the differences of specimens; the streams of the readings count upwards from 0.
const SPECIMENS: u64 = u64::MAX;

/// Reasons why nothing is simulated.
#[derive(Debug, thiserror::Error)]
pub enum HideError {
    /// The list of effects is wrong: what is wrong, and what to write instead.
    #[error("{0}")]
    Stated(String),
    /// An effect that doesn't exist.
    #[error(transparent)]
    Effect(#[from] CatalogueError),
    /// The muscle file states an effect in a wrong way.
    #[error(transparent)]
    File(#[from] FileError),
    /// An effect that this muscle can't have.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The protocol can't be carried out.
    #[error(transparent)]
    Inference(#[from] InferenceError),
}

impl HideError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Model(error) => error.fault(),
            Self::Inference(error) => error.fault(),
            Self::Stated(_) | Self::Effect(_) | Self::File(_) => Fault::Input,
        }
    }
}

/// Synthetic measurements of a muscle with hidden effects. `with` lists them as `name`, `name=value` or
/// `name.key=value`; a value alone belongs to the effect before it. Values have units. Parameters that aren't
/// stated have their usual values. For an effect of specimens, the value is the standard deviation between
/// them. The same seed gives the same bytes.
///
/// # Errors
/// [`HideError`].
pub fn simulate_with(
    muscle: &Muscle,
    catalogue: &Catalogue,
    protocol: &Protocol,
    with: &[String],
    seed: u64,
) -> Result<Simulation, HideError> {
    let find = |name: &str| Ok(Arc::clone(catalogue.find(name)?));
    let stated = stated(with, find, muscle)?;
    let (muscle, specimens) = &protocol.specimens_of(muscle)?;
    let known = known_model(muscle, &known(muscle, catalogue)?, specimens)?;
    let model = stated.iter().try_fold(known, |model, one| model.with(&one.effect, None))?;
    let theta = numbers(&model, &stated, muscle, seed)?;
    Ok(simulate(&model, &theta, protocol, seed)?)
}

/// An effect to hide, with the parameter values that were stated \[SI\].
struct Stated {
    effect: Arc<dyn Effect>,
    numbers: Vec<Option<f64>>,
}

fn wrong(what: String) -> HideError {
    HideError::Stated(what)
}

/// Parses `name`, `name=value`, `name.key=value`, or a further value of the effect before.
fn stated(
    items: &[String],
    find: impl Fn(&str) -> Result<Arc<dyn Effect>, HideError>,
    muscle: &Muscle,
) -> Result<Vec<Stated>, HideError> {
    let mut all: Vec<Stated> = Vec::new();
    for item in items {
        let item = item.trim();
        if item.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.' | '\u{2212}')) {
            let last = all.last_mut().ok_or_else(|| {
                wrong(format!("`{item}` belongs to no effect; write such as `coulomb-friction={item}`"))
            })?;
            last.next(item, muscle)?;
            continue;
        }
        let (left, value) =
            item.split_once('=').map_or((item, None), |(left, value)| (left, Some(value.trim())));
        let (name, key) = left.split_once('.').map_or((left, None), |(name, key)| (name, Some(key.trim())));
        let effect = find(name.trim())?;
        let is_it = |other: &Stated| other.effect.card().name == effect.card().name;
        let place = all.iter().position(is_it);
        if place.is_some() && key.is_none() {
            return Err(wrong(format!(
                "`{}` stands twice in the list of effects; once is enough",
                name.trim()
            )));
        }
        let place = place.unwrap_or_else(|| {
            let numbers = vec![None; effect.parameters().len()];
            all.push(Stated { effect, numbers });
            all.len() - 1
        });
        match (key, value) {
            (Some(key), Some(value)) => all[place].keyed(key, value, muscle)?,
            (Some(key), None) => {
                return Err(wrong(format!(
                    "`{item}` has no value; write such as {}",
                    all[place].example(Some(key), muscle)
                )));
            }
            (None, Some(value)) => all[place].next(value, muscle)?,
            (None, None) => {}
        }
    }
    Ok(all)
}

impl Stated {
    fn name(&self) -> String {
        self.effect.card().name.to_owned()
    }

    /// Calls `read` with the parameter cards for this muscle.
    fn with_cards<T>(&self, muscle: &Muscle, read: impl FnOnce(&[ParameterCard<'_>]) -> T) -> T {
        let cards: Vec<ParameterCard<'_>> =
            self.effect.parameters().into_iter().map(|card| card.of(muscle)).collect();
        read(&cards)
    }

    /// Gives a value to the first parameter that has none.
    fn next(&mut self, value: &str, muscle: &Muscle) -> Result<(), HideError> {
        let Some(place) = self.numbers.iter().position(Option::is_none) else {
            let count = self.numbers.len();
            let has = match count {
                0 => "no number: write its name alone".to_owned(),
                1 => "one number only".to_owned(),
                _ => format!("{count} numbers only"),
            };
            return Err(wrong(format!("`{value}` is too much for `{}`, which has {has}", self.name())));
        };
        self.put(place, value, muscle)
    }

    fn keyed(&mut self, key: &str, value: &str, muscle: &Muscle) -> Result<(), HideError> {
        let is_it =
            |cards: &[ParameterCard<'_>]| cards.iter().position(|card| card.key == key || card.name == key);
        if let Some(place) = self.with_cards(muscle, is_it) {
            return self.put(place, value, muscle);
        }
        let has = if self.numbers.is_empty() {
            "it has no numbers: write its name alone".to_owned()
        } else {
            format!("write such as {}", self.example(None, muscle))
        };
        Err(wrong(format!("the effect `{}` has no `{key}`; {has}", self.name())))
    }

    fn put(&mut self, place: usize, text: &str, muscle: &Muscle) -> Result<(), HideError> {
        let name = self.name();
        let value = self.with_cards(muscle, |cards| cards[place].read(&name, text)).map_err(wrong)?;
        self.numbers[place] = Some(value);
        Ok(())
    }

    /// An example of how one parameter, or all of them, are written.
    fn example(&self, key: Option<&str>, muscle: &Muscle) -> String {
        let name = self.name();
        let one = |card: &ParameterCard<'_>| format!("`{name}.{}={}`", card.key, card.shown(card.usual()));
        self.with_cards(muscle, |cards| {
            let fitting = cards.iter().filter(|card| key.is_none_or(|key| card.key == key));
            let list: Vec<String> = fitting.map(one).collect();
            if list.is_empty() { format!("`{name}`: it has no such number") } else { list.join(", ") }
        })
    }
}

/// All parameters of the model: the stated ones, usual ones, and one draw for each specimen.
fn numbers(model: &Model, stated: &[Stated], muscle: &Muscle, seed: u64) -> Result<Vec<f64>, HideError> {
    let mut theta = model.start();
    let mut random = Random::new(seed, SPECIMENS);
    for one in stated {
        let name = one.name();
        let is_of_specimens = one.effect.card().group == Group::Specimen;
        if is_of_specimens
            && model.parameters().iter().filter(|p| p.effect == name).count() <= one.numbers.len()
        {
            return Err(wrong(format!(
                "`{name}` needs two specimens or more; write such as `specimens = 3` into a `[[block]]`"
            )));
        }
        let is_silent = one.numbers.iter().all(Option::is_none);
        let values = one.with_cards(muscle, |cards| -> Vec<f64> {
            let value = |(card, number): (&ParameterCard<'_>, &Option<f64>)| {
                number.unwrap_or(if is_silent { card.usual() } else { card.typical })
            };
            cards.iter().zip(&one.numbers).map(value).collect()
        });
        let does_nothing = one.with_cards(muscle, |cards| {
            !cards.is_empty()
                && cards.iter().zip(&values).all(|(card, value)| card.off.total_cmp(value).is_eq())
        });
        if does_nothing && is_silent {
            let example = one.example(None, muscle);
            return Err(wrong(format!(
                "`{name}` has no usual size; write its numbers, in the way of {example}"
            )));
        }
        let places = (0..theta.len()).filter(|i| model.parameters()[*i].effect == name);
        for (place, value) in places.zip(values.iter().cycle()) {
            let number = &model.parameters()[place];
            let drawn = if is_of_specimens { value * random.normal() } else { *value };
            theta[place] = drawn.clamp(number.low, number.high);
        }
    }
    Ok(theta)
}
