//! From the tables of a file to effects: what must be there, and what must agree.

use super::value::{Entry, Table};
use super::{EXAMPLE, EffectFileError, MAX_PARAMETERS, UserEffect, UserParameter};
use crate::expression::{Expression, VARIABLES, check_name, quoted};
use bulge_muscles::Dimension;
use bulge_muscles::units::{self, Any, AnyUnitError};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Keys of an effect, and of a parameter.
const EFFECT_KEYS: [&str; 7] = ["title", "force", "about", "source", "family", "twins", "parameters"];
const PARAMETER_KEYS: [&str; 6] = ["unit", "typical", "low", "high", "prior", "about"];

const TITLE: &str = "title = \"Hose pulls on the muscle\"";
const FORCE: &str = "force = \"-k * (eps - eps_free)\"";
const TWINS: &str = "twins = [\"force-offset\"]";
const PARAMETER: &str =
    "parameters.k = { unit = \"N\", typical = \"50 N\", low = \"0 N\", high = \"500 N\" }";

/// How many characters a title, and another text, may have.
const MAX_TITLE: usize = 120;
const MAX_WORDS: usize = 4000;
/// How many effects may be named as twins.
const MAX_TWINS: usize = 20;

/// All effects of a file, in its order.
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
    let twins = twins(&table, name)?;
    let title = title.ok_or_else(|| table.missing("title", TITLE))?;
    let Some((force, force_place)) = table.words("force", FORCE)? else {
        return Err(table.missing("force", FORCE));
    };
    let (parameters, places) = parameters(&table)?;
    let known: Vec<(&str, Dimension)> = parameters.iter().map(|p| (p.name.as_str(), p.dimension)).collect();
    let formula = Expression::parse(force, &known, Dimension::FORCE).map_err(|error| {
        table.error(table.inside(force, &force_place, error.span()), error.what(), error.instead())
    })?;
    for (index, (parameter, place)) in parameters.iter().zip(places).enumerate() {
        if !formula.uses_parameter(index) {
            let name = &parameter.name;
            let what = format!("the parameter `{name}` does not occur in `force`");
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
        twins,
        force: formula,
        parameters,
    })
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
    for item in list.iter() {
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

/// The parameters, with the places of their names.
fn parameters(table: &Table<'_>) -> Result<(Vec<UserParameter>, Vec<Range<usize>>), EffectFileError> {
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
            let read = entries.iter().map(|entry| parameter(&list, entry)).collect::<Result<_, _>>()?;
            Ok((read, entries.into_iter().map(|(_, place, _)| place).collect()))
        }
    }
}

