//! Why a text is not a quantity, and what to write instead.

use crate::dimension::Dimension;
use crate::unit_expression::{MAX_POWER, MAX_UNIT};
use crate::unit_table::{Units, symbols};
use crate::units::Quantity;
use std::fmt;
use thiserror::Error;

/// What a text should be: a quantity of one dimension, or a number with any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// The quantity in words, such as "length".
    pub quantity: &'static str,
    /// A value written as it should be.
    pub example: &'static str,
    /// The natural unit.
    pub unit: &'static str,
    /// Its dimension; `None` if any will do.
    pub dimension: Option<Dimension>,
    /// The units of the dimension, each with its size in SI units.
    pub known: Units,
}

impl Wanted {
    /// A number with a unit of any dimension.
    pub(crate) const ANY: &'static Self =
        &Self { quantity: "number", example: "4 N s", unit: "N", dimension: None, known: &[] };

    /// A quantity of one dimension.
    #[must_use]
    pub const fn of<Q: Quantity>() -> &'static Self {
        const {
            &Self {
                quantity: Q::NAME,
                example: Q::EXAMPLE,
                unit: Q::SHOWN.0,
                dimension: Some(Q::DIMENSION),
                known: Q::UNITS,
            }
        }
    }

    /// The symbols of the allowed units, with commas.
    #[must_use]
    pub fn symbols(&self) -> String {
        let named = self.known.iter().map(|(symbol, _)| *symbol).filter(|symbol| !symbol.is_empty());
        named.collect::<Vec<_>>().join(", ")
    }

    fn is_any(&self) -> bool {
        self.dimension.is_none()
    }

    /// What to do about an unknown unit.
    fn cure(&self) -> String {
        if self.is_any() {
            let known = symbols().map(|(symbol, ..)| symbol).collect::<Vec<_>>();
            format!("known are {}", known.join(", "))
        } else {
            format!("write {self} (known: {})", self.symbols())
        }
    }

    fn with_width(&self) -> String {
        if self.is_any() { "1 N +- 0.2 N".to_owned() } else { format!("{} +- 1 %", self.example) }
    }

    fn finite(&self) -> String {
        if self.is_any() {
            "is not a finite number in SI units: write one between -1e308 and 1e308".to_owned()
        } else {
            format!("is not finite: write {self}")
        }
    }
}

/// "a length such as "110 mm"".
impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let with = if self.is_any() { " with its unit," } else { "" };
        write!(f, "{}{with} such as \"{}\"", with_article(self.quantity), self.example)
    }
}

/// Why a text is not the quantity that is needed. Every message says what to write instead.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum UnitError {
    /// Nothing is written.
    #[error("no {} is given: write {wanted}", wanted.quantity)]
    Empty {
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// A number without a unit.
    #[error("`{text}` has no unit: write {wanted} (known: {})", wanted.symbols())]
    NoUnit {
        /// What was written.
        text: String,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// A symbol that is no unit.
    #[error("`{text}` has the unknown unit `{unit}`: {}", cure(*suggestion, wanted))]
    UnknownUnit {
        /// What was written.
        text: String,
        /// The symbol.
        unit: String,
        /// The nearest symbol that may stand there, if one is near.
        suggestion: Option<&'static str>,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// A unit of another dimension.
    #[error("`{text}` is {}, here {} is needed: write {wanted}", with_article(found), with_article(wanted.quantity))]
    OtherDimension {
        /// What was written.
        text: String,
        /// The dimension it has.
        found: &'static str,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// No number at the beginning.
    #[error(
        "`{text}` does not begin with a number{}: write {wanted}",
        if wanted.is_any() { "" } else { " and a unit" }
    )]
    NotANumber {
        /// What was written.
        text: String,
        /// What is needed.
        wanted: &'static Wanted,
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
    #[error("`{text}` {}", wanted.finite())]
    NotFinite {
        /// What was written.
        text: String,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// A width that is negative or not finite.
    #[error(
        "the width in `{text}` is {width} in SI units, but can't be negative: write \"{}\", `+- 0` for an exact number, \
         or leave the width out",
        wanted.with_width()
    )]
    NegativeWidth {
        /// What was written.
        text: String,
        /// The width in SI units.
        width: f64,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// The width has another dimension than the value.
    #[error(
        "the width in `{text}` is {found}, but the value is {value}: write both in one unit, such as \"1 N +- 0.2 N\""
    )]
    OtherWidth {
        /// What was written.
        text: String,
        /// What the width is.
        found: String,
        /// What the value is.
        value: String,
    },
    /// No `..` between two values.
    #[error(
        "`{text}` is not a range: write two values with `..` between them, as in \"0 {}..{}\"",
        wanted.unit, wanted.example
    )]
    NotARange {
        /// What was written.
        text: String,
        /// What is needed.
        wanted: &'static Wanted,
    },
    /// A unit that is longer than any sensible one.
    #[error(
        "the unit `{text}` has {length} bytes, at most {MAX_UNIT} are read: write it as powers, such as `m^3`"
    )]
    TooLong {
        /// The beginning of the unit.
        text: String,
        /// Its length.
        length: usize,
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
    /// A product behind a quotient, which can be read in two ways.
    #[error(
        "`{text}` can be read in two ways: put what is divided by in parentheses, such as `J/(kg K)`, or write `J K/kg`"
    )]
    Ambiguous {
        /// What was written.
        text: String,
    },
    /// A unit that is not made of products, quotients and powers.
    #[error(
        "the unit `{text}` lacks {lacking}: write units with blanks, `/` and whole powers, such as `N s/m^2`"
    )]
    Malformed {
        /// What was written.
        text: String,
        /// What should stand there.
        lacking: &'static str,
    },
    /// A power that is too large.
    #[error(
        "the unit `{text}` has a power beyond {MAX_POWER}, or is too large or small to count in: write a smaller power"
    )]
    TooLarge {
        /// What was written.
        text: String,
    },
}

fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

fn cure(suggestion: Option<&str>, wanted: &Wanted) -> String {
    match suggestion {
        // The list of all units there are would hide it.
        Some(symbol) if wanted.is_any() => format!("did you mean `{symbol}`?"),
        Some(symbol) => format!("did you mean `{symbol}`? Otherwise {}", wanted.cure()),
        None => wanted.cure(),
    }
}
