//! The names of settings files, and their text, which must be small and UTF-8.

use crate::file_error::FileError;
use crate::settings::nearest;
use crate::shown::{LONGEST_NAME, shortened};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most bytes of a settings file.
pub(crate) const MOST_BYTES: usize = 1 << 20;

/// The names of a kind of settings file in messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileKind {
    /// The kind of file, such as "protocol".
    pub name: &'static str,
    /// A typical file name, such as "protocol.toml".
    pub file: &'static str,
    /// A line of such a file with a unit, such as `period = "50 s"`.
    pub line: &'static str,
}

impl FileKind {
    /// The text of such a file.
    ///
    /// # Errors
    /// If the file can't be read, is a folder, is larger than 1 MiB or is not UTF-8. The message is complete.
    pub fn read(self, path: &Path) -> Result<String, FileError> {
        let origin = path.display().to_string();
        let failed = |what: &str, instead: String| FileError::whole(&origin, what, instead);
        if path.is_dir() {
            let instead = format!("name a file in it, such as `{}`", path.join(self.file).display());
            return Err(failed(&format!("this is a directory, not {}", self.named()), instead));
        }
        let unreadable = |error: std::io::Error| match error.kind() {
            ErrorKind::NotFound => failed("there is no such file", similar_file(path)),
            ErrorKind::PermissionDenied => {
                failed("the file may not be read", "check its permissions, or copy it".to_owned())
            }
            _ => failed(
                &format!("the file cannot be read: {error}"),
                format!("name {}, such as `{}`", self.named(), self.file),
            ),
        };
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        // The size is checked before the encoding: a file that is cut off may end within a character.
        if bytes.len() > MOST_BYTES {
            return Err(self.too_large(&origin));
        }
        String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            // The bytes are valid up to there, so the replacement character stands exactly there.
            let text = String::from_utf8_lossy(error.as_bytes());
            let what = format!("byte {at} is not UTF-8 text");
            let instead = "save the file as plain text with the encoding UTF-8";
            FileError::at(&origin, &text, at..at + 1, what, instead)
        })
    }

    /// The tables of a text of at most 1 MiB.
    pub(crate) fn parse<'t>(self, text: &'t str, origin: &str) -> Result<Spanned<DeTable<'t>>, FileError> {
        if text.len() > MOST_BYTES {
            return Err(self.too_large(origin));
        }
        let table = DeTable::parse(text).map_err(|error| {
            let message = error.message().lines().collect::<Vec<_>>().join(", ");
            let span = error.span().unwrap_or(0..0);
            let instead = if message.contains("duplicate key") {
                "state each key once: delete one of the two, or put `#` before it".to_owned()
            } else {
                unquoted(text, span.start).unwrap_or_else(|| {
                    format!(
                        "each line is `key = value`, a `[table]` or a `# comment`; numbers with a unit stand in quotes: `{}`",
                        self.line
                    )
                })
            };
            FileError::at(origin, text, span, format!("this is not TOML: {message}"), instead)
        })?;
        match unprintable(table.get_ref()) {
            None => Ok(table),
            Some((span, what)) => {
                let instead = "delete it: names and texts are what can be printed";
                Err(FileError::at(origin, text, span, what, instead))
            }
        }
    }

    /// The kind with its article: "a muscle file".
    fn named(self) -> String {
        let article = if self.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {} file", self.name)
    }

    pub(crate) fn too_large(self, origin: &str) -> FileError {
        let what = format!("the file is larger than 1 MiB, so it is no {} file", self.name);
        let instead =
            format!("name {}: some ten lines of TOML (measured data go into a CSV file)", self.named());
        FileError::whole(origin, what, instead)
    }
}

/// The TOML file in the same folder whose name is nearest to the missing one.
fn similar_file(path: &Path) -> String {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let listed = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let mut names: Vec<String> = listed.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| Path::new(name).extension().is_some_and(|extension| extension == "toml"));
    names.retain(|name| !name.contains(char::is_control));
    names.sort();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    match nearest(&wanted, names.iter().map(String::as_str)) {
        Some(name) => format!("did you mean `{}`?", directory.join(name).display()),
        None => "check the path and the working directory".to_owned(),
    }
}

/// The first key that is no name, or text with a control character, which an escape such as `\u001b` can write.
/// A text of several lines has line breaks.
fn unprintable(table: &DeTable<'_>) -> Option<(Range<usize>, String)> {
    table.iter().find_map(|(key, value)| {
        let name = key.get_ref();
        if name.contains(char::is_control) || name.len() > LONGEST_NAME {
            let what =
                format!("the key `{}` has control characters, or is too long for a name", shortened(name));
            return Some((key.span(), what));
        }
        unprintable_in(value)
    })
}

fn unprintable_in(value: &Spanned<DeValue<'_>>) -> Option<(Range<usize>, String)> {
    match value.get_ref() {
        DeValue::String(text) => {
            let control = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t'))?;
            Some((value.span(), format!("a text has the control character U+{:04X}", u32::from(control))))
        }
        DeValue::Array(items) => items.iter().find_map(unprintable_in),
        DeValue::Table(table) => unprintable(table),
        _ => None,
    }
}

/// The commonest slip: `length = 110 mm` without quotes.
fn unquoted(text: &str, at: usize) -> Option<String> {
    let start = text.floor_char_boundary(at.min(text.len()));
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let (key, value) = text[line_start..].lines().next()?.split_once('=')?;
    let (key, value) = (key.trim(), value.split('#').next()?.trim());
    let is_bare = !value.is_empty() && !value.contains(['"', '\'', '{', '[', '=']);
    let is_word = (1..=64).contains(&key.len())
        && key.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
    (is_bare && is_word).then(|| format!("put text in quotes: `{key} = \"{}\"`", shortened(value)))
}
