//! Why a field isn't what its column holds.

use thiserror::Error;

/// Why a field isn't what its column holds.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CellError {
    /// Nothing there.
    #[error("the field is empty: write the value, or leave out the row (or the column, if it is optional)")]
    Empty,
    /// A comma within the number.
    #[error(
        "`{text}` has a decimal comma where the other numbers have points: write a point, or separate the columns with semicolons"
    )]
    DecimalComma {
        /// What is written.
        text: String,
    },
    /// Separators between thousands, a typographic minus, the D of Fortran.
    #[error("`{text}` is not spelt as numbers are read: write `{respelt}`")]
    Spelling {
        /// What is written.
        text: String,
        /// What it means.
        respelt: f64,
    },
    /// A number and a unit that isn't one of the column.
    #[error("`{text}` has another unit than the column: write the number alone, in the unit of the header")]
    UnitInside {
        /// What is written.
        text: String,
    },
    /// A time of day among other times.
    #[error("`{text}` is a time of day, unlike the first row: write all times in one way")]
    Clock {
        /// What is written.
        text: String,
    },
    /// Another time among times of day.
    #[error("`{text}` is no time of day, unlike the first row: write all times in one way")]
    NoClock {
        /// What is written.
        text: String,
    },
    /// A comment behind a field.
    #[error("`{text}` has a comment behind it: put the comment on a line of its own that begins with `#`")]
    Comment {
        /// What is written.
        text: String,
    },
    /// Bytes that are no text.
    #[error("the text is not UTF-8: store it as UTF-8")]
    NotUtf8,
    /// Text.
    #[error("`{text}` is not a number: write one such as `12.5` or `1.25e1`, or leave out the row")]
    NotANumber {
        /// What is written.
        text: String,
    },
    /// Infinite, not a number, or beyond what a double holds.
    #[error("`{text}` is not a finite number: leave out the row, or write what was read")]
    NotFinite {
        /// What is written.
        text: String,
    },
    /// Beyond anything that is measured.
    #[error(
        "`{text}` is larger than anything that is measured (1e30 in SI units): check the number and its unit"
    )]
    TooLarge {
        /// What is written.
        text: String,
    },
    /// No whole number.
    #[error("`{text}` is not a whole number: write a count such as `3`")]
    NotWhole {
        /// What is written.
        text: String,
    },
    /// No direction.
    #[error(
        "`{text}` is not a direction: write `shortening`, `contracting`, `up` or `+1`; `lengthening`, `extending`, `down` or `-1`; `rest` or `0`"
    )]
    NotADirection {
        /// What is written.
        text: String,
    },
}

impl CellError {
    /// What is wrong, in short, to count by.
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

    /// What is written there, if anything is.
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
