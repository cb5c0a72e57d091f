//! What is wrong with a muscle file: one complete message, with the line, a caret under the place, and what
//! to write.

use crate::shown::is_shown;
use std::fmt;
use std::ops::Range;
use thiserror::Error;

/// What is wrong with a muscle file. Its `Display` is the whole message:
///
/// ```text
/// muscle.toml:3:10: `110` has no unit: write a length such as "110 mm" (known: m, cm, mm, um, in, inch)
///   |
/// 3 | length = 110
///   |          ^^^
///   = write `length = "110 mm"`
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub struct FileError {
    origin: String,
    place: Option<Box<Place>>,
    what: String,
    instead: String,
}

/// The place in the file, and the line as it is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Place {
    line: usize,
    column: usize,
    shown: String,
    caret_at: usize,
    caret_width: usize,
}

/// How many characters of a long line are shown before the caret, and in all.
const BEFORE: usize = 60;
const SHOWN: usize = 110;

impl FileError {
    /// An error in the file as a whole: what is wrong, and what to do instead.
    #[must_use]
    pub fn whole(origin: &str, what: impl Into<String>, instead: impl Into<String>) -> Self {
        Self { origin: origin.to_owned(), place: None, what: what.into(), instead: instead.into() }
    }

    /// An error at a span of bytes in the text; any span has a place.
    #[must_use]
    pub fn at(
        origin: &str,
        text: &str,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> Self {
        let place = Some(Box::new(Place::new(text, span)));
        Self { place, ..Self::whole(origin, what, instead) }
    }

    /// The file, as it was named.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// The line, counted from 1; `None` if the file could not be read.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.line)
    }

    /// The column in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.column)
    }

    /// What is wrong, in one sentence.
    #[must_use]
    pub fn what(&self) -> &str {
        &self.what
    }

    /// What to write, or do, instead.
    #[must_use]
    pub fn instead(&self) -> &str {
        &self.instead
    }
}

impl Place {
    fn new(text: &str, span: Range<usize>) -> Self {
        let boundary = |at: usize| text.floor_char_boundary(at.min(text.len()));
        let start = boundary(span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let rest = &text[line_start..];
        let line_text = rest.split('\n').next().unwrap_or("").trim_end_matches('\r');
        let before = text[line_start..start].chars().count();
        let end = boundary(span.end).clamp(start, (line_start + line_text.len()).max(start));
        let skipped = before.saturating_sub(BEFORE);
        // What isn't shown takes one column, so that the caret stands under its place.
        let printable = |c: char| if is_shown(c) { c } else { ' ' };
        let shown: String = line_text.chars().skip(skipped).take(SHOWN).map(printable).collect();
        let caret_at = before - skipped;
        Self {
            line: text[..line_start].matches('\n').count() + 1,
            column: before + 1,
            caret_width: text[start..end].chars().count().clamp(1, (SHOWN - caret_at).max(1)),
            shown,
            caret_at,
        }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut margin = 1;
        match &self.place {
            None => write!(f, "{}: {}", self.origin, self.what)?,
            Some(place) => {
                let number = place.line.to_string();
                margin = number.len();
                let (indent, carets) = (" ".repeat(place.caret_at), "^".repeat(place.caret_width));
                writeln!(f, "{}:{}:{}: {}", self.origin, place.line, place.column, self.what)?;
                writeln!(f, "{:margin$} |", "")?;
                writeln!(f, "{number} | {}", place.shown)?;
                write!(f, "{:margin$} | {indent}{carets}", "")?;
            }
        }
        if self.instead.is_empty() {
            return Ok(());
        }
        let mut lines = self.instead.lines();
        write!(f, "\n{:margin$} = {}", "", lines.next().unwrap_or(""))?;
        lines.try_for_each(|line| write!(f, "\n{:margin$}   {line}", ""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_message() {
        let text = "name = \"x\"\r\n\tlength = 110 # \u{b5}\r\n";
        let at = text.find("110").unwrap();
        let error = FileError::at("m.toml", text, at..at + 3, "no unit", "write \"110 mm\"\nor \"0.11 m\"");
        let expected = "m.toml:2:11: no unit\n  |\n2 |  length = 110 # \u{b5}\n  |           ^^^\n  = write \"110 mm\"\n    or \"0.11 m\"";
        assert_eq!(error.to_string(), expected);
        assert_eq!((error.line(), error.column(), error.origin()), (Some(2), Some(11), "m.toml"));
        assert_eq!((error.what(), error.instead().lines().count()), ("no unit", 2));
    }

    #[test]
    fn columns_count_characters() {
        let text = "\u{b5}\u{b5}\u{b5} = 1";
        assert_eq!(FileError::at("m", text, 9..10, "", "").column(), Some(7));
    }

    #[test]
    fn any_span_has_a_place() {
        let long = format!("a = \"{}\"", "\u{e9}".repeat(5000));
        for text in ["", "\n", "a", "\u{e9}\u{e9}\n\u{e9}", &long] {
            for start in [0, 1, 2, 3, 70, 4000, usize::MAX] {
                for end in [0, 1, 5, 9000, usize::MAX] {
                    let message = FileError::at("m", text, start..end, "w", "i").to_string();
                    assert!(message.lines().all(|line| line.chars().count() <= SHOWN + 10), "{message}");
                    assert!(message.contains('^'));
                }
            }
        }
        let whole = FileError::whole("m", "no such file", "").to_string();
        assert_eq!(whole, "m: no such file");
    }
}
