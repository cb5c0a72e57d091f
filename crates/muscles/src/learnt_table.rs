//! Learnt effects in a muscle file: every table of `[effects]` that is not one of the shape effects.

use crate::file_error::FileError;
use crate::learnt::{Learnt, LearntValue, Place, SourceFile, is_plain};
use crate::parameter::Parameter;
use crate::settings::{Setting, Settings};
use crate::shown::shortened;
use crate::units::any_with_width;
use std::ops::Range;
use std::sync::Arc;

impl Settings<'_> {
    /// The effects in the table `[effects]` that this crate doesn't know, in the order of the file.
    pub(crate) fn learnt(&self) -> Result<Vec<Learnt>, FileError> {
        let (origin, text) = self.source();
        let names =
            self.names().into_iter().filter(|(name, _)| Parameter::effects().all(|other| other != *name));
        let mut file: Option<Arc<SourceFile>> = None;
        let source = || Arc::new(SourceFile { origin: origin.to_owned(), text: text.to_owned() });
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
        let instead = format!("write its values below `[effects.{name}]`");
        let table = self.table_named(name, name.to_owned(), &[], instead)?;
        let (mut values, mut places) = (Vec::new(), Vec::new());
        for (key, key_span) in table.names() {
            self.check_word(key, &key_span)?;
            let Some(value) = table.get(key) else { continue };
            values.push(table.learnt_value(key, value)?);
            places.push(value.span());
        }
        let place = Place::new(Arc::clone(file), span.clone(), places);
        let learnt = Learnt::new(name, values).map(|effect| effect.at(place));
        learnt.map_err(|error| self.error(span, error.to_string(), "write each value as `key = \"4 N s\"`"))
    }

    fn check_word(&self, word: &str, span: &Range<usize>) -> Result<(), FileError> {
        if is_plain(word) {
            return Ok(());
        }
        let what = format!("`{}` can't name an effect or a value of one", shortened(word));
        Err(self.error(span.clone(), what, "write a word of letters a to z, digits, `-` and `_`"))
    }

    /// "4 N s", "4 N s +- 1 N s", or a plain number.
    pub(crate) fn learnt_value(&self, key: &str, value: Setting<'_>) -> Result<LearntValue, FileError> {
        let wrong = |what: String| {
            let instead = format!("write such as `{key} = \"4 N s\"` or `{key} = \"4 N s +- 1 N s\"`");
            self.error(value.span(), what, instead)
        };
        let Some(text) = value.number() else {
            let kind = if value.type_name() == "a number" { "not decimal" } else { value.type_name() };
            return Err(wrong(format!("`{key}` is {kind}, but must be a number with its unit")));
        };
        let (found, width) = any_with_width(text).map_err(|error| wrong(error.to_string()))?;
        Ok(LearntValue {
            key: key.to_owned(),
            si: found.si,
            dimension: found.dimension,
            unit: found.unit,
            width,
        })
    }
}
