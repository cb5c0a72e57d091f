//! Effects in a muscle file that this crate doesn't know. They are found by a fit, and the code that computes
//! with them knows them by name.

use crate::dimension::Dimension;
use crate::error::MuscleError;
use crate::file_error::FileError;
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::settings::nearest;
use crate::shown::shortened;
use crate::units::{any_with_width, exact_any_text, unit};
use serde::Serialize;
use std::ops::Range;
use std::sync::Arc;

/// An effect by its name, with its values.
///
/// This crate doesn't know which names exist and which values they need. Code that does can answer with the
/// place in the file ([`Learnt::error`], [`Learnt::value_error`], [`crate::Muscle::check_learnt`]). The place
/// is no part of the effect: equal effects are equal wherever they stand.
///
/// ```
/// use bulge_muscles::{Dimension, from_toml};
///
/// let text = "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n
/// [effects.coulomb-friction]\nforce = \"14 N +- 2 N\"\n";
/// let muscle = from_toml(text, "muscle.toml")?;
/// let friction = &muscle.learnt()[0];
/// assert_eq!((friction.name(), friction.values()[0].si), ("coulomb-friction", 14.0));
/// assert_eq!(friction.values()[0].dimension, Dimension::FORCE);
/// assert_eq!(friction.values()[0].width, Some(2.0));
/// let error = friction.value_error("force", "friction is never 14 N", "write less");
/// assert!(error.to_string().starts_with("muscle.toml:8:9: friction is never 14 N"));
/// # Ok::<(), bulge_muscles::FileError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Learnt {
    name: String,
    values: Vec<LearntValue>,
    #[serde(skip)]
    place: Place,
}

/// One value of a [`Learnt`] effect, of any dimension.
///
/// Two values are equal if they are the same quantity, whatever unit they are shown in.
#[derive(Debug, Clone, Serialize)]
pub struct LearntValue {
    /// Its key in the effect's table.
    pub key: String,
    /// The value in SI.
    pub si: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit in which it is written; empty for a pure number.
    pub unit: String,
    /// The stated width, one standard deviation in SI.
    pub width: Option<f64>,
}

impl PartialEq for LearntValue {
    fn eq(&self, other: &Self) -> bool {
        let same = |value: &Self| (value.si.to_bits(), value.width.map(f64::to_bits), value.dimension);
        self.key == other.key && same(self) == same(other)
    }
}

/// The place of an effect in a file, if it comes from one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Place {
    file: Option<Arc<SourceFile>>,
    name: Range<usize>,
    values: Vec<Range<usize>>,
}

/// A file as it was read, for messages about it.
#[derive(Debug)]
pub(crate) struct SourceFile {
    pub(crate) origin: String,
    pub(crate) text: String,
}

/// The place of an effect is no part of its value.
impl PartialEq for Place {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Place {
    pub(crate) fn new(file: Arc<SourceFile>, name: Range<usize>, values: Vec<Range<usize>>) -> Self {
        Self { file: Some(file), name, values }
    }

    /// An error at the name; `None` without a file.
    pub(crate) fn error(&self, what: String, instead: String) -> Option<FileError> {
        let file = self.file.as_ref()?;
        Some(FileError::at(&file.origin, &file.text, self.name.clone(), what, instead))
    }
}

/// Whether TOML takes the name as a key without quotes.
pub(crate) fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
}

/// The option with which the user's own effects are given.
const OWN_FILE: &str = "`--effects FILE`";

