//! Sweep files: reads TOML into a plan. Every error states the place of the mistake and how to correct it.

mod axes;
mod check;
pub(crate) mod outputs;
mod scale;
#[cfg(test)]
mod tests;
pub(crate) mod wish;

pub(crate) use axes::quantity;

use bulge_effects::Catalogue;
use bulge_fibre::Approach;
use bulge_muscles::settings::{Document, FileKind, Keys, Settings};
use bulge_muscles::{Dimension, FileError, Muscle, Pressure};
use std::path::Path;

use axes::Placed;
use check::Family;

use crate::output::Output;
use crate::plan::{Design, Plan, Quantity, Range, catalogue};

/// Name of the file in messages.
const KIND: FileKind = FileKind { name: "sweep", file: "sweep.toml", line: "pressure = \"1 bar\"" };
/// Gauge pressure if none is stated \[Pa\].
const USUAL_PRESSURE: f64 = 1e5;
/// Points of a chunk: where the closed form applies, and where each point takes an integration.
const USUAL_CHUNK: u64 = 65_536;
const SHOOTING_CHUNK: u64 = 2048;
/// Most points of a chunk, because a chunk is held in memory.
const MOST_CHUNK: u64 = 1 << 24;
/// Most points of a design. At a million points per second they take nine years.
const MOST_POINTS: u64 = 1 << 48;

/// A sweep file with every key.
pub const SWEEP_EXAMPLE: &str = "\
name = \"pleated family\"         # default: the muscle's name
muscle = \"ppam-2-r16\"           # a muscle file, beside this one, or a shipped muscle
# effects = \"effects.toml\"      # effects of your own that the muscle states, beside this one
pressure = \"1 bar\"              # where no axis varies it
# contraction = \"20 %\"          # where no axis varies it
method = \"auto\"                 # or \"closed-form\", or \"shooting\"
outputs = [\"force_f\", \"volume_v\"]
design = \"grid\"                 # or \"random\", \"sobol\", \"latin-hypercube\"; none: only a table is built
# points = 10000                # of a random, sobol or latin-hypercube design, whose axes state none
# seed = 1                      # of a random or latin-hypercube design
# chunk = 65536                 # points that are computed and stored together

[axes.contraction]
range = \"0.5 %..limit\"          # to a value, or to the contraction at which the force vanishes
points = 101                    # of a grid
spacing = \"linear\"              # or \"log\", or \"chebyshev\"

[axes.slenderness]
range = \"2..100\"
points = 50
spacing = \"log\"

# [axes.fibres]                 # no table has an axis like this one
# list = [20, 40, 60]           # with units: list = [\"1 bar\", \"2 bar\"], or list = \"1,2 bar\"

[table]                         # the binary table, if one is wanted
outputs = [\"force_f\", \"volume_v\"]
tolerance = 1e-6                # largest relative error of the values
gradient = 1e-4                 # and of their gradients
max_size = \"64 KiB\"
form = \"fastest\"                # or \"smallest\", \"splines\", \"chebyshev\"
checks = 131072                 # points off the grid that certify it, 100000 or more
";

/// Keys of the file, each with an example.
const TOP: Keys = &[
    ("name", "name = \"pleated family\""),
    ("muscle", "muscle = \"ppam-2-r16\""),
    ("effects", "effects = \"effects.toml\""),
    ("pressure", "pressure = \"1 bar\""),
    ("contraction", "contraction = \"20 %\""),
    ("method", "method = \"auto\""),
    ("outputs", "outputs = [\"force_f\", \"volume_v\"]"),
    ("design", "design = \"grid\""),
    ("points", "points = 10000"),
    ("seed", "seed = 1"),
    ("chunk", "chunk = 65536"),
    ("axes", "axes.contraction = { range = \"0.5 %..20 %\", points = 101 }"),
    ("table", "[table]"),
];

/// Designs under the names used in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Grid,
    Random,
    Sobol,
    LatinHypercube,
}

impl Plan {
    /// Reads a sweep file; [`SWEEP_EXAMPLE`] shows every key. The muscle file that it names is looked up
    /// beside it.
    ///
    /// # Errors
    /// If the file can't be read, is larger than 1 MiB, is not UTF-8 or is no valid sweep, or if its muscle
    /// can't be read. The message is complete.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let (text, origin) = (KIND.read(path)?, path.display().to_string());
        Self::from_toml(&text, &origin, path.parent())
    }

    /// Reads a sweep from TOML text. Messages call the text `origin`, usually a file name. The muscle file is
    /// looked up in `folder`, or in the current folder if none is given.
    ///
    /// ```
    /// use bulge_sweep::{Plan, SWEEP_EXAMPLE};
    /// let plan = Plan::from_toml(SWEEP_EXAMPLE, "sweep.toml", None)?;
    /// assert_eq!((plan.points(), plan.axes[1].name.as_str()), (5050, "slenderness"));
    /// let error = Plan::from_toml(&SWEEP_EXAMPLE.replace("spacing", "spacin"), "sweep.toml", None).unwrap_err();
    /// assert_eq!((error.line(), error.instead()), (Some(16), "did you mean `spacing`?"));
    /// # Ok::<(), bulge_muscles::FileError>(())
    /// ```
    ///
    /// # Errors
    /// If the text is no valid sweep or its muscle can't be read. The error states the place and the
    /// correction.
    pub fn from_toml(text: &str, origin: &str, folder: Option<&Path>) -> Result<Self, FileError> {
        plan(&Document::parse(KIND, text, origin)?.settings("the sweep", TOP), folder, None)
    }

    /// Reads a sweep of the given muscle, whatever muscle file the text names. This is for processes that
    /// don't see that file.
    ///
    /// # Errors
    /// If the text is no valid sweep of the muscle. The error states the place and the correction.
    pub fn with_muscle(text: &str, origin: &str, muscle: &Muscle) -> Result<Self, FileError> {
        plan(&Document::parse(KIND, text, origin)?.settings("the sweep", TOP), None, Some(muscle))
    }
}

