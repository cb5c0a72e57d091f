//! Quotes user text in messages: short, on one line, printable.

use bulge_muscles::shown::shortened_to;

/// Longest quotation in characters.
const LONGEST: usize = 60;

/// At most [`LONGEST`] characters of a text, on one line, all of them shown.
pub(crate) fn quoted(text: &str) -> String {
    shortened_to(LONGEST, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_printable() {
        assert_eq!(quoted(" a\tb\u{0}\n"), "a b\u{fffd}");
        assert_eq!(quoted(&"x".repeat(500)).chars().count(), LONGEST + 1);
    }
}