fn parameter(list: &Table<'_>, entry: &Entry<'_>) -> Result<UserParameter, EffectFileError> {
    let (name, place, _) = entry;
    check_name(name).map_err(|what| {
        let taken = VARIABLES.iter().any(|known| known.name == *name || known.alias == Some(name));
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
    let known = Known { table, unit, factor, dimension };
    let (low, low_place) = known.required("low")?;
    let (high, high_place) = known.required("high")?;
    let (typical, typical_place) = known.required("typical")?;
    let bounds = || format!("{} to {}", known.shown(low), known.shown(high));
    if low >= high {
        let what =
            format!("`low` is {}, but must be less than `high`, {}", known.shown(low), known.shown(high));
        return Err(known.table.error(low_place.start.max(high_place.start)..low_place.end.max(high_place.end), what,
            "write the smallest possible value as `low` and the largest as `high`; for a known value, write a number into the formula"));
    }
    if !(low..=high).contains(&typical) {
        let what = format!("`typical` is {}, outside of its bounds {}", known.shown(typical), bounds());
        return Err(known.table.error(typical_place, what, "write a value between `low` and `high`"));
    }
    let prior = known.prior()?;
    if let Some(((mean, _), place)) = &prior
        && !(low..=high).contains(mean)
    {
        let what =
            format!("the mean of `prior` is {}, outside of its bounds {}", known.shown(*mean), bounds());
        return Err(known.table.error(place.clone(), what, "write a mean between `low` and `high`"));
    }
    let prior = prior.map(|(prior, _)| prior);
    let Known { unit, .. } = known;
    Ok(UserParameter { name: (*name).to_owned(), unit, factor, dimension, typical, low, high, prior, about })
}

/// The unit, which may also be the number 1.
fn unit_text(table: &Table<'_>) -> Result<Option<(String, Range<usize>)>, EffectFileError> {
    let Some(value) = table.get("unit") else { return Ok(None) };
    match value.get_ref() {
        DeValue::Integer(number) if number.as_str() == "1" => Ok(Some(("1".to_owned(), value.span()))),
        DeValue::String(text) if text.trim().is_empty() => Ok(Some(("1".to_owned(), value.span()))),
        DeValue::String(text) => Ok(Some((text.trim().to_owned(), value.span()))),
        _ => Err(table.wrong_type("unit", value, "text in quotes", "unit = \"N\"")),
    }
}

/// A parameter's table whose unit is known.
struct Known<'a> {
    table: Table<'a>,
    unit: String,
    factor: f64,
    dimension: Dimension,
}

impl Known<'_> {
    /// An SI value as the file would write it.
    fn shown(&self, si: f64) -> String {
        units::exact_any_text(si, &self.unit)
    }

    fn example(&self, key: &str) -> String {
        let number = if self.is_plain() { "0.5".to_owned() } else { format!("\"50 {}\"", self.unit) };
        match key {
            "prior" if self.is_plain() => "prior = \"0.5 +- 0.1\"".to_owned(),
            "prior" => format!("prior = \"50 {0} +- 10 {0}\"", self.unit),
            _ => format!("{key} = {number}"),
        }
    }

    /// Whether a bare number is a value in this unit.
    fn is_plain(&self) -> bool {
        self.dimension.is_none() && matches!(self.unit.as_str(), "1" | "-" | "rad" | "decade")
    }

    fn required(&self, key: &str) -> Result<(f64, Range<usize>), EffectFileError> {
        let Some(value) = self.table.get(key) else {
            return Err(self.table.missing(key, &self.example(key)));
        };
        let text = self.value_text(key, value)?;
        let found = units::any(&text).map_err(|error| self.no_number(key, value, &error))?;
        self.check(key, value, &found)?;
        Ok((found.si, value.span()))
    }

    /// Mean and standard deviation.
    fn prior(&self) -> Result<Option<((f64, f64), Range<usize>)>, EffectFileError> {
        let Some(value) = self.table.get("prior") else { return Ok(None) };
        let text = self.value_text("prior", value)?;
        let (mean, width) =
            units::any_with_width(&text).map_err(|error| self.no_number("prior", value, &error))?;
        self.check("prior", value, &mean)?;
        match width {
            Some(width) => Ok(Some(((mean.si, width), value.span()))),
            None => {
                let what = "`prior` has no standard deviation";
                let instead = format!("write `{}`, or leave it out", self.example("prior"));
                Err(self.table.error(value.span(), what, instead))
            }
        }
    }

    fn value_text(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Result<String, EffectFileError> {
        match value.get_ref() {
            DeValue::String(text) => Ok(text.to_string()),
            DeValue::Float(number) => Ok(number.as_str().to_owned()),
            DeValue::Integer(number) if number.radix() == 10 => Ok(number.as_str().to_owned()),
            _ => Err(self.table.wrong_type(key, value, "a number with its unit", &self.example(key))),
        }
    }

    fn no_number(&self, key: &str, value: &Spanned<DeValue<'_>>, error: &AnyUnitError) -> EffectFileError {
        self.table.error(value.span(), error.to_string(), format!("write `{}`", self.example(key)))
    }

    /// The unit of a value must be that of the parameter; a bare number is none in per cent or degrees.
    fn check(&self, key: &str, value: &Spanned<DeValue<'_>>, found: &Any) -> Result<(), EffectFileError> {
        let wanted = format!("a parameter in `{}` needs {}", self.unit, self.dimension.describe());
        let what = if found.dimension != self.dimension && found.unit.is_empty() {
            format!("`{key}` has no unit, but {wanted}")
        } else if found.dimension != self.dimension {
            format!("`{key}` is {}, but {wanted}", found.dimension.describe())
        } else if found.unit.is_empty() && !self.is_plain() {
            format!("`{key}` has no unit, but the parameter is in `{}`", self.unit)
        } else {
            return Ok(());
        };
        Err(self.table.error(value.span(), what, format!("write `{}`", self.example(key))))
    }
}
