//! Quotes user text in messages: short, on one line, printable.

/// Longest quotation in characters.
const LONGEST: usize = 60;

/// At most [`LONGEST`] characters of a text, without control characters.
pub(crate) fn quoted(text: &str) -> String {
    let printable = |c: char| if c.is_control() || c == '\u{feff}' { '\u{fffd}' } else { c };
    let trimmed = text.trim();
    let mut out: String = trimmed.chars().take(LONGEST).map(printable).collect();
    if trimmed.chars().nth(LONGEST).is_some() {
        out.push('\u{2026}');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_printable() {
        assert_eq!(quoted(" a\tb\u{0}\n"), "a\u{fffd}b\u{fffd}");
        assert_eq!(quoted(&"x".repeat(500)).chars().count(), LONGEST + 1);
    }
}
