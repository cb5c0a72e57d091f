//! Reasons why a field doesn't fit its column.

use thiserror::Error;

/// Why a field doesn't fit its column.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CellError {
    /// The field is empty.
    #[error("the field is empty: write the value, or leave out the row (or the column, if it is optional)")]
    Empty,
    /// A decimal comma among numbers with points.
    #[error(
        "`{text}` has a decimal comma where the other numbers have points: write a point, or separate the columns with semicolons"
    )]
    DecimalComma {
        /// The text as written.
        text: String,
    },
    /// Separators between thousands, a typographic minus, or the exponent letter D of Fortran.
    #[error("`{text}` is not spelt as numbers are read: write `{respelt}`")]
    Spelling {
        /// The text as written.
        text: String,
        /// The number that it means.
        respelt: f64,
    },
    /// A number with a unit that doesn't suit the column.
    #[error("`{text}` has another unit than the column: write the number alone, in the unit of the header")]
    UnitInside {
        /// The text as written.
        text: String,
    },
    /// A time of day among other times.
    #[error("`{text}` is a time of day, unlike the first row: write all times in one way")]
    Clock {
        /// The text as written.
        text: String,
    },
    /// A number of seconds among times of day.
    #[error("`{text}` is no time of day, unlike the first row: write all times in one way")]
    NoClock {
        /// The text as written.
        text: String,
    },
    /// A comment after a field.
    #[error("`{text}` has a comment behind it: put the comment on a line of its own that begins with `#`")]
    Comment {
        /// The text as written.
        text: String,
    },
    /// Bytes that are not text.
    #[error("the text is not UTF-8: store it as UTF-8")]
    NotUtf8,
    /// Text.
    #[error("`{text}` is not a number: write one such as `12.5` or `1.25e1`, or leave out the row")]
    NotANumber {
        /// The text as written.
        text: String,
    },
    /// Infinite, not a number, or beyond the range of a double.
    #[error("`{text}` is not a finite number: leave out the row, or write what was read")]
    NotFinite {
        /// The text as written.
        text: String,
    },
    /// Larger than any measurement.
    #[error(
        "`{text}` is larger than anything that is measured (1e30 in SI units): check the number and its unit"
    )]
    TooLarge {
        /// The text as written.
        text: String,
    },
    /// Not a whole number.
    #[error("`{text}` is not a whole number: write a count such as `3`")]
    NotWhole {
        /// The text as written.
        text: String,
    },
    /// Not a direction.
    #[error(
        "`{text}` is not a direction: write `shortening`, `contracting`, `up` or `+1`; `lengthening`, `extending`, `down` or `-1`; `rest` or `0`"
    )]
    NotADirection {
        /// The text as written.
        text: String,
    },
}

impl CellError {
    /// The kind of error in short, for counting.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::DecimalComma { .. } => "a decimal comma among points",
            Self::UnitInside { .. } => "another unit than the column's",
            Self::Clock { .. } => "a time of day among numbers",
            Self::NoClock { .. } => "no time of day",
            Self::NotFinite { .. } => "not a finite number",
            Self::TooLarge { .. } => "larger than anything that is measured",
            Self::NotWhole { .. } => "not a whole number",
            Self::NotADirection { .. } => "not a direction",
            Self::NotUtf8 => "no text",
            Self::Spelling { .. } | Self::Comment { .. } | Self::NotANumber { .. } => "not a number",
        }
    }

    /// The text as written, if there is any.
    pub(crate) fn text(&self) -> Option<&str> {
        match self {
            Self::Empty | Self::NotUtf8 => None,
            Self::DecimalComma { text }
            | Self::UnitInside { text }
            | Self::Clock { text }
            | Self::NoClock { text }
            | Self::NotFinite { text }
            | Self::TooLarge { text }
            | Self::NotWhole { text }
            | Self::NotADirection { text }
            | Self::Spelling { text, .. }
            | Self::Comment { text }
            | Self::NotANumber { text } => Some(text),
        }
    }
}
