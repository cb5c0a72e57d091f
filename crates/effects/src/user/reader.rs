//! Reads effects from the tables of a file, and checks that they are complete and consistent.

use super::quantity::Quantity;
use super::{EXAMPLE, MAX_PARAMETERS, ShapeFormula, ShapeQuantity, UserEffect, UserFormula, UserParameter};
use crate::catalogue::Catalogue;
use crate::expression::{Expression, ExpressionError, SHAPE_VARIABLES, VARIABLES, Variable, check_name};
use crate::mechanism::{Form, Mechanism};
use bulge_muscles::settings::{Document, Keys, Setting, Settings};
use bulge_muscles::shown::{one_line, shortened};
use bulge_muscles::{Dimension, FileError, units};
use std::ops::Range;

/// The keys of the file, of an effect, and of a parameter.
const FILE: Keys = &[("effects", "[effects.hose-stiffness]")];
const EFFECT: Keys = &[
    ("title", "title = \"Hose pulls on the muscle\""),
    ("force", "force = \"-k * (eps - eps_free)\""),
    ("energy", "energy = \"h * c10 * (l1^2 + l2^2 + 1/(l1*l2)^2 - 3)\""),
    ("area", "area = \"pi*(r - t)^2\""),
    ("twist", "twist = \"sin(alpha0)/r0*(1 + k*p)\""),
    ("about", "about = \"what happens\""),
    ("source", "source = \"author, title, year, equation\""),
    ("family", "family = \"mounting\""),
    ("mechanism", "mechanism = \"give-of-the-rig\""),
    ("form", "form = \"loose\""),
    ("twins", "twins = [\"force-offset\"]"),
    ("parameters", PARAMETER),
];
const PARAMETER_KEYS: Keys = &[
    ("unit", "unit = \"N\""),
    ("typical", "typical = \"50 N\""),
    ("low", "low = \"0 N\""),
    ("high", "high = \"500 N\""),
    ("prior", "prior = \"50 N +- 30 N\""),
    ("about", "about = \"what it is\""),
];
const PARAMETER: &str =
    "parameters.k = { unit = \"N\", typical = \"50 N\", low = \"0 N\", high = \"500 N\" }";

/// The largest numbers of characters of a title and of other texts.
const MAX_TITLE: usize = 120;
const MAX_WORDS: usize = 4000;
/// The largest number of twins.
const MAX_TWINS: usize = 20;

/// All effects of a file, in their order.
pub(crate) fn effects(document: &Document<'_>) -> Result<Vec<UserEffect>, FileError> {
    let root = document.settings("the file", FILE);
    root.check_keys()?;
    let Some(all) = root.table("effects", "`effects`", &[])?.filter(|all| !all.names().is_empty()) else {
        let instead = format!("a file of effects looks like this:\n{EXAMPLE}");
        return Err(root.error(root.key_span("effects"), "the file states no effect", instead));
    };
    all.names().into_iter().map(|(name, place)| effect(&all, name, place)).collect()
}

fn effect(all: &Settings<'_>, name: &str, place: Range<usize>) -> Result<UserEffect, FileError> {
    if !is_effect_name(name) {
        let what = format!("`{}` is no name of an effect", shortened(name));
        let instead =
            "write lower-case words with hyphens, such as `[effects.hose-stiffness]`, at most 64 characters";
        return Err(all.error(place, what, instead));
    }
    let instead = format!("write `[effects.{name}]`");
    // A table made by dotted keys has no place of its own, so the place of its name is used.
    let table = all.table_named(name, format!("the effect `{name}`"), EFFECT, instead)?.at(place);
    table.check_keys()?;
    let title = words(&table, "title", MAX_TITLE)?;
    let about = words(&table, "about", MAX_WORDS)?;
    let source = words(&table, "source", MAX_WORDS)?;
    let family = words(&table, "family", MAX_TITLE)?;
    let mechanism = mechanism(&table, family.as_deref())?;
    let form = table.word("form", &Form::ALL.map(|form| (form.name(), form)))?.unwrap_or(Form::Loose);
    let twins = twins(&table, name)?;
    let title = title.ok_or_else(|| table.missing("title"))?;
    let (key, shape) = formula_key(&table)?;
    let (formula_value, formula_text) = filled(&table, key)?.ok_or_else(|| table.missing("force"))?;
    let variables: &'static [Variable] = if shape.is_some() { &SHAPE_VARIABLES } else { &VARIABLES };
    let (parameters, places) = parameters(&table, variables)?;
    let known: Vec<(&str, Dimension)> = parameters.iter().map(|p| (p.name.as_str(), p.dimension)).collect();
    let at = |error: ExpressionError| {
        table.error(table.inside(formula_value, error.span()), error.what(), error.instead())
    };
    let formula = match shape {
        None => UserFormula::Force(Expression::parse(formula_text, &known, Dimension::FORCE).map_err(at)?),
        Some(quantity) => {
            UserFormula::Shape(ShapeFormula::parse(quantity, formula_text, &known).map_err(at)?)
        }
    };
    for (index, (parameter, place)) in parameters.iter().zip(places).enumerate() {
        if !formula.expression().uses_parameter(index) {
            let name = &parameter.name;
            let what = format!("the parameter `{name}` does not occur in `{key}`");
            return Err(table.error(
                place,
                what,
                format!("delete `parameters.{name}`, or use it in the formula"),
            ));
        }
    }
    Ok(UserEffect {
        name: name.to_owned(),
        title,
        about,
        source,
        family,
        mechanism,
        form,
        twins,
        formula,
        parameters,
    })
}

