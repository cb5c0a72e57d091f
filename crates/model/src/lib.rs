//! Force of a pneumatic artificial muscle along a measured history, computed from a base law and chosen
//! effects, with exact derivatives.
//!
//! ```text
//! readings p, eps, history -> rig effects -> true p, eps -> equilibrium of the reshaped muscle -> loads -> load cell -> force
//! ```
//!
//! The base law is the equilibrium of the fibre net (default) or one of the force laws of the papers.
//! [`Model::evaluate`] runs it along a [`Record`], sweep by sweep. It returns the force of every row with
//! exact derivatives by any of the parameters and by the readings.
//!
//! Deliberately absent: fitting and judging. A model predicts; it doesn't say whether the prediction is
//! right.

mod answer;
mod base;
mod equilibrium;
mod error;
mod evaluate;
mod failure;
mod files;
mod lattice;
mod model;
mod muscle_with_effects;
mod parameter;
mod pass;
mod prediction;
mod record;
mod restriction;
mod row;
mod segment;
mod solved;
mod specimen;
mod strands;
mod warm;
mod work;

pub use equilibrium::{Equilibrium, EquilibriumDocument};
pub use error::ModelError;
pub use evaluate::Wanted;
pub use files::read_options;
pub use model::{AtRest, Chosen, Model};
pub use muscle_with_effects::{MuscleWithEffects, MuscleWithEffectsError};
pub use parameter::ModelParameter;
pub use prediction::{Partly, Prediction};
pub use record::Record;
pub use restriction::{NumberName, Restriction, Says};
pub use specimen::specimen;
pub use warm::Warm;
pub use work::forces_asked;
