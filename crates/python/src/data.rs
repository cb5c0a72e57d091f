//! Measurements: read from files or from the text of a table, and as columns.

use bulge_measurements::{self as measurements, ColumnMap, QualityOptions, ReadOptions, Trace};
use bulge_model::read_options;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;

use crate::error::OrRaise;
use crate::muscle::Muscle;

/// How files are read.
fn options(columns: Option<&str>, muscle: Option<&Muscle>, force_may_lack: bool) -> PyResult<ReadOptions> {
    let columns = columns.map(str::parse::<ColumnMap>).transpose().or_raise()?;
    let options = match muscle {
        Some(muscle) => read_options(&muscle.muscle, columns.as_ref()).or_raise()?,
        None => ReadOptions { columns: columns.unwrap_or_default(), ..ReadOptions::default() },
    };
    Ok(ReadOptions { force_may_lack, ..options })
}

/// A checked set of measurements.
#[pyclass(frozen, module = "bulge._bulge")]
#[derive(Clone)]
pub(crate) struct Data(pub(crate) Arc<measurements::Data>);

#[pymethods]
impl Data {
    /// From files; `columns` says which column is which, and the muscle how a displacement counts.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        columns: Option<&str>,
        muscle: Option<PyRef<'_, Muscle>>,
        force_may_lack: bool,
    ) -> PyResult<Self> {
        let options = options(columns, muscle.as_deref(), force_may_lack)?;
        Ok(Self(Arc::new(py.detach(|| measurements::Data::read_with(&paths, &options)).or_raise()?)))
    }

    /// From the text of a CSV file.
    #[staticmethod]
    fn from_csv(
        py: Python<'_>,
        text: &str,
        origin: &str,
        columns: Option<&str>,
        muscle: Option<PyRef<'_, Muscle>>,
        force_may_lack: bool,
    ) -> PyResult<Self> {
        let options = options(columns, muscle.as_deref(), force_may_lack)?;
        let read = || measurements::Data::from_bytes(text.as_bytes(), origin, &options);
        Ok(Self(Arc::new(py.detach(read).or_raise()?)))
    }

    /// What columns were taken for, which rows were set apart: the JSON document.
    fn reading(&self) -> PyResult<String> {
        serde_json::to_string(self.0.reading()).or_raise()
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Whether the rows follow each other; else they are a static map.
    #[getter]
    fn is_path(&self) -> bool {
        self.0.is_path()
    }

    /// Whether a force was measured.
    #[getter]
    fn has_force(&self) -> bool {
        self.0.has_force()
    }

    #[getter]
    fn n_sweeps(&self) -> usize {
        self.0.sweeps().len()
    }

    #[getter]
    fn files(&self) -> Vec<String> {
        self.0.files().iter().map(|file| file.name.clone()).collect()
    }

    #[getter]
    fn sha256(&self) -> String {
        self.0.sha256()
    }

    /// The columns in SI, by names that say the unit.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let data = &self.0;
        let columns = PyDict::new(py);
        let number = |values: &[f64]| PyArray1::from_slice(py, values);
        columns.set_item("pressure_pa", number(data.pressure()))?;
        match data.motion() {
            Trace::Contraction(values) => columns.set_item("contraction", number(values))?,
            Trace::Length(values) => columns.set_item("length_m", number(values))?,
        }
        if data.has_force() {
            columns.set_item("force_n", number(data.force()))?;
        }
        for (name, values) in [
            ("time_s", data.time()),
            ("temperature_k", data.temperature()),
            ("diameter_m", data.columns().diameter_m.as_deref()),
            ("volume_m3", data.columns().volume_m3.as_deref()),
            ("force_sd_n", data.force_sd()),
        ] {
            if let Some(values) = values {
                columns.set_item(name, number(values))?;
            }
        }
        if let Some(values) = data.columns().cycle.as_deref() {
            columns.set_item("cycle", PyArray1::from_slice(py, values))?;
        }
        let mut sweep = vec![0_i64; data.len()];
        for (number, one) in (0..).zip(data.sweeps()) {
            if let Some(rows) = sweep.get_mut(one.rows.clone()) {
                rows.fill(number);
            }
        }
        columns.set_item("sweep", PyArray1::from_vec(py, sweep))?;
        let names = data.specimens();
        let name = |row| names.get(data.specimen_of(row) as usize).map_or("", String::as_str);
        let specimen: Vec<&str> = (0..data.len()).map(name).collect();
        columns.set_item("specimen", specimen)?;
        Ok(columns)
    }

    /// What is noteworthy about the data, in sentences; of a muscle of length `l0`, if that is known.
    fn quality(&self, l0: Option<f64>) -> Vec<String> {
        let options = QualityOptions { l0_m: l0, ..QualityOptions::default() };
        self.0.quality(&options).findings.into_iter().map(|finding| finding.says).collect()
    }
}
