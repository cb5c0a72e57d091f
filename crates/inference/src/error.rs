//! Reasons why a comparison or a fit is impossible.

use bulge_model::ModelError;
use bulge_muscles::memory::Shortage;
use bulge_muscles::{Fault, FileError};

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum InferenceError {
    /// No rows are left.
    #[error("no rows are left to compare with: {left_out}")]
    NoRows {
        /// Why the rows were left out.
        left_out: String,
    },
    /// Most rows have a reading that no muscle has.
    #[error("most rows can't be those of a muscle: {what}; see that pressure and force are not exchanged")]
    Unit {
        /// The readings, and what to check.
        what: String,
    },
    /// The rows don't fit into the memory.
    #[error(
        "{files}: what is asked of {rows} rows {shortage}: keep fewer rows per second, take fewer files at once, or allow more memory"
    )]
    Memory {
        /// The files.
        files: String,
        /// Their rows.
        rows: usize,
        /// The memory that is needed, and that is left.
        shortage: Shortage,
    },
    /// The specimens that the muscle file states are not those that were measured.
    #[error(transparent)]
    Specimens(Box<FileError>),
    /// There are more free parameters than rows.
    #[error(
        "{numbers} numbers (those of effects, and of zeros, gains and widths that the muscle file states) can't be fitted to {rows} rows that count and differ; measure more, or fit fewer at once"
    )]
    TooFewRows {
        /// Rows that count.
        rows: usize,
        /// Parameters to fit.
        numbers: usize,
    },
    /// All rows are identical, so that nothing can be fitted.
    #[error("all {rows} rows are identical: nothing can be fitted to a single point")]
    Identical {
        /// Number of rows.
        rows: usize,
    },
    /// The contractions are impossible: the data belong to another muscle or are in another unit.
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
    /// A value, bound or tie is stated for a parameter that no fit changes.
    #[error("`{number}` is {says}, but it isn't fitted: {instead}")]
    Restriction {
        /// The parameter, `effect.name`.
        number: String,
        /// What is stated of it: `held`, `bounded` or `tied`.
        says: &'static str,
        /// Why no fit changes it, and what to do.
        instead: String,
    },
    /// The table `[fitted]` of a muscle file doesn't belong to this muscle.
    #[error("`{number}` in the table `[fitted]`: {why}; fit again, or take the table out")]
    Fitted {
        /// The parameter, `effect.key`.
        number: String,
        /// What disagrees.
        why: String,
    },
    /// The protocol can't be carried out, at all or with this muscle.
    #[error("{what}; {instead}")]
    Protocol {
        /// What is wrong.
        what: String,
        /// What to write or do instead.
        instead: String,
    },
    /// The model can't make a prediction.
    #[error("{what}{source}")]
    Model {
        /// The lines, if rows are to blame: `lines 12, 33-40: `. Otherwise empty.
        what: String,
        /// The model's own error.
        source: Box<ModelError>,
    },
    /// The noise of a record can't be described or whitened.
    #[error("the noise: {0}")]
    Noise(#[from] crate::noise::error::NoiseError),
}

impl InferenceError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub fn fault(&self) -> Fault {
        if let Self::Model { source, .. } = self { source.fault() } else { Fault::Input }
    }
}

impl From<ModelError> for InferenceError {
    /// For planned rows: there are no lines of a file to name.
    fn from(source: ModelError) -> Self {
        Self::Model { what: String::new(), source: Box::new(source) }
    }
}