fn plan(settings: &Settings<'_>, folder: Option<&Path>, muscle: Option<&Muscle>) -> Result<Plan, FileError> {
    settings.check_keys()?;
    let muscle = muscle.map_or_else(|| settings.muscle("muscle", folder), |muscle| Ok(muscle.clone()))?;
    let own = own_effects(settings, folder)?;
    let catalogue = own
        .as_ref()
        .map_or_else(|| Ok(Catalogue::builtin()), |(text, origin)| catalogue(Some(text), origin))?;
    let axes = axes::axes(settings, &muscle)?;
    let pressure_pa = pressure(settings, &axes)?;
    let family = Family { muscle: &muscle, catalogue: &catalogue, pressure: pressure_pa, axes: &axes };
    family.check()?;
    let design = design(settings, &axes)?;
    let muscles = family.muscles()?;
    let contraction = contraction(settings, &family, design.is_some())?;
    let (approach, shoots) = method(settings, &family, &muscles)?;
    let has = |parameter| muscle.get(parameter).is_some() || family.varies(&Quantity::Parameter(parameter));
    let outputs = outputs::outputs(settings, &has)?.unwrap_or_else(|| vec![Output::ForceF, Output::VolumeV]);
    let table = wish::wish(settings, &axes, &outputs, &has)?;
    if design.is_none() && table.is_none() {
        let what = "no axis says how many points it has, and no table is wanted: there is nothing to do";
        let instead = "add such as `points = 101` to each axis, or a `[table]`";
        return Err(settings.error(settings.value_span("axes"), what, instead));
    }
    Ok(Plan {
        name: name(settings, &muscle)?,
        pressure_pa,
        contraction,
        approach,
        design,
        outputs,
        chunk: chunk(settings, if shoots { SHOOTING_CHUNK } else { USUAL_CHUNK })?,
        table,
        axes: axes.into_iter().map(|placed| placed.axis).collect(),
        muscle,
        own_effects: own.map(|(text, _)| text),
    })
}

