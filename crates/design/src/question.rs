//! What the questions of a design have in common: refusals that name a part of the question, and drawings.

use bulge_muscles::units::significant;

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
