//! What can't be done, in one sentence, and the place on the page that it is about.

use bulge_measurements::ColumnUse;
use serde::Serialize;

/// Where on the page a sentence belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Place {
    /// The files.
    Data,
    /// What the columns are taken for.
    Columns,
    /// The muscle.
    Muscle,
    /// The effects that were chosen, and their numbers.
    Effects,
    /// The user's own effects.
    OwnEffects,
    /// The rows that were excluded by hand.
    Excluded,
    /// The test that is planned.
    Plan,
    /// The shape in 3D.
    Shape,
    /// The request itself.
    Request,
}

/// Why something was not done.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Refusal {
    /// What, where, and what to write instead.
    pub(crate) error: String,
    /// Where on the page it belongs.
    #[serde(rename = "where")]
    pub(crate) place: Place,
    /// The columns of the files, where these could not be told apart.
    #[serde(skip)]
    pub(crate) columns: Vec<ColumnUse>,
}

impl Refusal {
    /// A sentence about a place.
    #[expect(clippy::needless_pass_by_value, reason = "errors and texts alike, at the end of their lives")]
    pub(crate) fn new(place: Place, error: impl ToString) -> Self {
        Self { error: error.to_string(), place, columns: Vec::new() }
    }

    /// The same as a function, for errors that are passed on.
    pub(crate) fn at<E: ToString>(place: Place) -> impl Fn(E) -> Self {
        move |error| Self::new(place, error)
    }
}
