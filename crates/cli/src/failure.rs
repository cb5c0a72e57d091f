//! Errors of the command, each as one message and an exit status.

use bulge_design::gas::GasError;
use bulge_design::heat::HeatError;
use bulge_design::sensing::SensingError;
use bulge_design::size::SizeError;
use bulge_effects::CatalogueError;
use bulge_fibre::FibreError;
use bulge_inference::{HideError, InferenceError, Stated, StatementError};
use bulge_measurements::{MeasurementError, WrittenError};
use bulge_membrane::MembraneError;
use bulge_membrane::case::CaseError;
use bulge_model::{ModelError, MuscleWithEffectsError};
use bulge_muscles::{Fault, FileError, PresetError, UnitError};
use bulge_report::{LearningError, PlotError};
use bulge_sweep::export::ExportError;
use bulge_sweep::{BuildError, SweepError, TabulateError};
use bulge_table::TableError;
use bulge_vtk::VtkError;
use std::path::PathBuf;

/// Why a command fails.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{0}")]
    File(Box<FileError>),
    #[error("{0}")]
    Preset(Box<PresetError>),
    #[error("{option}: {source}")]
    Option { option: &'static str, source: Box<UnitError> },
    #[error("{option}: {what}")]
    Value { option: &'static str, what: String },
    #[error("{muscle} at {pressure}: {source}")]
    Equilibrium { muscle: String, pressure: String, source: Box<FibreError> },
    #[error("cannot write {}: {source}", path.display())]
    Output { path: PathBuf, source: std::io::Error },
    #[error("{0}")]
    Vtk(Box<VtkError>),
    #[error("cannot draw the plot: {0}")]
    Plot(Box<PlotError>),
    #[error("{0}")]
    Effect(Box<CatalogueError>),
    #[error("{0}")]
    Measurement(Box<MeasurementError>),
    #[error("{0}")]
    Inference(Box<InferenceError>),
    #[error("{0}")]
    Model(Box<ModelError>),
    #[error("{0}")]
    MuscleWithEffects(Box<MuscleWithEffectsError>),
    #[error("{0}")]
    NotConverged(String),
    #[error("{0}")]
    Learning(Box<LearningError>),
    #[error("{0}")]
    Size(Box<SizeError>),
    #[error("{0}")]
    Sensing(Box<SensingError>),
    #[error("{0}")]
    Heat(Box<HeatError>),
    #[error("{0}")]
    Gas(Box<GasError>),
    #[error("{0}")]
    Sweep(Box<SweepError>),
    #[error("{0}")]
    Tabulate(Box<TabulateError>),
    #[error("{0}")]
    Export(Box<ExportError>),
    #[error("{}: {what}", path.display())]
    TableFile { path: PathBuf, what: String },
    #[error("{0}")]
    Table(#[from] TableError),
    #[error("{0}")]
    Outside(String),
    /// As [`Self::Outside`], with an answer on standard output.
    #[error("{why}")]
    NoneFound { answer: String, why: String },
    #[error("{origin}: {source}{kept}")]
    Membrane { origin: String, source: Box<CaseError>, kept: String },
    #[error(transparent)]
    Workbench(#[from] bulge_workbench::WorkbenchError),
    #[error("the result cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("{0}")]
    Written(#[from] WrittenError),
    #[error("{failed} of {all} checks failed:\n{table}")]
    Checks { failed: usize, all: usize, table: String },
}

impl Failure {
    /// The answer on standard output in spite of the failure: a script that requested JSON reads there that
    /// nothing was found.
    pub(crate) fn answer(&self) -> &str {
        if let Self::NoneFound { answer, .. } = self { answer } else { "" }
    }

    /// Exit status: 1 the input is wrong, 3 no solution exists, 4 it did not converge.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Equilibrium { source, .. } => status(source.fault()),
            Self::Inference(error) => status(error.fault()),
            Self::Model(error) => status(error.fault()),
            Self::MuscleWithEffects(error) => status(error.fault()),
            Self::NotConverged(_) => 4,
            Self::Learning(error) => status(error.fault()),
            Self::Outside(_) | Self::NoneFound { .. } => 3,
            Self::Sensing(error) => match error.as_ref() {
                SensingError::Equilibrium { .. }
                | SensingError::Overstrained { .. }
                | SensingError::NotMonotone { .. }
                | SensingError::NoChange
                | SensingError::NoPlace { .. } => 3,
                _ => 1,
            },
            Self::Gas(error) => match error.as_ref() {
                GasError::Number { .. } => 1,
                GasError::Stopped { .. } => 4,
                GasError::Muscle { error, .. } => status(error.fault()),
                _ => 3,
            },
            Self::Heat(error) => match error.as_ref() {
                HeatError::Invalid { .. } => 1,
                HeatError::Choked { .. } => 3,
                HeatError::Step { .. } | HeatError::NotPeriodic { .. } => 4,
            },
            Self::Size(error) if matches!(**error, SizeError::Muscle { .. }) => 3,
            Self::Tabulate(error) => match error.as_ref() {
                TabulateError::Build(BuildError::NoValue(_)) => 3,
                _ => 1,
            },
            Self::Membrane { source, .. } => match source.as_ref() {
                CaseError::State {
                    source:
                        MembraneError::LimitPoint { .. }
                        | MembraneError::Collapsed { .. }
                        | MembraneError::Overstretched { .. },
                    ..
                } => 3,
                CaseError::Structure(_) | CaseError::State { source: MembraneError::NoGas { .. }, .. } => 1,
                CaseError::State { .. } => 4,
            },
            _ => 1,
        }
    }
}

/// Exit status of a kind of error.
fn status(fault: Fault) -> u8 {
    match fault {
        Fault::Input => 1,
        Fault::NoSolution => 3,
        Fault::NotConverged => 4,
    }
}

impl From<HideError> for Failure {
    fn from(error: HideError) -> Self {
        match error {
            HideError::Stated(what) => Self::Value { option: "--with", what },
            HideError::Effect(error) => error.into(),
            HideError::File(error) => error.into(),
            HideError::Model(error) => error.into(),
            HideError::Inference(error) => error.into(),
        }
    }
}

impl From<StatementError> for Failure {
    fn from(error: StatementError) -> Self {
        match error {
            StatementError::Text { about, what } => Self::Value { option: option(about), what },
            StatementError::Lines(error) => Self::Measurement(error),
            StatementError::Inference(error) => Self::Inference(error),
        }
    }
}

/// The option to which the error belongs.
fn option(about: Stated) -> &'static str {
    match about {
        Stated::Exclude => "--exclude",
        Stated::Hold => "--hold",
        Stated::Bound => "--bound",
        Stated::Tie => "--tie",
    }
}

/// Converts errors of the libraries into failures. They are boxed, since they are large and rare.
macro_rules! boxed {
    ($($variant:ident($error:ty)),*) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::$variant(Box::new(error))
            }
        })*
    };
}

boxed!(
    File(FileError),
    Preset(PresetError),
    Vtk(VtkError),
    Plot(PlotError),
    Effect(CatalogueError),
    Measurement(MeasurementError),
    Inference(InferenceError),
    Learning(LearningError),
    Model(ModelError),
    Size(SizeError),
    Sensing(SensingError),
    Heat(HeatError),
    Gas(GasError),
    Sweep(SweepError),
    Tabulate(TabulateError),
    Export(ExportError)
);