/// The key of the formula, and the shape quantity that it describes. The key is `force` if there is no
/// formula.
fn formula_key(table: &Settings<'_>) -> Result<(&'static str, Option<ShapeQuantity>), FileError> {
    let shapes = ShapeQuantity::ALL.map(|quantity| (quantity.key(), Some(quantity)));
    let all = std::iter::once(("force", None)).chain(shapes);
    let mut stated = all.filter(|(key, _)| table.get(key).is_some());
    let first = stated.next().unwrap_or(("force", None));
    let Some((other, _)) = stated.next() else { return Ok(first) };
    let what = format!("{} has a formula for `{}` and one for `{other}`", table.title(), first.0);
    Err(table.error(table.value_span(other), what, "write two effects, one for each"))
}

/// Lower-case words with hyphens: "hose-stiffness".
fn is_effect_name(name: &str) -> bool {
    let is_word =
        |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit());
    name.len() <= 64 && name.starts_with(|c: char| c.is_ascii_lowercase()) && name.split('-').all(is_word)
}

/// A text that isn't empty, as it is written: of one line or of several.
fn filled<'a>(table: &Settings<'a>, name: &str) -> Result<Option<(Setting<'a>, &'a str)>, FileError> {
    let (Some(value), Some(text)) = (table.get(name), table.lines(name)?) else { return Ok(None) };
    if text.trim().is_empty() {
        return Err(table.unreadable(name, value, format!("`{name}` is empty")));
    }
    Ok(Some((value, text)))
}

fn words(table: &Settings<'_>, name: &str, limit: usize) -> Result<Option<String>, FileError> {
    let Some((value, text)) = filled(table, name)? else { return Ok(None) };
    let length = text.chars().count();
    if length > limit {
        let what = format!("`{name}` has {length} characters, but at most {limit} are read");
        return Err(table.error(value.span(), what, "shorten it, or write the rest behind a `#`"));
    }
    Ok(Some(one_line(text.trim()).into_owned()))
}

/// The mechanism: the stated one, or that of the family, or the user's own.
fn mechanism(table: &Settings<'_>, family: Option<&str>) -> Result<Mechanism, FileError> {
    let catalogue = Catalogue::builtin();
    let of_family = catalogue
        .iter()
        .map(|effect| effect.card())
        .find(|card| Some(card.family) == family)
        .map(|card| (card.family, card.mechanism));
    let key = |mechanism: Mechanism| mechanism.name().replace(' ', "-");
    let keys = Mechanism::ALL.map(key);
    let known: Vec<_> = keys.iter().map(String::as_str).zip(Mechanism::ALL).collect();
    match (table.word("mechanism", &known)?, of_family) {
        (Some(mechanism), Some((family, other))) if other != mechanism => {
            let what =
                format!("`{family}` is a family of the mechanism `{}`, not `{}`", key(other), key(mechanism));
            let instead = "leave the mechanism out, or give the effect a family of its own";
            Err(table.error(table.value_span("mechanism"), what, instead))
        }
        (Some(mechanism), _) | (None, Some((_, mechanism))) => Ok(mechanism),
        (None, None) => Ok(Mechanism::User),
    }
}

