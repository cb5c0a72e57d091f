//! What people state of an analysis in words, on a command line or in a script: rows to leave out by their lines, numbers held, bounded or tied.

use bulge_measurements::{Data, MeasurementError};
use bulge_muscles::{Fault, Muscle};

use crate::comparison::options::Options;
use crate::error::InferenceError;
use crate::fit::restrictions::check_restrictions;

/// What is stated of numbers, each list in its order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Statements {
    /// As [`Options::hold`] takes them: `coulomb-friction.force=14 N`.
    pub hold: Vec<String>,
    /// As [`Options::bound`] takes them: `coulomb-friction.force=5..20 N`.
    pub bound: Vec<String>,
    /// As [`Options::tie`] takes them: `force-lag.time=pressure-lag.time`.
    pub tie: Vec<String>,
}

/// Why something can't be stated.
#[derive(Debug, thiserror::Error)]
pub enum StatementError {
    /// A text that can't be read, or that this analysis can't heed.
    #[error("{}: {what}", about.name())]
    Text {
        /// What it is about.
        about: Stated,
        /// What is wrong with it, and what to write.
        what: String,
    },
    /// No list of lines, or of none of these files.
    #[error(transparent)]
    Lines(#[from] Box<MeasurementError>),
    /// Something is stated of a number that isn't fitted, or the comparison can't be made.
    #[error(transparent)]
    Inference(#[from] Box<InferenceError>),
}

impl StatementError {
    /// Whose fault it is.
    #[must_use]
    pub fn fault(&self) -> Fault {
        if let Self::Inference(error) = self { error.fault() } else { Fault::Input }
    }
}

/// What a statement is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stated {
    /// Rows to leave out.
    Exclude,
    /// A number at a value.
    Hold,
    /// A number between two values.
    Bound,
    /// A number with the value of another.
    Tie,
}

impl Stated {
    /// The word that a command or a function has for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exclude => "exclude",
            Self::Hold => "hold",
            Self::Bound => "bound",
            Self::Tie => "tie",
        }
    }
}

impl Options {
    /// The same with what is stated of its numbers. `muscle` is the one that is fitted: its widths say what is fitted along.
    ///
    /// # Errors
    /// [`StatementError`]: as [`Options::hold`], [`Options::bound`], [`Options::tie`] and [`check_restrictions`].
    pub fn stating(
        self,
        statements: &Statements,
        data: &Data,
        muscle: &Muscle,
    ) -> Result<Self, StatementError> {
        let mut options = self;
        let wrong = |about| move |what| StatementError::Text { about, what };
        for text in &statements.hold {
            options = options.hold(text, muscle).map_err(wrong(Stated::Hold))?;
        }
        for text in &statements.bound {
            options = options.bound(text, muscle).map_err(wrong(Stated::Bound))?;
        }
        for text in &statements.tie {
            options = options.tie(text, muscle).map_err(wrong(Stated::Tie))?;
        }
        check_restrictions(data, muscle, &options).map_err(Box::new)?;
        Ok(options)
    }

    /// The same without the rows of some lines, as [`Data::rows_of_lines`] takes them: `12,33-40`.
    ///
    /// # Errors
    /// As [`rows_to_exclude`].
    pub fn excluding(self, lines: &str, data: &Data) -> Result<Self, StatementError> {
        Ok(Self { excluded: rows_to_exclude(lines, data)?, ..self })
    }
}

/// The rows of some lines, of which not all are.
///
/// # Errors
/// [`StatementError`]: as [`Data::rows_of_lines`]; if no row would be left.
pub fn rows_to_exclude(lines: &str, data: &Data) -> Result<Vec<usize>, StatementError> {
    let rows = data.rows_of_lines(lines).map_err(Box::new)?;
    if !data.is_empty() && rows.len() == data.len() {
        let what = "these are all rows: leave some to compare with".to_owned();
        return Err(StatementError::Text { about: Stated::Exclude, what });
    }
    Ok(rows)
}
