//! What the questions of a design have in common: refusals that name a part of the question, and drawings.

use bulge_muscles::units::significant;
use bulge_muscles::{Length, Pressure, Quantity, Ratio, Volume};
use std::fmt::Display;

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
pub enum QuestionError<E: std::error::Error> {
    /// A part of the question that can't be answered.
    #[error("{about}: {what}")]
    Part {
        /// Its name, in words joined by `_`, such as `dead_volume`.
        about: &'static str,
        /// What is wrong, and what to say instead. Other parts are named as options, such as `--angle`.
        what: String,
    },
    /// An error of the answer.
    #[error(transparent)]
    Answer(#[from] E),
}

impl<E: std::error::Error> QuestionError<E> {
    /// A part of the question that can't be answered.
    pub(crate) fn part<T>(about: &'static str, what: impl Into<String>) -> Result<T, Self> {
        Err(Self::Part { about, what: what.into() })
    }
}

/// A drawing: named lines against two axes. The first line is lowest in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// What is drawn.
    pub title: String,
    /// Names of the axes, with their units.
    pub axes: [&'static str; 2],
    /// Name and points of each line.
    pub lines: Vec<(String, Vec<[f64; 2]>)>,
}

/// A length \[m\] as people write it.
pub(crate) fn millimetres(metres: f64) -> String {
    format!("{} mm", significant(1e3 * metres, 4))
}

/// A name with its SI unit in brackets, such as "the length of the muscle \[m\]", and a value as a statement in
/// the units that people write: "the length of the muscle is 0.5 mm". A share is marked by \[%\].
pub(crate) fn is(what: &str, value: f64) -> String {
    let split = what.strip_suffix(']').and_then(|what| what.rsplit_once(" ["));
    let Some((name, unit)) = split else { return format!("{what} is {value}") };
    match unit {
        "m" => said::<Length>(name, value),
        "Pa" => said::<Pressure>(name, value),
        "%" => said::<Ratio>(name, value),
        "m^3" => said::<Volume>(name, value),
        "m^3/(s Pa)" => format!("{name} is {} l/(s bar)", 1e8 * value),
        unit => format!("{name} is {value} {unit}"),
    }
}

fn said<Q: Quantity + Display>(name: &str, value: f64) -> String {
    format!("{name} is {}", Q::from_si(value))
}

#[cfg(test)]
mod tests {
    use super::is;

    #[test]
    fn values_are_said_in_the_units_that_people_write() {
        for (what, value, said) in [
            ("the wall [m]", 5e-4, "the wall is 0.5 mm"),
            ("the pressure [Pa]", -2e5, "the pressure is -2 bar"),
            ("the share [%]", 1.2, "the share is 120 %"),
            ("the period [s]", 0.2, "the period is 0.2 s"),
            ("the number of cells", 3.0, "the number of cells is 3"),
        ] {
            assert_eq!(is(what, value), said);
        }
    }
}
