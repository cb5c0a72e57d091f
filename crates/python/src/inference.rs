//! Model against measurement: the functions of `bulge-inference` with their documents, and reports.

use bulge_effects::{Catalogue, Effect, describe, known};
use bulge_inference as inference;
use bulge_inference::{DiagnoseOptions, Loss, NextLimits, Options, Progress, Protocol, rows_to_exclude};
use bulge_report::diagnosis::NextStep;
use bulge_report::{Learnt, comparison, diagnosis, posterior_svg};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

use crate::data::Data;
use crate::error::{OrRaise, input};
use crate::muscle::{Muscle, catalogue, own_effects};
use crate::statements::Said;
use crate::task::{Watch, beside, beside_on};

/// Name, title and drawing of each plot of a report.
type Plots = Vec<(String, String, String)>;

/// A comparison, with its rows for reports.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Comparison(inference::Comparison, inference::Rows);

#[pymethods]
impl Comparison {
    /// The JSON document.
    fn document(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).or_raise()
    }

    /// Rows as columns in SI, by names that say the unit.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows = &self.1;
        let columns = PyDict::new(py);
        let names = |names: &[String], index: &[u32]| -> Vec<String> {
            index.iter().map(|k| names.get(*k as usize).cloned().unwrap_or_default()).collect()
        };
        columns.set_item("file", names(&rows.files, &rows.file))?;
        columns.set_item("line", PyArray1::from_iter(py, rows.line.iter().map(|line| i64::from(*line))))?;
        if rows.is_path {
            columns.set_item("sweep", names(&rows.sweeps, &rows.sweep))?;
        }
        columns.set_item("specimen", names(&rows.specimens, &rows.specimen))?;
        columns.set_item("counts", PyArray1::from_slice(py, &rows.counts))?;
        let numbers = [
            ("time_s", rows.time_s.as_deref()),
            ("pressure_pa", Some(&rows.pressure_pa[..])),
            ("contraction", Some(&rows.contraction)),
            ("measured_n", Some(&rows.measured_n)),
            ("base_n", Some(&rows.base_n)),
            ("model_n", Some(&rows.model_n)),
            ("residual_n", Some(&rows.residual_n())),
        ];
        for (name, values) in numbers.into_iter().filter_map(|(name, values)| Some((name, values?))) {
            columns.set_item(name, PyArray1::from_slice(py, values))?;
        }
        Ok(columns)
    }

    /// The report, a page that stands for itself.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| comparison::html(&self.0, Some(&self.1))).or_raise()
    }

    /// Its plots as SVG: name, title, drawing.
    fn plots(&self, py: Python<'_>) -> PyResult<Plots> {
        Ok(drawings(py.detach(|| comparison::plots(&self.0)).or_raise()?))
    }
}

/// A diagnosis, with its reports.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Diagnosis(inference::Diagnosis);

#[pymethods]
impl Diagnosis {
    /// The JSON document.
    fn document(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).or_raise()
    }

    /// The verdict in sentences.
    fn headlines(&self) -> Vec<String> {
        diagnosis::headlines(&self.0)
    }

    /// The report, a page that stands for itself.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| diagnosis::html(&self.0)).or_raise()
    }

    /// Its plots as SVG: name, title, drawing.
    fn plots(&self, py: Python<'_>) -> PyResult<Plots> {
        Ok(drawings(py.detach(|| diagnosis::plots(&self.0)).or_raise()?))
    }
}

fn drawings(plots: Vec<comparison::Plot>) -> Plots {
    plots.into_iter().map(|plot| (plot.name.to_owned(), plot.title, plot.svg)).collect()
}

/// The effects of the muscle and the user's own, and those that are named.
fn options(muscle: &Muscle, own: &str, with: &[String]) -> PyResult<Options> {
    let catalogue = all(muscle, own)?;
    let effects = with
        .iter()
        .map(|name| Ok(Arc::clone(catalogue.find(name.trim()).or_raise()?)))
        .collect::<PyResult<Vec<Arc<dyn Effect>>>>()?;
    let known = known(&muscle.muscle, &catalogue).or_raise()?;
    Ok(Options { known, ..Options::new(catalogue, effects) })
}

/// The built-in effects, the muscle's own and further ones; an effect that both state is one.
fn all(muscle: &Muscle, own: &str) -> PyResult<Catalogue> {
    let stated = own_effects(&muscle.own)?;
    let mut catalogue = catalogue(&muscle.own)?;
    for effect in own_effects(own)?.into_iter().filter(|effect| !stated.contains(effect)) {
        catalogue = catalogue.with(effect).or_raise()?;
    }
    Ok(catalogue)
}

/// A loss by its name.
fn loss_named(name: &str) -> PyResult<Loss> {
    Loss::named(name).ok_or_else(|| {
        let all = Loss::ALL.map(Loss::name).join("\", \"");
        input(format!("loss: there is no \"{name}\"; write \"{all}\""))
    })
}

