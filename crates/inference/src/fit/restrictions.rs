//! Parameters held, bounded or tied, as users write them: `bladder-elasticity.modulus=0.31 MPa`,
//! `self-heating.time=100..900 s`, `a.x=b.y`.

use bulge_effects::{Effect, ParameterCard};
use bulge_measurements::Data;
use bulge_model::{NumberName, Restriction, Says};
use bulge_muscles::Muscle;
use bulge_muscles::settings::nearest;
use std::sync::Arc;

use crate::comparison::analysis::Analysis;
use crate::comparison::options::Options;
use crate::error::InferenceError;

/// A parameter of an effect, found by its name, with the texts before and after its value.
struct Named<'o> {
    effect: &'o Arc<dyn Effect>,
    /// Index among the effect's parameters.
    place: usize,
    name: NumberName,
}

impl Named<'_> {
    fn card<T>(&self, muscle: &Muscle, read: impl FnOnce(&ParameterCard<'_>) -> T) -> T {
        read(&self.effect.parameters()[self.place].of(muscle))
    }
}

impl Options {
    /// The options with a parameter held at a value: `effect.number=value`, or `effect=value` if the effect
    /// has one parameter. `effect.number[specimen]` names the parameter of one specimen.
    ///
    /// # Errors
    /// In a sentence: if there is no such effect or parameter, if the value has another dimension or lies
    /// outside the effect's bounds, or if a restriction of this parameter is stated already.
    pub fn hold(self, text: &str, muscle: &Muscle) -> Result<Self, String> {
        let (left, value) = halves(text, "coulomb-friction.force=14 N")?;
        let named = self.named(left)?;
        let value = named.card(muscle, |card| card.read(&named.name.effect, value))?;
        let name = named.name;
        self.with_restriction(Restriction { number: name, says: Says::Held(value) })
    }

    /// The options with a parameter bounded: `effect.number=low..high`.
    ///
    /// # Errors
    /// As [`Options::hold`]; also if the lower bound isn't below the upper one.
    pub fn bound(self, text: &str, muscle: &Muscle) -> Result<Self, String> {
        let (left, range) = halves(text, "coulomb-friction.force=5..20 N")?;
        let named = self.named(left)?;
        let range = named.card(muscle, |card| card.read_range(&named.name.effect, range))?;
        let name = named.name;
        self.with_restriction(Restriction { number: name, says: Says::Within(range) })
    }

