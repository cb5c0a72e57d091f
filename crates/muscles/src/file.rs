//! Muscle files: TOML into a muscle, with the place and the cure for everything that is wrong.

use crate::construction::{Braided, Construction, Ends, FibreCount, Kind, Pleated};
use crate::error::MuscleError;
use crate::file_error::FileError;
use crate::instrument::{Instrument, Instruments};
use crate::keys;
use crate::material::{Bladder, Fibre, Unfolding};
use crate::muscle::Muscle;
use crate::quantity::{Angle, Area, Force, Length, LineStiffness, Pressure, Ratio};
use crate::table::{Document, Table};
use crate::units::{Quantity, shortened};
use std::cell::RefCell;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;
use toml::de::DeTable;

/// A muscle file has ten lines; what is larger than this is something else.
const MAX_BYTES: usize = 1 << 20;

/// Reads a muscle file.
///
/// # Errors
/// If the file cannot be read, is larger than 1 MiB, is not UTF-8 or is not a valid muscle. The message is complete.
pub fn read(path: impl AsRef<Path>) -> Result<Muscle, FileError> {
    let path = path.as_ref();
    let origin = path.display().to_string();
    let bytes = read_bytes(path).map_err(|(what, instead)| FileError::whole(&origin, what, instead))?;
    let not_utf8 = |error: std::string::FromUtf8Error| {
        let at = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes());
        // Up to `at` the bytes are valid, so the replacement character stands exactly there.
        let what = format!("byte {at} is not UTF-8 text");
        FileError::at(&origin, &text, at..at + 1, what, "save the file as plain text with the encoding UTF-8")
    };
    from_toml(&String::from_utf8(bytes).map_err(not_utf8)?, &origin)
}

/// Reads a muscle from TOML text; `origin` is what messages call the text, usually a file name.
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
    if text.len() > MAX_BYTES {
        let (what, instead) = too_large();
        return Err(FileError::whole(origin, what, instead));
    }
    let root = DeTable::parse(text).map_err(|error| syntax_error(text, origin, &error))?;
    if root.get_ref().is_empty() {
        let instead = format!("a muscle file looks like this:\n{}", keys::EXAMPLE);
        let what = "the file states nothing: a muscle needs `name`, `kind`, `length` and `radius`";
        return Err(FileError::at(origin, text, 0..0, what, instead));
    }
    Document { text, origin, root: root.get_ref(), widths: RefCell::default() }.muscle()
}

type Complaint = (String, String);

fn read_bytes(path: &Path) -> Result<Vec<u8>, Complaint> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => ("there is no such file".to_owned(), similar_file(path)),
        ErrorKind::PermissionDenied => {
            ("the file may not be read".to_owned(), "check its permissions, or copy it".to_owned())
        }
        _ => (
            format!("the file cannot be read: {error}"),
            "name a muscle file, such as `muscle.toml`".to_owned(),
        ),
    };
    let is_directory = || {
        let instead = format!("name a file in it, such as `{}`", path.join("muscle.toml").display());
        ("this is a directory, not a muscle file".to_owned(), instead)
    };
    if path.is_dir() {
        return Err(is_directory());
    }
    let limit = u64::try_from(MAX_BYTES).unwrap_or(u64::MAX).saturating_add(1);
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(limit).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MAX_BYTES { Err(too_large()) } else { Ok(bytes) }
}

fn too_large() -> Complaint {
    let what = format!("the file is larger than {} KiB, so it is no muscle file", MAX_BYTES >> 10);
    (what, "name a muscle file: about ten lines of TOML (measured data go into a CSV file)".to_owned())
}

/// The TOML file beside the missing one whose name is nearest.
fn similar_file(path: &Path) -> String {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let listed = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let mut names: Vec<String> = listed.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| Path::new(name).extension().is_some_and(|extension| extension == "toml"));
    names.sort();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    match keys::nearest(&wanted, &known) {
        Some(name) => format!("did you mean `{}`?", directory.join(name).display()),
        None => "check the path and the working directory".to_owned(),
    }
}

fn syntax_error(text: &str, origin: &str, error: &toml::de::Error) -> FileError {
    let span = error.span().unwrap_or(0..0);
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line = text[line_start..].lines().next().unwrap_or("");
    let instead = if message.contains("duplicate key") {
        "state each key once: delete one of the two, or put `#` before it".to_owned()
    } else {
        unquoted(line).unwrap_or_else(|| {
            "each line is `key = value`, a `[table]` or a `# comment`, such as `length = \"110 mm\"`"
                .to_owned()
        })
    };
    FileError::at(origin, text, span, format!("this is not TOML: {message}"), instead)
}

