//! Case files: parses TOML into a case. Every error has its place and its remedy.

use bulge_muscles::settings::{Document, FileKind, Keys, Settings};
use bulge_muscles::{Dimension, FileError, Muscle, Parameter};
use std::path::Path;

use super::{Case, Ends, materials, parts, source, steps, supports};
use crate::material::Thread;
use crate::state::{Copies, Tolerance};
use crate::structure::Part;

/// Name of the file in messages.
const KIND: FileKind = FileKind { name: "membrane case", file: "case.toml", line: "pressure = \"3 bar\"" };

const TOP: Keys = &[
    ("name", "name = \"a clamped tube\""),
    ("mesh", "mesh = \"tube.msh\""),
    ("mesher", "[mesher]"),
    ("scale", "[scale]"),
    ("material", "[[material]]"),
    ("part", "[[part]]"),
    ("support", "[[support]]"),
    ("step", "[[step]]"),
    ("solver", "[solver]"),
];

/// Most iterations for one equilibrium.
const MOST_ITERATIONS: u32 = 100_000;

const SOLVER: Keys = &[("residual", "residual = 1e-10"), ("iterations", "iterations = 2000")];

impl Case {
    /// Reads a case file; [`super::CASE_EXAMPLE`] has every key. The mesh and the muscle that it names are
    /// relative to its folder.
    ///
    /// # Errors
    /// If the file, its mesh or its muscle can't be read, or if it is no valid case. The message is complete.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let (text, origin) = (KIND.read(path)?, path.display().to_string());
        Self::from_toml(&text, &origin, path.parent())
    }

    /// Reads a case from TOML text. `origin` is its name in messages; `folder` contains its mesh and its
    /// muscle, if they aren't in the current one.
    ///
    /// ```
    /// use bulge_membrane::case::{CASE_EXAMPLE, Case};
    /// let case = Case::from_toml(CASE_EXAMPLE, "case.toml", None)?;
    /// let mut run = case.start()?;
    /// let last = run.last_row(|_| ())?;
    /// assert!((last.force.unwrap() + 4.509_371_9).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the text is no valid case; the error has the place and the remedy.
    pub fn from_toml(text: &str, origin: &str, folder: Option<&Path>) -> Result<Self, FileError> {
        let document = Document::parse(KIND, text, origin)?;
        let settings = document.settings("the case", TOP);
        settings.check_keys()?;
        let source = source::read(&settings, folder)?;
        let materials = materials::read(&settings)?;
        let parts = parts::read(&settings, &source, &materials.sheets)?;
        let bending = parts::bending(&settings, &source, &materials)?;
        let supports = supports::read(&settings, &source)?;
        supports::check_sectors(&settings, &source, &parts, &supports)?;
        let ends = Ends::of(&source.mesh, &supports.held, supports.fittings.len());
        let steps = steps::read(&settings, &source, &supports.fittings, ends)?;
        Ok(Self {
            name: settings.text("name")?.unwrap_or("membrane").to_owned(),
            supports: supports.held,
            contacts: supports.contacts,
            fittings: supports.fittings,
            ends,
            copies: source.copies,
            length: source.length,
            unfolded_radius: source.unfolded_radius,
            steps,
            tolerance: tolerance(&settings)?,
            muscle: source.muscle.map(|muscle| stiffened(muscle, &parts)),
            parts,
            bending,
            materials: materials.sheets,
            mesh: source.mesh,
            lattice: source.lattice,
        })
    }
}

/// The muscle with the stiffness that the case gives its fibres.
fn stiffened(muscle: Muscle, parts: &[(String, Part)]) -> Muscle {
    let stiffness = parts.iter().find_map(|(_, part)| match part {
        Part::Cable { thread: Thread::Elastic { stiffness }, .. } => Some(*stiffness),
        _ => None,
    });
    let changed = stiffness.and_then(|stiffness| muscle.with(Parameter::FibreStiffness, stiffness).ok());
    changed.unwrap_or(muscle)
}

