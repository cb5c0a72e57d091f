//! A refused request: one sentence, and the part of the page it refers to.

use bulge_measurements::ColumnUse;
use serde::Serialize;

/// Part of the page to which a sentence belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Place {
    /// The files.
    Data,
    /// The assignment of the columns.
    Columns,
    /// The muscle.
    Muscle,
    /// The chosen effects and their parameters.
    Effects,
    /// The user's own effects.
    OwnEffects,
    /// The rows that were excluded by hand.
    Excluded,
    /// The planned test.
    Plan,
    /// The shape in 3D.
    Shape,
    /// The request itself.
    Request,
}

/// Why a request was refused.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Refusal {
    /// The problem, where it is, and what to write instead.
    pub(crate) error: String,
    /// The part of the page to which it belongs.
    #[serde(rename = "where")]
    pub(crate) place: Place,
    /// The columns of the files, if they could not be identified.
    #[serde(skip)]
    pub(crate) columns: Vec<ColumnUse>,
}

impl Refusal {
    /// From a part of the page and a sentence.
    #[expect(clippy::needless_pass_by_value, reason = "errors and texts alike, at the end of their lives")]
    pub(crate) fn new(place: Place, error: impl ToString) -> Self {
        Self { error: error.to_string(), place, columns: Vec::new() }
    }

    /// As [`Refusal::new`], as a function for `map_err`.
    pub(crate) fn at<E: ToString>(place: Place) -> impl Fn(E) -> Self {
        move |error| Self::new(place, error)
    }
}
