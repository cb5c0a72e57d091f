//! Parameter estimation and model criticism: fits, the ladder of errors, and the diagnosis of the missing
//! effect.
//!
//! - `fit`: the free parameters of a model, with intervals and warnings ([`Fit`]).
//! - `comparison`: [`compare`] climbs the ladder. It starts with the base model as stated and adds one effect
//!   at a time. Each rung is refitted together with what the rig's data sheets leave open, and reports its
//!   error on the data, its error on held-out pressures, and the noise floor. [`fit_effects`] fits the last
//!   rung alone.
//! - `noise`: the law of the noise ([`NoiseLaw`]) and the whitening of residuals ([`Whitening`]).
//! - `diagnosis`: [`diagnose`] finds the effect that is missing; [`plan`] predicts what a test would show.
//! - `prediction`: [`predict`] gives the force at new rows, with intervals from the uncertainty that a fit
//!   has left in the parameters.
//! - `protocol`: what a test bench does ([`Protocol`]) and what it would measure ([`simulate`]).
//!
//! Results are plain values; text, JSON and the report are functions of them. `noise` depends on none of the
//! other modules, `fit` only on `noise`, and `diagnosis` on all of them.
//!
//! Deliberately absent: equilibria (`bulge-model` solves them), writing files, plots.

mod chebyshev;
mod comparison;
mod diagnosis;
mod error;
mod fit;
mod median;
mod noise;
mod prediction;
mod progress;
mod protocol;
mod vector;

pub use bulge_model::{NumberName, Restriction, Says};
pub use bulge_numerics::Random;
pub use comparison::compare::{Comparing, Fitting, compare, compare_with_rows, fit_effects, posterior};
pub use comparison::document::{
    Bin, Breakdown, Comparison, Curve, CurvePoint, DataSummary, HeldLoad, HeldLoadPoint, LeftOut, LoopGap,
    Mismatch, NoiseFloor, Part, ResidualMap, Rival, Rung, Stack,
};
pub use comparison::options::Options;
pub use comparison::row_by_row::Rows;
pub use comparison::rows::UNPRESSURISED;
pub use comparison::stated::{Stated, StatementError, Statements, rows_to_exclude};
pub use diagnosis::confidence::{Confidence, wilson};
pub use diagnosis::decision_rule::SEPARATION;
pub use diagnosis::diagnose::{DiagnoseOptions, diagnose};
pub use diagnosis::document::*;
pub use diagnosis::drawn::{DrawnForm, DrawnForms, drawn_forms};
pub use diagnosis::geometry::{AssumedNumber, DoubtfulNumber, Geometry, MovedNumber, OtherAnswer};
pub use diagnosis::not_looked_for::NotLookedFor;
pub use diagnosis::plan::{ConfusedPair, Plan, PlannedEffect, plan};
pub use diagnosis::proposals::NextLimits;
pub use diagnosis::search::MOST_EFFECTS;
pub use error::InferenceError;
pub use fit::document::{Convergence, Fit, Fitted};
pub use fit::extension::{Extension, extended};
pub use fit::held::HeldNumber;
pub use fit::loss::Loss;
pub use fit::posterior::{Posterior, PosteriorParameter};
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
