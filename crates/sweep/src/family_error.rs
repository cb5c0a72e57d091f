//! Errors of a family: a point without equilibrium, or a plan without a family.

use bulge_fibre::FibreError;
use bulge_model::{ModelError, MuscleWithEffectsError};
use bulge_muscles::{Fault, FileError, MuscleError};

/// Why a point has no equilibrium, or a plan no family.
#[derive(Debug, thiserror::Error)]
pub enum FamilyError {
    /// No equilibrium.
    #[error(transparent)]
    Equilibrium(#[from] FibreError),
    /// A value that is impossible for the muscle.
    #[error(transparent)]
    Muscle(#[from] MuscleError),
    /// An effect that can't act.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No equilibrium of the muscle with its effects.
    #[error(transparent)]
    MuscleWithEffects(#[from] MuscleWithEffectsError),
    /// An effect that the muscle file states in a wrong way.
    #[error(transparent)]
    File(#[from] FileError),
    /// A derivative with respect to a quantity that the muscle doesn't have.
    #[error("this muscle has no `{name}` to differentiate by: give it one first, with `Muscle::with`")]
    NoVariable {
        /// Name of the variable.
        name: &'static str,
    },
    /// An elastic group for a muscle without a number of fibres.
    #[error("the elastic group p sin(2 pi/n) R^2/EA needs a number of fibres n")]
    NoFibreNumber,
    /// An output of inextensible fibres that can't be tabulated from a contraction of 0.
    #[error(
        "a table of `{output}` can't begin at a contraction of 0, where the force of inextensible fibres is infinite: begin at \"0.5 %..limit\", say, or leave `{output}` out"
    )]
    FromZero {
        /// Its name.
        output: String,
    },
    /// An axis that varies an effect which is not part of the muscle.
    #[error(
        "the effect `{effect}` belongs to a rig or to one specimen: a sweep of the muscle leaves it out, so it can't be an axis"
    )]
    NoPart {
        /// Its name.
        effect: String,
    },
    /// A number of fibres that isn't whole.
    #[error("the number of fibres is {found}: it must be a whole number")]
    NotWhole {
        /// The number.
        found: f64,
    },
}

impl FamilyError {
    /// Who is at fault. An equilibrium error has the same fault as for a single shape.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Equilibrium(error) => error.fault(),
            Self::MuscleWithEffects(error) => error.fault(),
            Self::Model(error) => error.fault(),
            _ => Fault::Input,
        }
    }
}
