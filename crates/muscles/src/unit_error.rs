//! Why a text is not a quantity, and what to write instead.

use crate::units::Units;
use thiserror::Error;

/// Why a text is not the quantity that is needed. Every message says what to write instead.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UnitError {
    /// Nothing is written.
    #[error("no {quantity} is given: write {} such as \"{example}\"", with_article(quantity))]
    Empty {
        /// The dimension that is needed.
        quantity: &'static str,
        /// A value written as it should be.
        example: &'static str,
    },
    /// A number without a unit.
    #[error(
        "`{text}` has no unit: write {} such as \"{example}\" (known: {})",
        with_article(quantity),
        symbols(known)
    )]
    NoUnit {
        /// What was written.
        text: String,
        /// The dimension that is needed.
        quantity: &'static str,
        /// A value written as it should be.
        example: &'static str,
        /// The units of the dimension.
        known: Units,
    },
    /// A unit of no known dimension.
    #[error(
        "`{text}` has the unknown unit `{unit}`: {}write {} such as \"{example}\" (known: {})",
        question(*suggestion), with_article(quantity), symbols(known)
    )]
    UnknownUnit {
        /// What was written.
        text: String,
        /// The unit in it.
        unit: String,
        /// The dimension that is needed.
        quantity: &'static str,
        /// The nearest unit of that dimension, if one is near.
        suggestion: Option<&'static str>,
        /// A value written as it should be.
        example: &'static str,
        /// The units of the dimension.
        known: Units,
    },
    /// A unit of another dimension.
    #[error(
        "`{text}` is {}, here {} is needed: write {} such as \"{example}\"",
        with_article(found),
        with_article(quantity),
        with_article(quantity)
    )]
    OtherDimension {
        /// What was written.
        text: String,
        /// The dimension it has.
        found: &'static str,
        /// The dimension that is needed.
        quantity: &'static str,
        /// A value written as it should be.
        example: &'static str,
    },
    /// No number at the beginning.
    #[error(
        "`{text}` does not begin with a number and a unit: write {} such as \"{example}\"",
        with_article(quantity)
    )]
    NotANumber {
        /// What was written.
        text: String,
        /// The dimension that is needed.
        quantity: &'static str,
        /// A value written as it should be.
        example: &'static str,
    },
    /// A comma within one number.
    #[error("`{text}` has a comma in the number: write a decimal point, as in \"{fixed}\"")]
    DecimalComma {
        /// What was written.
        text: String,
        /// The same with a point.
        fixed: String,
    },
    /// Infinite, not a number, or beyond what a double holds.
    #[error("`{text}` is not finite: write {} such as \"{example}\"", with_article(quantity))]
    NotFinite {
        /// What was written.
        text: String,
        /// The dimension that is needed.
        quantity: &'static str,
        /// A value written as it should be.
        example: &'static str,
    },
    /// A width that is negative or not finite.
    #[error(
        "the width in `{text}` is {width} in SI units, but can't be negative: write \"{example} +- 1 %\", \
         `+- 0` for an exact number, or leave the width out"
    )]
    NegativeWidth {
        /// What was written.
        text: String,
        /// The width in SI units.
        width: f64,
        /// A value written as it should be.
        example: &'static str,
    },
    /// No `..` between two values.
    #[error(
        "`{text}` is not a range: write two values with `..` between them, as in \"0 {unit}..{example}\""
    )]
    NotARange {
        /// What was written.
        text: String,
        /// The natural unit.
        unit: &'static str,
        /// A value written as it should be.
        example: &'static str,
    },
}

fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

fn symbols(units: Units) -> String {
    let named: Vec<_> = units.iter().map(|(symbol, _)| *symbol).filter(|symbol| !symbol.is_empty()).collect();
    named.join(", ")
}

fn question(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |symbol| format!("did you mean `{symbol}`? Otherwise "))
}
