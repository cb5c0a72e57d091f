//! Statements of a user about an analysis, on a command line or in a script: rows to leave out by their
//! lines, parameters held, bounded or tied.

use bulge_measurements::{Data, MeasurementError};
use bulge_muscles::{Fault, Muscle};

use crate::comparison::options::Options;
use crate::error::InferenceError;
use crate::fit::restrictions::check_restrictions;

/// Restrictions of parameters; each list keeps its order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Statements {
    /// As in [`Options::hold`]: `coulomb-friction.force=14 N`.
    pub hold: Vec<String>,
    /// As in [`Options::bound`]: `coulomb-friction.force=5..20 N`.
    pub bound: Vec<String>,
    /// As in [`Options::tie`]: `force-lag.time=pressure-lag.time`.
    pub tie: Vec<String>,
}

/// Reasons why a statement is refused.
#[derive(Debug, thiserror::Error)]
pub enum StatementError {
    /// The text can't be parsed, or this analysis can't use it.
    #[error("{}: {what}", about.name())]
    Text {
        /// Subject of the statement.
        about: Stated,
        /// What is wrong with it, and what to write.
        what: String,
    },
    /// The list of lines is invalid, or has none of these files.
    #[error(transparent)]
    Lines(#[from] Box<MeasurementError>),
    /// The statement concerns a parameter that isn't fitted, or the comparison is impossible.
    #[error(transparent)]
    Inference(#[from] Box<InferenceError>),
}

impl StatementError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub fn fault(&self) -> Fault {
        if let Self::Inference(error) = self { error.fault() } else { Fault::Input }
    }
}

/// Subject of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stated {
    /// Rows to leave out.
    Exclude,
    /// A parameter held at a value.
    Hold,
    /// A parameter bounded by two values.
    Bound,
    /// A parameter tied to another one.
    Tie,
}

impl Stated {
    /// The word for it in commands and functions.
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
    /// The options with these statements about parameters. `muscle` is the one that is fitted: its widths
    /// decide which nuisance parameters there are.
    ///
    /// # Errors
    /// [`StatementError`], as in [`Options::hold`], [`Options::bound`], [`Options::tie`] and
    /// [`check_restrictions`].
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

    /// The options without the rows of some lines, written as in [`Data::rows_of_lines`]: `12,33-40`.
    ///
    /// # Errors
    /// As [`rows_to_exclude`].
    pub fn excluding(self, lines: &str, data: &Data) -> Result<Self, StatementError> {
        Ok(Self { excluded: rows_to_exclude(lines, data)?, ..self })
    }
}

/// The rows of some lines; they may not be all rows.
///
/// # Errors
/// [`StatementError`], as in [`Data::rows_of_lines`], or if no row would remain.
pub fn rows_to_exclude(lines: &str, data: &Data) -> Result<Vec<usize>, StatementError> {
    let rows = data.rows_of_lines(lines).map_err(Box::new)?;
    if !data.is_empty() && rows.len() == data.len() {
        let what = "these are all rows: leave some to compare with".to_owned();
        return Err(StatementError::Text { about: Stated::Exclude, what });
    }
    Ok(rows)
}