    /// The options with a parameter tied to another one, whose fitted value it takes:
    /// `effect.number=other.number`.
    ///
    /// # Errors
    /// As [`Options::hold`]; also if the two parameters differ in dimension, if their bounds don't overlap,
    /// or if the ties form a circle.
    pub fn tie(self, text: &str, muscle: &Muscle) -> Result<Self, String> {
        let (left, right) = halves(text, "force-lag.time=pressure-lag.time")?;
        let (one, other) = (self.named(left)?, self.named(right)?);
        let bounds = |named: &Named<'_>| {
            named.card(muscle, |card| ([card.low, card.high], card.dimension(), card.unit.to_owned()))
        };
        let ([low, high], dimension, unit) = bounds(&one);
        let ([other_low, other_high], other_dimension, other_unit) = bounds(&other);
        if dimension != other_dimension {
            return Err(format!(
                "`{}` is in {unit} and `{}` in {other_unit}: only numbers of the same unit can be tied",
                one.name, other.name
            ));
        }
        if low.max(other_low) > high.min(other_high) {
            return Err(format!(
                "`{}` and `{}` can't have the same value: their bounds don't meet",
                one.name, other.name
            ));
        }
        let (number, to) = (one.name, other.name);
        let mut end = &to;
        for _ in 0..=self.restrictions.len() {
            if *end == number {
                return Err(format!("`{number}` is tied to itself; take one of the ties out"));
            }
            let next = self.restrictions.iter().find(|other| other.number == *end);
            let Some(Restriction { says: Says::Tied(next), .. }) = next else { break };
            end = next;
        }
        self.with_restriction(Restriction { number, says: Says::Tied(to) })
    }

    /// The SI unit of a parameter, named as in [`Options::hold`]: `Pa` for `bladder-elasticity.modulus`, `1`
    /// for dimensionless parameters.
    ///
    /// # Errors
    /// In a sentence: if there is no such effect or parameter.
    pub fn si_unit_of(&self, number: &str, muscle: &Muscle) -> Result<String, String> {
        Ok(self.named(number)?.card(muscle, |card| card.dimension().to_string()))
    }

    fn with_restriction(mut self, new: Restriction) -> Result<Self, String> {
        let same = |other: &&Restriction| {
            let [a, b] = [&other.number, &new.number];
            let both = a.specimen.is_none() || b.specimen.is_none() || a.specimen == b.specimen;
            a.effect == b.effect && a.name == b.name && both
        };
        if let Some(other) = self.restrictions.iter().find(same) {
            let [first, second] = [&other.says, &new.says].map(stated);
            let what =
                if first == second { format!("{first} twice") } else { format!("{first} and {second}") };
            return Err(format!("`{}` is {what}; one of the two is enough", new.number));
        }
        self.restrictions.push(new);
        Ok(self)
    }

    fn named(&self, text: &str) -> Result<Named<'_>, String> {
        let text = text.trim();
        let (text, specimen) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
            Some((number, specimen)) => (number, Some(specimen.to_owned())),
            None => (text, None),
        };
        let (name, key) = text.split_once('.').map_or((text, None), |(name, key)| (name, Some(key.trim())));
        let effect = self.catalogue.find(name.trim()).map_err(|error| error.to_string())?;
        let (card, cards) = (effect.card(), effect.parameters());
        let has = || {
            let all: Vec<String> =
                cards.iter().map(|number| format!("`{}.{}`", card.name, number.key)).collect();
            if all.is_empty() { "it has no numbers".to_owned() } else { format!("it has {}", all.join(", ")) }
        };
        let place = match key {
            Some(key) => cards.iter().position(|number| number.key == key || number.name == key),
            None if cards.len() == 1 => Some(0),
            None => return Err(format!("which number of `{}`? {}", card.name, has())),
        };
        let Some(place) = place else {
            let key = key.unwrap_or_default();
            let instead = nearest(key, cards.iter().map(|number| number.key))
                .map_or_else(has, |near| format!("did you mean `{}.{near}`?", card.name));
            return Err(format!("the effect `{}` has no `{key}`; {instead}", card.name));
        };
        let name = NumberName { effect: card.name.to_owned(), name: cards[place].name.to_owned(), specimen };
        drop(cards);
        Ok(Named { effect, place, name })
    }
}

/// Refuses restrictions of parameters that aren't fitted, for example of effects that the model doesn't have.
///
/// A comparison itself ignores them, so that an effect can be taken away and come back with its restrictions.
///
/// # Errors
/// [`InferenceError::Restriction`] for the first such restriction, and all errors of [`crate::compare`].
pub fn check_restrictions(data: &Data, muscle: &Muscle, options: &Options) -> Result<(), InferenceError> {
    if options.restrictions.is_empty() {
        return Ok(());
    }
    let analysis = Analysis::new(data, muscle, options)?;
    let model = analysis.model(options.effects.len())?.model;
    let Some(idle) = options.restrictions.iter().find(|restriction| !model.has(restriction)) else {
        return Ok(());
    };
    let effect = &idle.number.effect;
    let has = |name: &str| model.parameters().iter().any(|p| p.effect == name);
    let other = match &idle.says {
        Says::Tied(to) if !has(&to.effect) => Some(&to.effect),
        _ => None,
    };
    let instead = if let Some(missing) = other.or((!has(effect)).then_some(effect)) {
        format!("the model has no `{missing}`: name it in --with")
    } else if idle.number.specimen.is_some() {
        "no specimen of that name has a number of its own".to_owned()
    } else {
        format!("it is known from the muscle file: name `{effect}` in --with to fit it anew")
    };
    Err(InferenceError::Restriction { number: idle.number.to_string(), says: stated(&idle.says), instead })
}

fn stated(says: &Says) -> &'static str {
    match says {
        Says::Held(_) => "held",
        Says::Within(_) => "bounded",
        Says::Tied(_) => "tied",
    }
}

