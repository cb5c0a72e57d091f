//! Settings files: tables of TOML with the place of every key, values with units, and a cure for each
//! mistake.

mod setting;

use crate::dimension::Dimension;
use crate::file::read;
use crate::file_error::FileError;
pub use crate::file_kind::FileKind;
use crate::muscle::Muscle;
use crate::presets::{PRESETS, PresetError, preset};
use crate::shown::{LONGEST_NAME, shortened};
use crate::units::{self, Quantity, UnitError};
use std::borrow::Cow;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys of a table, each with a line that shows how it is written.
pub type Keys = &'static [(&'static str, &'static str)];
/// What to write instead, from the name of a key and the text of its value.
type Elsewhere = fn(&str, Option<&str>) -> Option<String>;

/// A parsed settings file.
///
/// ```
/// use bulge_muscles::{Dimension, settings::{Document, FileKind}};
///
/// let kind = FileKind { name: "recipe", file: "recipe.toml", line: "time = \"50 s\"" };
/// let document = Document::parse(kind, "time = \"1 min\"", "recipe.toml")?;
/// let settings = document.settings("the recipe", &[("time", "time = \"50 s\"")]);
/// settings.check_keys()?;
/// assert_eq!(settings.quantity("time", Dimension::TIME)?, Some(60.0));
/// # Ok::<(), bulge_muscles::FileError>(())
/// ```
#[derive(Debug)]
pub struct Document<'t> {
    origin: &'t str,
    text: &'t str,
    root: Spanned<DeTable<'t>>,
}

/// One table of a settings file.
#[derive(Debug, Clone)]
pub struct Settings<'a> {
    origin: &'a str,
    text: &'a str,
    title: Cow<'a, str>,
    span: Range<usize>,
    entries: &'a DeTable<'a>,
    keys: Keys,
}

/// One value of a settings file, with its place.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    value: &'a Spanned<DeValue<'a>>,
}

impl<'t> Document<'t> {
    /// Parses TOML text. `origin` is the name of the text in messages, usually a file name.
    ///
    /// # Errors
    /// If the text is larger than 1 MiB or is not TOML.
    pub fn parse(kind: FileKind, text: &'t str, origin: &'t str) -> Result<Self, FileError> {
        Ok(Self { origin, text, root: kind.parse(text, origin)? })
    }

    /// The top of the file, with its name in messages and the keys that it may have.
    #[must_use]
    pub fn settings(&self, title: &'static str, keys: Keys) -> Settings<'_> {
        Settings {
            origin: self.origin,
            text: self.text,
            title: title.into(),
            span: 0..0,
            entries: self.root.get_ref(),
            keys,
        }
    }
}

impl<'a> Settings<'a> {
    /// The same table under another name, with the place of a key as its own.
    #[must_use]
    pub(crate) fn called(self, title: String, key: &str) -> Self {
        let span = self.value_span(key);
        Settings { title: title.into(), ..self.at(span) }
    }

    /// The same table with another place for what is missing in it.
    #[must_use]
    pub fn at(self, span: Range<usize>) -> Self {
        Settings { span, ..self }
    }

    /// Its name in messages.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The name and the text of the file.
    pub(crate) fn source(&self) -> (&'a str, &'a str) {
        (self.origin, self.text)
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Setting<'a>> {
        let found = self.entries.iter().find(|(key, _)| key.get_ref() == name);
        found.map(|(_, value)| Setting { value })
    }

    /// The keys with their places, in the order of the file.
    #[must_use]
    pub fn names(&self) -> Vec<(&'a str, Range<usize>)> {
        let mut names: Vec<_> = self.entries.keys().map(|key| (key.get_ref().as_ref(), key.span())).collect();
        names.sort_by_key(|(_, span): &(&str, _)| span.start);
        names
    }

    /// Refuses keys that the table doesn't have.
    ///
    /// # Errors
    /// Names the first one in the file, with the nearest key that there is.
    pub fn check_keys(&self) -> Result<(), FileError> {
        self.check_keys_or(|_, _| None)
    }

