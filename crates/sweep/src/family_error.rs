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
    /// An output that is no number.
    #[error("`{output}` is {value}")]
    NotFinite {
        /// Its name.
        output: String,
        /// What it is instead.
        value: f64,
    },
    /// An axis or an output that the muscle doesn't have: what is wrong, and what to do instead.
    #[error("{0}")]
    Input(String),
}

impl FamilyError {
    /// Who is at fault. An equilibrium error has the same fault as for a single shape.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Equilibrium(error) => error.fault(),
            Self::MuscleWithEffects(error) => error.fault(),
            Self::Model(error) => error.fault(),
            Self::NotFinite { .. } => Fault::NoSolution,
            _ => Fault::Input,
        }
    }

    /// A derivative with respect to a quantity that the muscle doesn't have.
    pub(crate) fn no_variable(name: &str) -> Self {
        let cure = "give it one first, with `Muscle::with`";
        Self::Input(format!("this muscle has no `{name}` to differentiate by: {cure}"))
    }

    /// An axis that varies an effect which is not part of the muscle.
    pub(crate) fn no_part(effect: &str) -> Self {
        Self::Input(format!(
            "the effect `{effect}` belongs to a rig or to one specimen: a sweep of the muscle leaves it out, so it can't be an axis"
        ))
    }

    /// An elastic group for a muscle without a number of fibres.
    pub(crate) fn no_fibre_number() -> Self {
        Self::Input("the elastic group p sin(2 pi/n) R^2/EA needs a number of fibres n".to_owned())
    }
}