/// Text of the effects file that the sweep names, and the name of that file in messages.
fn own_effects(
    settings: &Settings<'_>,
    folder: Option<&Path>,
) -> Result<Option<(String, String)>, FileError> {
    let Some(named) = settings.text("effects")? else { return Ok(None) };
    let path = folder.map_or_else(|| named.into(), |folder| folder.join(named));
    let text = bulge_effects::user::KIND.read(&path).map_err(|error| {
        let instead = format!("name a file of effects beside the sweep: {}", error.instead());
        settings.error(settings.value_span("effects"), error.what().to_owned(), instead)
    })?;
    Ok(Some((text, path.display().to_string())))
}

fn name(settings: &Settings<'_>, muscle: &Muscle) -> Result<String, FileError> {
    let name = settings.text("name")?.unwrap_or_else(|| muscle.name());
    if name.trim().is_empty() {
        let instead = "write such as `name = \"pleated family\"`, or leave it out";
        return Err(settings.error(settings.value_span("name"), "`name` is empty", instead));
    }
    Ok(name.to_owned())
}

fn pressure(settings: &Settings<'_>, axes: &[Placed<'_>]) -> Result<f64, FileError> {
    let stated = settings.quantity("pressure", Dimension::PRESSURE)?;
    if stated.is_some() {
        refuse_twice(settings, "pressure", axes, &Quantity::Pressure)?;
    }
    let pressure = stated.unwrap_or(USUAL_PRESSURE);
    if pressure > 0.0 {
        return Ok(pressure);
    }
    let what = format!("the pressure {} is not possible: it must be > 0", Pressure::pa(pressure));
    Err(settings.error(settings.value_span("pressure"), what, "write such as `pressure = \"1 bar\"`"))
}

/// Refuses a value of a quantity that an axis varies.
fn refuse_twice(
    settings: &Settings<'_>,
    name: &str,
    axes: &[Placed<'_>],
    quantity: &Quantity,
) -> Result<(), FileError> {
    if axes.iter().all(|placed| placed.axis.quantity != *quantity) {
        return Ok(());
    }
    let what = format!("`{name}` has a value, and an axis varies it");
    Err(settings.error(settings.key_span(name), what, format!("delete `{name}`, or `[axes.{name}]`")))
}

/// The contraction if no axis varies it.
fn contraction(
    settings: &Settings<'_>,
    family: &Family<'_, '_>,
    has_points: bool,
) -> Result<Option<f64>, FileError> {
    let axis = family.axes.iter().find(|placed| placed.axis.quantity == Quantity::Contraction);
    let stated = settings.quantity("contraction", Dimension::NONE)?;
    if stated.is_some() {
        refuse_twice(settings, "contraction", family.axes, &Quantity::Contraction)?;
    }
    let lowest = match (axis.map(|placed| &placed.axis.range), stated) {
        (Some(Range::List(values)), _) => values.first().copied().unwrap_or_default(),
        (Some(Range::Between { from, .. }), _) => *from,
        (None, Some(value)) => value,
        (None, None) => {
            let what = "the sweep needs a contraction: neither a value nor an axis is stated";
            let instead = "add such as `contraction = \"20 %\"`, or `[axes.contraction]` with `range = \"0.5 %..limit\"`";
            return Err(settings.error(settings.value_span("axes"), what, instead));
        }
    };
    let refused = |what: String| match axis {
        Some(placed) => placed.wrong(what),
        None => {
            settings.error(settings.value_span("contraction"), what, "write such as `contraction = \"20 %\"`")
        }
    };
    if lowest.abs() >= 1.0 {
        return Err(refused(format!(
            "the contraction {lowest} is not possible: it must be between -1 and 1"
        )));
    }
    // A table may consist of outputs that stay finite at 0.
    let may_be_zero = axis.is_some() && !has_points;
    if family.is_singular() && (lowest < 0.0 || (lowest == 0.0 && !may_be_zero)) {
        return Err(refused(format!(
            "the contraction {lowest} is not possible: the force of straight fibres that don't stretch is infinite at 0"
        )));
    }
    Ok(stated)
}

fn method(
    settings: &Settings<'_>,
    family: &Family<'_, '_>,
    muscles: &[Muscle],
) -> Result<(Approach, bool), FileError> {
    let words =
        [("auto", Approach::Auto), ("closed-form", Approach::ClosedForm), ("shooting", Approach::Shooting)];
    let approach = settings.word("method", &words)?.unwrap_or_default();
    let shoots = family.shoots(muscles);
    if let Some(what) = family.obstacle(approach, shoots) {
        return Err(settings.error(settings.value_span("method"), what, "write `method = \"auto\"`"));
    }
    Ok((approach, shoots || approach == Approach::Shooting))
}

fn chunk(settings: &Settings<'_>, usual: u64) -> Result<u64, FileError> {
    let chunk = settings.count("chunk")?.unwrap_or(usual);
    if (1..=MOST_CHUNK).contains(&chunk) {
        return Ok(chunk);
    }
    let what = format!("a chunk of {chunk} points is not possible: it has 1 to {MOST_CHUNK}");
    Err(settings.error(settings.value_span("chunk"), what, "write such as `chunk = 65536`"))
}

fn design(settings: &Settings<'_>, axes: &[Placed<'_>]) -> Result<Option<Design>, FileError> {
    let words = [
        ("grid", Kind::Grid),
        ("random", Kind::Random),
        ("sobol", Kind::Sobol),
        ("latin-hypercube", Kind::LatinHypercube),
    ];
    let stated = settings.word("design", &words)?;
    let strange: &[&str] = match stated {
        None | Some(Kind::Grid) => &["points", "seed"],
        Some(Kind::Sobol) => &["seed"],
        Some(Kind::Random | Kind::LatinHypercube) => &[],
    };
    if let Some(key) = strange.iter().find(|key| settings.get(key).is_some()) {
        let what = format!("`{key}` means nothing for this design: it has no such number");
        let instead = format!("delete `{key}`, or write `design = \"latin-hypercube\"`");
        return Err(settings.error(settings.key_span(key), what, instead));
    }
    let counts = |placed: &Placed<'_>| !matches!(placed.axis.range, Range::Between { points: None, .. });
    match stated {
        None if !axes.iter().any(counts) => Ok(None),
        None | Some(Kind::Grid) => grid(settings, axes).map(Some),
        Some(kind) => scattered(settings, axes, kind).map(Some),
    }
}

