//! Muscle files: TOML into a muscle, with the place and the cure for everything that is wrong.

use crate::construction::{Braided, Construction, Ends, FibreCount, Kind, Pleated};
use crate::error::MuscleError;
use crate::file_error::FileError;
use crate::fitted::fitted_in;
use crate::instrument::{Instrument, Instruments};
use crate::keys;
use crate::material::Fibre;
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::quantity::{Angle, Area, Force, Length, Pressure, Ratio};
use crate::settings::{Document, FileKind, Settings, nearest};
use crate::shown::shortened;
use crate::specimen::specimens_in;
use crate::units::{self, Quantity};
use std::path::Path;

const KIND: FileKind = FileKind { name: "muscle", file: "muscle.toml", line: "length = \"110 mm\"" };

/// Reads a muscle file.
///
/// # Errors
/// If the file cannot be read, is larger than 1 MiB, is not UTF-8 or is not a valid muscle. The message is
/// complete.
pub fn read(path: impl AsRef<Path>) -> Result<Muscle, FileError> {
    let path = path.as_ref();
    from_toml(&KIND.read(path)?, &path.display().to_string())
}

/// Reads a muscle from TOML text. `origin` is the name of the text in messages, usually a file name.
///
/// ```
/// let error = bulge_muscles::from_toml("kind = \"pleated\"\nlength = 110\n", "muscle.toml").unwrap_err();
/// assert_eq!((error.line(), error.column()), (Some(2), Some(10)));
/// assert!(error.to_string().starts_with("muscle.toml:2:10: `110` has no unit"));
/// ```
///
/// # Errors
/// If the text is not a valid muscle.
pub fn from_toml(text: &str, origin: &str) -> Result<Muscle, FileError> {
    let document = Document::parse(KIND, text, origin)?;
    let root = document.settings("the muscle", keys::of(""));
    if root.names().is_empty() {
        let instead = format!("a muscle file looks like this:\n{}", keys::EXAMPLE);
        let what = "the file states nothing: a muscle needs `name`, `kind`, `length` and `radius`";
        return Err(root.error(0..0, what, instead));
    }
    Reader { root, widths: Vec::new() }.muscle()
}

/// A muscle file, with the widths found so far.
struct Reader<'a> {
    root: Settings<'a>,
    widths: Vec<(Parameter, f64)>,
}

/// A table within another, named by its path. Its keys are checked.
fn table<'a>(parent: &Settings<'a>, within: &str, name: &str) -> Result<Option<Settings<'a>>, FileError> {
    let path = keys::join(within, name);
    let table = parent.table(name, format!("`[{path}]`"), keys::of(&path))?;
    // Other effects are learnt ones.
    table.as_ref().filter(|_| path != "effects").map_or(Ok(()), Settings::check_keys)?;
    Ok(table)
}

fn needed<T>(table: &Settings<'_>, name: &str, found: Option<T>) -> Result<T, FileError> {
    found.ok_or_else(|| table.missing(name))
}

/// Refuses keys of the other family.
fn check_owner(table: &Settings<'_>, path: &str, kind: Kind) -> Result<(), FileError> {
    for (name, span) in table.names() {
        if let Some(owner) = keys::owner(&keys::join(path, name)).filter(|owner| *owner != kind) {
            let (owner, kind) = (owner.name(), kind.name());
            let what = format!("`{name}` belongs to a {owner} muscle, but this one is {kind}");
            let instead = format!("delete `{name}`, or write `kind = \"{owner}\"`");
            return Err(table.error(span, what, instead));
        }
    }
    Ok(())
}

impl<'a> Reader<'a> {
    fn muscle(mut self) -> Result<Muscle, FileError> {
        self.root.check_keys_or(keys::elsewhere)?;
        let kind = self.kind()?;
        self.root = self.root.called(format!("a muscle with `kind = \"{}\"`", kind.name()), "kind");
        let [effects, instruments, fibre] = ["effects", "instruments", "fibre"].map(|name| self.table(name));
        let (effects, instruments, fibre) = (effects?, instruments?, fibre?);
        check_owner(&self.root, "", kind)?;
        if let Some(effects) = &effects {
            check_owner(effects, "effects", kind)?;
        }
        // Wrong values come before missing ones: a file is usually right except for one slip.
        let name = self.root.text("name")?;
        let length = self.of_muscle(Parameter::Length)?;
        let construction = match kind {
            Kind::Pleated => Construction::Pleated(self.pleated()?),
            Kind::Braided => Construction::Braided(self.braided()?),
        };
        let shape = effects.as_ref().map(|effects| self.shape(effects)).transpose()?.unwrap_or_default();
        let name = needed(&self.root, "name", name)?;
        let length = Length::m(needed(&self.root, "length", length)?);
        let mut muscle = Muscle::new(name, length, construction).map_err(|error| self.invalid(&error))?;
        if let Some(fibre) = fibre {
            let fibre = self.fibre(&fibre)?;
            muscle = muscle.with_fibre(fibre).map_err(|error| self.invalid(&error))?;
        }
        muscle = shape.of(muscle).map_err(|error| self.invalid(&error))?;
        if let Some(effects) = &effects {
            for effect in effects.learnt()? {
                muscle = muscle.with_learnt(effect);
            }
        }
        if let Some(instruments) = instruments {
            muscle = muscle.with_instruments(instruments_in(&instruments)?);
        }
        if let Some(data) = self.table("data")?
            && let Some(columns) = table(&data, "data", "columns")?
        {
            for (quantity, _) in columns.names() {
                muscle = muscle.with_data_column(quantity, columns.text(quantity)?.unwrap_or_default());
            }
        }
        if let Some(fitted) = fitted_in(&self.root)? {
            muscle = muscle.with_fitted(fitted);
        }
        if let Some(specimens) = self.root.table("specimens", "`[specimens]`", &[])? {
            muscle = specimens_in(&specimens, muscle)?;
        }
        for (parameter, width) in &self.widths {
            muscle = muscle.with_width(*parameter, *width).map_err(|error| self.invalid(&error))?;
        }
        Ok(muscle)
    }

