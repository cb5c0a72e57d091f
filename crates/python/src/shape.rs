//! One equilibrium shape: its document, its meridian and its surface as arrays.

use bulge_model::Equilibrium;
use bulge_vtk::{Bulge, Style, write_vtp};
use numpy::{PyArray1, PyArray2, ndarray::Array2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

use crate::error::{OrRaise, input};

/// An equilibrium.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Shape {
    pub(crate) muscle: bulge_muscles::Muscle,
    pub(crate) found: Equilibrium,
}

impl Shape {
    fn bulge(&self, surface: Option<&str>, cloth: Option<f64>, facets: Option<u32>) -> PyResult<Bulge<'_>> {
        let shape = &self.found.shape;
        let style = match surface {
            None => Style::natural(&self.muscle, shape, cloth),
            Some("pleats") => Style::Pleats { cloth_circumference: cloth },
            Some("revolution") => Style::Revolution,
            Some(other) => {
                return Err(input(format!(
                    "surface: there is no `{other}`; write \"pleats\" or \"revolution\""
                )));
            }
        };
        let bulge = Bulge::of(&self.muscle, shape, style);
        Ok(Bulge { facets: facets.unwrap_or(bulge.facets), ..bulge })
    }
}

#[pymethods]
impl Shape {
    /// The JSON document of `bulge shape --json`.
    fn document(&self) -> PyResult<String> {
        serde_json::to_string(&self.found.document()).or_raise()
    }

    /// The meridian, an array for each quantity.
    fn meridian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let points = &self.found.shape.meridian;
        let columns = PyDict::new(py);
        let add = |name: &str, of: &dyn Fn(&bulge_fibre::MeridianPoint) -> f64| {
            columns.set_item(name, PyArray1::from_iter(py, points.iter().map(of)))
        };
        add("x_m", &|p| p.x_m)?;
        add("r_m", &|p| p.r_m)?;
        add("slope_rad", &|p| p.slope_rad)?;
        add("braid_angle_rad", &|p| p.braid_angle_rad)?;
        add("fibre_tension_n", &|p| p.fibre_tension_n)?;
        add("fibre_strain", &|p| p.fibre_strain)?;
        add("membrane_force_n_per_m", &|p| p.membrane_force_n_per_m)?;
        add("fibre_length_m", &|p| p.fibre_length_m)?;
        add("turn_rad", &|p| p.turn_rad)?;
        Ok(columns)
    }

    /// The surface: `points` (n, 3) \[m\], `quads` (m, 4), `fibres` (k, stations), `point_data` and `cell_data` by name. Cells are first the
    /// fibres, then the quadrangles.
    fn surface<'py>(
        &self,
        py: Python<'py>,
        surface: Option<&str>,
        cloth: Option<f64>,
        facets: Option<u32>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let mesh = self.bulge(surface, cloth, facets)?.mesh().or_raise()?;
        let all = PyDict::new(py);
        all.set_item("points", table(py, mesh.points.len(), 3, mesh.points.iter().flatten().copied())?)?;
        let index = |i: &usize| i64::try_from(*i).unwrap_or(i64::MAX);
        all.set_item("quads", table(py, mesh.quads.len(), 4, mesh.quads.iter().flatten().map(index))?)?;
        let stations = mesh.fibres.first().map_or(0, Vec::len);
        let fibres = mesh.fibres.iter().flatten().map(index);
        all.set_item("fibres", table(py, mesh.fibres.len(), stations, fibres)?)?;
        let fields = |fields: Vec<(&'static str, Vec<f64>)>| -> PyResult<Bound<'py, PyDict>> {
            let named = PyDict::new(py);
            for (name, values) in fields {
                named.set_item(name, PyArray1::from_vec(py, values))?;
            }
            Ok(named)
        };
        all.set_item("point_data", fields(mesh.point_fields)?)?;
        let cells = fields(mesh.cell_fields)?;
        cells.set_item("part", PyArray1::from_vec(py, mesh.part))?;
        all.set_item("cell_data", cells)?;
        Ok(all)
    }

    /// Writes the surface as a VTK file (.vtp).
    fn write_vtk(&self, path: PathBuf, surface: Option<&str>, cloth: Option<f64>) -> PyResult<()> {
        write_vtp(path, &self.bulge(surface, cloth, None)?).or_raise()
    }
}

/// Rows of numbers as an array.
fn table<T: numpy::Element>(
    py: Python<'_>,
    rows: usize,
    columns: usize,
    values: impl Iterator<Item = T>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let array = Array2::from_shape_vec((rows, columns), values.collect());
    Ok(PyArray2::from_owned_array(py, array.map_err(|error| input(error.to_string()))?))
}
