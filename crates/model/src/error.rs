//! What can go wrong in a model, with the rows and numbers.

use bulge_fibre::FibreError;
use bulge_muscles::Fault;
use bulge_muscles::MuscleError;

/// Why a model has no prediction.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ModelError {
    /// Some rows have no equilibrium.
    #[error("no equilibrium at {pressure_pa} Pa and contraction {contraction:.4}: {source}")]
    NoEquilibrium {
        /// Rows, from 0.
        rows: Vec<usize>,
        /// True pressure there \[Pa\].
        pressure_pa: f64,
        /// True contraction there.
        contraction: f64,
        /// What the solver said of the first.
        source: Box<FibreError>,
    },
    /// A row's prediction is not a number.
    #[error("the model gives no finite force at {} of the rows (the first has the number {}): {what}", rows.len(), rows.first().map_or(0, |r| r + 1))]
    NotFinite {
        /// Rows, from 0.
        rows: Vec<usize>,
        /// What to look at.
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
    /// An effect of the other kind of muscle.
    #[error("`{effect}` is an effect of {owner} muscles, and this one is {kind}; leave it out")]
    OtherKind {
        /// The effect.
        effect: String,
        /// Whose it is.
        owner: &'static str,
        /// What this is.
        kind: &'static str,
    },
    /// The same effect twice.
    #[error("`{effect}` stands twice in the list of effects; once is enough")]
    Twice {
        /// The effect.
        effect: String,
    },
    /// Too many shape parameters at once.
    #[error(
        "{count} parameters that change the shape at once are too many: at most {most}; leave some effects out"
    )]
    TooManyShapes {
        /// How many.
        count: usize,
        /// The most.
        most: usize,
    },
    /// The number of values is not that of the parameters.
    #[error("{given} values for a model of {expected} parameters")]
    Values {
        /// Given.
        given: usize,
        /// Expected.
        expected: usize,
    },
}

impl ModelError {
    /// Whose fault it is: data that ask for an equilibrium that doesn't exist are wrong input; a search that failed is not.
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
