//! Model against measurement: fits with intervals and warnings, and the ladder of errors.
//!
//! [`compare`] climbs the ladder: the base as stated, then one effect after the other, each rung fitted together with what the rig's data sheets
//! leave open, with its error on the data and on held-out pressures, and the noise floor that no model can go below. [`fit_effects`] is the last
//! rung alone. Results are plain values ([`Comparison`], [`Fit`]) that text, JSON and report are functions of.
//!
//! Deliberately absent: equilibria (it asks `bulge-model`), files, and the decision which effect is missing.

mod as_set;
mod averaged;
mod candidates;
mod carry_over;
mod chebyshev;
mod classes;
mod compare;
mod comparison;
mod confidence;
mod confirm;
mod diagnose;
mod diagnosis;
mod document;
mod dot;
mod error;
mod explained;
mod extension;
mod fit;
mod fitting;
mod floor;
mod hints;
mod input_noise;
mod interval;
mod law_of_record;
mod levels;
mod loops;
mod misfit;
mod mismatch;
mod next;
mod noise_error;
mod noise_estimate;
mod noise_law;
mod nuisance;
mod null;
mod offset_belief;
mod orthonormal;
mod plan;
mod planned;
mod problem;
mod progress;
mod protocol;
mod protocol_file;
mod random;
mod requirements;
mod residuals;
mod restricted_likelihood;
mod rivals;
mod rows;
mod scene;
mod search;
mod settle;
mod showing;
mod simplex;
mod simulation;
mod smooth;
mod space;
mod stack;
mod tangents;
mod truth;
mod weights;
mod whitening;

pub use compare::{Fitting, Options, compare, fit_effects};
pub use comparison::{
    Bin, Breakdown, Comparison, Curve, CurvePoint, DataSummary, LeftOut, LoopGap, NoiseFloor, Part,
    ResidualMap, Rival, Rung, Stack,
};
pub use confidence::Confidence;
pub use diagnose::{DiagnoseOptions, diagnose};
pub use diagnosis::*;
pub use error::InferenceError;
pub use extension::{Extension, extended};
pub use fit::{Convergence, Fit, Fitted};
pub use next::NextLimits;
pub use noise_error::NoiseError;
pub use noise_law::{CorrelationTime, NoiseLaw, NoiseSource};
pub use offset_belief::OffsetBelief;
pub use plan::{ConfusedPair, Plan, PlannedEffect, plan};
pub use progress::Progress;
pub use protocol::{Block, MOST_ROWS, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors};
pub use protocol_file::PROTOCOL_EXAMPLE;
pub use random::Random;
pub use simulation::{Simulation, simulate};
pub use truth::{Ended, HiddenEffect, HiddenNumber, RigReadings, Truth};
pub use weights::{Noise, effective_rows};
pub use whitening::Whitening;