    /// A value out of range, at its place.
    fn invalid(&self, error: &MuscleError) -> FileError {
        let instead = match error {
            MuscleError::NoFibreCount => {
                "add a line such as `fibres = 60`: the fibres of the braid, both families together".to_owned()
            }
            MuscleError::NoWall | MuscleError::NoGasWall => "add a line such as `wall = \"2 mm\"`".to_owned(),
            MuscleError::LobesOfContinuous => "write a number of fibres, such as `fibres = 40`".to_owned(),
            _ => match error.range() {
                Some(range) => format!("write {range}, such as {}", keys::example(error.key())),
                None => format!("write {}", keys::example(error.key())),
            },
        };
        self.root.error(self.root.place(error.key()), error.to_string(), instead)
    }

    fn table(&self, name: &str) -> Result<Option<Settings<'a>>, FileError> {
        table(&self.root, "", name)
    }

    /// A number, in SI. Its width is recorded as that of the parameter.
    fn wide(
        &mut self,
        table: &Settings<'_>,
        name: &str,
        parameter: Parameter,
    ) -> Result<Option<f64>, FileError> {
        let found = table.parsed(name, |text| parameter.parse_with_width(text))?;
        let Some((value, width)) = found else { return Ok(None) };
        self.widths.extend(width.map(|width| (parameter, width)));
        Ok(Some(value))
    }

    /// A parameter at the top of the file.
    fn of_muscle(&mut self, parameter: Parameter) -> Result<Option<f64>, FileError> {
        let root = self.root.clone();
        self.wide(&root, parameter.name(), parameter)
    }

    fn kind(&self) -> Result<Kind, FileError> {
        let [pleated, braided] = [Kind::Pleated, Kind::Braided].map(|kind| (kind.name(), kind));
        let also = [("ppam", pleated.0), ("mckibben", braided.0), ("braid", braided.0)];
        self.root.word_or("kind", &[pleated, braided], &also)?.ok_or_else(|| {
            let instead = "write `kind = \"pleated\"` or `kind = \"braided\"`";
            self.root.error(0..0, "`kind` is missing: it says which keys the muscle needs", instead)
        })
    }

    fn pleated(&mut self) -> Result<Pleated, FileError> {
        let (radius, fibres) = (self.of_muscle(Parameter::Radius)?, self.fibres(Kind::Pleated)?);
        let radius = Length::m(needed(&self.root, "radius", radius)?);
        let fibres = needed(&self.root, "fibres", fibres)?;
        Pleated::new(radius, fibres).map_err(|error| self.invalid(&error))
    }

    fn braided(&mut self) -> Result<Braided, FileError> {
        let radius = self.of_muscle(Parameter::Radius)?;
        let angle = self.of_muscle(Parameter::BraidAngle)?;
        let radius = Length::m(needed(&self.root, "radius", radius)?);
        let angle = Angle::rad(needed(&self.root, "braid_angle", angle)?);
        let mut braided = Braided::new(radius, angle).map_err(|error| self.invalid(&error))?;
        let known = [Ends::Clamped, Ends::Cylinder].map(|ends| (ends.name(), ends));
        let also = [("exact", known[0].0), ("free", known[1].0)];
        if let Some(ends) = self.root.word_or("ends", &known, &also)? {
            braided = braided.with_ends(ends);
        }
        if let Some(FibreCount::Discrete(count)) = self.fibres(Kind::Braided)? {
            braided = braided.with_fibres(count).map_err(|error| self.invalid(&error))?;
        }
        if let Some(wall) = self.of_muscle(Parameter::Wall)? {
            braided = braided.with_wall(Length::m(wall)).map_err(|error| self.invalid(&error))?;
        }
        Ok(braided)
    }

    fn fibres(&self, kind: Kind) -> Result<Option<FibreCount>, FileError> {
        let Some(value) = self.root.get("fibres") else { return Ok(None) };
        let count = |number: u64| u32::try_from(number).ok().filter(|count| *count >= 3);
        if let Some(count) = value.whole().and_then(count) {
            return Ok(Some(FibreCount::Discrete(count)));
        }
        let is_pleated = kind == Kind::Pleated;
        if is_pleated && value.text() == Some("continuous") {
            return Ok(Some(FibreCount::Continuous));
        }
        let or = if is_pleated { ", or \"continuous\"" } else { "" };
        let wanted = format!("a whole number of at least 3{or}");
        let Some(found) = value.number() else { return Err(self.root.wrong_type("fibres", value, &wanted)) };
        let (quotes, instead) = match (value.text(), found.trim().parse::<f64>()) {
            (Some(_), Ok(number)) if number.fract() == 0.0 && number >= 3.0 => {
                ("\"", format!("write the number without quotes: `fibres = {number}`"))
            }
            (Some(text), _) if is_pleated && nearest(text, ["continuous"].into_iter()).is_some() => {
                ("\"", "write `fibres = \"continuous\"`".to_owned())
            }
            (None, Ok(number)) if (3.0..=1e6).contains(&number) => {
                ("", format!("write a whole number, such as `fibres = {}`", number.trunc()))
            }
            (text, _) => {
                let quotes = if text.is_some() { "\"" } else { "" };
                (quotes, "write the number of fibres, such as `fibres = 40`".to_owned())
            }
        };
        let what = format!("`fibres` is {quotes}{}{quotes}, but must be {wanted}", shortened(found));
        Err(self.root.error(value.span(), what, instead))
    }

    fn fibre(&mut self, table: &Settings<'_>) -> Result<Fibre, FileError> {
        let section = table.parsed("section", units::parse::<Area>)?;
        let stiffness = self.wide(table, "stiffness", Parameter::FibreStiffness)?;
        let stiffness = Force::n(needed(table, "stiffness", stiffness)?);
        let fibre = Fibre::new(stiffness).map_err(|error| self.invalid(&error))?;
        section.map_or(Ok(fibre), |section| fibre.with_section(section).map_err(|error| self.invalid(&error)))
    }

    /// The effects whose numbers are those of the muscle.
    fn shape(&mut self, effects: &Settings<'a>) -> Result<Shape, FileError> {
        let mut shape = Shape::default();
        for effect in Parameter::effects() {
            let Some(table) = table(effects, "effects", effect)? else { continue };
            let mut absent = None;
            for (parameter, key) in Parameter::in_effect(effect) {
                match self.wide(&table, key, parameter)? {
                    Some(value) => shape.numbers.push((parameter, value)),
                    None if parameter == Parameter::GasWall => shape.has_inner_gas = true,
                    None if parameter == Parameter::C01 => {}
                    None => absent = absent.or(Some(key)),
                }
            }
            if let Some(key) = absent {
                return Err(table.missing(key));
            }
            if effect == "bladder-elasticity" {
                // If the muscle has a wall of its own, there is no second one that could have a width.
                let wall = match self.root.get("wall") {
                    Some(_) => table.parsed("wall", |text| Parameter::Wall.parse(text))?,
                    None => self.wide(&table, "wall", Parameter::Wall)?,
                };
                shape.bladder_wall = wall.map(Length::m);
            }
        }
        Ok(shape)
    }
}

