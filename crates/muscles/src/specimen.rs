//! Specimens that have numbers of their own. A number that isn't stated for a specimen is shared.

use crate::error::MuscleError;
use crate::file_error::FileError;
use crate::keys;
use crate::learnt::{Place, SourceFile};
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::settings::{Settings, nearest};
use crate::shown::{LONGEST_NAME, listed, shortened};
use serde::Serialize;
use std::sync::Arc;

/// The numbers in which one specimen differs from the muscle.
///
/// ```
/// use bulge_muscles::{Length, from_toml};
///
/// let text = "name = \"hose\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n
/// [specimens.short]\nlength = \"60 mm\"\n";
/// let hose = from_toml(text, "hose.toml")?;
/// assert_eq!(hose.specimens()[0].name(), "short");
/// assert_eq!(hose.of_specimen("short")?.length(), Length::mm(60.0));
/// assert_eq!(hose.of_specimen("another")?.length(), Length::mm(250.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Specimen {
    name: String,
    numbers: Vec<(Parameter, f64)>,
    #[serde(skip)]
    place: Place,
}

impl Specimen {
    /// Its name, as in the column `specimen` of the data.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its own numbers in SI.
    #[must_use]
    pub fn numbers(&self) -> &[(Parameter, f64)] {
        &self.numbers
    }
}

impl Muscle {
    /// The same muscle with numbers \[SI\] in which a specimen differs. They replace earlier ones of that
    /// specimen.
    ///
    /// # Errors
    /// If the name is blank or has quotes or control characters, or the muscle can't have one of the numbers.
    pub fn with_specimen(
        mut self,
        name: impl Into<String>,
        mut numbers: Vec<(Parameter, f64)>,
    ) -> Result<Self, MuscleError> {
        let name = name.into();
        let is_long = name.len() > LONGEST_NAME;
        if is_long
            || name.trim().is_empty()
            || name.contains(|c: char| c.is_control() || matches!(c, '"' | '\\'))
        {
            return Err(MuscleError::SpecimenName { name: shortened(&name) });
        }
        // The wall comes first, because a bladder or its gas needs it.
        numbers.sort_by_key(|(parameter, _)| (*parameter != Parameter::Wall, *parameter));
        let specimen = Specimen { name, numbers, place: Place::default() };
        self.with_numbers_of(&specimen)?;
        match self.specimens.iter_mut().find(|other| other.name == specimen.name) {
            Some(other) => *other = specimen,
            None => self.specimens.push(specimen),
        }
        Ok(self)
    }

    /// The specimens that differ from the muscle, in the order of the file.
    #[must_use]
    pub fn specimens(&self) -> &[Specimen] {
        &self.specimens
    }

    /// The same muscle without the specimens that differ from it.
    #[must_use]
    pub fn without_specimens(mut self) -> Self {
        self.specimens.clear();
        self
    }

    /// The muscle of a specimen: the muscle as stated if nothing is stated for the specimen.
    ///
    /// # Errors
    /// If the muscle, changed since the specimen was added, can't have its numbers.
    pub fn of_specimen(&self, name: &str) -> Result<Self, MuscleError> {
        match self.specimens.iter().find(|specimen| specimen.name == name) {
            Some(specimen) => self.with_numbers_of(specimen),
            None => Ok(self.clone().without_specimens()),
        }
    }

    fn with_numbers_of(&self, specimen: &Specimen) -> Result<Self, MuscleError> {
        self.clone().without_specimens().with_all(&specimen.numbers)
    }

    /// Compares the stated specimens with those of the data. Returns those of the data for which nothing is
    /// stated: they are the muscle as it is.
    ///
    /// # Errors
    /// If nothing is measured on a stated specimen, or if a specimen of the data looks like a slip in the
    /// name of a stated one. The message has the place in the muscle's file.
    pub fn check_specimens<'n>(&self, measured: &'n [String]) -> Result<Vec<&'n str>, FileError> {
        if self.specimens.is_empty() {
            return Ok(Vec::new());
        }
        let stated = |name: &str| self.specimens.iter().any(|specimen| specimen.name == name);
        let others: Vec<&str> = measured.iter().map(String::as_str).filter(|name| !stated(name)).collect();
        let absent = self.specimens.iter().find(|specimen| !measured.contains(&specimen.name));
        if let Some(specimen) = absent {
            let name = &specimen.name;
            let what = format!("no row of the data is of the specimen `{name}`");
            let instead = match nearest(name, others.iter().copied()) {
                Some(near) => format!("write `[specimens.{near}]`, or `{name}` in the column `specimen`"),
                None => format!(
                    "delete the table, or name the rows in the column `specimen`: the data have {}",
                    listed(20, "`", measured)
                ),
            };
            return Err(self.specimen_error(specimen, what, instead));
        }
        for other in &others {
            let names = self.specimens.iter().map(|specimen| specimen.name.as_str());
            let near = nearest(other, names).and_then(|near| self.specimens.iter().find(|s| s.name == near));
            let Some(near) = near.filter(|near| is_slip(&near.name, other)) else { continue };
            let what =
                format!("the data have rows of `{}` and of the specimen `{}`", shortened(other), near.name);
            let instead = format!(
                "if they are the same, write one name in the column `specimen`; if not, add `[specimens.{}]`, which may be empty",
                toml_key(other)
            );
            return Err(self.specimen_error(near, what, instead));
        }
        Ok(others)
    }

    fn specimen_error(&self, specimen: &Specimen, what: String, instead: String) -> FileError {
        let placed = specimen.place.error(what.clone(), instead.clone());
        placed.unwrap_or_else(|| FileError::whole(self.name(), what, instead))
    }

    /// The same muscle with the specimens' own numbers changed in the ratio in which those of the muscle have
    /// changed since `before`.
    #[must_use]
    pub fn with_specimens_following(mut self, before: &Self) -> Self {
        let ratio = |parameter: Parameter| {
            let (now, before) = (self.get(parameter)?, before.get(parameter).filter(|b| *b != 0.0)?);
            Some(now / before).filter(|ratio| ratio.to_bits() != 1.0_f64.to_bits())
        };
        let mut specimens = self.specimens.clone();
        for (parameter, value) in specimens.iter_mut().flat_map(|specimen| &mut specimen.numbers) {
            if let Some(ratio) = ratio(*parameter).filter(|_| *parameter != Parameter::Fibres) {
                *value *= ratio;
            }
        }
        self.specimens = specimens;
        self
    }
}

