//! Errors of a model, with the rows and numbers concerned.

use bulge_fibre::FibreError;
use bulge_muscles::{Fault, MuscleError, Pressure, Ratio};

/// Why a model has no prediction.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ModelError {
    /// Some rows have no equilibrium.
    #[error("no equilibrium at {:.4} and a contraction of {:.2}: {source}", Pressure::pa(*pressure_pa), Ratio::one(*contraction))]
    NoEquilibrium {
        /// Rows, from 0.
        rows: Vec<usize>,
        /// True pressure there \[Pa\].
        pressure_pa: f64,
        /// True contraction there.
        contraction: f64,
        /// The solver's error at the first row.
        source: Box<FibreError>,
    },
    /// A row's prediction is not a number.
    #[error("the model gives no finite force at {} of the rows (the first has the number {}): {what}", rows.len(), rows.first().map_or(0, |r| r + 1))]
    NotFinite {
        /// Rows, from 0.
        rows: Vec<usize>,
        /// The things to check.
        what: &'static str,
    },
    /// The muscle can't have an effect, or not with these values.
    #[error("effect `{effect}`: {source}")]
    Reshape {
        /// The effect.
        effect: String,
        /// Why.
        source: Box<MuscleError>,
    },
    /// The muscle can't have the numbers of a specimen.
    #[error("specimen `{specimen}`: {source}")]
    Specimen {
        /// The specimen.
        specimen: String,
        /// Why.
        source: Box<MuscleError>,
    },
    /// The effect belongs to the other kind of muscle.
    #[error("`{effect}` is an effect of {owner} muscles, and this one is {kind}; leave it out")]
    OtherKind {
        /// The effect.
        effect: String,
        /// The kind of muscle that has the effect.
        owner: &'static str,
        /// The kind of this muscle.
        kind: &'static str,
    },
    /// The same effect is listed twice.
    #[error("`{effect}` stands twice in the list of effects; once is enough")]
    Twice {
        /// The effect.
        effect: String,
    },
    /// Too many shape parameters are differentiated by at once.
    #[error(
        "{count} parameters that change the shape at once are too many: at most {most}; leave some effects out"
    )]
    TooManyShapes {
        /// Number of parameters.
        count: usize,
        /// Largest number allowed.
        most: usize,
    },
    /// The number of values differs from the number of parameters.
    #[error("{given} values for a model of {expected} parameters")]
    Values {
        /// Number of values given.
        given: usize,
        /// Number of values expected.
        expected: usize,
    },
}

impl ModelError {
    /// The fault behind the error. Data that ask for an equilibrium that doesn't exist are wrong input; a
    /// failed search isn't.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::NoEquilibrium { source, .. } if source.fault() == Fault::NotConverged => {
                Fault::NotConverged
            }
            _ => Fault::Input,
        }
    }
}
