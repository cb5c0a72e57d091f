//! Why a winding has no resistance, no contraction or no best zone.

use bulge_fibre::FibreError;
use bulge_muscles::{Fault, Pressure, Quantity};

/// What is wrong, where, and how to correct it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensingError {
    /// A winding, a request, a meridian or a curve that is impossible: what is wrong, and what to do instead.
    #[error("{0}")]
    Input(String),
    /// The muscle has no equilibrium in this state.
    #[error("the winding has no resistance at {} and contraction {:.4} %: {error}", Pressure::pa(*pressure_pa), 100.0 * contraction)]
    Equilibrium {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
        /// Contraction.
        contraction: f64,
        /// Error of the solver.
        error: Box<FibreError>,
    },
    /// The elastomer would tear.
    #[error(
        "at contraction {:.3} % the channel is strained by {:.1} % at {:.2} % of the fibre length, more than the {:.1} % that the elastomer bears: \
         contract less, wind nearer to the fittings or with fewer turns, or take the reference at a larger radius",
        100.0 * contraction, 100.0 * strain, 100.0 * at, 100.0 * allowed
    )]
    Overstrained {
        /// Contraction.
        contraction: f64,
        /// Largest strain along the channel.
        strain: f64,
        /// Its position, as a fraction of the fibre length.
        at: f64,
        /// Largest strain allowed.
        allowed: f64,
    },
    /// The resistance doesn't change with the contraction.
    #[error(
        "the resistance changes by less than 1e-9 of itself over this range: this winding feels nothing; give it turns where the radius changes"
    )]
    NoChange,
    /// Two contractions with the same resistance.
    #[error(
        "the resistance does not rise or fall all the way: it turns between contraction {:.3} % and {:.3} %, so that it doesn't tell the contraction; choose another zone or a shorter range",
        100.0 * between[0], 100.0 * between[1]
    )]
    NotMonotone {
        /// Contractions between which it turns.
        between: [f64; 2],
    },
    /// No zone meets the requirements.
    #[error(
        "none of the {scanned} zones is good enough: the largest mean sensitivity of a monotone one is {largest:.6} per contraction, {wanted:.6} is wanted, \
         and {overstrained} zones strain the elastomer too much; ask for less, or allow other widths or a shorter range"
    )]
    NoPlace {
        /// Zones tried.
        scanned: usize,
        /// Largest sensitivity |dR/de|/R0 among monotone zones within the strain limit; 0 if there is none.
        largest: f64,
        /// Smallest sensitivity required.
        wanted: f64,
        /// Number of zones that strain the elastomer too much.
        overstrained: usize,
    },
}

impl SensingError {
    /// The kind of the error: wrong input, or no solution.
    #[must_use]
    pub const fn fault(&self) -> Fault {
        match self {
            Self::Input(_) => Fault::Input,
            Self::Equilibrium { .. }
            | Self::Overstrained { .. }
            | Self::NotMonotone { .. }
            | Self::NoChange
            | Self::NoPlace { .. } => Fault::NoSolution,
        }
    }

    /// The error of the solver in a state of the muscle.
    pub(super) fn unsolved(pressure: Pressure, contraction: f64) -> impl Fn(FibreError) -> Self {
        move |error| Self::Equilibrium { pressure_pa: pressure.si(), contraction, error: Box::new(error) }
    }
}
