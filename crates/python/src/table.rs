//! Certified tables: looked up at arrays of points.

use bulge_sweep::TableDescription;
use bulge_table as tables;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, ndarray::Array2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use rayon::prelude::*;
use std::sync::Arc;

use crate::error::{OrRaise, input};
use crate::task::{Watch, beside};

/// Most axes of a table.
const MOST_AXES: usize = tables::format::MOST_AXES;
/// Points of one task.
const BLOCK: usize = 4096;

/// A table: its bytes, and that they were checked.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Table {
    bytes: Arc<Vec<u8>>,
    checked: tables::Checked,
    axes: usize,
    outputs: usize,
}

/// Values (points, outputs) and gradients (points, outputs x axes), with NaN outside of the domain.
type Looked<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl Table {
    /// From the bytes of a table file.
    #[staticmethod]
    fn from_bytes(bytes: &[u8], origin: &str) -> PyResult<Self> {
        let table = tables::Table::from_bytes(bytes).map_err(|error| input(format!("{origin}: {error}")))?;
        let (checked, axes, outputs) = (table.checked(), table.axes(), table.outputs());
        Ok(Self { bytes: Arc::new(bytes.to_vec()), checked, axes, outputs })
    }

    /// Its bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    /// The JSON document of what it says of itself.
    fn document(&self) -> PyResult<String> {
        serde_json::to_string(&TableDescription::of(&self.table()?).or_raise()?).or_raise()
    }

    /// Values at one point; none outside of the domain.
    fn at(&self, point: &Bound<'_, PyTuple>) -> PyResult<Option<Vec<f64>>> {
        Ok(self.one(point)?.map(|(values, _)| values))
    }

    /// Gradients at one point, those of the first output first; none outside of the domain.
    fn slopes_at(&self, point: &Bound<'_, PyTuple>) -> PyResult<Option<Vec<f64>>> {
        Ok(self.one(point)?.map(|(_, gradients)| gradients))
    }

    /// Values and gradients at points (points, axes).
    fn sample<'py>(&self, py: Python<'py>, points: PyReadonlyArray2<'py, f64>) -> PyResult<Looked<'py>> {
        let (flat, count) = self.points(&points)?;
        let bytes = Arc::clone(&self.bytes);
        let (checked, axes, outputs) = (self.checked, self.axes, self.outputs);
        let found = looked_up(py, count, move |watch| {
            let table = tables::Table::again(&bytes, checked)?;
            let mut values = vec![f64::NAN; count * outputs];
            let mut gradients = vec![f64::NAN; count * outputs * axes];
            let blocks = flat
                .par_chunks(BLOCK * axes)
                .zip(values.par_chunks_mut(BLOCK * outputs))
                .zip(gradients.par_chunks_mut(BLOCK * outputs * axes));
            blocks.for_each(|((points, values), gradients)| {
                watch.look();
                let rows = points
                    .chunks_exact(axes)
                    .zip(values.chunks_exact_mut(outputs))
                    .zip(gradients.chunks_exact_mut(outputs * axes));
                for ((point, values), gradients) in rows {
                    if table.sample(point, values, gradients).is_none() {
                        values.fill(f64::NAN);
                        gradients.fill(f64::NAN);
                    }
                }
            });
            Ok((values, gradients))
        })?;
        let (values, gradients) = found;
        let array = |values: Vec<f64>, columns: usize| {
            let array = Array2::from_shape_vec((count, columns), values);
            array.map(|array| PyArray2::from_owned_array(py, array)).map_err(|error| input(error.to_string()))
        };
        Ok((array(values, outputs)?, array(gradients, outputs * axes)?))
    }

    /// The end of the first axis at points of the others (points, axes); NaN outside of them.
    fn upper_end<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (flat, count) = self.points(&points)?;
        let bytes = Arc::clone(&self.bytes);
        let (checked, axes) = (self.checked, self.axes);
        let ends = looked_up(py, count, move |watch| {
            let table = tables::Table::again(&bytes, checked)?;
            let mut ends = vec![f64::NAN; count];
            flat.par_chunks(BLOCK * axes).zip(ends.par_chunks_mut(BLOCK)).for_each(|(points, ends)| {
                watch.look();
                for (point, end) in points.chunks_exact(axes).zip(ends) {
                    *end = table.upper_end(point).unwrap_or(f64::NAN);
                }
            });
            Ok(ends)
        })?;
        Ok(PyArray1::from_vec(py, ends))
    }
}

impl Table {
    fn table(&self) -> PyResult<tables::Table<'_>> {
        tables::Table::again(&self.bytes, self.checked).or_raise()
    }

    /// Values and gradients at one point; none outside of the domain.
    fn one(&self, point: &Bound<'_, PyTuple>) -> PyResult<Option<(Vec<f64>, Vec<f64>)>> {
        let mut at = [0.0; MOST_AXES];
        if point.len() != self.axes {
            return Err(input(format!("{} numbers, but the table has {} axes", point.len(), self.axes)));
        }
        for (at, value) in at.iter_mut().zip(point.iter()) {
            *at = value.extract()?;
        }
        let mut values = vec![0.0; self.outputs];
        let mut gradients = vec![0.0; self.outputs * self.axes];
        let found = self.table()?.sample(&at[..self.axes], &mut values, &mut gradients);
        Ok(found.map(|()| (values, gradients)))
    }

    /// Points one after the other, and how many there are.
    fn points(&self, points: &PyReadonlyArray2<'_, f64>) -> PyResult<(Vec<f64>, usize)> {
        let axes = self.axes;
        let points = points.as_array();
        if points.ncols() != axes {
            return Err(input(format!(
                "{} numbers per point, but the table has {axes} axes",
                points.ncols()
            )));
        }
        Ok((points.iter().copied().collect(), points.nrows()))
    }
}

/// Looks up on this thread where there are few points, else beside the interpreter.
fn looked_up<T: Send + 'static>(
    py: Python<'_>,
    count: usize,
    work: impl FnOnce(&Watch) -> Result<T, tables::TableError> + Send + 'static,
) -> PyResult<T> {
    if count <= BLOCK { work(&Watch::default()).or_raise() } else { beside(py, None, work)?.or_raise() }
}
