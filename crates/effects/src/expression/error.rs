//! Errors in formulas: the place, the error and the correction.

use bulge_muscles::FileError;
use std::ops::Range;
use thiserror::Error;

/// An error in a formula. Its `Display` is the whole message:
///
/// ```text
/// formula:1:5: unknown name `epss`
///   |
/// 1 | k * epss
///   |     ^^^^
///   = did you mean `eps`?
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct ExpressionError {
    span: Range<usize>,
    message: FileError,
}

impl ExpressionError {
    pub(crate) fn new(
        text: &str,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> Self {
        Self { message: FileError::at("formula", text, span.clone(), what, instead), span }
    }

    /// The bytes of the formula that the error refers to.
    #[must_use]
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The line, counted from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.message.line().unwrap_or(1)
    }

    /// The column in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> usize {
        self.message.column().unwrap_or(1)
    }

    /// The error in one sentence.
    #[must_use]
    pub fn what(&self) -> &str {
        self.message.what()
    }

    /// The correction to make.
    #[must_use]
    pub fn instead(&self) -> &str {
        self.message.instead()
    }
}

/// The name that was probably meant. It differs only in case and hyphens, or by one or two slips.
pub(crate) fn nearest<'n>(word: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let word = plain(word);
    let length = word.chars().count();
    // A long word can't be a slip for a short name, and comparing it would take long.
    if length > 64 {
        return None;
    }
    let slips = |name: &str| strsim::damerau_levenshtein(&plain(name), &word);
    let closest = names.into_iter().map(|name| (slips(name), name)).min_by_key(|(slips, _)| *slips);
    closest.filter(|(slips, _)| *slips <= (length / 3).max(usize::from(length == 2))).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One slip in three letters, none in a single one.
    #[test]
    fn what_was_meant_is_near() {
        let names = ["eps", "pressure", "p"];
        assert_eq!(nearest("esp", names), Some("eps"));
        assert_eq!(nearest("Pressure ", names), Some("pressure"));
        assert_eq!(nearest("pleasure", names), Some("pressure"));
        assert_eq!(nearest("pleasant", names), None);
        assert_eq!(nearest("xyz", names), None);
        assert_eq!(nearest("q", names), None);
        assert_eq!(nearest(&"p".repeat(65), names), None);
    }
}