fn telling(watch: &Watch) -> Progress {
    let (told, beat) = (watch.clone(), watch.clone());
    Progress::to(move |share, what| told.at(share, what)).beating(move || beat.look())
}

/// Compares; see `bulge.compare`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn compare(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    with_: Vec<String>,
    own: &str,
    law: Option<&str>,
    fit_law: bool,
    rivals: bool,
    loss: &str,
    said: Said,
) -> PyResult<Comparison> {
    let mut options = options(muscle, own, &with_)?;
    options.loss = loss_named(loss)?;
    options.rivals = rivals;
    if let Some(name) = law {
        options =
            options.with_law(name, &muscle.muscle, fit_law).map_err(|what| input(format!("law: {what}")))?;
    }
    let options = said.apply(py, options, &data.0, &muscle.muscle)?;
    let (data, muscle) = (Arc::clone(&data.0), muscle.muscle.clone());
    let found = beside(py, None, move |_| inference::compare_with_rows(&data, &muscle, &options))?;
    let (comparison, rows) = found.or_raise()?;
    Ok(Comparison(comparison, rows))
}

/// The options of a diagnosis.
struct Asked {
    base: Options,
    among: Option<Vec<String>>,
    tolerance_n: Option<f64>,
    seed: u64,
    limits: NextLimits,
}

/// Diagnoses beside the interpreter.
fn diagnosed(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    asked: Asked,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<inference::Diagnosis> {
    let (data, muscle) = (Arc::clone(&data.0), muscle.muscle.clone());
    let found = beside_on(py, progress, threads, move |watch| {
        let Asked { base, among, tolerance_n, seed, limits } = asked;
        let progress = telling(watch);
        let base = DiagnoseOptions::new(base);
        let options = DiagnoseOptions { among, tolerance_n, seed, limits, progress, ..base };
        inference::diagnose(&data, &muscle, &options)
    })?;
    found.or_raise()
}

/// Diagnoses; see `bulge.diagnose`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn diagnose(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    with_: Vec<String>,
    own: &str,
    among: Vec<String>,
    tolerance: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    said: Said,
    progress: Option<Py<PyAny>>,
) -> PyResult<Diagnosis> {
    if tolerance.is_some_and(|tolerance| tolerance.is_nan() || tolerance < 0.0) {
        return Err(input("tolerance: give the RMS misfit that doesn't matter, such as \"5 N\""));
    }
    let base = options(muscle, own, &with_)?;
    let named = |name: &String| base.catalogue.find(name.trim()).or_raise().map(|e| e.card().name.to_owned());
    let among = among.iter().map(named).collect::<PyResult<Vec<String>>>()?;
    let among = (!among.is_empty()).then_some(among);
    let base = said.apply(py, base, &data.0, &muscle.muscle.clone().with_usual_widths().0)?;
    let asked = Asked { base, among, tolerance_n: tolerance, seed, limits: NextLimits::default() };
    Ok(Diagnosis(diagnosed(py, data, muscle, asked, threads, progress)?))
}

/// The document of the next experiment; see `bulge.next_experiment`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn next_experiment(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    with_: Vec<String>,
    own: &str,
    pressure: Option<[f64; 2]>,
    contraction: Option<[f64; 2]>,
    seed: u64,
    said: Said,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let limits = NextLimits { pressure_pa: pressure, contraction };
    limits.check().map_err(|(name, what)| input(format!("{name}: {what}")))?;
    let base = options(muscle, own, &with_)?;
    let base = said.apply(py, base, &data.0, &muscle.muscle.clone().with_usual_widths().0)?;
    let catalogue = base.catalogue.clone();
    let asked = Asked { base, among: None, tolerance_n: None, seed, limits };
    let found = diagnosed(py, data, muscle, asked, None, progress)?;
    serde_json::to_string(&NextStep::after(&found, &catalogue, limits).document()).or_raise()
}

/// A fit, with what it was made of: its rows are computed when they are asked for.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Fit {
    document: String,
    data: Arc<bulge_measurements::Data>,
    muscle: bulge_muscles::Muscle,
    options: Options,
}

#[pymethods]
impl Fit {
    /// The JSON document.
    fn document(&self) -> &str {
        &self.document
    }

    /// The comparison whose last rung is this fit.
    fn comparison(&self, py: Python<'_>) -> PyResult<Comparison> {
        let (data, muscle) = (Arc::clone(&self.data), self.muscle.clone());
        // The ladder of a fit has no held-out errors.
        let options = Options { held_out: false, ..self.options.clone() };
        let found = beside(py, None, move |_| inference::compare_with_rows(&data, &muscle, &options))?;
        let (comparison, rows) = found.or_raise()?;
        Ok(Comparison(comparison, rows))
    }

