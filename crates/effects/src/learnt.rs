//! Conversion between effects with parameters and the `[effects.NAME]` tables of muscle files.

use bulge_muscles::{FileError, Learnt, LearntValue, Muscle, MuscleError};
use std::sync::Arc;

use crate::card::ParameterCard;
use crate::catalogue::Catalogue;
use crate::effect::Effect;

/// An effect with its parameters \[SI\], in the order of [`Effect::parameters`].
pub type Known = (Arc<dyn Effect>, Vec<f64>);

/// The effects that a muscle states in `[effects.NAME]` tables, with their parameters, in the order of the
/// file.
///
/// Shape effects that are fields of the muscle ([`bulge_muscles::Parameter::effects`]) are not included,
/// because the muscle already contains them.
///
/// ```
/// use bulge_effects::{Catalogue, known};
///
/// let text = "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n
/// [effects.coulomb-friction]\nforce = \"14 N\"\n";
/// let muscle = bulge_muscles::from_toml(text, "muscle.toml")?;
/// let (friction, numbers) = &known(&muscle, &Catalogue::builtin())?[0];
/// assert_eq!((friction.card().name, numbers.as_slice()), ("coulomb-friction", [14.0].as_slice()));
/// # Ok::<(), bulge_muscles::FileError>(())
/// ```
///
/// # Errors
/// With the place in the file: an unknown effect, an effect of the other kind of muscle, a key that the
/// effect doesn't have, a missing key, a quantity of another dimension, or a value outside the bounds of the
/// effect.
pub fn known(muscle: &Muscle, catalogue: &Catalogue) -> Result<Vec<Known>, FileError> {
    let names: Vec<&str> = catalogue.iter().map(|effect| effect.card().name).collect();
    muscle.check_learnt(&names)?;
    let one = |stated: &Learnt| {
        let effect = catalogue
            .find(stated.name())
            .map_err(|error| stated.error(error.to_string(), "take the table out"))?;
        Ok((Arc::clone(effect), numbers(stated, effect.as_ref(), muscle)?))
    };
    muscle.learnt().iter().map(one).collect()
}

/// The table of an effect with these parameters \[SI\] and their standard deviations, where known.
///
/// # Errors
/// If a parameter is missing or not finite.
pub fn learnt(effect: &dyn Effect, numbers: &[f64], widths: &[Option<f64>]) -> Result<Learnt, MuscleError> {
    let name = effect.card().name.to_owned();
    let value = |(i, card): (usize, &ParameterCard<'_>)| LearntValue {
        key: card.key.to_owned(),
        si: numbers.get(i).copied().unwrap_or(f64::NAN),
        dimension: card.dimension(),
        unit: card.unit.to_owned(),
        width: widths.get(i).copied().flatten().filter(|width| width.is_finite() && *width > 0.0),
    };
    Learnt::new(name, effect.parameters().iter().enumerate().map(value).collect())
}

fn numbers(stated: &Learnt, effect: &dyn Effect, muscle: &Muscle) -> Result<Vec<f64>, FileError> {
    let card = effect.card();
    if let Some(owner) = card.kind.filter(|owner| *owner != muscle.kind()) {
        let what = format!(
            "`{}` is an effect of {} muscles, and this one is {}",
            card.name,
            owner.name(),
            muscle.kind().name()
        );
        return Err(stated.error(what, "take the table out"));
    }
    let cards = effect.parameters();
    let keys: Vec<String> = cards.iter().map(|card| format!("`{}`", card.key)).collect();
    if let Some(strange) = stated.values().iter().find(|v| cards.iter().all(|card| card.key != v.key)) {
        let what = format!("the effect `{}` has no `{}`", card.name, strange.key);
        let has = if keys.is_empty() { "no numbers at all".to_owned() } else { keys.join(", ") };
        return Err(stated.value_error(&strange.key, what, format!("it has {has}")));
    }
    cards.iter().map(|number| value(stated, &number.of(muscle))).collect()
}