/// The commonest slip: `length = 110 mm` without quotes.
fn unquoted(line: &str) -> Option<String> {
    let (key, value) = line.split_once('=')?;
    let (key, value) = (key.trim(), value.split('#').next()?.trim());
    let is_bare = !value.is_empty() && !value.contains(['"', '\'', '{', '[', '=']);
    let is_word = !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
    (is_bare && is_word).then(|| format!("put text in quotes: `{key} = \"{}\"`", shortened(value)))
}

impl<'a> Document<'a> {
    fn muscle(&'a self) -> Result<Muscle, FileError> {
        let root = Table { document: self, path: String::new(), span: 0..0, entries: self.root };
        root.check_names()?;
        let kind = self.kind(&root)?;
        let (effects, instruments, fibre) =
            (root.table("effects")?, root.table("instruments")?, root.table("fibre")?);
        root.check_owner(kind)?;
        if let Some(effects) = &effects {
            effects.check_owner(kind)?;
        }
        // Wrong values come before missing ones: a file is usually right but for one slip.
        let name = root.text("name")?;
        let length = root.quantity::<Length>("length")?;
        let construction = match kind {
            Kind::Pleated => Construction::Pleated(self.pleated(&root, effects.as_ref())?),
            Kind::Braided => Construction::Braided(self.braided(&root, effects.as_ref())?),
        };
        let name = name.ok_or_else(|| root.missing("name"))?;
        let length = length.ok_or_else(|| root.missing("length"))?;
        let invalid = |error: MuscleError| self.invalid(&error);
        let mut muscle = Muscle::new(name, length, construction).map_err(invalid)?;
        if let Some(fibre) = fibre {
            muscle = muscle.with_fibre(self.fibre(&fibre)?).map_err(invalid)?;
        }
        if let Some(effects) = &effects {
            muscle = self.materials(muscle, effects)?;
            for effect in effects.learnt()? {
                muscle = muscle.with_learnt(effect);
            }
        }
        if let Some(instruments) = instruments {
            muscle = muscle.with_instruments(instruments_in(&instruments)?);
        }
        if let Some(data) = root.checked_table("data")?
            && let Some(columns) = data.checked_table("columns")?
        {
            for (quantity, _) in columns.names() {
                muscle = muscle.with_data_column(quantity, columns.text(quantity)?.unwrap_or_default());
            }
        }
        for (parameter, width) in self.widths.take() {
            muscle = muscle.with_width(parameter, width).map_err(invalid)?;
        }
        Ok(muscle)
    }

    fn kind(&self, root: &Table<'a>) -> Result<Kind, FileError> {
        let known = [(Kind::Pleated.name(), Kind::Pleated), (Kind::Braided.name(), Kind::Braided)];
        let also = [("ppam", Kind::Pleated), ("mckibben", Kind::Braided), ("braid", Kind::Braided)];
        root.word("kind", &known, &also)?.ok_or_else(|| {
            let instead = "write `kind = \"pleated\"` or `kind = \"braided\"`";
            self.error(0..0, "`kind` is missing: it says which keys the muscle needs", instead)
        })
    }

    fn pleated(&self, root: &Table<'a>, effects: Option<&Table<'a>>) -> Result<Pleated, FileError> {
        let invalid = |error: MuscleError| self.invalid(&error);
        let (radius, fibres) = (root.quantity::<Length>("radius")?, root.fibres(Kind::Pleated)?);
        let radius = radius.ok_or_else(|| root.missing("radius"))?;
        let fibres = fibres.ok_or_else(|| root.missing("fibres"))?;
        let mut pleated = Pleated::new(radius, fibres).map_err(invalid)?;
        let Some(effects) = effects else { return Ok(pleated) };
        if let Some(table) = effects.checked_table("end-radius")? {
            pleated = pleated.with_end_radius(table.required("radius")?).map_err(invalid)?;
        }
        if let Some(table) = effects.checked_table("pleat-depth")? {
            pleated = pleated.with_pleat_depth(table.required("depth")?).map_err(invalid)?;
        }
        if let Some(table) = effects.checked_table("fibre-misalignment")? {
            pleated = pleated.with_misalignment(table.required("angle")?).map_err(invalid)?;
        }
        if let Some(table) = effects.checked_table("lobes")? {
            let circumference = table.required("circumference")?;
            pleated = pleated.with_cloth_circumference(circumference).map_err(invalid)?;
        }
        Ok(pleated)
    }

