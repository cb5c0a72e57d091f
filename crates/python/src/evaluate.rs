//! Outputs of a muscle at many points: arrays in, arrays out, on all cores without the interpreter's lock.

use bulge_effects::known;
use bulge_fibre::Approach;
use bulge_muscles::Parameter;
use bulge_sweep::plan::Quantity;
use bulge_sweep::{Family, Output, Points, Reason, Values, evaluate as at_points};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{OrRaise, input, of_fault};
use crate::muscle::{Muscle, catalogue};
use crate::task::beside;

/// Points up to which a thread of its own costs more than it gives.
const FEW: usize = 64;
/// Reasons that are handed over.
const REASONS: usize = 20;

/// Values of an axis: one for all points, or one each.
#[derive(FromPyObject)]
pub(crate) enum AxisValues<'py> {
    Same(f64),
    Each(PyReadonlyArray1<'py, f64>),
}

/// The same, without Python.
enum Owned {
    Same(f64),
    Each(Vec<f64>),
}

/// Arrays in the order of the outputs, the number of points without equilibrium, and the first of these with the exceptions that their reasons are.
pub(crate) type Found<'py> = (Vec<Bound<'py, PyArray1<f64>>>, usize, Vec<(usize, Py<PyAny>)>);

/// Outputs at `count` points.
#[expect(clippy::too_many_arguments, reason = "called from one place, by the names of the Python part")]
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    muscle: &Muscle,
    outputs: &[String],
    axes: Vec<(String, AxisValues<'py>)>,
    count: usize,
    pressure: Option<f64>,
    approach: Approach,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found<'py>> {
    let outputs: Vec<Output> = outputs.iter().map(|name| output(name)).collect::<PyResult<_>>()?;
    let (mut quantities, mut values) = (Vec::new(), Vec::new());
    for (name, axis) in axes {
        quantities.push(Quantity::named(&name, &muscle.muscle).ok_or_else(|| no_axis(&name, muscle))?);
        values.push(match axis {
            AxisValues::Same(value) => Owned::Same(value),
            AxisValues::Each(array) if array.as_array().len() == count => {
                Owned::Each(array.as_array().to_vec())
            }
            AxisValues::Each(array) => {
                return Err(input(format!("{name}: {} values for {count} points", array.as_array().len())));
            }
        });
    }
    let known = known(&muscle.muscle, &catalogue(&muscle.own)?).or_raise()?;
    let has_pressure = pressure.is_some() || quantities.contains(&Quantity::Pressure);
    if !has_pressure && depends_on_pressure(muscle, &quantities) {
        return Err(input(
            "pressure: the shape of this muscle depends on it; give the gauge pressure, such as pressure=\"2 bar\"",
        ));
    }
    // Nothing that is asked for depends on a pressure that isn't given.
    let family =
        Family::of(&muscle.muscle, known, pressure.unwrap_or(1.0), approach, quantities).or_raise()?;
    let run = move |told: &(dyn Fn(usize) + Sync)| {
        let lent: Vec<Values<'_>> = values
            .iter()
            .map(|values| match values {
                Owned::Same(value) => Values::Same(*value),
                Owned::Each(values) => Values::Each(values),
            })
            .collect();
        at_points(&family, &lent, count, &outputs, REASONS, told)
    };
    let Points { outputs, infeasible, reasons } = if count <= FEW && progress.is_none() {
        py.detach(|| run(&|_| ()))
    } else {
        beside(py, progress, move |watch| {
            let done = AtomicUsize::new(0);
            run(&|more| {
                let done = done.fetch_add(more, Ordering::Relaxed) + more;
                watch.at(done as f64 / count as f64, "points");
            })
        })?
    };
    let arrays = outputs.into_iter().map(|values| PyArray1::from_vec(py, values)).collect();
    let raised = |reason: Reason| (reason.row, of_fault(reason.fault, reason.says).into_value(py).into_any());
    Ok((arrays, infeasible, reasons.into_iter().map(raised).collect()))
}

/// Whether the dimensionless shape of a muscle depends on the pressure: where something stretches, or effects act.
fn depends_on_pressure(muscle: &Muscle, varied: &[Quantity]) -> bool {
    let stretches = |parameter: Parameter| {
        muscle.muscle.get(parameter).is_some() || varied.contains(&Quantity::Parameter(parameter))
    };
    // The elastic group stands for the stiffness of the fibres.
    let fibres = stretches(Parameter::FibreStiffness) && !varied.contains(&Quantity::ElasticGroup);
    let wall = [Parameter::C10, Parameter::C01, Parameter::HoopStiffness].into_iter().any(stretches);
    fibres || wall || !muscle.muscle.learnt().is_empty()
}

fn output(name: &str) -> PyResult<Output> {
    Output::named(name).ok_or_else(|| {
        let all: Vec<String> = Output::PLAIN.iter().map(|output| output.name()).collect();
        input(format!(
            "there is no output `{name}`; known: {}, force_by_pressure, volume_by_radius and the like",
            all.join(", ")
        ))
    })
}

fn no_axis(name: &str, muscle: &Muscle) -> PyErr {
    let plain = ["contraction", "pressure", "slenderness", "elastic_group"].map(str::to_owned);
    let numbers = Parameter::ALL.iter().map(|parameter| parameter.name().to_owned());
    let effects = muscle.muscle.learnt().iter().map(|learnt| format!("{}.…", learnt.name()));
    let all: Vec<String> = plain.into_iter().chain(numbers).chain(effects).collect();
    input(format!("nothing called `{name}` can be varied; known: {}", all.join(", ")))
}
