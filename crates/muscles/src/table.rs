//! The tables of a muscle file: keys with their places, values with their units, and what is wrong with them.

use crate::construction::{FibreCount, Kind};
use crate::error::MuscleError;
use crate::file_error::FileError;
use crate::keys;
use crate::parameter::Parameter;
use crate::units::{self, Quantity, shortened};
use std::cell::RefCell;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A parsed file, with the widths found so far.
pub(crate) struct Document<'a> {
    pub(crate) text: &'a str,
    pub(crate) origin: &'a str,
    pub(crate) root: &'a DeTable<'a>,
    pub(crate) widths: RefCell<Vec<(Parameter, f64)>>,
}

/// One table of it.
pub(crate) struct Table<'a> {
    pub(crate) document: &'a Document<'a>,
    pub(crate) path: String,
    pub(crate) span: Range<usize>,
    pub(crate) entries: &'a DeTable<'a>,
}

impl Document<'_> {
    pub(crate) fn error(
        &self,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> FileError {
        FileError::at(self.origin, self.text, span, what, instead)
    }

    /// The place of a dotted path, or of the last table on the way to it.
    pub(crate) fn span_of(&self, path: &str) -> Range<usize> {
        let (mut table, mut span) = (self.root, 0..0);
        for name in path.split('.') {
            let Some((_, value)) = table.iter().find(|(key, _)| key.get_ref() == name) else { break };
            span = value.span();
            let DeValue::Table(inner) = value.get_ref() else { break };
            table = inner;
        }
        span
    }

    /// A value out of range, at its place.
    pub(crate) fn invalid(&self, error: &MuscleError) -> FileError {
        let key = error.key();
        let instead = match error {
            MuscleError::NoFibreCount => {
                "add a line such as `fibres = 60`: the fibres of the braid, both families together".to_owned()
            }
            MuscleError::NoWall | MuscleError::NoGasWall => "add a line such as `wall = \"2 mm\"`".to_owned(),
            MuscleError::LobesOfContinuous => "write a number of fibres, such as `fibres = 40`".to_owned(),
            MuscleError::TooFewFibres { .. } => {
                "write the number of fibres, such as `fibres = 40` (a pleated muscle may say \"continuous\")"
                    .to_owned()
            }
            _ => format!("write {}", keys::example(key)),
        };
        self.error(self.span_of(key), error.to_string(), instead)
    }
}

/// What a value is, in words.
pub(crate) fn type_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

impl<'a> Table<'a> {
    pub(crate) fn get(&self, name: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
    }

    /// The keys with their places, in the order of the file.
    pub(crate) fn names(&self) -> Vec<(&'a str, Range<usize>)> {
        let mut names: Vec<_> = self.entries.keys().map(|key| (key.get_ref().as_ref(), key.span())).collect();
        names.sort_by_key(|(_, span)| span.start);
        names
    }

    pub(crate) fn check_names(&self) -> Result<(), FileError> {
        let known = keys::children(&self.path);
        let Some((name, span)) = self.names().into_iter().find(|(name, _)| !known.contains(name)) else {
            return Ok(());
        };
        let shown = shortened(name);
        let (what, instead) = match self.path.as_str() {
            "" => (format!("unknown key `{shown}`"), keys::instead_of(name, "")),
            path => (format!("unknown key `{shown}` in `[{path}]`"), keys::instead_of(name, path)),
        };
        Err(self.document.error(span, what, instead))
    }

    /// Refuses keys of the other family.
    pub(crate) fn check_owner(&self, kind: Kind) -> Result<(), FileError> {
        for (name, span) in self.names() {
            let path = keys::join(&self.path, name);
            let owner = if path == "effects" { None } else { keys::owner(&path) };
            if let Some(owner) = owner.filter(|owner| *owner != kind) {
                let (owner, kind) = (owner.name(), kind.name());
                let what = format!("`{name}` belongs to a {owner} muscle, but this one is {kind}");
                let instead = format!("delete `{name}`, or write `kind = \"{owner}\"`");
                return Err(self.document.error(span, what, instead));
            }
        }
        Ok(())
    }

    pub(crate) fn missing(&self, name: &str) -> FileError {
        let instead = format!("add {}", keys::example(&keys::join(&self.path, name)));
        if !self.path.is_empty() {
            let what = format!("`[{}]` needs `{name}`, which is missing", self.path);
            return self.document.error(self.span.clone(), what, instead);
        }
        let span = self.document.span_of("kind");
        let kind = self.get("kind").and_then(|value| value.get_ref().as_str()).unwrap_or("");
        let what = format!("`{name}` is missing: a muscle with `kind = \"{kind}\"` needs it");
        self.document.error(span, what, instead)
    }

    pub(crate) fn wrong_type(&self, name: &str, value: &Spanned<DeValue<'_>>, wanted: &str) -> FileError {
        let what = format!("`{name}` is {}, but must be {wanted}", type_of(value.get_ref()));
        let instead = format!("write {}", keys::example(&keys::join(&self.path, name)));
        self.document.error(value.span(), what, instead)
    }