/// Effects whose numbers are those of the muscle.
#[derive(Default)]
struct Shape {
    numbers: Vec<(Parameter, f64)>,
    bladder_wall: Option<Length>,
    has_inner_gas: bool,
}

impl Shape {
    fn of(self, mut muscle: Muscle) -> Result<Muscle, MuscleError> {
        if let Some(wall) = self.bladder_wall {
            muscle = muscle.with_bladder_wall(wall)?;
        }
        muscle = muscle.with_all(&self.numbers)?;
        if self.has_inner_gas { muscle.with_gas_wall(None) } else { Ok(muscle) }
    }
}

fn instruments_in(all: &Settings<'_>) -> Result<Instruments, FileError> {
    /// A standard deviation in SI, which must be > 0; 0 if it is absent.
    fn spread<Q: Quantity>(table: &Settings<'_>, name: &str) -> Result<f64, FileError> {
        let value = table.size::<Q>(name)?;
        if value > 0.0 || table.get(name).is_none() {
            return Ok(value);
        }
        let what = format!("`{name}` is {value} in SI units: a standard deviation must be greater than 0");
        let instead = format!("write such as `{}`, or leave it out", table.example(name));
        Err(table.error(table.value_span(name), what, instead))
    }
    fn one<Q: Quantity>(all: &Settings<'_>, name: &str) -> Result<Option<Instrument>, FileError> {
        let Some(table) = table(all, "instruments", name)? else { return Ok(None) };
        let (noise, zero) = (spread::<Q>(&table, "noise")?, spread::<Q>(&table, "zero")?);
        let gain = spread::<Ratio>(&table, "gain")?;
        let instead = format!("write such as `{}`", table.example("noise"));
        Instrument::new(noise, zero, Ratio::one(gain))
            .map(Some)
            .map_err(|error| all.error(all.value_span(name), error.to_string(), instead))
    }
    Ok(Instruments {
        force: one::<Force>(all, "force")?,
        pressure: one::<Pressure>(all, "pressure")?,
        length: one::<Length>(all, "length")?,
    })
}
