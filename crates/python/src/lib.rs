//! The compiled part of the Python package `bulge`: thin classes over the crates, which the Python part (`python/bulge`) makes pleasant.
//!
//! What crosses the border: NumPy arrays of `f64` in SI, JSON documents as text (the same as those of the command line), and texts of TOML
//! files. What takes long runs on a thread of its own without the interpreter's lock, so that Ctrl-C is heard and progress can be told
//! (`task`). Errors become exceptions with the sentences of the crates (`error`).
//!
//! Deliberately absent: units of arguments, pandas, plots, distribution. They are Python, in the part that is.

#![allow(
    clippy::needless_pass_by_value,
    reason = "arguments of a Python function are values; `&self` and `Py<..>` are how PyO3 hands them over"
)]

mod data;
mod design;
mod error;
mod evaluate;
mod inference;
mod muscle;
mod shape;
mod statements;
mod sweep;
mod table;
mod task;

use mimalloc::MiMalloc;
use pyo3::{pyfunction, pymodule};

/// Dask starts its workers with `MALLOC_TRIM_THRESHOLD_`, with which glibc gives large blocks, and the top of its heap, back to the system as soon
/// as they are free: page faults then take a tenth of a sweep. An allocator of our own does not hear that.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The compiled part of `bulge`.
#[pymodule(name = "_bulge")]
mod bulge_module {
    use super::error::{BulgeError, InputError, NoSolutionError, NotConvergedError};
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::data::Data;
    #[pymodule_export]
    use super::design::{
        Answer, air_fill, air_shut, air_stroke, heat, joint, membrane, resistance, sense, size, weight,
    };
    #[pymodule_export]
    use super::inference::{
        Comparison, Diagnosis, Fit, compare, diagnose, effect_names, effects, fit, next_experiment, plan,
        predict, simulate,
    };
    #[pymodule_export]
    use super::muscle::{Muscle, presets, si, unit_factor, units_of};
    #[pymodule_export]
    use super::shape::Shape;
    #[pymodule_export]
    use super::sweep::{Sweep, sweep_example};
    #[pymodule_export]
    use super::table::Table;
    #[pymodule_export]
    use super::version;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let py = module.py();
        module.add("BulgeError", py.get_type::<BulgeError>())?;
        module.add("InputError", py.get_type::<InputError>())?;
        module.add("NoSolutionError", py.get_type::<NoSolutionError>())?;
        module.add("NotConvergedError", py.get_type::<NotConvergedError>())
    }
}

/// The version of Bulge.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
