//! Reasons why noise can't be described or whitened.

/// Errors of a noise law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoiseError {
    /// Numbers of values don't match.
    #[error("{what}: there are {given} values where {expected} are needed; {instead}")]
    Lengths {
        /// The values in question.
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many are needed.
        expected: usize,
        /// What to give instead.
        instead: &'static str,
    },
    /// Something isn't a finite number, or a variance is negative.
    #[error("{what} at place {place} is {value}; give a finite number{bound}")]
    Value {
        /// The values in question.
        what: &'static str,
        /// Index, from 0.
        place: usize,
        /// The value.
        value: f64,
        /// What else the value must satisfy.
        bound: &'static str,
    },
    /// The model leaves no degree of freedom for the noise.
    #[error(
        "a saturated model of {columns} numbers leaves no noise of {rows} rows; use fewer columns or more rows"
    )]
    TooFewRows {
        /// Rows that count.
        rows: usize,
        /// Independent columns.
        columns: usize,
    },
    /// The correlation time is in seconds, but the record has no time.
    #[error(
        "the noise law has a correlation time of {seconds} s, and the record has no time; state it in rows"
    )]
    NoTime {
        /// The correlation time \[s\].
        seconds: f64,
    },
    /// The covariance is singular.
    #[error(
        "row {row} (from 0) follows from the rows before it without noise of its own (variance {variance:e} N^2 of {total:e} N^2): \
         give the noise law a white part"
    )]
    Singular {
        /// Row of the record.
        row: usize,
        /// Conditional variance given the rows before it \[N^2\].
        variance: f64,
        /// Total variance of the row \[N^2\].
        total: f64,
    },
}
