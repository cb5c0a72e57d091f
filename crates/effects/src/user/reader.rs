//! Reads effects from the tables of a file, and checks that they are complete and consistent.

use super::quantity::Quantity;
use super::value::{Entry, Table};
use super::{
    EXAMPLE, EffectFileError, MAX_PARAMETERS, ShapeFormula, ShapeQuantity, UserEffect, UserFormula,
    UserParameter,
};
use crate::catalogue::Catalogue;
use crate::expression::{
    Expression, ExpressionError, SHAPE_VARIABLES, VARIABLES, Variable, check_name, nearest, quoted,
};
use crate::mechanism::{Form, Mechanism};
use bulge_muscles::Dimension;
use bulge_muscles::units;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// The keys of an effect, and of a parameter.
const EFFECT_KEYS: [&str; 12] = [
    "title",
    "force",
    "energy",
    "area",
    "twist",
    "about",
    "source",
    "family",
    "mechanism",
    "form",
    "twins",
    "parameters",
];
const PARAMETER_KEYS: [&str; 6] = ["unit", "typical", "low", "high", "prior", "about"];

const TITLE: &str = "title = \"Hose pulls on the muscle\"";
const FORCE: &str = "force = \"-k * (eps - eps_free)\"";
const MECHANISM: &str = "mechanism = \"give-of-the-rig\"";
const FORM: &str = "form = \"loose\"";
const TWINS: &str = "twins = [\"force-offset\"]";
const PARAMETER: &str =
    "parameters.k = { unit = \"N\", typical = \"50 N\", low = \"0 N\", high = \"500 N\" }";

/// The largest numbers of characters of a title and of other texts.
const MAX_TITLE: usize = 120;
const MAX_WORDS: usize = 4000;
/// The largest number of twins.
const MAX_TWINS: usize = 20;

/// All effects of a file, in their order.
pub(crate) fn effects(
    text: &str,
    origin: &str,
    root: &DeTable<'_>,
) -> Result<Vec<UserEffect>, EffectFileError> {
    let root = Table { text, origin, title: "the file".to_owned(), span: 0..0, entries: root };
    root.only(&["effects"])?;
    let looks = || format!("a file of effects looks like this:\n{EXAMPLE}");
    let Some(entry) = root.in_order().into_iter().next() else {
        return Err(root.error(0..0, "the file states no effect", looks()));
    };
    let all = root.table(&entry, "`effects`".to_owned(), "[effects.hose-stiffness]")?;
    let entries = all.in_order();
    if entries.is_empty() {
        return Err(all.error(all.span.clone(), "the file states no effect", looks()));
    }
    entries.iter().map(|entry| effect(&all, entry)).collect()
}