    /// The same. `elsewhere` may know what to write instead of a key that resembles none of the table.
    pub(crate) fn check_keys_or(&self, elsewhere: Elsewhere) -> Result<(), FileError> {
        let known = || self.keys.iter().map(|(key, _)| *key);
        let stranger = self.names().into_iter().find(|(name, _)| known().all(|key| key != *name));
        let Some((name, span)) = stranger else { return Ok(()) };
        let near = nearest(name, known()).map(|near| format!("did you mean `{near}`?"));
        let text = self.get(name).and_then(Setting::text);
        let known = known().collect::<Vec<_>>().join(", ");
        let others = || format!("known here: {known}; leave the rest out, or write it behind a `#`");
        let instead = near.or_else(|| elsewhere(name, text)).unwrap_or_else(others);
        Err(self.error(span, format!("unknown key `{}` in {}", shortened(name), self.title), instead))
    }

    /// A quantity of a type, in SI; 0 if it is absent.
    ///
    /// # Errors
    /// If the value is no such quantity.
    pub fn size<Q: Quantity>(&self, name: &str) -> Result<f64, FileError> {
        Ok(self.parsed(name, units::parse::<Q>)?.map_or(0.0, Quantity::si))
    }

    /// The result of `parse` for a number with its unit.
    pub(crate) fn parsed<T>(
        &self,
        name: &str,
        parse: impl Fn(&str) -> Result<T, UnitError>,
    ) -> Result<Option<T>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let text = self.number(name, value)?;
        parse(text).map(Some).map_err(|error| self.unreadable(name, value, error))
    }

    /// A quantity of a dimension, in SI.
    ///
    /// # Errors
    /// If the value is no such quantity.
    pub fn quantity(&self, name: &str, dimension: Dimension) -> Result<Option<f64>, FileError> {
        self.get(name).map(|value| self.quantity_of(name, value, dimension)).transpose()
    }

    /// The same for a value within that of a key.
    ///
    /// # Errors
    /// If the value is no such quantity.
    pub fn quantity_of(
        &self,
        name: &str,
        value: Setting<'a>,
        dimension: Dimension,
    ) -> Result<f64, FileError> {
        let found =
            units::any(self.number(name, value)?).map_err(|error| self.unreadable(name, value, error))?;
        if found.dimension == dimension {
            return Ok(found.si);
        }
        let what =
            format!("`{name}` is {}, but must be {}", found.dimension.describe(), dimension.describe());
        Err(self.unreadable(name, value, what))
    }

    fn number(&self, name: &str, value: Setting<'a>) -> Result<&'a str, FileError> {
        value.number().ok_or_else(|| self.wrong_type(name, value, "text with a number and a unit"))
    }

    /// A whole number.
    ///
    /// # Errors
    /// If the value is no whole number, or is negative or too large for the type.
    pub fn count<N: TryFrom<u64>>(&self, name: &str) -> Result<Option<N>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let refused = || self.wrong_type(name, value, "a whole number, 1 or more");
        let number = value.whole().and_then(|number| N::try_from(number).ok());
        number.map(Some).ok_or_else(refused)
    }