fn value(stated: &Learnt, card: &ParameterCard<'_>) -> Result<f64, FileError> {
    let example = format!("write `{} = \"{}\"`", card.key, card.shown(card.typical));
    let Some(value) = stated.value(card.key) else {
        if card.may_be_absent {
            return Ok(card.off);
        }
        let about = if card.about.is_empty() { String::new() } else { format!(", {}", card.about) };
        let what = format!("the effect `{}` needs `{}`{about}", stated.name(), card.key);
        return Err(stated.error(what, example));
    };
    if value.dimension != card.dimension() {
        let what =
            format!("`{}` is {}, not {}", card.key, card.dimension().describe(), value.dimension.describe());
        return Err(stated.value_error(card.key, what, example));
    }
    card.within(value.si).ok_or_else(|| {
        let what = format!(
            "`{}` = {} is out of the bounds of the effect `{}`",
            card.key,
            card.shown(value.si),
            stated.name()
        );
        let instead = format!("it lies between {} and {}", card.shown(card.low), card.shown(card.high));
        stated.value_error(card.key, what, instead)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::{Parameter, Quantity, from_toml, preset, to_toml, units};

    #[test]
    fn files_from_before_an_effect_had_a_number_mean_what_they_meant() {
        for (table, expected) in [
            ("[effects.line-drop]\nloss = \"2 %\"", vec![0.02, 1.0]),
            ("[effects.force-nonlinearity]\ncurvature = \"1 %/kN\"", vec![1e-5, 2.0]),
            ("[effects.self-heating]\namplitude = \"3 %\"\ntime = \"600 s\"", vec![0.03, 600.0, 0.0]),
        ] {
            let found = with("pleated", table).unwrap();
            let gap = found[0].1.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(found[0].1.len() == expected.len() && gap < 1e-12, "{table}: {:?}", found[0].1);
        }
        assert!(with("pleated", "[effects.self-heating]\namplitude = \"3 %\"").is_err());
    }

    fn with(kind: &str, table: &str) -> Result<Vec<Known>, FileError> {
        let text = if kind == "pleated" {
            "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n"
        } else {
            "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n"
        };
        known(&from_toml(&format!("{text}\n{table}\n"), "m.toml").unwrap(), &Catalogue::builtin())
    }

    #[test]
    fn every_effect_survives_a_file() {
        let catalogue = Catalogue::builtin();
        for name in ["ppam-2-r16", "dmsp-20-250"] {
            let muscle = preset(name).unwrap();
            for effect in catalogue.iter().filter(|e| e.card().kind.is_none_or(|k| k == muscle.kind())) {
                if Parameter::effects().any(|name| name == effect.card().name) {
                    continue;
                }
                let cards: Vec<_> = effect.parameters().into_iter().map(|card| card.of(&muscle)).collect();
                for card in &cards {
                    let (factor, _) = units::unit(card.unit).unwrap();
                    assert!(
                        (factor / card.factor - 1.0).abs() < 1e-12,
                        "{}: {}",
                        effect.card().name,
                        card.unit
                    );
                }
                let theta: Vec<f64> =
                    cards.iter().map(|c| (0.37 * c.high + 0.63 * c.typical).clamp(c.low, c.high)).collect();
                let widths: Vec<Option<f64>> = cards.iter().map(|c| Some(0.013 * (c.high - c.low))).collect();
                let stated = learnt(effect.as_ref(), &theta, &widths).unwrap();
                let text = to_toml(&muscle.clone().with_learnt(stated));
                let back = from_toml(&text, "m.toml").unwrap();
                let found = known(&back, &catalogue).unwrap();
                assert_eq!(found.len(), 1, "{text}");
                assert_eq!((found[0].0.card().name, &found[0].1), (effect.card().name, &theta), "{text}");
            }
            assert!(muscle.length().si() > 0.0);
        }
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        for (kind, table, parts) in [
            ("pleated", "[effects.coulomb-frction]\nforce = \"1 N\"", ["m.toml:7:10", "`coulomb-friction`"]),
            ("pleated", "[effects.coulomb-friction]\nfroce = \"1 N\"", ["m.toml:8:", "it has `force`"]),
            ("pleated", "[effects.coulomb-friction]", ["m.toml:7:10", "needs `force`"]),
            ("pleated", "[effects.coulomb-friction]\nforce = \"1 mm\"", ["m.toml:8:", "not a length"]),
            ("pleated", "[effects.coulomb-friction]\nforce = \"-1 N\"", ["m.toml:8:", "between 0 N and"]),
            ("pleated", "[effects.radius-error]\nradius = \"10 mm\"", ["m.toml:7:10", "braided muscles"]),
            (
                "braided",
                "[effects.radius-error]\nradius = \"90 mm\"",
                ["m.toml:8:", "between 5 mm and 20 mm"],
            ),
        ] {
            let message = with(kind, table).unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{message:?} does not say {part:?}");
            }
        }
        assert_eq!(with("braided", "[effects.end-taper]").unwrap().len(), 1);
    }
}
