//! The axes of a sweep file: the quantity that each varies, and its values.

use bulge_muscles::settings::{Keys, Setting, Settings, nearest};
use bulge_muscles::shown::shortened;
use bulge_muscles::{FileError, Muscle, Parameter};
use std::ops;

use super::scale::Scale;
use crate::plan::{Axis, End, Quantity, Range, Spacing};
use crate::sobol::DIMENSIONS;

/// Keys of an axis, each with an example.
pub(super) const AXIS: Keys = &[
    ("range", "range = \"2..100\""),
    ("list", "list = [20, 40, 60]"),
    ("points", "points = 101"),
    ("spacing", "spacing = \"log\""),
];
/// Most values of one axis of a grid.
const MOST_POINTS: u64 = 1_000_000_000;
/// Most axes: the number of dimensions of the low-discrepancy sequence.
const MOST_AXES: usize = DIMENSIONS;

/// An axis with its place in the file.
pub(super) struct Placed<'a> {
    pub(super) axis: Axis,
    /// The table of the axis.
    pub(super) settings: Settings<'a>,
    /// Place of its name.
    pub(super) name: ops::Range<usize>,
    /// Place of its range or list.
    pub(super) values: ops::Range<usize>,
    /// Example of valid values.
    pub(super) example: String,
}

impl Placed<'_> {
    /// An error about the range or list of the axis, with a valid example.
    pub(super) fn wrong(&self, what: impl Into<String>) -> FileError {
        self.settings.error(self.values.clone(), what, self.example.clone())
    }
}

/// The axes in the order of the file.
pub(super) fn axes<'a>(settings: &Settings<'a>, muscle: &Muscle) -> Result<Vec<Placed<'a>>, FileError> {
    let table = settings.table("axes", "`[axes]`", &[])?.ok_or_else(|| settings.missing("axes"))?;
    let names = table.names();
    if names.is_empty() {
        return Err(settings.missing("axes"));
    }
    if let Some((_, span)) = names.get(MOST_AXES) {
        let what = format!("there are {} axes, but at most {MOST_AXES} are possible", names.len());
        return Err(settings.error(span.clone(), what, "leave some out, or sweep them one after another"));
    }
    let one = |(name, span): &(&str, ops::Range<usize>)| axis(&table, name, span.clone(), muscle);
    names.iter().map(one).collect()
}

fn axis<'a>(
    axes: &Settings<'a>,
    name: &str,
    span: ops::Range<usize>,
    muscle: &Muscle,
) -> Result<Placed<'a>, FileError> {
    let Some((quantity, shown, scale)) = quantity(name, muscle) else {
        return Err(unknown(axes, name, span, muscle));
    };
    if let Quantity::Parameter(parameter) = quantity
        && let Some(owner) = parameter.kind().filter(|owner| *owner != muscle.kind())
    {
        let (kind, owner) = (muscle.kind().name(), owner.name());
        let what = format!("a {kind} muscle has no `{shown}`: that belongs to a {owner} muscle");
        return Err(axes.error(span, what, "delete the axis, or name another muscle"));
    }
    let settings = axes.table(name, format!("`[axes.{}]`", quoted(name)), AXIS)?;
    let settings = settings.ok_or_else(|| axes.missing(name))?;
    settings.check_keys()?;
    let (range, key) = match (settings.get("range"), settings.get("list")) {
        (Some(value), None) => (between(&settings, value, &scale, &quantity)?, "range"),
        (None, Some(value)) => (list(&settings, value, &scale)?, "list"),
        (Some(_), Some(value)) => {
            let what = "an axis has either a `range` or a `list`, and this one has both";
            return Err(settings.error(value.span(), what, "delete one of the two"));
        }
        (None, None) => {
            let what = format!("the axis `{shown}` has no values");
            let instead = scale.range_example().replacen("write", "add", 1);
            return Err(settings.error(span, what, instead));
        }
    };
    let example = if key == "range" { scale.range_example() } else { scale.list_example() };
    let values = settings.value_span(key);
    Ok(Placed {
        axis: Axis { quantity, name: shown, unit: scale.unit, range },
        settings,
        name: span,
        values,
        example,
    })
}

/// The quantity that a name stands for, its column name, and the scale of its values.
pub(crate) fn quantity(name: &str, muscle: &Muscle) -> Option<(Quantity, String, Scale)> {
    let is_it =
        |p: &Parameter| [p.name(), p.key()].contains(&name) || p.key().strip_prefix("effects.") == Some(name);
    let parameter = Parameter::ALL.into_iter().find(is_it);
    if let Some(parameter) = parameter {
        return Some((
            Quantity::Parameter(parameter),
            parameter.name().to_owned(),
            Scale::parameter(parameter),
        ));
    }
    let (quantity, scale) = match name {
        "contraction" => (Quantity::Contraction, Scale::contraction()),
        "pressure" => (Quantity::Pressure, Scale::pressure()),
        "slenderness" => (Quantity::Slenderness, Scale::slenderness()),
        "elastic_group" => (Quantity::ElasticGroup, Scale::elastic_group()),
        _ => {
            let name = name.strip_prefix("effects.").unwrap_or(name);
            let (effect, key) = name.split_once('.')?;
            let stated = muscle.learnt().iter().find(|learnt| learnt.name() == effect)?;
            let scale = Scale::effect(stated.value(key)?);
            let quantity = Quantity::Effect { effect: effect.to_owned(), key: key.to_owned() };
            return Some((quantity, name.to_owned(), scale));
        }
    };
    Some((quantity, name.to_owned(), scale))
}

