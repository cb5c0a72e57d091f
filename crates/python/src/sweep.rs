//! Sweeps: a plan that travels as text, chunks run into a folder or made as bytes, the manifest and the table.

use bulge_muscles::{Quantity as _, output, to_toml};
use bulge_sweep::{
    Built, ChunkManifest, Plan, RunOptions, SWEEP_EXAMPLE, TableDescription, begin, complete, manifest,
    piece, run, tabulate,
};
use bulge_table::Table;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Arc;

use crate::error::{OrRaise, input};
use crate::task::{beside, beside_on};

/// A sweep.
#[pyclass(frozen, module = "bulge._bulge")]
#[derive(Clone)]
pub(crate) struct Sweep {
    plan: Arc<Plan>,
    text: String,
}

/// A sweep file with every key.
#[pyfunction]
pub(crate) fn sweep_example() -> &'static str {
    SWEEP_EXAMPLE
}

#[pymethods]
impl Sweep {
    /// From the text of a sweep file; `folder` is where its muscle file lies.
    #[staticmethod]
    fn from_text(text: &str, origin: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let plan = Arc::new(Plan::from_toml(text, origin, folder.as_deref()).or_raise()?);
        Ok(Self { plan, text: text.to_owned() })
    }

    /// The same with the muscle beside it: for processes that don't see the muscle file.
    #[staticmethod]
    fn with_muscle(text: &str, muscle: &str) -> PyResult<Self> {
        let muscle = bulge_muscles::from_toml(muscle, "muscle").or_raise()?;
        let plan = Arc::new(Plan::with_muscle(text, "sweep", &muscle).or_raise()?);
        Ok(Self { plan, text: text.to_owned() })
    }

    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The file of its muscle.
    #[getter]
    fn muscle(&self) -> String {
        to_toml(&self.plan.muscle)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.plan.name
    }

    #[getter]
    fn points(&self) -> u128 {
        self.plan.points()
    }

    #[getter]
    fn chunks(&self) -> u64 {
        self.plan.chunks()
    }

    /// Points of one chunk.
    #[getter]
    fn chunk(&self) -> u64 {
        self.plan.chunk
    }

    /// Length of the muscle \[m\].
    #[getter]
    fn length(&self) -> f64 {
        self.plan.muscle.length().si()
    }

    /// Names and units of the columns.
    #[getter]
    fn columns(&self) -> Vec<(String, String)> {
        let axes = self.plan.axes.iter().map(|axis| (axis.name.clone(), axis.unit.clone()));
        axes.chain(self.plan.outputs.iter().map(|output| (output.name(), output.unit()))).collect()
    }

    #[getter]
    fn has_table(&self) -> bool {
        self.plan.table.is_some()
    }

    /// What decides the numbers: `plan.json`.
    fn canonical(&self) -> PyResult<String> {
        self.plan.canonical().or_raise()
    }

    /// Writes a file so that it is there whole or not at all.
    #[staticmethod]
    fn write(py: Python<'_>, path: PathBuf, content: Vec<u8>) -> PyResult<()> {
        let wrong = |error: std::io::Error| input(format!("cannot write {}: {error}", path.display()));
        py.detach(|| output::write(&path, &content)).map_err(wrong)
    }

    /// Makes a folder ready for the chunks.
    fn begin(&self, folder: PathBuf, resume: bool, csv: bool) -> PyResult<()> {
        begin(&self.plan, &folder, &RunOptions { resume, csv, ..RunOptions::default() }).or_raise()
    }

    /// Writes the manifest by the promises of the chunks; the JSON document, or none if one is missing.
    fn complete(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Option<String>> {
        let found = py.detach(|| complete(&self.plan, &folder)).or_raise()?;
        found.map(|summary| serde_json::to_string(&summary).or_raise()).transpose()
    }

    /// Runs chunks into a folder; the JSON document of what was done.
    #[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
    fn run(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        resume: bool,
        chunks: Option<(u64, u64)>,
        csv: bool,
        merge: Vec<PathBuf>,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<String> {
        let plan = Arc::clone(&self.plan);
        let options = RunOptions { chunks: chunks.map(|(a, b)| a..b), resume, csv, merge };
        let found = beside_on(py, progress, threads, move |watch| {
            run(&plan, &folder, &options, &|done| {
                watch.at(done.done as f64 / done.all.max(1) as f64, "points");
            })
        })?;
        serde_json::to_string(&found.or_raise()?).or_raise()
    }

    /// One chunk as bytes: its Parquet file, its CSV file if asked for, and its promise.
    fn piece<'py>(
        &self,
        py: Python<'py>,
        chunk: u64,
        csv: bool,
    ) -> PyResult<(Bound<'py, PyBytes>, Option<String>, String)> {
        let plan = Arc::clone(&self.plan);
        let made = beside(py, None, move |_| piece(&plan, chunk, csv))?.or_raise()?;
        let promise = serde_json::to_string(&made.promise).or_raise()? + "\n";
        Ok((PyBytes::new(py, &made.parquet), made.csv, promise))
    }

    /// The text of `manifest.json` from those of all promises, in their order.
    fn manifest(&self, promises: Vec<String>) -> PyResult<String> {
        let promises: Vec<ChunkManifest> =
            promises.iter().map(|text| serde_json::from_str(text)).collect::<Result<_, _>>().or_raise()?;
        manifest(&self.plan, &promises).or_raise()
    }

    /// The table that the sweep wishes: its bytes, the JSON document of what it says of itself, and whether it reaches the tolerance.
    fn table<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyBytes>, String, bool)> {
        let plan = Arc::clone(&self.plan);
        let built = beside(py, progress, move |watch| {
            let built = plan.table.as_ref().map(|wish| tabulate(&plan, wish, &|what| watch.at(0.0, what)));
            watch.at(1.0, "done");
            built
        })?;
        let Some(built) = built else {
            return Err(input(
                "this sweep has no `[table]`: add one to its file, as in `bulge.sweep_example()`",
            ));
        };
        let Built { bytes, is_met, .. } = built.or_raise()?;
        let description = TableDescription::of(&Table::from_bytes(&bytes).or_raise()?).or_raise()?;
        let text = serde_json::to_string_pretty(&description).or_raise()? + "\n";
        Ok((PyBytes::new(py, &bytes), text, is_met))
    }
}
