//! Learnt effects in a muscle file: every table of `[effects]` that is not one of the shape effects.

use crate::file_error::FileError;
use crate::keys;
use crate::learnt::{Learnt, LearntValue, Place, SHAPE_EFFECTS, SourceFile, is_plain};
use crate::table::{Table, type_of};
use crate::units::{any_with_width, shortened};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::DeValue;

impl<'a> Table<'a> {
    /// The effects in the table `[effects]` that this crate doesn't know, in the order of the file.
    pub(crate) fn learnt(&self) -> Result<Vec<Learnt>, FileError> {
        let names = self.names().into_iter().filter(|(name, _)| !SHAPE_EFFECTS.contains(name));
        let mut file: Option<Arc<SourceFile>> = None;
        let source = || {
            let (origin, text) = (self.document.origin.to_owned(), self.document.text.to_owned());
            Arc::new(SourceFile { origin, text })
        };
        names
            .map(|(name, span)| {
                let file = file.get_or_insert_with(source);
                self.one_learnt(name, span, file)
            })
            .collect()
    }

    fn one_learnt(
        &self,
        name: &str,
        span: Range<usize>,
        file: &Arc<SourceFile>,
    ) -> Result<Learnt, FileError> {
        self.check_word(name, &span)?;
        let Some(value) = self.get(name) else { return Err(self.missing(name)) };
        let DeValue::Table(entries) = value.get_ref() else {
            let what = format!("`{name}` is {}, but must be a table", type_of(value.get_ref()));
            let instead = format!("write its values below `[effects.{name}]`");
            return Err(self.document.error(value.span(), what, instead));
        };
        let path = keys::join(&self.path, name);
        let table = Table { document: self.document, path, span: span.clone(), entries };
        let (mut values, mut places) = (Vec::new(), Vec::new());
        for (key, key_span) in table.names() {
            self.check_word(key, &key_span)?;
            let Some(value) = table.get(key) else { continue };
            values.push(table.learnt_value(key, value)?);
            places.push(value.span());
        }
        let place = Place::new(Arc::clone(file), span.clone(), places);
        let learnt = Learnt::new(name, values).map(|effect| effect.at(place));
        learnt.map_err(|error| {
            self.document.error(span, error.to_string(), "write each value as `key = \"4 N s\"`")
        })
    }

    fn check_word(&self, word: &str, span: &Range<usize>) -> Result<(), FileError> {
        if is_plain(word) {
            return Ok(());
        }
        let what = format!("`{}` can't name an effect or a value of one", shortened(word));
        Err(self.document.error(span.clone(), what, "write a word of letters a to z, digits, `-` and `_`"))
    }

    /// "4 N s", "4 N s +- 1 N s", or a plain number.
    fn learnt_value(&self, key: &str, value: &Spanned<DeValue<'a>>) -> Result<LearntValue, FileError> {
        let instead = || format!("write such as `{key} = \"4 N s\"` or `{key} = \"4 N s +- 1 N s\"`");
        let text = match value.get_ref() {
            DeValue::String(text) => text.as_ref(),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            other => {
                let kind = if matches!(other, DeValue::Integer(_)) { "not decimal" } else { type_of(other) };
                let what = format!("`{key}` is {kind}, but must be a number with its unit");
                return Err(self.document.error(value.span(), what, instead()));
            }
        };
        match any_with_width(text) {
            Ok((found, width)) => Ok(LearntValue {
                key: key.to_owned(),
                si: found.si,
                dimension: found.dimension,
                unit: found.unit,
                width,
            }),
            Err(error) => Err(self.document.error(value.span(), error.to_string(), instead())),
        }
    }
}