impl Learnt {
    /// An effect with its values, in their order.
    ///
    /// # Errors
    /// If the name or a key is no plain word, the name is one of [`Parameter::effects`], a key comes twice, a
    /// value is not finite, a width is not finite and > 0, or a unit is not of its dimension.
    pub fn new(name: impl Into<String>, values: Vec<LearntValue>) -> Result<Self, MuscleError> {
        let name = name.into();
        let wrong = |what: String| Err(MuscleError::Learnt { name: shortened(&name), what });
        if !is_plain(&name) {
            return wrong("is no plain word of letters, digits, `-` and `_`".to_owned());
        }
        if Parameter::effects().any(|other| other == name) {
            return wrong("has fields of its own in a muscle, such as `Muscle::with` changes".to_owned());
        }
        for (i, value) in values.iter().enumerate() {
            let key = shortened(&value.key);
            if !is_plain(&value.key) {
                return wrong(format!("has the key `{key}`, which is no plain word"));
            }
            if values[..i].iter().any(|other| other.key == value.key) {
                return wrong(format!("has the key `{key}` twice"));
            }
            if !value.si.is_finite() {
                return wrong(format!("has `{key}` = {}, which is not finite", value.si));
            }
            if let Some(width) = value.width.filter(|width| !(width.is_finite() && width.is_sign_positive()))
            {
                return wrong(format!(
                    "has `{key}` with the width {width}: it must be finite and not negative"
                ));
            }
            if !unit(&value.unit).is_ok_and(|(_, dimension)| dimension == value.dimension) {
                let (unit, kind) = (shortened(&value.unit), value.dimension.describe());
                return wrong(format!("has `{key}` in `{unit}`, which is no unit of {kind}"));
            }
        }
        Ok(Self { name, values, place: Place::default() })
    }

    pub(crate) fn at(self, place: Place) -> Self {
        Self { place, ..self }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its values, in the order of the file.
    #[must_use]
    pub fn values(&self) -> &[LearntValue] {
        &self.values
    }

    /// The value of a key.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<&LearntValue> {
        self.values.iter().find(|value| value.key == key)
    }

    /// The line of its name in the file it comes from, counted from 1.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.place.file.as_ref().and_then(|_| self.error("", "").line())
    }

    /// The column of its name in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> Option<usize> {
        self.place.file.as_ref().and_then(|_| self.error("", "").column())
    }

    /// An error in this effect: what is wrong, and what to write instead. It has the place in the file if the
    /// effect comes from one.
    #[must_use]
    pub fn error(&self, what: impl Into<String>, instead: impl Into<String>) -> FileError {
        self.error_at(self.place.name.clone(), what.into(), instead.into())
    }

    /// An error in one of its values. A key that it doesn't have gives the place of the effect.
    #[must_use]
    pub fn value_error(&self, key: &str, what: impl Into<String>, instead: impl Into<String>) -> FileError {
        let index = self.values.iter().position(|value| value.key == key);
        let span = index.and_then(|index| self.place.values.get(index)).unwrap_or(&self.place.name);
        self.error_at(span.clone(), what.into(), instead.into())
    }

    fn error_at(&self, span: Range<usize>, what: String, instead: String) -> FileError {
        match &self.place.file {
            Some(file) => FileError::at(&file.origin, &file.text, span, what, instead),
            None => FileError::whole(&format!("[effects.{}]", self.name), what, instead),
        }
    }

    /// Refuses a name that is neither among `known` nor a shape effect. The error names the nearest one of
    /// all.
    pub(crate) fn check(&self, known: &[&str]) -> Result<(), FileError> {
        if known.contains(&self.name.as_str()) {
            return Ok(());
        }
        let mut all: Vec<&str> = Parameter::effects().collect();
        all.extend(known);
        let instead = match nearest(&self.name, all.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? An effect of your own needs its file: {OWN_FILE}"),
            None => format!(
                "`bulge effects` lists those that are; an effect of your own needs its file: {OWN_FILE}"
            ),
        };
        let name = shortened(&self.name);
        Err(self.error(format!("unknown effect `{name}`: it is not in the catalogue"), instead))
    }
}

impl LearntValue {
    /// The value as it is written in a file, so that reading gives exactly the same numbers: in its unit if
    /// possible, else in SI.
    pub(crate) fn text(&self) -> String {
        let si_unit = if self.dimension.is_none() { String::new() } else { self.dimension.to_string() };
        let text = |unit: &str| {
            let width = self.width.map(|width| format!(" +- {}", exact_any_text(width, unit)));
            format!("{}{}", exact_any_text(self.si, unit), width.unwrap_or_default())
        };
        let same = |text: &String| {
            any_with_width(text).is_ok_and(|(value, width)| {
                value.si.to_bits() == self.si.to_bits()
                    && width.map(f64::to_bits) == self.width.map(f64::to_bits)
                    && value.dimension == self.dimension
            })
        };
        let in_unit = Some(text(&self.unit)).filter(same).unwrap_or_else(|| text(&si_unit));
        // A pure number needs no quotes.
        let bare = self.width.is_none() && in_unit.parse::<f64>().is_ok();
        if bare { in_unit } else { format!("\"{in_unit}\"") }
    }
}