    fn braided(&self, root: &Table<'a>, effects: Option<&Table<'a>>) -> Result<Braided, FileError> {
        let invalid = |error: MuscleError| self.invalid(&error);
        let (radius, angle) = (root.quantity::<Length>("radius")?, root.quantity::<Angle>("braid_angle")?);
        let radius = radius.ok_or_else(|| root.missing("radius"))?;
        let angle = angle.ok_or_else(|| root.missing("braid_angle"))?;
        let mut braided = Braided::new(radius, angle).map_err(invalid)?;
        let known = [(Ends::Clamped.name(), Ends::Clamped), (Ends::Cylinder.name(), Ends::Cylinder)];
        if let Some(ends) =
            root.word("ends", &known, &[("exact", Ends::Clamped), ("free", Ends::Cylinder)])?
        {
            braided = braided.with_ends(ends);
        }
        if let Some(FibreCount::Discrete(count)) = root.fibres(Kind::Braided)? {
            braided = braided.with_fibres(count).map_err(invalid)?;
        }
        if let Some(wall) = root.quantity("wall")? {
            braided = braided.with_wall(wall).map_err(invalid)?;
        }
        if let Some(table) = effects.map(|effects| effects.checked_table("end-radius")).transpose()?.flatten()
        {
            braided = braided.with_fitting_radius(table.required("radius")?).map_err(invalid)?;
        }
        Ok(braided)
    }

    fn fibre(&self, table: &Table<'a>) -> Result<Fibre, FileError> {
        table.check_names()?;
        let invalid = |error: MuscleError| self.invalid(&error);
        let section = table.quantity::<Area>("section")?;
        let fibre = Fibre::new(table.required::<Force>("stiffness")?).map_err(invalid)?;
        section.map_or(Ok(fibre), |section| fibre.with_section(section).map_err(invalid))
    }

    /// The effects that are materials.
    fn materials(&self, mut muscle: Muscle, effects: &Table<'a>) -> Result<Muscle, FileError> {
        let invalid = |error: MuscleError| self.invalid(&error);
        if let Some(table) = effects.checked_table("bladder-elasticity")? {
            let own = muscle.own_wall();
            let c01 = table.quantity("c01")?.unwrap_or(Pressure::pa(0.0));
            let c10 = table.required("c10")?;
            // Beside a wall of the muscle there is no second one that could have a width.
            let stated = if own.is_some() { table.plain("wall")? } else { table.quantity("wall")? };
            let wall = stated.or(own).ok_or_else(|| invalid(MuscleError::NoWall))?;
            muscle = muscle.with_bladder(Bladder::new(c10, c01, wall).map_err(invalid)?).map_err(invalid)?;
        }
        if let Some(table) = effects.checked_table("wall-thickness")? {
            muscle = muscle.with_gas_wall(table.quantity("thickness")?).map_err(invalid)?;
        }
        if let Some(table) = effects.checked_table("limited-unfolding")? {
            let hoop_stiffness = table.required::<LineStiffness>("hoop_stiffness")?;
            let limit =
                Unfolding::new(hoop_stiffness, table.required("unfolded_radius")?).map_err(invalid)?;
            muscle = muscle.with_unfolding(limit);
        }
        Ok(muscle)
    }
}

fn instruments_in(table: &Table<'_>) -> Result<Instruments, FileError> {
    fn one<Q: Quantity>(table: &Table<'_>, name: &str) -> Result<Option<Instrument>, FileError> {
        let Some(table) = table.checked_table(name)? else { return Ok(None) };
        let noise = table.spread::<Q>("noise")?;
        let zero = table.spread::<Q>("zero")?;
        let gain = table.spread::<Ratio>("gain")?;
        let invalid = |error: MuscleError| {
            let instead = format!("write {}", keys::example(&keys::join(&table.path, "noise")));
            table.document.error(table.span.clone(), error.to_string(), instead)
        };
        Ok(Some(Instrument::new(noise, zero, Ratio::one(gain)).map_err(invalid)?))
    }
    table.check_names()?;
    Ok(Instruments {
        force: one::<Force>(table, "force")?,
        pressure: one::<Pressure>(table, "pressure")?,
        length: one::<Length>(table, "length")?,
    })
}