    /// Yes or no: `true` or `false`.
    ///
    /// # Errors
    /// If the value is something else.
    pub fn flag(&self, name: &str) -> Result<Option<bool>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.value.get_ref() {
            DeValue::Boolean(flag) => Ok(Some(*flag)),
            _ => Err(self.wrong_type(name, value, "`true` or `false`")),
        }
    }

    /// Text in quotes, on one line.
    ///
    /// # Errors
    /// If the value is something else, or longer than a name can be.
    pub fn text(&self, name: &str) -> Result<Option<&'a str>, FileError> {
        let (Some(value), Some(text)) = (self.get(name), self.lines(name)?) else { return Ok(None) };
        if text.contains(char::is_control) {
            let what = format!("`{name}` has a line break or a tab");
            return Err(self.error(value.span(), what, "write it on one line, with blanks"));
        }
        if text.len() > LONGEST_NAME {
            let what = format!("`{name}` is longer than {LONGEST_NAME} bytes");
            return Err(self.error(value.span(), what, "shorten it, or write the rest behind a `#`"));
        }
        Ok(Some(text))
    }

    /// Text in quotes, of any length and number of lines.
    ///
    /// # Errors
    /// If the value is something else.
    pub fn lines(&self, name: &str) -> Result<Option<&'a str>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        value.text().map(Some).ok_or_else(|| self.wrong_type(name, value, "text in quotes"))
    }

    /// One word of a list.
    ///
    /// # Errors
    /// If the value is another word. The message names the nearest word, else all of them.
    pub fn word<T: Copy>(&self, name: &str, known: &[(&str, T)]) -> Result<Option<T>, FileError> {
        self.word_or(name, known, &[])
    }

    /// The same. Words in `also` are not accepted, but answered with the right one.
    pub(crate) fn word_or<'w, T: Copy>(
        &self,
        name: &str,
        known: &[(&'w str, T)],
        also: &[(&str, &'w str)],
    ) -> Result<Option<T>, FileError> {
        let (Some(value), Some(text)) = (self.get(name), self.text(name)?) else { return Ok(None) };
        if let Some((_, found)) = known.iter().find(|(word, _)| *word == text) {
            return Ok(Some(*found));
        }
        let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        let meant = also.iter().find(|(word, _)| text.eq_ignore_ascii_case(word)).map(|(_, word)| *word);
        let likely =
            meant.or_else(|| nearest(text, words.iter().copied())).map_or(words.clone(), |w| vec![w]);
        let lines: Vec<String> = likely.iter().map(|word| format!("`{name} = \"{word}\"`")).collect();
        let what = format!("`{name}` is \"{}\", but must be one of: {}", shortened(text), words.join(", "));
        Err(self.error(value.span(), what, format!("write {}", lines.join(" or "))))
    }

    /// The muscle that a key names: a muscle file in `folder`, or a shipped muscle where no file of that name
    /// exists.
    ///
    /// # Errors
    /// If the key is absent, or names no muscle, or its file can't be read.
    pub fn muscle(&self, name: &str, folder: Option<&Path>) -> Result<Muscle, FileError> {
        let named = self.text(name)?.ok_or_else(|| self.missing(name))?;
        let path = folder.map_or_else(|| named.into(), |folder| folder.join(named));
        let is_shipped = PRESETS.iter().any(|preset| preset.name == named);
        let looks_like_a_name = !named.contains(['/', '.', '\\']);
        if !(is_shipped || looks_like_a_name) || (path.exists() && !named.is_empty()) {
            return read(path);
        }
        preset(named).map_err(|error| match error {
            PresetError::File(error) => error,
            PresetError::Unknown { name: unknown, instead } => {
                let what = format!("`{unknown}` is neither a muscle file nor a shipped muscle");
                self.error(self.value_span(name), what, instead)
            }
        })
    }

    /// A table within this one, with its name in messages and the keys that it may have.
    ///
    /// # Errors
    /// If the value is no table.
    pub fn table(
        &self,
        name: &str,
        title: impl Into<Cow<'a, str>>,
        keys: Keys,
    ) -> Result<Option<Self>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let DeValue::Table(entries) = value.value.get_ref() else {
            return Err(self.wrong_type(name, value, "a table"));
        };
        Ok(Some(self.inner(value.span(), entries, title.into(), keys)))
    }

    /// A table whose name isn't among the keys, because the file chooses it. `instead` says how it is written.
    ///
    /// # Errors
    /// If the value is no table.
    pub fn table_named(
        &self,
        name: &str,
        title: impl Into<Cow<'a, str>>,
        keys: Keys,
        instead: impl Into<String>,
    ) -> Result<Self, FileError> {
        self.table(name, title, keys).ok().flatten().ok_or_else(|| {
            let kind = self.get(name).map_or("nothing", Setting::type_name);
            let what = format!("`{}` is {kind}, but must be a table", shortened(name));
            self.error(self.value_span(name), what, instead)
        })
    }

    /// An array of tables, such as `[[block]]`, with the name of each in messages and the keys that it may
    /// have.
    ///
    /// # Errors
    /// If the value is no array of tables.
    pub fn tables(
        &self,
        name: &str,
        title: &'static str,
        keys: Keys,
    ) -> Result<Option<Vec<Self>>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let refused = || self.wrong_type(name, value, "an array of tables");
        let DeValue::Array(items) = value.value.get_ref() else { return Err(refused()) };
        let one = |item: &'a Spanned<DeValue<'a>>| {
            let DeValue::Table(entries) = item.get_ref() else { return Err(refused()) };
            Ok(self.inner(item.span(), entries, title.into(), keys))
        };
        items.iter().map(one).collect::<Result<_, _>>().map(Some)
    }

    fn inner(&self, span: Range<usize>, entries: &'a DeTable<'a>, title: Cow<'a, str>, keys: Keys) -> Self {
        Settings { origin: self.origin, text: self.text, title, span, entries, keys }
    }

    /// The place of a key, or of the table if the key is absent.
    #[must_use]
    pub fn key_span(&self, name: &str) -> Range<usize> {
        let key = self.entries.keys().find(|key| key.get_ref() == name);
        key.map_or_else(|| self.span.clone(), Spanned::span)
    }

    /// The place of a value, or of the table if the value is absent.
    #[must_use]
    pub fn value_span(&self, name: &str) -> Range<usize> {
        self.get(name).map_or_else(|| self.span.clone(), Setting::span)
    }

    /// The place of some bytes of a text: the whole value if it was written with escapes.
    #[must_use]
    pub fn inside(&self, value: Setting<'_>, part: Range<usize>) -> Range<usize> {
        let place = value.span();
        let written = self.text.get(place.clone()).unwrap_or("");
        let quotes = if written.starts_with("\"\"\"") || written.starts_with("'''") { 3 } else { 1 };
        let body = written.get(quotes..).unwrap_or("");
        // A line break directly after three quotes doesn't belong to the text.
        let breaks = ["\r\n", "\n"].into_iter().filter(|_| quotes == 3);
        let skipped =
            breaks.filter(|line_break| body.starts_with(line_break)).map(str::len).next().unwrap_or(0);
        if value.text().is_some_and(|text| body[skipped..].starts_with(text)) {
            let start = place.start + quotes + skipped;
            start + part.start..start + part.end
        } else {
            place
        }
    }

    /// The place of a dotted path, or of the last table on the way to it.
    pub(crate) fn place(&self, path: &str) -> Range<usize> {
        let (mut table, mut span) = (self.entries, self.span.clone());
        for name in path.split('.') {
            let Some((_, value)) = table.iter().find(|(key, _)| key.get_ref() == name) else { break };
            span = value.span();
            let DeValue::Table(inner) = value.get_ref() else { break };
            table = inner;
        }
        span
    }

    /// An error at a place: what is wrong, and what to write instead.
    #[must_use]
    pub fn error(
        &self,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> FileError {
        FileError::at(self.origin, self.text, span, what, instead)
    }

    /// An error in the value of a key, with the line that shows how the key is written.
    #[must_use]
    pub fn unreadable(&self, name: &str, value: Setting<'_>, what: impl Display) -> FileError {
        self.error(value.span(), what.to_string(), self.write(name))
    }

    /// An error for a value of another type than `wanted`.
    #[must_use]
    pub fn wrong_type(&self, name: &str, value: Setting<'_>, wanted: &str) -> FileError {
        self.unreadable(name, value, format!("`{name}` is {}, but must be {wanted}", value.type_name()))
    }

    /// An error for a missing key that the table needs.
    #[must_use]
    pub fn missing(&self, name: &str) -> FileError {
        let what = format!("{} needs `{name}`, which is missing", self.title);
        self.error(self.span.clone(), what, self.write(name).replacen("write", "add", 1))
    }

    fn write(&self, name: &str) -> String {
        let table = if self.title.starts_with("`[") { format!(" in {}", self.title) } else { String::new() };
        format!("write such as `{}`{table}", self.example(name))
    }

    /// The line that shows how a key is written.
    #[must_use]
    pub fn example(&self, name: &str) -> &'static str {
        self.keys.iter().find(|(key, _)| *key == name).map_or("", |(_, example)| example)
    }
}

