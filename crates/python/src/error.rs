//! Errors of the crates as Python exceptions, with the same sentences.

use bulge_design::gas::GasError;
use bulge_design::heat::HeatError;
use bulge_design::joint::JointError;
use bulge_design::sensing::SensingError;
use bulge_design::size::SizeError;
use bulge_effects::CatalogueError;
use bulge_fibre::FibreError;
use bulge_inference::{HideError, InferenceError, StatementError};
use bulge_measurements::MeasurementError;
use bulge_model::{ModelError, MuscleWithEffectsError};
use bulge_muscles::{Fault, FileError, MuscleError, PresetError};
use bulge_report::{LearningError, PlotError};
use bulge_sweep::{FamilyError, SweepError, TabulateError};
use bulge_table::TableError;
use bulge_vtk::VtkError;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fmt::Display;

create_exception!(
    bulge,
    BulgeError,
    PyValueError,
    "What Bulge can't do, in a sentence: what, where, what to write instead."
);
create_exception!(bulge, InputError, BulgeError, "The input is wrong (the command line's exit status 1).");
create_exception!(
    bulge,
    NoSolutionError,
    BulgeError,
    "No solution exists (exit status 3); the sentence says where the limit lies."
);
create_exception!(bulge, NotConvergedError, BulgeError, "The search did not converge (exit status 4).");

/// What to write instead on the command line, and here.
const IN_PYTHON: [(&str, &str); 5] = [
    ("in --with", "in `with_`"),
    ("`--resume`", "`resume=True`"),
    ("`bulge effects`", "`bulge.effects()`"),
    ("`bulge effects --laws` lists them", "the cards of `bulge.effects()` name those that effects have"),
    ("its file: `--effects FILE`", "`own=`"),
];

/// The exception of a fault, with its sentence.
pub(crate) fn of_fault(fault: Fault, says: String) -> PyErr {
    // The same advice in the words of this language.
    let says = IN_PYTHON.iter().fold(says, |says, (there, here)| says.replace(there, here));
    match fault {
        Fault::Input => InputError::new_err(says),
        Fault::NoSolution => NoSolutionError::new_err(says),
        Fault::NotConverged => NotConvergedError::new_err(says),
    }
}

/// Wrong input.
pub(crate) fn input(says: impl Into<String>) -> PyErr {
    InputError::new_err(says.into())
}

/// What becomes an exception.
pub(crate) trait Raised: Display {
    /// Whose fault it is.
    fn fault(&self) -> Fault {
        Fault::Input
    }
}

macro_rules! raised {
    ($($wrong:ty),*; $($own:ty),*) => {
        $(impl Raised for $wrong {})*
        $(impl Raised for $own {
            fn fault(&self) -> Fault {
                <$own>::fault(self)
            }
        })*
    };
}

raised!(
    FileError, PresetError, MuscleError, MeasurementError, CatalogueError, SweepError, TableError,
    TabulateError, VtkError, PlotError, serde_json::Error, std::io::Error;
    SizeError, JointError, GasError, SensingError, HeatError,
    FibreError, ModelError, MuscleWithEffectsError, FamilyError, InferenceError, HideError, LearningError, StatementError
);

/// `?` for errors of the crates.
pub(crate) trait OrRaise<T> {
    /// The value, or the exception.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Raised> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| of_fault(error.fault(), error.to_string()))
    }
}