fn twins(table: &Settings<'_>, own: &str) -> Result<Vec<String>, FileError> {
    let Some(value) = table.get("twins") else { return Ok(Vec::new()) };
    let no_list = |value| table.wrong_type("twins", value, "a list of names of effects");
    let list = value.items().ok_or_else(|| no_list(value))?;
    if list.len() > MAX_TWINS {
        let what = format!("`twins` names {} effects, but at most {MAX_TWINS} are read", list.len());
        return Err(table.error(value.span(), what, "name those that are hardest to tell apart"));
    }
    let mut twins: Vec<String> = Vec::new();
    for item in list {
        let name = item.text().ok_or_else(|| no_list(item))?;
        let what = if !is_effect_name(name) {
            format!("`{}` is no name of an effect", shortened(name))
        } else if name == own {
            format!("`{own}` cannot be its own twin")
        } else if twins.iter().any(|other| other == name) {
            format!("`{name}` is named twice")
        } else {
            twins.push(name.to_owned());
            continue;
        };
        let instead = format!("write names of other effects: `{}`", table.example("twins"));
        return Err(table.error(item.span(), what, instead));
    }
    Ok(twins)
}

/// The parameters, and the places of their names.
fn parameters(
    table: &Settings<'_>,
    variables: &[Variable],
) -> Result<(Vec<UserParameter>, Vec<Range<usize>>), FileError> {
    let list = table.table("parameters", format!("`parameters` of {}", table.title()), &[])?;
    let names = list.as_ref().map(Settings::names).unwrap_or_default();
    let Some(list) = list.filter(|_| !names.is_empty()) else {
        let what = format!("{} has no parameter, so there is nothing to learn about it", table.title());
        let instead = format!("add `{PARAMETER}` and use it in the formula");
        return Err(table.error(table.key_span("parameters"), what, instead));
    };
    if let Some((_, place)) = names.get(MAX_PARAMETERS) {
        let (title, count) = (table.title(), names.len());
        let what = format!("{title} has {count} parameters, but at most {MAX_PARAMETERS} are read");
        let instead = "write numbers for those that are known, or several effects";
        return Err(table.error(place.clone(), what, instead));
    }
    let read = names.iter().map(|(name, place)| parameter(&list, name, place, variables));
    Ok((read.collect::<Result<_, _>>()?, names.into_iter().map(|(_, place)| place).collect()))
}

fn parameter(
    list: &Settings<'_>,
    name: &str,
    place: &Range<usize>,
    variables: &[Variable],
) -> Result<UserParameter, FileError> {
    check_name(name, variables).map_err(|what| {
        let taken = variables.iter().any(|known| known.name == name || known.alias == Some(name));
        let instead = if taken {
            "rename the parameter, or delete it and use the variable".to_owned()
        } else {
            format!("rename the parameter: `{PARAMETER}`")
        };
        list.error(place.clone(), what, instead)
    })?;
    let instead = format!("write `{PARAMETER}`");
    let table =
        list.table_named(name, format!("the parameter `{name}`"), PARAMETER_KEYS, instead)?.at(place.clone());
    table.check_keys()?;
    let about = words(&table, "about", MAX_WORDS)?;
    let unit = unit_text(&table)?;
    let (factor, dimension) = units::unit(&unit).map_err(|error| {
        let instead = "write `unit = \"N\"`, or `unit = \"1\"` for a pure number";
        table.error(table.value_span("unit"), error.to_string(), instead)
    })?;
    let known = Quantity { table, unit, dimension };
    let (low, typical, high) = known.bounded()?;
    let prior = known.prior(low, high)?;
    let unit = known.unit;
    Ok(UserParameter { name: name.to_owned(), unit, factor, dimension, typical, low, high, prior, about })
}

/// The unit, which may be written as the number 1.
fn unit_text(table: &Settings<'_>) -> Result<String, FileError> {
    let value = table.get("unit").ok_or_else(|| table.missing("unit"))?;
    match value.text().or(value.number().filter(|number| *number == "1")).map(str::trim) {
        Some("") => Ok("1".to_owned()),
        Some(unit) => Ok(unit.to_owned()),
        None => Err(table.wrong_type("unit", value, "text in quotes")),
    }
}
