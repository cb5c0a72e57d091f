//! Model against measurement: fits, the ladder of errors, and which physical effect is missing.
//!
//! - `fit`: the free numbers of a model, with intervals and warnings ([`Fit`]),
//! - `comparison`: [`compare`] climbs the ladder: the base as stated, then one effect after the other, each rung fitted together with what the rig's data sheets
//!   leave open, with its error on the data and on held-out pressures, and the noise floor; [`fit_effects`] is the last rung alone,
//! - `noise`: the law of the noise ([`NoiseLaw`]) and how it is taken out ([`Whitening`]),
//! - `diagnosis`: [`diagnose`] finds what is missing, [`plan`] what a test would show,
//! - `prediction`: [`predict`] gives the force of new rows, with intervals by what a fit knows of the numbers,
//! - `protocol`: what a test bench does ([`Protocol`]) and would measure ([`simulate`]).
//!
//! Results are plain values that text, JSON and report are functions of. `noise` knows none of the others, `fit` only `noise`; `diagnosis` knows them all.
//!
//! Deliberately absent: equilibria (it asks `bulge-model`), files to write, plots.

mod chebyshev;
mod comparison;
mod diagnosis;
mod dot;
mod error;
mod fit;
mod median;
mod noise;
mod prediction;
mod progress;
mod protocol;

pub use bulge_model::{NumberName, Restriction, Says};
pub use bulge_numerics::Random;
pub use comparison::compare::{Comparing, Fitting, compare, compare_with_rows, fit_effects};
pub use comparison::document::{
    Bin, Breakdown, Comparison, Curve, CurvePoint, DataSummary, HeldLoad, HeldLoadPoint, LeftOut, LoopGap,
    Mismatch, NoiseFloor, Part, ResidualMap, Rival, Rung, Stack,
};
pub use comparison::options::Options;
pub use comparison::row_by_row::Rows;
pub use comparison::rows::UNPRESSURISED;
pub use comparison::stated::{Stated, StatementError, Statements, rows_to_exclude};
pub use diagnosis::confidence::Confidence;
pub use diagnosis::diagnose::{DiagnoseOptions, diagnose};
pub use diagnosis::document::*;
pub use diagnosis::drawn::{DrawnForm, DrawnForms, drawn_forms};
pub use diagnosis::geometry::{AssumedNumber, DoubtfulNumber, Geometry, MovedNumber, OtherAnswer};
pub use diagnosis::next::NextLimits;
pub use diagnosis::not_looked_for::NotLookedFor;
pub use diagnosis::plan::{ConfusedPair, Plan, PlannedEffect, plan};
pub use diagnosis::search::MOST_EFFECTS;
pub use error::InferenceError;
pub use fit::document::{Convergence, Fit, Fitted};
pub use fit::extension::{Extension, extended};
pub use fit::held::HeldNumber;
pub use fit::restrictions::check_restrictions;
pub use fit::weights::{Noise, effective_rows};
pub use noise::error::NoiseError;
pub use noise::law::{CorrelationTime, NoiseLaw, NoiseSource};
pub use noise::offset_belief::OffsetBelief;
pub use noise::whitening::Whitening;
pub use prediction::document::{Against, Predicted, PredictedColumns, UncertainNumber};
pub use prediction::predict::predict;
pub use progress::Progress;
pub use protocol::bench::{Block, MOST_ROWS, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors};
pub use protocol::file::PROTOCOL_EXAMPLE;
pub use protocol::hidden::{HideError, simulate_with};
pub use protocol::simulation::{Simulation, simulate};
pub use protocol::truth::{Ended, HiddenEffect, HiddenNumber, RigReadings, Truth};