    pub(crate) fn text(&self, name: &str) -> Result<Option<&'a str>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.get_ref() {
            DeValue::String(text) => Ok(Some(text)),
            _ => Err(self.wrong_type(name, value, "text in quotes")),
        }
    }

    /// One word of a closed list; words in `also` are not accepted, but answered with the right one.
    pub(crate) fn word<T: Copy + PartialEq>(
        &self,
        name: &str,
        known: &[(&'static str, T)],
        also: &[(&'static str, T)],
    ) -> Result<Option<T>, FileError> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        if let Some((_, found)) = known.iter().find(|(word, _)| *word == text) {
            return Ok(Some(*found));
        }
        let words: Vec<_> = known.iter().map(|(word, _)| *word).collect();
        let same = also.iter().find(|(word, _)| text.eq_ignore_ascii_case(word));
        let same =
            same.and_then(|(_, meant)| known.iter().find(|(_, other)| other == meant)).map(|(word, _)| *word);
        let instead = match same.or_else(|| keys::nearest(text, &words)) {
            Some(word) => format!("write `{name} = \"{word}\"`"),
            None => {
                format!("write `{name} = \"{}\"`", words.join("\"` or `{name} = \"").replace("{name}", name))
            }
        };
        let what = format!("`{name}` is \"{}\", but must be one of: {}", shortened(text), words.join(", "));
        Err(self.document.error(self.document.span_of(&keys::join(&self.path, name)), what, instead))
    }

    pub(crate) fn fibres(&self, kind: Kind) -> Result<Option<FibreCount>, FileError> {
        let Some(value) = self.get("fibres") else { return Ok(None) };
        let wanted = match kind {
            Kind::Pleated => "a whole number of at least 3, or \"continuous\"",
            Kind::Braided => "a whole number of at least 3",
        };
        let refuse = |found: &str, instead: String| {
            let what = format!("`fibres` is {}, but must be {wanted}", shortened(found));
            Err(self.document.error(value.span(), what, instead))
        };
        match value.get_ref() {
            DeValue::Integer(number) => match i128::from_str_radix(number.as_str(), number.radix()) {
                Ok(count) if u32::try_from(count).is_ok_and(|count| count >= 3) => {
                    Ok(u32::try_from(count).ok().map(FibreCount::Discrete))
                }
                _ => refuse(number.as_str(), "write the number of fibres, such as `fibres = 40`".to_owned()),
            },
            DeValue::Float(number) => {
                let whole = number.as_str().parse::<f64>().map_or(40.0, f64::trunc);
                let whole = if (3.0..=1e6).contains(&whole) { whole } else { 40.0 };
                refuse(number.as_str(), format!("write a whole number, such as `fibres = {whole}`"))
            }
            DeValue::String(text) if text == "continuous" && kind == Kind::Pleated => {
                Ok(Some(FibreCount::Continuous))
            }
            DeValue::String(text) => {
                let instead = match text.trim().parse::<u32>() {
                    Ok(count) if count >= 3 => format!("write the number without quotes: `fibres = {count}`"),
                    _ if kind == Kind::Pleated && keys::nearest(text, &["continuous"]).is_some() => {
                        "write `fibres = \"continuous\"`".to_owned()
                    }
                    _ => "write the number of fibres, such as `fibres = 40`".to_owned(),
                };
                refuse(&format!("\"{text}\""), instead)
            }
            _ => Err(self.wrong_type("fibres", value, wanted)),
        }
    }

    pub(crate) fn table(&self, name: &str) -> Result<Option<Table<'a>>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let DeValue::Table(entries) = value.get_ref() else {
            return Err(self.wrong_type(name, value, "a table"));
        };
        let path = keys::join(&self.path, name);
        Ok(Some(Table { document: self.document, path, span: value.span(), entries }))
    }

    pub(crate) fn checked_table(&self, name: &str) -> Result<Option<Table<'a>>, FileError> {
        let table = self.table(name)?;
        table.as_ref().map_or(Ok(()), Table::check_names)?;
        Ok(table)
    }

    /// A quantity, whose width is noted where the key is a parameter of the muscle.
    pub(crate) fn quantity<Q: Quantity>(&self, name: &str) -> Result<Option<Q>, FileError> {
        let path = keys::join(&self.path, name);
        let own = |parameter: &Parameter| {
            parameter.key() == path
                || (*parameter == Parameter::Wall && path == "effects.bladder-elasticity.wall")
        };
        let Some(parameter) = Parameter::ALL.into_iter().find(own) else { return self.plain(name) };
        let Some((value, width)) = self.read(name, units::parse_with_width::<Q>)? else { return Ok(None) };
        if let Some(width) = width {
            self.document.widths.borrow_mut().push((parameter, width.si()));
        }
        Ok(Some(value))
    }

    /// A quantity without a width.
    pub(crate) fn plain<Q: Quantity>(&self, name: &str) -> Result<Option<Q>, FileError> {
        self.read(name, units::parse::<Q>)
    }

    pub(crate) fn required<Q: Quantity>(&self, name: &str) -> Result<Q, FileError> {
        self.quantity(name)?.ok_or_else(|| self.missing(name))
    }

    /// A standard deviation in SI, which must be > 0; 0 if it is absent.
    pub(crate) fn spread<Q: Quantity>(&self, name: &str) -> Result<f64, FileError> {
        let Some(value) = self.plain::<Q>(name)?.map(Quantity::si) else { return Ok(0.0) };
        if value > 0.0 {
            return Ok(value);
        }
        let path = keys::join(&self.path, name);
        let what = format!("`{name}` is {value} in SI units: a standard deviation must be greater than 0");
        let instead = format!("write {}, or leave it out", keys::example(&path));
        Err(self.document.error(self.document.span_of(&path), what, instead))
    }

    pub(crate) fn read<T>(
        &self,
        name: &str,
        parse: impl Fn(&str) -> Result<T, units::UnitError>,
    ) -> Result<Option<T>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        // A bare number goes the same way: it is a ratio, or its message says which unit is missing.
        let text = match value.get_ref() {
            DeValue::String(text) => text.as_ref(),
            DeValue::Integer(number) => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => return Err(self.wrong_type(name, value, "text with a number and a unit")),
        };
        let instead = || format!("write {}", keys::example(&keys::join(&self.path, name)));
        parse(text).map(Some).map_err(|error| self.document.error(value.span(), error.to_string(), instead()))
    }
}