    /// The posterior of its numbers: a JSON document, the draws (draw, number), and the picture as SVG.
    fn posterior<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
    ) -> PyResult<(String, Bound<'py, PyArray2<f64>>, Option<String>)> {
        let (data, muscle, options) = (Arc::clone(&self.data), self.muscle.clone(), self.options.clone());
        let title = format!("{}: what the data leave open", muscle.name());
        let found = beside(py, None, move |_| inference::posterior(&data, &muscle, &options, seed))?;
        let (_, posterior) = found.or_raise()?;
        let draws = PyArray2::from_vec2(py, &posterior.draws).map_err(|error| input(error.to_string()))?;
        let picture = posterior_svg(&title, &posterior).ok();
        Ok((serde_json::to_string(&posterior).or_raise()?, draws, picture))
    }
}

/// Fits; see `bulge.fit`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn fit(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    with_: Vec<String>,
    own: &str,
    form_error: bool,
    loss: &str,
    said: Said,
) -> PyResult<Fit> {
    let mut options = said.apply(py, options(muscle, own, &with_)?, &data.0, &muscle.muscle)?;
    options.loss = loss_named(loss)?;
    let (data, muscle) = (Arc::clone(&data.0), muscle.muscle.clone());
    let (of, on, with) = (Arc::clone(&data), muscle.clone(), options.clone());
    let fitting = beside(py, None, move |_| inference::fit_effects(&of, &on, &with))?;
    let learnt = Learnt::of(fitting.or_raise()?).or_raise()?;
    let drawn = if form_error {
        let (of, on, with) = (Arc::clone(&data), muscle.clone(), options.clone());
        let drawn = beside(py, None, move |_| inference::drawn_forms(&of, &on, &with))?;
        Some(drawn.or_raise()?)
    } else {
        None
    };
    let document = serde_json::to_string(&learnt.document().with_drawn(drawn.as_ref())).or_raise()?;
    Ok(Fit { document, data, muscle, options })
}

/// The document of a prediction; see `bulge.predict`.
#[pyfunction]
pub(crate) fn predict(
    py: Python<'_>,
    data: &Data,
    muscle: &Muscle,
    own: &str,
    exclude: Option<&str>,
) -> PyResult<String> {
    let catalogue = all(muscle, own)?;
    let excluded = exclude.map(|lines| rows_to_exclude(lines, &data.0)).transpose().or_raise()?;
    let excluded = excluded.unwrap_or_default();
    let (data, muscle) = (Arc::clone(&data.0), muscle.muscle.clone());
    let found = beside(py, None, move |_| inference::predict(&data, &muscle, &catalogue, &excluded))?;
    serde_json::to_string(&found.or_raise()?).or_raise()
}

/// The document of a plan; see `bulge.plan`.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    muscle: &Muscle,
    protocol: &str,
    origin: &str,
    own: &str,
) -> PyResult<String> {
    let protocol = Protocol::from_toml(protocol, origin).or_raise()?;
    let catalogue = all(muscle, own)?;
    let known = known(&muscle.muscle, &catalogue).or_raise()?;
    let muscle = muscle.muscle.clone();
    let found = beside(py, None, move |_| inference::plan(&muscle, &known, &catalogue, &protocol))?;
    serde_json::to_string(&found.or_raise()?).or_raise()
}

/// Simulated measurements: the text of the data, the file of the muscle as stated, and the truth as a JSON document.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    muscle: &Muscle,
    protocol: &str,
    origin: &str,
    with_: Vec<String>,
    own: &str,
    seed: u64,
) -> PyResult<(String, String, String)> {
    let protocol = Protocol::from_toml(protocol, origin).or_raise()?;
    let catalogue = all(muscle, own)?;
    let muscle = muscle.muscle.clone();
    let found =
        beside(py, None, move |_| inference::simulate_with(&muscle, &catalogue, &protocol, &with_, seed))?;
    let found = found.or_raise()?;
    let truth = serde_json::to_string(&found.truth).or_raise()?;
    Ok((found.csv, bulge_muscles::to_toml(&found.muscle), truth))
}

/// Names of the effects.
#[pyfunction]
pub(crate) fn effect_names(own: &str) -> PyResult<Vec<String>> {
    Ok(catalogue(own)?.iter().map(|effect| effect.card().name.to_owned()).collect())
}

/// The card of an effect: the page to read, and the JSON document.
#[pyfunction]
pub(crate) fn effects(name: &str, own: &str) -> PyResult<(String, String)> {
    let catalogue = catalogue(own)?;
    let effect = catalogue.find(name).or_raise()?;
    let document = serde_json::to_string(&bulge_effects::CardDocument::of(effect.as_ref())).or_raise()?;
    Ok((describe(effect.as_ref()), document))
}
