//! Errors of the command, each as one message and an exit status.

use bulge_design::QuestionError;
use bulge_design::gas::GasError;
use bulge_design::heat::HeatError;
use bulge_design::sensing::SensingError;
use bulge_design::size::SizeError;
use bulge_effects::CatalogueError;
use bulge_fibre::FibreError;
use bulge_inference::{HideError, InferenceError, Stated, StatementError};
use bulge_measurements::{MeasurementError, WrittenError};
use bulge_membrane::case::CaseError;
use bulge_model::{ModelError, MuscleWithEffectsError};
use bulge_muscles::{Fault, FileError, PresetError};
use bulge_report::cloth::ClothError;
use bulge_report::{LearningError, PlotError};
use bulge_sweep::export::ExportError;
use bulge_sweep::{BuildError, SweepError, TabulateError};
use bulge_table::TableError;
use bulge_vtk::VtkError;
use bulge_workbench::WorkbenchError;
use serde_json::json;
use std::ffi::OsStr;
use std::path::PathBuf;

/// Why a command fails.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{option}: {what}")]
    Value { option: &'static str, what: String },
    #[error("{muscle} at {pressure}: {source}")]
    Equilibrium { muscle: String, pressure: String, source: Box<FibreError> },
    #[error("cannot write {}: {source}", path.display())]
    Output { path: PathBuf, source: std::io::Error },
    /// An error of a library, with the exit status.
    #[error("{says}")]
    Library { says: String, status: u8 },
    #[error("{0}")]
    NotConverged(String),
    #[error("{}: {what}", path.display())]
    TableFile { path: PathBuf, what: String },
    #[error("{0}")]
    Outside(String),
    /// As [`Self::Outside`], with an answer on standard output.
    #[error("{why}")]
    NoneFound { answer: String, why: String },
    #[error("{origin}: {source}{kept}")]
    Membrane { origin: String, source: Box<CaseError>, kept: String },
    #[error("the result cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("{failed} of {all} checks failed:\n{table}")]
    Checks { failed: usize, all: usize, table: String },
}

impl Failure {
    /// The answer on standard output in spite of the failure: a script that requested JSON reads there that
    /// nothing was found, or what failed, as `{"schema": "bulge.failure/1", "message": "...", "status": 1}`.
    pub(crate) fn answer(&self) -> String {
        if let Self::NoneFound { answer, .. } = self {
            return answer.clone();
        }
        if !wants_json() {
            return String::new();
        }
        document(&self.to_string(), self.status())
    }

    /// Exit status: 1 the input is wrong, 3 no solution exists, 4 it did not converge.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Equilibrium { source, .. } => status(source.fault()),
            Self::Library { status, .. } => *status,
            Self::NotConverged(_) => 4,
            Self::Outside(_) | Self::NoneFound { .. } => 3,
            Self::Membrane { source, .. } => status(source.fault()),
            _ => 1,
        }
    }
}

/// What failed, as a document.
pub(crate) fn document(message: &str, status: u8) -> String {
    format!("{:#}\n", json!({ "schema": "bulge.failure/1", "message": message, "status": status }))
}

/// Whether a document was requested, by whatever command.
pub(crate) fn wants_json() -> bool {
    std::env::args_os().any(|argument| argument == OsStr::new("--json"))
}

/// Exit status of a kind of error.
fn status(fault: Fault) -> u8 {
    match fault {
        Fault::Input => 1,
        Fault::NoSolution => 3,
        Fault::NotConverged => 4,
    }
}

/// Turns errors of the libraries into failures: each with its exit status.
macro_rules! of_libraries {
    ($($error:ty: $status:expr,)*) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                let status: fn(&$error) -> u8 = $status;
                Self::Library { status: status(&error), says: error.to_string() }
            }
        })*
    };
}

of_libraries!(
    FileError: |_| 1,
    PresetError: |_| 1,
    VtkError: |_| 1,
    CatalogueError: |_| 1,
    MeasurementError: |_| 1,
    WrittenError: |_| 1,
    SweepError: |_| 1,
    ExportError: |_| 1,
    TableError: |_| 1,
    WorkbenchError: |_| 1,
    InferenceError: |error| status(error.fault()),
    ModelError: |error| status(error.fault()),
    MuscleWithEffectsError: |error| status(error.fault()),
    LearningError: |error| status(error.fault()),
    ClothError: |error| status(error.fault()),
    SizeError: |error| status(error.fault()),
    TabulateError: |error| match error {
        TabulateError::Build(BuildError::NoValue(_)) => 3,
        _ => 1,
    },
    SensingError: |error| status(error.fault()),
    GasError: |error| status(error.fault()),
    HeatError: |error| status(error.fault()),
);

impl<E: std::error::Error + Into<Self>> From<QuestionError<E>> for Failure {
    fn from(error: QuestionError<E>) -> Self {
        match error {
            QuestionError::Part { about, what } => {
                Self::Library { says: format!("--{}: {what}", about.replace('_', "-")), status: 1 }
            }
            QuestionError::Answer(error) => error.into(),
        }
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        Self::Library { says: format!("cannot draw the plot: {error}"), status: 1 }
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
            StatementError::Lines(error) => (*error).into(),
            StatementError::Inference(error) => (*error).into(),
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
