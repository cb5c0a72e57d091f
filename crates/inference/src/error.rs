//! Why a comparison or a fit can't be made.

use bulge_model::ModelError;
use bulge_muscles::{Fault, FileError};

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum InferenceError {
    /// No rows are left.
    #[error("no rows are left to compare with: {left_out}")]
    NoRows {
        /// Why they were left out.
        left_out: String,
    },
    /// The muscle states other specimens than were measured.
    #[error(transparent)]
    Specimens(Box<FileError>),
    /// More numbers than rows.
    #[error("{numbers} numbers can't be fitted to {rows} rows; measure more, or fit fewer effects at once")]
    TooFewRows {
        /// Rows that count.
        rows: usize,
        /// Numbers to fit.
        numbers: usize,
    },
    /// All rows are the same, and something is to be fitted.
    #[error("all {rows} rows are identical: nothing can be fitted to a single point")]
    Identical {
        /// How many.
        rows: usize,
    },
    /// The contractions are impossible: the data are those of another muscle, or in another unit.
    #[error(
        "the muscle doesn't match the data: the contraction at {lines} is {:.1} % of the {:.1} mm of {muscle}; check `length` in the muscle file, and the \
         unit and the zero of the data{meant}", 100.0 * contraction, 1e3 * length_m
    )]
    OtherSize {
        /// Name of the muscle.
        muscle: String,
        /// Lines of the file.
        lines: String,
        /// Contraction of the first row.
        contraction: f64,
        /// Length of the muscle \[m\].
        length_m: f64,
        /// What the readings may have been meant as; may be empty.
        meant: String,
    },
    /// An effect needs something that the data don't have.
    #[error("`{effect}` needs {needs}, which these data don't have; leave it out or measure it")]
    Needs {
        /// The effect.
        effect: String,
        /// What it needs.
        needs: &'static str,
    },
    /// Something is stated of a number that no fit changes.
    #[error("`{number}` is {says}, but it isn't fitted: {instead}")]
    Restriction {
        /// The number, `effect.name`.
        number: String,
        /// `held`, `bounded` or `tied`.
        says: &'static str,
        /// Why it isn't, and what to do.
        instead: String,
    },
    /// The table `[fitted]` of a muscle file isn't about this muscle.
    #[error("`{number}` in the table `[fitted]`: {why}; fit again, or take the table out")]
    Fitted {
        /// The number, `effect.key`.
        number: String,
        /// What doesn't agree.
        why: String,
    },
    /// A protocol that nobody can carry out, or with this muscle.
    #[error("{what}; {instead}")]
    Protocol {
        /// What is wrong.
        what: String,
        /// What to write or do instead.
        instead: String,
    },
    /// The model has no prediction.
    #[error("{what}{source}")]
    Model {
        /// The lines, if rows are to blame: `lines 12, 33-40: `.
        what: String,
        /// What it says.
        source: Box<ModelError>,
    },
    /// The noise of a record can't be described or whitened.
    #[error("the noise: {0}")]
    Noise(#[from] crate::noise::error::NoiseError),
}

impl InferenceError {
    /// Whose fault it is.
    #[must_use]
    pub fn fault(&self) -> Fault {
        if let Self::Model { source, .. } = self { source.fault() } else { Fault::Input }
    }
}

impl From<ModelError> for InferenceError {
    /// Of something planned: there are no lines of a file to name.
    fn from(source: ModelError) -> Self {
        Self::Model { what: String::new(), source: Box::new(source) }
    }
}
