//! Model against measurement: fits with intervals and warnings, and the ladder of errors.
//!
//! [`compare`] climbs the ladder: the base as stated, then one effect after the other, each rung fitted together with what the rig's data sheets
//! leave open, with its error on the data and on held-out pressures, and the noise floor that no model can go below. [`fit_effects`] is the last
//! rung alone. Results are plain values ([`Comparison`], [`Fit`]) that text, JSON and report are functions of.
//!
//! Deliberately absent: equilibria (it asks `bulge-model`), files, and the decision which effect is missing.

mod compare;
mod comparison;
mod error;
mod extension;
mod fit;
mod fitting;
mod floor;
mod interval;
mod levels;
mod loops;
mod nuisance;
mod problem;
mod requirements;
mod residuals;
mod rivals;
mod rows;
mod stack;
mod weights;

pub use compare::{Fitting, Options, compare, fit_effects};
pub use comparison::{
    Bin, Breakdown, Comparison, Curve, CurvePoint, DataSummary, LeftOut, LoopGap, NoiseFloor, Part,
    ResidualMap, Rival, Rung, Stack,
};
pub use error::InferenceError;
pub use extension::{Extension, extended};
pub use fit::{Convergence, Fit, Fitted};
pub use weights::{Noise, effective_rows};