/// The name that was probably meant: a slip or two away apart from case and hyphens, or with this beginning.
pub fn nearest<'n>(word: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let (word, names) = (plain(word), names.collect::<Vec<_>>());
    let length = word.chars().count();
    let slips = |name: &str| strsim::damerau_levenshtein(&plain(name), &word);
    let closest = names.iter().min_by_key(|name| slips(name)).filter(|name| slips(name) <= length / 3);
    closest.or_else(|| names.iter().find(|name| length >= 4 && plain(name).starts_with(&word))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file_kind::MOST_BYTES;
    use crate::quantity::Length;

    const KIND: FileKind = FileKind { name: "recipe", file: "recipe.toml", line: "time = \"50 s\"" };
    const KEYS: Keys = &[
        ("time", "time = \"50 s\""),
        ("depth", "depth = \"2 mm\""),
        ("count", "count = 3"),
        ("name", "name = \"cake\""),
        ("step", "[[step]]"),
        ("oven", "[oven]"),
    ];

    #[track_caller]
    fn refused<T: std::fmt::Debug>(found: Result<T, FileError>, parts: &[&str]) {
        let message = found.unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[test]
    fn values_of_every_type() {
        let text = "time = \"2 min\"\ndepth = \"3 mm\"\ncount = 0x10\nname = \"cake\"\nstep = [{time = \"1 s\"}, {}]\noven = {depth = \"1 m\"}\n";
        let document = Document::parse(KIND, text, "r.toml").unwrap();
        let top = document.settings("the recipe", KEYS);
        top.check_keys().unwrap();
        assert_eq!(top.quantity("time", Dimension::TIME).unwrap(), Some(120.0));
        assert_eq!(
            (top.size::<Length>("depth").unwrap(), top.size::<Length>("width").unwrap()),
            (0.003, 0.0)
        );
        assert_eq!((top.count::<u32>("count").unwrap(), top.count::<u8>("x").unwrap()), (Some(16), None));
        assert_eq!(top.text("name").unwrap(), Some("cake"));
        assert_eq!(top.word("name", &[("pie", 1), ("cake", 2)]).unwrap(), Some(2));
        let steps = top.tables("step", "this `[[step]]`", KEYS).unwrap().unwrap();
        assert_eq!(steps.len(), 2);
        assert_eq!(steps[0].quantity("time", Dimension::TIME).unwrap(), Some(1.0));
        let oven = top.table("oven", "`[oven]`", KEYS).unwrap().unwrap();
        assert_eq!(oven.size::<Length>("depth"), Ok(1.0));
        assert!(top.names().iter().zip(KEYS).all(|((name, _), (key, _))| name == key));
        let oven = top.get("oven").unwrap();
        assert_eq!((oven.type_name(), oven.entries().unwrap()[0].0), ("a table", "depth"));
        assert_eq!(
            (&text[oven.span()], &text[top.key_span("oven")], top.key_span("x")),
            ("{depth = \"1 m\"}", "oven", 0..0)
        );
    }

    #[test]
    fn mistakes_have_a_place_and_a_cure() {
        let refuses = |text: &str, parts: &[&str], read: &dyn Fn(&Settings<'_>) -> Result<(), FileError>| {
            let document = Document::parse(KIND, text, "r.toml").unwrap();
            refused(read(&document.settings("the recipe", KEYS)), parts);
        };
        let time = |s: &Settings<'_>| s.quantity("time", Dimension::TIME).map(drop);
        refuses(
            "tmie = 1",
            &["r.toml:1:1", "unknown key `tmie` in the recipe", "did you mean `time`?"],
            &|s| s.check_keys(),
        );
        refuses("xyz = 1", &["known here: time, depth"], &|s| s.check_keys());
        refuses("time = 40", &["r.toml:1:8", "a pure number, but must be a time", "time = \"50 s\""], &time);
        refuses("time = 0x40", &["`time` is a number, but must be text with a number and a unit"], &time);
        refuses("time = \"4 zs\"", &["r.toml:1:8", "unknown unit", "50 s"], &time);
        refuses("depth = \"4 s\"", &["r.toml:1:9", "depth = \"2 mm\""], &|s| {
            s.size::<Length>("depth").map(drop)
        });
        for count in ["-1", "2.5", "\"3\"", "300"] {
            let text = format!("count = {count}");
            refuses(&text, &["r.toml:1:9", "but must be a whole number", "count = 3"], &|s| {
                s.count::<u8>("count").map(drop)
            });
        }
        refuses("name = \"pi\"", &["one of: pie, cake", "write `name = \"pie\"`"], &|s| {
            s.word("name", &[("pie", 1), ("cake", 2)]).map(drop)
        });
        refuses("name = 3", &["text in quotes"], &|s| s.word("name", &[("pie", 1)]).map(drop));
        refuses("step = 3", &["an array of tables", "[[step]]"], &|s| s.tables("step", "", KEYS).map(drop));
        refuses("step = [3]", &["an array of tables"], &|s| s.tables("step", "", KEYS).map(drop));
        refuses("oven = true", &["is true or false, but must be a table"], &|s| {
            s.table("oven", "", KEYS).map(drop)
        });
        refuses("", &["the recipe needs `time`", "add such as `time = \"50 s\"`"], &|s| {
            Err(s.missing("time"))
        });
        refused(Document::parse(KIND, "time = 5 s", "r.toml"), &["r.toml:1:", "not TOML", "in quotes"]);
    }

    #[test]
    fn only_small_text_files_are_read() {
        let folder = std::env::temp_dir().join(format!("bulge-settings-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("r.toml");
        refused(KIND.read(&folder), &["a directory, not a recipe file", "recipe.toml`"]);
        refused(KIND.read(&path), &["no such file", "check the path"]);
        std::fs::write(&path, b"a\xff").unwrap();
        refused(KIND.read(&path), &["byte 1 is not UTF-8"]);
        std::fs::write(&path, "\u{e9}".repeat(MOST_BYTES)).unwrap();
        refused(KIND.read(&path), &["larger than 1 MiB, so it is no recipe"]);
        std::fs::write(&path, "x = 1").unwrap();
        assert_eq!(KIND.read(&path).unwrap(), "x = 1");
        std::fs::remove_dir_all(&folder).unwrap();
        let long = " ".repeat(MOST_BYTES + 1);
        refused(Document::parse(KIND, &long, "r"), &["larger than 1 MiB", "some ten lines"]);
        assert!(Document::parse(KIND, &long[1..], "r").is_ok());
    }

    #[test]
    fn the_nearest_name() {
        let names = || ["fibre_stiffness", "coulomb-friction.force", "radius"].into_iter();
        assert_eq!(nearest("Fibre-Stifness", names()), Some("fibre_stiffness"));
        assert_eq!(nearest("coulomb friction.force", names()), Some("coulomb-friction.force"));
        assert_eq!(nearest("pressure", names()), None);
        assert_eq!(shortened(&"x".repeat(50)).chars().count(), 41);
    }
}
