//! Why a field doesn't fit its column.

/// Why a field doesn't fit its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CellError {
    /// What the field is, in short, for counting.
    pub(crate) kind: &'static str,
    /// The text as written; empty if there is none.
    pub(crate) text: String,
}

/// The kind of a number with a unit that doesn't suit the column.
pub(crate) const OTHER_UNIT: &str = "another unit than the column's";

impl CellError {
    /// The reason why a text is none that its column takes.
    pub(crate) fn new(kind: &'static str, text: impl Into<String>) -> Self {
        Self { kind, text: text.into() }
    }

    /// The field is empty.
    pub(crate) fn empty() -> Self {
        Self::new("empty", "")
    }

    /// Infinite, not a number, or beyond the range of a double.
    pub(crate) fn not_finite(text: String) -> Self {
        Self::new("not a finite number", text)
    }

    /// Not a direction.
    pub(crate) fn not_a_direction(text: String) -> Self {
        Self::new("not a direction", text)
    }
}