fn tolerance(settings: &Settings<'_>) -> Result<Tolerance, FileError> {
    let mut tolerance = Tolerance::default();
    let Some(table) = settings.table("solver", "`[solver]`", SOLVER)? else { return Ok(tolerance) };
    table.check_keys()?;
    if let Some(residual) = number(&table, "residual", |x| (1e-14..=1e-3).contains(&x), "from 1e-14 to 1e-3")?
    {
        tolerance.residual = residual;
    }
    match table.count::<u32>("iterations")? {
        None => (),
        Some(iterations) if (1..=MOST_ITERATIONS).contains(&iterations) => {
            tolerance.iterations = iterations as usize;
        }
        Some(iterations) => {
            let what = format!("`iterations` is {iterations}, but must be from 1 to {MOST_ITERATIONS}");
            let instead = "write such as `iterations = 2000`";
            return Err(table.error(table.value_span("iterations"), what, instead));
        }
    }
    Ok(tolerance)
}

/// A dimensionless number that satisfies a condition.
pub(super) fn number(
    settings: &Settings<'_>,
    key: &str,
    is_good: impl Fn(f64) -> bool,
    range: &str,
) -> Result<Option<f64>, FileError> {
    in_range(settings, key, Dimension::NONE, is_good, range)
}

/// A quantity that satisfies a condition, in SI.
pub(super) fn in_range(
    settings: &Settings<'_>,
    key: &str,
    dimension: Dimension,
    is_good: impl Fn(f64) -> bool,
    range: &str,
) -> Result<Option<f64>, FileError> {
    let Some(value) = settings.quantity(key, dimension)? else { return Ok(None) };
    if is_good(value) {
        return Ok(Some(value));
    }
    let what = format!("`{key}` is not possible: it must be {range}");
    let example = settings.example(key);
    Err(settings.error(settings.value_span(key), what, format!("write such as `{example}`")))
}

/// A quantity > 0, in SI.
pub(super) fn positive(
    settings: &Settings<'_>,
    key: &str,
    dimension: Dimension,
) -> Result<Option<f64>, FileError> {
    in_range(settings, key, dimension, |x| x > 0.0, "> 0")
}

/// The same for a mandatory key.
pub(super) fn needed(settings: &Settings<'_>, key: &str, dimension: Dimension) -> Result<f64, FileError> {
    positive(settings, key, dimension)?.ok_or_else(|| settings.missing(key))
}

/// Three dimensionless numbers, not all zero.
pub(super) fn direction(settings: &Settings<'_>, key: &str) -> Result<Option<[f64; 3]>, FileError> {
    let Some(value) = settings.get(key) else { return Ok(None) };
    let items = value.items().unwrap_or_default();
    let numbers: Vec<f64> = items
        .iter()
        .filter_map(|item| item.number()?.parse::<f64>().ok())
        .filter(|x| x.is_finite())
        .collect();
    match numbers[..] {
        [x, y, z] if items.len() == 3 && x.abs() + y.abs() + z.abs() > 0.0 => Ok(Some([x, y, z])),
        _ => Err(settings.error(
            value.span(),
            format!("`{key}` must be a direction: three numbers, not all zero"),
            format!("write such as `{}`", settings.example(key)),
        )),
    }
}

/// A mandatory nonempty name.
pub(super) fn name<'a>(settings: &Settings<'a>, key: &str) -> Result<&'a str, FileError> {
    let text = settings.text(key)?.ok_or_else(|| settings.missing(key))?;
    if text.trim().is_empty() {
        let instead = format!("write such as `{}`", settings.example(key));
        return Err(settings.error(settings.value_span(key), format!("`{key}` is empty"), instead));
    }
    Ok(text)
}

/// Number of copies of a mesh from a file in the whole structure.
pub(super) fn copies(settings: &Settings<'_>) -> Result<Copies, FileError> {
    let one = |key: &str| {
        let count = number(
            settings,
            key,
            |x| (1.0..=1e5).contains(&x) && x.fract() == 0.0,
            "a whole number from 1 on",
        )?;
        Ok::<f64, FileError>(count.unwrap_or(1.0))
    };
    Ok(Copies { around: one("around")?, along: one("along")? })
}