/// Names that differ by a number are names of a series, not slips.
fn is_slip(stated: &str, other: &str) -> bool {
    let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
    digits(stated) == digits(other)
}

/// A name in the form that TOML takes as a key.
pub(crate) fn toml_key(name: &str) -> String {
    if crate::learnt::is_plain(name) { name.to_owned() } else { format!("\"{name}\"") }
}

/// The tables `[specimens.NAME]` of a muscle file.
pub(crate) fn specimens_in(all: &Settings<'_>, mut muscle: Muscle) -> Result<Muscle, FileError> {
    let (origin, text) = all.source();
    let file = Arc::new(SourceFile { origin: origin.to_owned(), text: text.to_owned() });
    for (name, span) in all.names() {
        let key = toml_key(name);
        let title = format!("`[specimens.{key}]`");
        let keys = keys::of(keys::SPECIMEN);
        let instead = format!("write its numbers below `[specimens.{key}]`, such as `length = \"60 mm\"`");
        let table = all.table_named(name, title, keys, instead)?;
        let mut numbers = Vec::new();
        numbers_in(&table, "", &mut numbers)?;
        muscle = muscle.with_specimen(name, numbers).map_err(|error| {
            let (span, instead) = match &error {
                MuscleError::SpecimenName { .. } => {
                    (span.clone(), "write a name without quotes, such as `[specimens.short]`".to_owned())
                }
                _ => (table.place(error.key()), format!("write {}", keys::example(error.key()))),
            };
            all.error(span, error.to_string(), instead)
        })?;
        if let Some(specimen) = muscle.specimens.last_mut() {
            specimen.place = Place::new(Arc::clone(&file), span, Vec::new());
        }
    }
    Ok(muscle)
}

/// The numbers of a table and of the tables in it. `path` is the table's path in a muscle file.
fn numbers_in(
    table: &Settings<'_>,
    path: &str,
    numbers: &mut Vec<(Parameter, f64)>,
) -> Result<(), FileError> {
    if path == "effects" {
        let shared = |name: &str| keys::of(path).iter().all(|(key, _)| *key != name);
        if let Some((name, span)) = table.names().into_iter().find(|(name, _)| shared(name)) {
            let what = format!("the effect `{}` can't differ between specimens", shortened(name));
            let instead = format!(
                "state it for all in `[effects.{name}]`: only numbers of the muscle are a specimen's own"
            );
            return Err(table.error(span, what, instead));
        }
    }
    table.check_keys()?;
    for (name, _) in table.names() {
        let (path, Some(value)) = (keys::join(path, name), table.get(name)) else { continue };
        let keys = if path == "fibre" { keys::of(keys::SPECIMEN_FIBRE) } else { keys::of(&path) };
        if !keys.is_empty() {
            if let Some(inner) = table.table(name, format!("`{name}` of {}", table.title()), keys)? {
                numbers_in(&inner, &path, numbers)?;
            }
            continue;
        }
        let of_wall = path == "effects.bladder-elasticity.wall";
        let Some(parameter) =
            Parameter::ALL.into_iter().find(|p| p.key() == path || of_wall && *p == Parameter::Wall)
        else {
            continue;
        };
        let number = match (parameter, value.whole()) {
            (Parameter::Fibres, Some(count)) => Some(count as f64),
            (Parameter::Fibres, None) => {
                return Err(table.wrong_type(name, value, "a whole number of at least 3"));
            }
            _ if value.number().is_some_and(|text| text.contains(['±', '+'])) => {
                let what = format!("`{name}` of a specimen has no width of its own");
                let instead =
                    "write the number alone: the width that the muscle states is that of all specimens";
                return Err(table.error(value.span(), what, instead));
            }
            _ => table.parsed(name, |text| parameter.parse(text))?,
        };
        numbers.extend(number.map(|number| (parameter, number)));
    }
    Ok(())
}