impl Muscle {
    /// The same muscle with one more learnt effect, or with other values of an effect that it has.
    #[must_use]
    pub fn with_learnt(mut self, effect: Learnt) -> Self {
        match self.learnt.iter_mut().find(|other| other.name() == effect.name()) {
            Some(other) => *other = effect,
            None => self.learnt.push(effect),
        }
        self
    }

    /// The same muscle without learnt effects: the part that this crate itself knows.
    #[must_use]
    pub fn without_learnt(mut self) -> Self {
        self.learnt.clear();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(key: &str, si: f64, unit: &str, dimension: Dimension) -> LearntValue {
        LearntValue { key: key.to_owned(), si, dimension, unit: unit.to_owned(), width: None }
    }

    #[test]
    fn the_shape_effects_are_those_of_the_keys() {
        let mut names: Vec<&str> = Parameter::effects().collect();
        let mut known: Vec<&str> = crate::keys::of("effects").iter().map(|(key, _)| *key).collect();
        names.sort_unstable();
        known.sort_unstable();
        assert_eq!(names, known);
    }

    #[test]
    fn nonsense_is_refused_with_its_reason() {
        let good = value("force", 14.0, "N", Dimension::FORCE);
        assert!(Learnt::new("coulomb-friction", vec![good.clone()]).is_ok());
        for (name, values, part) in [
            ("", vec![], "no plain word"),
            ("two words", vec![], "`two words` is no plain word"),
            ("lobes", vec![], "fields of its own"),
            ("x", vec![value("a b", 1.0, "", Dimension::NONE)], "`a b`"),
            ("x", vec![good.clone(), good.clone()], "`force` twice"),
            ("x", vec![value("a", f64::NAN, "", Dimension::NONE)], "NaN"),
            ("x", vec![LearntValue { width: Some(-0.5), ..good.clone() }], "width -0.5"),
            ("x", vec![value("a", 1.0, "mm", Dimension::FORCE)], "no unit of a force"),
            ("x", vec![value("a", 1.0, "furlong", Dimension::LENGTH)], "`furlong`"),
        ] {
            let message = Learnt::new(name, values).unwrap_err().to_string();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[test]
    fn values_are_written_in_their_unit() {
        let with = |value: LearntValue, width| LearntValue { width: Some(width), ..value };
        for (value, text) in [
            (
                value("a", 4000.0, "N s/mm", Dimension::LINE_STIFFNESS.times(Dimension::TIME).unwrap()),
                "\"4 N s/mm\"",
            ),
            (value("a", 0.5, "", Dimension::NONE), "0.5"),
            (value("a", 40.0, "", Dimension::NONE), "40"),
            (value("a", 0.25, "%", Dimension::NONE), "\"25 %\""),
            (with(value("a", 0.25, "%", Dimension::NONE), 0.01), "\"25 % +- 1 %\""),
            (with(value("a", 14.0, "N", Dimension::FORCE), 2.0), "\"14 N +- 2 N\""),
            (with(value("a", 0.2, "", Dimension::NONE), 0.1), "\"0.2 +- 0.1\""),
        ] {
            assert_eq!(value.text(), text);
        }
    }

    #[test]
    fn an_effect_without_a_file_has_no_place() {
        let effect = Learnt::new("creep", vec![]).unwrap();
        assert_eq!((effect.line(), effect.column()), (None, None));
        assert_eq!(effect.value_error("x", "w", "i").to_string(), "[effects.creep]: w\n  = i");
        assert!(effect.check(&["creep"]).is_ok() && effect.check(&[]).is_err());
    }
}
