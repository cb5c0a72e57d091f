//! What is shown of text that others wrote: names, cells, comments, names of files.
//!
//! A terminal obeys some characters instead of showing them, and others change the order of what stands around
//! them or can't be seen. A message shows none of these, is on the lines that we gave it, and ends.

use std::borrow::Cow;
use std::fmt::Display;

/// Most bytes of a name in a file: of a key or a text on one line of settings, of a label of a row.
pub const LONGEST_NAME: usize = 1000;

/// Whether a terminal shows a character, and in its place: it is no control character, no line separator,
/// doesn't turn the direction of writing, and isn't of no width.
#[must_use]
pub fn is_shown(c: char) -> bool {
    !c.is_control()
        && !matches!(
            c,
            '\u{ad}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}'
            | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}'
            | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}'
        )
}

/// The character, if it is shown; a blank for other white space, and U+FFFD for what remains.
fn shown(c: char) -> char {
    match c {
        c if is_shown(c) => c,
        c if c.is_whitespace() => ' ',
        _ => '\u{fffd}',
    }
}

/// A text of any length and number of lines, for a terminal.
#[must_use]
pub fn plain(text: &str) -> Cow<'_, str> {
    if text.chars().all(|c| c == '\n' || is_shown(c)) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|c| if c == '\n' { c } else { shown(c) }).collect())
}

/// A name as it is kept: on one line. Others may have written line breaks and other control characters into it,
/// which become blanks.
#[must_use]
pub fn one_line(name: &str) -> Cow<'_, str> {
    if name.contains(char::is_control) {
        Cow::Owned(name.replace(char::is_control, " "))
    } else {
        Cow::Borrowed(name)
    }
}

/// A quotation for a message: at most 40 characters, on one line, all of them shown.
#[must_use]
pub fn shortened(text: &str) -> String {
    shortened_to(40, text)
}

/// As [`shortened`], of at most so many characters.
#[must_use]
pub fn shortened_to(most: usize, text: &str) -> String {
    let text = text.trim();
    let mut out: String = text.chars().take(most).map(shown).collect();
    if text.chars().nth(most).is_some() {
        out.push('\u{2026}');
    }
    out
}

/// A list for a message: at most so many names, each shortened and between `quote`, and how many more there
/// are.
///
/// ```
/// use bulge_muscles::shown::listed;
///
/// assert_eq!(listed(2, "`", ["a", "b", "c", "d"]), "`a`, `b` and 2 more");
/// assert_eq!(listed(2, "", ["a", "b"]), "a, b");
/// ```
#[must_use]
pub fn listed<N: AsRef<str>>(most: usize, quote: impl Display, names: impl IntoIterator<Item = N>) -> String {
    let mut names = names.into_iter();
    let shown: Vec<String> = names
        .by_ref()
        .take(most)
        .map(|name| format!("{quote}{}{quote}", shortened_to(60, name.as_ref())))
        .collect();
    let more = match names.count() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    shown.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Escape sequences, what rings or returns, and what can't be seen or turns the writing.
    const HOSTILE: &str =
        "a\u{1b}[31m\u{7}\r\0\u{9b}\u{7f}\u{202e}\u{2066}\u{200b}\u{feff}\u{2028}\u{e0041}b";

    #[test]
    fn a_terminal_shows_all_that_is_printed() {
        let expected =
            "a\u{fffd}[31m\u{fffd} \u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd} \u{fffd}b";
        assert_eq!(shortened(HOSTILE), expected);
        assert_eq!(plain(&format!("{HOSTILE}\n\tc")), format!("{expected}\n c"));
        assert!(!one_line(HOSTILE).contains(char::is_control));
    }

    #[test]
    fn what_people_write_stays() {
        for text in [
            "Länge ε₀ [µm] ±0,1 °C",
            "Länge in two characters",
            "סרט بالون 筋肉 मांसपेशी",
            "1\u{a0}000\u{202f}N",
        ] {
            assert!(matches!(plain(text), Cow::Borrowed(_)), "{text}");
            assert_eq!(shortened(text), text);
            assert_eq!(one_line(text), text);
        }
    }

    #[test]
    fn quotations_and_lists_end() {
        assert_eq!(shortened(&"x".repeat(10_000_000)), format!("{}\u{2026}", "x".repeat(40)));
        assert_eq!(listed(1, "`", [HOSTILE, "b"]), format!("`{}` and 1 more", shortened(HOSTILE)));
        let names = (0..100_000).map(|n| n.to_string());
        assert_eq!(listed(3, "", names), "0, 1, 2 and 99997 more");
    }
}