/// Names of the axes that are possible for the muscle.
fn known(muscle: &Muscle) -> Vec<String> {
    let plain = ["contraction", "pressure", "slenderness", "elastic_group"].map(str::to_owned);
    let fits = |parameter: &Parameter| parameter.kind().is_none_or(|kind| kind == muscle.kind());
    let parameters = Parameter::ALL.into_iter().filter(fits).map(|parameter| parameter.name().to_owned());
    let effects = muscle
        .learnt()
        .iter()
        .flat_map(|effect| effect.values().iter().map(|value| format!("{}.{}", effect.name(), value.key)));
    plain.into_iter().chain(parameters).chain(effects).collect()
}

fn unknown(axes: &Settings<'_>, name: &str, span: ops::Range<usize>, muscle: &Muscle) -> FileError {
    let what = format!("unknown axis `{}`", shortened(name));
    // Without quotes, [axes.fibre.stiffness] is a table within a table.
    let dotted = axes.get(name).and_then(|value| dotted(name, value, muscle));
    if let Some(dotted) = dotted {
        return axes.error(span, what, format!("write the name in quotes: `[axes.\"{dotted}\"]`"));
    }
    let known = known(muscle);
    let instead = match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known for this muscle: {}", known.join(", ")),
    };
    axes.error(span, what, instead)
}

/// The full name of an axis that TOML split at its dots.
fn dotted(name: &str, value: Setting<'_>, muscle: &Muscle) -> Option<String> {
    value.entries()?.into_iter().find_map(|(key, inner)| {
        let name = format!("{name}.{key}");
        if quantity(&name, muscle).is_some() { Some(name) } else { dotted(&name, inner, muscle) }
    })
}

/// The name as a TOML key.
fn quoted(name: &str) -> String {
    if name.contains('.') { format!("\"{name}\"") } else { name.to_owned() }
}

fn between(
    settings: &Settings<'_>,
    value: Setting<'_>,
    scale: &Scale,
    quantity: &Quantity,
) -> Result<Range, FileError> {
    let refused = |what: String| settings.error(value.span(), what, scale.range_example());
    let text = value.text().ok_or_else(|| settings.wrong_type("range", value, "a range in quotes"))?;
    let (from, to) = scale.range(text).map_err(refused)?;
    let words = [("linear", Spacing::Linear), ("log", Spacing::Log), ("chebyshev", Spacing::Chebyshev)];
    let spacing = settings.word("spacing", &words)?.unwrap_or(Spacing::Linear);
    if to.is_none() && *quantity != Quantity::Contraction {
        return Err(refused(
            "`limit` is the contraction at which the force vanishes: it ends no other axis".to_owned(),
        ));
    }
    if to.is_some_and(|to| from >= to || !(to - from).is_finite()) {
        return Err(refused(format!("a range must rise and have a finite length, and `{text}` doesn't")));
    }
    // Even with both ends > 0 their ratio may overflow.
    if spacing == Spacing::Log && !(from > 0.0 && to.is_none_or(|to| (to / from).is_finite())) {
        let what = format!("logarithmic spacing from {from} is not possible: both ends must be > 0");
        let instead = "write a lower end > 0, or `spacing = \"linear\"`";
        return Err(settings.error(settings.value_span("spacing"), what, instead));
    }
    let points: Option<u64> = settings.count("points")?;
    if let Some(points) = points.filter(|points| !(2..=MOST_POINTS).contains(points)) {
        let what = format!("an axis of {points} points is not possible: it needs 2 to {MOST_POINTS}");
        let instead = "write such as `points = 101`; a single value is a list: `list = [2]`";
        return Err(settings.error(settings.value_span("points"), what, instead));
    }
    Ok(Range::Between { from, to: to.map_or(End::Limit, End::Value), points, spacing })
}

fn list(settings: &Settings<'_>, value: Setting<'_>, scale: &Scale) -> Result<Range, FileError> {
    let refused = |value: Setting<'_>, what: String| settings.error(value.span(), what, scale.list_example());
    if let Some(key) = ["points", "spacing"].into_iter().find(|key| settings.get(key).is_some()) {
        let what = format!("`{key}` belongs to a `range`, and this axis has a `list`");
        return Err(settings.error(settings.key_span(key), what, format!("delete `{key}`")));
    }
    let values = if let Some(text) = value.text() {
        scale.list(text).map_err(|what| refused(value, what))?
    } else {
        let items = value.items().ok_or_else(|| settings.wrong_type("list", value, "a list of values"))?;
        let one = |item: Setting<'_>| {
            let text = item.number().ok_or_else(|| settings.wrong_type("list", item, "a list of values"))?;
            scale.one(text, None).map_err(|what| refused(item, what))
        };
        items.into_iter().map(one).collect::<Result<Vec<f64>, _>>()?
    };
    if values.is_empty() {
        return Err(refused(value, "an axis needs at least one value".to_owned()));
    }
    if let Some((last, next)) = values.iter().zip(&values[1..]).find(|(last, next)| next <= last) {
        let what = format!("a list must rise, but {next} comes after {last}");
        return Err(settings.error(value.span(), what, "sort the values, and write each once"));
    }
    Ok(Range::List(values))
}
