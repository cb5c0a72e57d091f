//! Tables of a file of effects: keys with their places, and errors in their values.

use super::{EffectFileError, located};
use crate::expression::{nearest, quoted};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key with its place and its value.
pub(crate) type Entry<'a> = (&'a str, Range<usize>, &'a Spanned<DeValue<'a>>);

/// One table and the text around it.
#[derive(Clone)]
pub(crate) struct Table<'a> {
    pub(crate) text: &'a str,
    pub(crate) origin: &'a str,
    /// The name of the table in messages.
    pub(crate) title: String,
    pub(crate) span: Range<usize>,
    pub(crate) entries: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    pub(crate) fn error(
        &self,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> EffectFileError {
        located(self.origin, self.text, span, what, instead)
    }

    /// The entries in the order of the file.
    pub(crate) fn in_order(&self) -> Vec<Entry<'a>> {
        let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| -> Entry<'a> {
            let name: &std::borrow::Cow<'a, str> = key.get_ref();
            (name.as_ref(), key.span(), value)
        };
        let mut entries: Vec<_> = self.entries.iter().map(entry).collect();
        entries.sort_by_key(|(_, span, _)| span.start);
        entries
    }

    pub(crate) fn get(&self, name: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
    }

    /// Refuses keys that are not in this list.
    pub(crate) fn only(&self, known: &[&'static str]) -> Result<(), EffectFileError> {
        let unknown = self.in_order().into_iter().find(|(name, ..)| !known.contains(name));
        let Some((name, span, _)) = unknown else { return Ok(()) };
        let instead = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known here: {}; leave the rest out, or write it behind a `#`", known.join(", ")),
        };
        Err(self.error(span, format!("unknown key `{}` in {}", quoted(name), self.title), instead))
    }

    pub(crate) fn missing(&self, name: &str, example: &str) -> EffectFileError {
        let what = format!("{} needs `{name}`, which is missing", self.title);
        self.error(self.span.clone(), what, format!("add `{example}`"))
    }

    pub(crate) fn wrong_type(
        &self,
        name: &str,
        value: &Spanned<DeValue<'_>>,
        wanted: &str,
        example: &str,
    ) -> EffectFileError {
        let found = match value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        let what = format!("`{}` is {found}, but must be {wanted}", quoted(name));
        self.error(value.span(), what, format!("write `{example}`"))
    }

    /// A text that isn't empty.
    pub(crate) fn words(
        &self,
        name: &str,
        example: &str,
    ) -> Result<Option<(&'a str, Range<usize>)>, EffectFileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.get_ref() {
            DeValue::String(text) if text.trim().is_empty() => {
                Err(self.error(value.span(), format!("`{name}` is empty"), format!("write `{example}`")))
            }
            DeValue::String(text) => Ok(Some((text.as_ref(), value.span()))),
            _ => Err(self.wrong_type(name, value, "text in quotes", example)),
        }
    }

    /// A table inside this one.
    pub(crate) fn table(
        &self,
        entry: &Entry<'a>,
        title: String,
        example: &str,
    ) -> Result<Table<'a>, EffectFileError> {
        let (name, key, value) = entry;
        let DeValue::Table(entries) = value.get_ref() else {
            return Err(self.wrong_type(name, value, "a table", example));
        };
        // A table made by dotted keys has no place of its own, so the place of its name is used.
        Ok(Table { text: self.text, origin: self.origin, title, span: key.clone(), entries })
    }

    /// The place in the file of some bytes of a text value. It is the whole value if that was written with
    /// escapes.
    pub(crate) fn inside(&self, value: &str, place: &Range<usize>, part: Range<usize>) -> Range<usize> {
        let written = self.text.get(place.clone()).unwrap_or("");
        let quotes = if written.starts_with("\"\"\"") || written.starts_with("'''") { 3 } else { 1 };
        let body = written.get(quotes..).unwrap_or("");
        // A line break directly after three quotes doesn't belong to the text.
        let skipped = if quotes == 3 && body.starts_with("\r\n") {
            2
        } else {
            usize::from(quotes == 3 && body.starts_with('\n'))
        };
        if body.get(skipped..).is_some_and(|rest| rest.starts_with(value)) {
            let start = place.start + quotes + skipped;
            start + part.start..start + part.end
        } else {
            place.clone()
        }
    }
}