fn grid(settings: &Settings<'_>, axes: &[Placed<'_>]) -> Result<Design, FileError> {
    let mut total = 1_u64;
    for placed in axes {
        let values = match &placed.axis.range {
            Range::List(values) => values.len() as u64,
            Range::Between { points: Some(points), .. } => *points,
            Range::Between { points: None, .. } => return Err(placed.settings.missing("points")),
        };
        total = total.saturating_mul(values);
    }
    if total <= MOST_POINTS {
        return Ok(Design::Grid);
    }
    let what = format!("this grid has more than {MOST_POINTS} points, more than can ever be computed");
    let instead = "write fewer `points`, or `design = \"sobol\"`";
    Err(settings.error(settings.value_span("axes"), what, instead))
}

/// A design whose points lie anywhere within the ranges of the axes.
fn scattered(settings: &Settings<'_>, axes: &[Placed<'_>], kind: Kind) -> Result<Design, FileError> {
    for placed in axes {
        match placed.axis.range {
            Range::List(_) => {
                let what = "the points of this design lie anywhere in a range, but this axis is a list";
                let instead = "write a `range`, or `design = \"grid\"`";
                return Err(settings.error(placed.values.clone(), what, instead));
            }
            Range::Between { points: Some(_), .. } => {
                let what = "the axes of this design have no points of their own: all share one number";
                let instead = "delete it and write `points` at the top, or `design = \"grid\"`";
                return Err(settings.error(placed.settings.key_span("points"), what, instead));
            }
            Range::Between { points: None, .. } => {}
        }
    }
    let points = settings.count("points")?.ok_or_else(|| settings.missing("points"))?;
    if !(1..=MOST_POINTS).contains(&points) {
        let what = format!("a design of {points} points is not possible: it has 1 to {MOST_POINTS}");
        return Err(settings.error(settings.value_span("points"), what, "write such as `points = 10000`"));
    }
    let seed = settings.count("seed")?.unwrap_or(1);
    Ok(match kind {
        Kind::Grid => Design::Grid,
        Kind::Random => Design::Random { points, seed },
        Kind::Sobol => Design::Sobol { points },
        Kind::LatinHypercube => Design::LatinHypercube { points, seed },
    })
}
