//! Where text leaves the program for a terminal: answers on standard output, messages on standard error.
//!
//! Files that a user gives, and their names, may have been written by anyone. What a terminal would obey instead of
//! showing it doesn't get there. Files that are written to standard output are not text of ours, and go as they are.

use bulge_muscles::shown::{is_shown, one_line, plain};
use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use crate::failure::wants_json;
use crate::files;

/// Most characters of a line of a message, and most of its lines.
const LONGEST_LINE: usize = 1000;
const MOST_LINES: usize = 300;

/// Writes the answer of a command to standard output: text, or a document that holds the same strings as before,
/// with escapes.
pub(crate) fn answer(text: &str) -> io::Result<()> {
    let shown = if wants_json() { escaped(text) } else { plain(text) };
    files::print(shown.as_bytes())
}

/// Writes a message to standard error. If this can't be written, nothing more can be done.
pub(crate) fn message(text: &str) {
    let _ = io::stderr().lock().write_all(bounded(&plain(text)).as_bytes());
}

/// The arguments of the command, none of which has a control character, because messages quote them: line breaks and
/// tabs between the parts of a text are blanks. Names of files can't be changed so.
///
/// # Errors
/// The argument with another control character, or with any in the name of a file.
pub(crate) fn arguments(given: impl Iterator<Item = OsString>) -> Result<Vec<OsString>, String> {
    let one = |argument: OsString| {
        let text = argument.to_string_lossy().into_owned();
        if !text.contains(char::is_control) {
            return Ok(argument);
        }
        let value = text.split_once('=').map_or("", |(_, value)| value);
        let is_file = [&*text, value].iter().any(|name| !name.is_empty() && Path::new(name).exists());
        if is_file || text.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t')) {
            return Err(text);
        }
        Ok(one_line(&text).into_owned().into())
    };
    given.map(one).collect()
}

/// A message with an end: long lines are cut, and so are many.
fn bounded(text: &str) -> Cow<'_, str> {
    let mut lines = text.split_inclusive('\n');
    let is_short = |line: &str| line.len() <= LONGEST_LINE || line.chars().nth(LONGEST_LINE).is_none();
    if text.split('\n').all(is_short) && text.matches('\n').count() <= MOST_LINES {
        return Cow::Borrowed(text);
    }
    let mut out = String::new();
    for line in lines.by_ref().take(MOST_LINES) {
        if is_short(line.trim_end_matches('\n')) {
            out.push_str(line);
        } else {
            out.extend(line.chars().take(LONGEST_LINE - 1));
            out.push_str("\u{2026}\n");
        }
    }
    match lines.count() {
        0 => {}
        // Writing to a String can't fail.
        more => _ = writeln!(out, "and {more} more lines"),
    }
    Cow::Owned(out)
}

/// A JSON document, in whose strings what isn't shown is escaped.
fn escaped(document: &str) -> Cow<'_, str> {
    let stays = |c: char| c == '\n' || is_shown(c);
    if document.chars().all(stays) {
        return Cow::Borrowed(document);
    }
    let mut out = String::with_capacity(document.len() + 64);
    for c in document.chars() {
        if stays(c) {
            out.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                let _ = write!(out, "\\u{unit:04x}");
            }
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_end() {
        assert_eq!(bounded("one\ntwo\n"), "one\ntwo\n");
        let wide = bounded(&"x".repeat(5000)).into_owned();
        assert_eq!((wide.chars().count(), wide.ends_with("x\u{2026}\n")), (LONGEST_LINE + 1, true));
        let long = bounded(&"x\n".repeat(1000)).into_owned();
        assert!(long.ends_with("x\nand 700 more lines\n"), "{long}");
    }

    #[test]
    fn a_document_says_the_same() {
        let hostile = "\u{7f}\u{9b}31m\u{202e}\u{feff}\u{e0041}\u{b5}";
        let document = serde_json::to_string_pretty(&[hostile]).unwrap();
        let shown = escaped(&document);
        assert!(shown.chars().all(|c| c == '\n' || is_shown(c)), "{shown}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&shown).unwrap(), [hostile]);
    }

    #[test]
    fn names_of_files_can_be_printed() {
        let folder = tempfile::tempdir().unwrap();
        let two_lines = folder.path().join("a\nb");
        std::fs::write(&two_lines, "").unwrap();
        let taken = |argument: &str| arguments(std::iter::once(argument.into())).ok();
        for refused in [
            "a\u{1b}[31m",
            "a\u{9b}",
            two_lines.to_str().unwrap(),
            &format!("--muscle={}", two_lines.display()),
        ] {
            assert_eq!(taken(refused), None, "{refused}");
        }
        for (given, found) in
            [("1 bar,\n\t2 bar", "1 bar,  2 bar"), ("force=F\u{fc}hler", "force=F\u{fc}hler"), ("", "")]
        {
            assert_eq!(taken(given), Some(vec![found.into()]));
        }
    }
}