fn halves<'t>(text: &'t str, example: &str) -> Result<(&'t str, &'t str), String> {
    let found =
        text.split_once('=').filter(|(left, right)| !left.trim().is_empty() && !right.trim().is_empty());
    found.ok_or_else(|| format!("`{text}` states nothing of a number; write such as `{example}`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Catalogue;
    use bulge_muscles::preset;

    fn options() -> (Muscle, Options) {
        (preset("dmsp-20-250").unwrap(), Options::new(Catalogue::builtin(), Vec::new()))
    }

    #[test]
    fn statements_are_read_with_their_units() {
        let (muscle, options) = options();
        let options = options.hold("bladder-elasticity.modulus=0.31 MPa", &muscle).unwrap();
        let options = options.bound("coulomb-friction = 5 .. 20 N", &muscle).unwrap();
        let options = options.tie("force-lag.time=pressure-lag.time", &muscle).unwrap();
        let options = options.hold("force-offset.offset[short]=-2 N", &muscle).unwrap();
        let [held, bounded, tied, own] = options.restrictions.as_slice() else { panic!("four") };
        assert_eq!(held.number.to_string(), "bladder-elasticity.modulus");
        assert!(matches!(held.says, Says::Held(value) if (value - 0.31e6).abs() < 1e-6));
        assert!(
            matches!(bounded.says, Says::Within([low, high]) if low.to_bits() == 5.0_f64.to_bits() && high.to_bits() == 20.0_f64.to_bits())
        );
        assert!(matches!(&tied.says, Says::Tied(to) if to.to_string() == "pressure-lag.time"));
        assert_eq!(own.number.to_string(), "force-offset.offset[short]");
    }

    #[test]
    fn a_number_in_si_units_is_itself() {
        let (muscle, options) = options();
        let unit = |number: &str| options.si_unit_of(number, &muscle);
        assert_eq!(unit("bladder-elasticity.modulus").unwrap(), "Pa");
        assert_eq!(unit("coulomb-friction").unwrap(), "N");
        assert_eq!(unit("force-offset.offset[short]").unwrap(), "N");
        assert!(unit("coulomb-frction.force").unwrap_err().contains("did you mean `coulomb-friction`?"));
        let (value, pascal) = (123_456.7, unit("bladder-elasticity").unwrap());
        let held = options.clone().hold(&format!("bladder-elasticity={value:e} {pascal}"), &muscle).unwrap();
        assert_eq!(held.restrictions[0].says, Says::Held(value));
    }

    #[test]
    fn mistakes_are_answered_with_what_to_write() {
        let (muscle, options) = options();
        let options = options.hold("coulomb-friction.force=14 N", &muscle).unwrap();
        let hold = |text: &str| options.clone().hold(text, &muscle).map(|_| ()).unwrap_err();
        let bound = |text: &str| options.clone().bound(text, &muscle).map(|_| ()).unwrap_err();
        let tie = |text: &str| options.clone().tie(text, &muscle).map(|_| ()).unwrap_err();
        for (message, part) in [
            (hold("coulomb-frction.force=14 N"), "did you mean `coulomb-friction`?"),
            (hold("self-heating.tme=30 s"), "did you mean `self-heating.time`?"),
            (hold("self-heating=30 s"), "which number of `self-heating`? it has"),
            (hold("coulomb-friction.force"), "write such as"),
            (hold("self-heating.time=3 mm"), "is a time (s), but `3 mm` is a length"),
            (hold("self-heating.time=-3 s"), "out of the bounds of `self-heating`"),
            (hold("coulomb-friction.force=10 N"), "is held twice"),
            (bound("coulomb-friction.force=5..20 N"), "is held and bounded"),
            (bound("self-heating.time=200..50 s"), "200..50 s"),
            (bound("self-heating.time=20 s"), "write such as"),
            (tie("self-heating.time=coulomb-friction.force"), "only numbers of the same unit"),
            (tie("force-lag.time=force-lag.time"), "tied to itself"),
        ] {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        let once = options.clone().tie("force-lag.time=pressure-lag.time", &muscle).unwrap();
        assert!(
            once.tie("pressure-lag.time=force-lag.time", &muscle).unwrap_err().contains("tied to itself")
        );
    }
}