fn effect(all: &Table<'_>, entry: &Entry<'_>) -> Result<UserEffect, EffectFileError> {
    let (name, place, _) = entry;
    if !is_effect_name(name) {
        let what = format!("`{}` is no name of an effect", quoted(name));
        let instead =
            "write lower-case words with hyphens, such as `[effects.hose-stiffness]`, at most 64 characters";
        return Err(all.error(place.clone(), what, instead));
    }
    let title = format!("the effect `{name}`");
    let table = all.table(entry, title, &format!("[effects.{name}]"))?;
    table.only(&EFFECT_KEYS)?;
    let title = words(&table, "title", TITLE, MAX_TITLE)?;
    let about = words(&table, "about", "about = \"what happens\"", MAX_WORDS)?;
    let source = words(&table, "source", "source = \"author, title, year, equation\"", MAX_WORDS)?;
    let family = words(&table, "family", "family = \"mounting\"", MAX_TITLE)?;
    let mechanism = mechanism(&table, family.as_deref())?;
    let form = form(&table)?;
    let twins = twins(&table, name)?;
    let title = title.ok_or_else(|| table.missing("title", TITLE))?;
    let (key, shape) = formula_key(&table)?;
    let Some((formula_text, formula_place)) = table.words(key, FORCE)? else {
        return Err(table.missing("force", FORCE));
    };
    let variables: &'static [Variable] = if shape.is_some() { &SHAPE_VARIABLES } else { &VARIABLES };
    let (parameters, places) = parameters(&table, variables)?;
    let known: Vec<(&str, Dimension)> = parameters.iter().map(|p| (p.name.as_str(), p.dimension)).collect();
    let at = |error: ExpressionError| {
        let place = table.inside(formula_text, &formula_place, error.span());
        table.error(place, error.what(), error.instead())
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
        name: (*name).to_owned(),
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
fn formula_key(table: &Table<'_>) -> Result<(&'static str, Option<ShapeQuantity>), EffectFileError> {
    let shapes = ShapeQuantity::ALL.map(|quantity| (quantity.key(), Some(quantity)));
    let all = std::iter::once(("force", None)).chain(shapes);
    let mut stated = all.filter(|(key, _)| table.get(key).is_some());
    let first = stated.next().unwrap_or(("force", None));
    match stated.next() {
        None => Ok(first),
        Some((other, _)) => {
            let span = table.get(other).map_or(table.span.clone(), toml::Spanned::span);
            let what = format!("{} has a formula for `{}` and one for `{other}`", table.title, first.0);
            Err(table.error(span, what, "write two effects, one for each"))
        }
    }
}

/// Lower-case words with hyphens: "hose-stiffness".
fn is_effect_name(name: &str) -> bool {
    let is_word =
        |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit());
    name.len() <= 64 && name.starts_with(|c: char| c.is_ascii_lowercase()) && name.split('-').all(is_word)
}

fn words(
    table: &Table<'_>,
    name: &str,
    example: &str,
    limit: usize,
) -> Result<Option<String>, EffectFileError> {
    let Some((text, place)) = table.words(name, example)? else { return Ok(None) };
    let length = text.chars().count();
    if length > limit {
        let what = format!("`{name}` has {length} characters, but at most {limit} are read");
        return Err(table.error(place, what, "shorten it, or write the rest behind a `#`"));
    }
    Ok(Some(text.trim().to_owned()))
}

/// The mechanism: the stated one, or that of the family, or the user's own.
fn mechanism(table: &Table<'_>, family: Option<&str>) -> Result<Mechanism, EffectFileError> {
    let catalogue = Catalogue::builtin();
    let of_family = catalogue
        .iter()
        .map(|effect| effect.card())
        .find(|card| Some(card.family) == family)
        .map(|card| (card.family, card.mechanism));
    let Some((stated, place)) = table.words("mechanism", MECHANISM)? else {
        return Ok(of_family.map_or(Mechanism::User, |(_, mechanism)| mechanism));
    };
    let key = |mechanism: Mechanism| mechanism.name().replace(' ', "-");
    let Some(mechanism) = Mechanism::ALL.into_iter().find(|mechanism| key(*mechanism) == stated.trim())
    else {
        let keys = Mechanism::ALL.map(key);
        let instead = match nearest(stated, keys.iter().map(String::as_str)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("write one of {}, or leave it out", keys.join(", ")),
        };
        return Err(table.error(place, format!("there is no mechanism `{}`", quoted(stated)), instead));
    };
    match of_family {
        Some((family, other)) if other != mechanism => {
            let what =
                format!("`{family}` is a family of the mechanism `{}`, not `{}`", key(other), key(mechanism));
            Err(table.error(place, what, "leave the mechanism out, or give the effect a family of its own"))
        }
        _ => Ok(mechanism),
    }
}

/// How exact the formula can be; loose if not stated.
fn form(table: &Table<'_>) -> Result<Form, EffectFileError> {
    let Some((stated, place)) = table.words("form", FORM)? else { return Ok(Form::Loose) };
    Form::ALL.into_iter().find(|form| form.name() == stated.trim()).ok_or_else(|| {
        let instead = "write `exact` (only its numbers can be wrong), `near` (to 5 %) or `loose` (to 40 %)";
        table.error(place, format!("there is no form `{}`", quoted(stated)), instead)
    })
}

fn twins(table: &Table<'_>, own: &str) -> Result<Vec<String>, EffectFileError> {
    let Some(value) = table.get("twins") else { return Ok(Vec::new()) };
    let wanted = "a list of names of effects";
    let DeValue::Array(list) = value.get_ref() else {
        return Err(table.wrong_type("twins", value, wanted, TWINS));
    };
    if list.len() > MAX_TWINS {
        let what = format!("`twins` names {} effects, but at most {MAX_TWINS} are read", list.len());
        return Err(table.error(value.span(), what, "name those that are hardest to tell apart"));
    }
    let mut twins: Vec<String> = Vec::new();
    for item in list {
        let DeValue::String(name) = item.get_ref() else {
            return Err(table.wrong_type("twins", item, wanted, TWINS));
        };
        let what = if !is_effect_name(name) {
            format!("`{}` is no name of an effect", quoted(name))
        } else if name == own {
            format!("`{own}` cannot be its own twin")
        } else if twins.iter().any(|other| other == name) {
            format!("`{name}` is named twice")
        } else {
            twins.push(name.to_string());
            continue;
        };
        return Err(table.error(item.span(), what, format!("write names of other effects: `{TWINS}`")));
    }
    Ok(twins)
}

/// The parameters, and the places of their names.
fn parameters(
    table: &Table<'_>,
    variables: &[Variable],
) -> Result<(Vec<UserParameter>, Vec<Range<usize>>), EffectFileError> {
    let none = |place| {
        let what = format!("{} has no parameter, so there is nothing to learn about it", table.title);
        table.error(place, what, format!("add `{PARAMETER}` and use it in the formula"))
    };
    let Some(entry) = table.in_order().into_iter().find(|(name, ..)| *name == "parameters") else {
        return Err(none(table.span.clone()));
    };
    let list = table.table(&entry, format!("`parameters` of {}", table.title), PARAMETER)?;
    let entries = list.in_order();
    match entries.len() {
        0 => Err(none(list.span.clone())),
        count if count > MAX_PARAMETERS => {
            let what =
                format!("{} has {count} parameters, but at most {MAX_PARAMETERS} are read", table.title);
            let place = entries[MAX_PARAMETERS].1.clone();
            Err(table.error(place, what, "write numbers for those that are known, or several effects"))
        }
        _ => {
            let read =
                entries.iter().map(|entry| parameter(&list, entry, variables)).collect::<Result<_, _>>()?;
            Ok((read, entries.into_iter().map(|(_, place, _)| place).collect()))
        }
    }
}

fn parameter(
    list: &Table<'_>,
    entry: &Entry<'_>,
    variables: &[Variable],
) -> Result<UserParameter, EffectFileError> {
    let (name, place, _) = entry;
    check_name(name, variables).map_err(|what| {
        let taken = variables.iter().any(|known| known.name == *name || known.alias == Some(name));
        let instead = if taken {
            "rename the parameter, or delete it and use the variable".to_owned()
        } else {
            format!("rename the parameter: `{PARAMETER}`")
        };
        list.error(place.clone(), what, instead)
    })?;
    let table = list.table(entry, format!("the parameter `{name}`"), PARAMETER)?;
    table.only(&PARAMETER_KEYS)?;
    let about = words(&table, "about", "about = \"what it is\"", MAX_WORDS)?;
    let Some((unit, unit_place)) = unit_text(&table)? else {
        return Err(table.missing("unit", "unit = \"N\""));
    };
    let (factor, dimension) = units::unit(&unit).map_err(|error| {
        table.error(
            unit_place,
            error.to_string(),
            "write `unit = \"N\"`, or `unit = \"1\"` for a pure number",
        )
    })?;
    let known = Quantity { table, unit, dimension };
    let (low, typical, high) = known.bounded()?;
    let prior = known.prior(low, high)?;
    let unit = known.unit;
    Ok(UserParameter { name: (*name).to_owned(), unit, factor, dimension, typical, low, high, prior, about })
}

/// The unit, which may be written as the number 1.
fn unit_text(table: &Table<'_>) -> Result<Option<(String, Range<usize>)>, EffectFileError> {
    let Some(value) = table.get("unit") else { return Ok(None) };
    match value.get_ref() {
        DeValue::Integer(number) if number.as_str() == "1" => Ok(Some(("1".to_owned(), value.span()))),
        DeValue::String(text) if text.trim().is_empty() => Ok(Some(("1".to_owned(), value.span()))),
        DeValue::String(text) => Ok(Some((text.trim().to_owned(), value.span()))),
        _ => Err(table.wrong_type("unit", value, "text in quotes", "unit = \"N\"")),
    }
}
