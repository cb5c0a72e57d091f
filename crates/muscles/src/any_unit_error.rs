//! Why a text is not a number with a unit of whatever dimension, and what to write instead.

use crate::unit_expression::{MAX_POWER, MAX_UNIT, symbols};
use thiserror::Error;

/// Why a text is not a number with a unit. Every message says what to write instead.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AnyUnitError {
    /// Nothing is written.
    #[error("no number is given: write a number with its unit, such as \"4 N s\"")]
    Empty,
    /// No number at the beginning.
    #[error("`{text}` does not begin with a number: write a number with its unit, such as \"4 N s\"")]
    NotANumber {
        /// What was written.
        text: String,
    },
    /// A comma within the number.
    #[error("`{text}` has a comma in the number: write a decimal point, as in \"{fixed}\"")]
    DecimalComma {
        /// What was written.
        text: String,
        /// The same with a point.
        fixed: String,
    },
    /// Infinite, not a number, or beyond what a double holds.
    #[error("`{text}` is not a finite number in SI units: write one between -1e308 and 1e308")]
    NotFinite {
        /// What was written.
        text: String,
    },
    /// A unit longer than any that is meant.
    #[error(
        "the unit `{text}` has {length} bytes, at most {MAX_UNIT} are read: write it as powers, such as `m^3`"
    )]
    TooLong {
        /// The beginning of the unit.
        text: String,
        /// Its length.
        length: usize,
    },
    /// A symbol that is no unit.
    #[error("`{text}` has the unknown unit `{unit}`: {}known are {}", question(*suggestion), known_symbols())]
    UnknownUnit {
        /// What was written.
        text: String,
        /// The symbol.
        unit: String,
        /// The nearest symbol, if one is near.
        suggestion: Option<&'static str>,
    },
    /// A temperature scale whose zero is not the absolute one.
    #[error(
        "`{text}` has the unit `{unit}`, whose zero is not the zero of the temperature: write K (a difference of 1 degC is 1 K, \
         a temperature of 20 degC is 293.15 K)"
    )]
    Offset {
        /// What was written.
        text: String,
        /// The symbol.
        unit: String,
    },
    /// A product behind a quotient, which people read in two ways.
    #[error(
        "`{text}` can be read in two ways: put what is divided by in parentheses, such as `J/(kg K)`, or write `J K/kg`"
    )]
    Ambiguous {
        /// What was written.
        text: String,
    },
    /// Not products, quotients and powers of units.
    #[error(
        "the unit `{text}` lacks {wanted}: write units with blanks, `/` and whole powers, such as `N s/m^2`"
    )]
    Malformed {
        /// What was written.
        text: String,
        /// What should stand there.
        wanted: &'static str,
    },
    /// A power beyond reason.
    #[error(
        "the unit `{text}` has a power beyond {MAX_POWER}, or is too large or small to count in: write a smaller power"
    )]
    TooLarge {
        /// What was written.
        text: String,
    },
    /// The width has another dimension than the value.
    #[error(
        "the width in `{text}` is {found}, but the value is {wanted}: write both in one unit, such as \"1 N +- 0.2 N\""
    )]
    OtherDimension {
        /// What was written.
        text: String,
        /// What the width is.
        found: String,
        /// What the value is.
        wanted: String,
    },
    /// A width that is negative or not finite.
    #[error(
        "the width in `{text}` is {width} in SI units, but can't be negative: write \"1 N +- 0.2 N\", `+- 0` for an exact number, or leave the width out"
    )]
    NegativeWidth {
        /// What was written.
        text: String,
        /// The width in SI units.
        width: f64,
    },
}

fn question(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |symbol| format!("did you mean `{symbol}`? Otherwise "))
}

fn known_symbols() -> String {
    symbols().map(|(symbol, ..)| symbol).collect::<Vec<_>>().join(", ")
}
