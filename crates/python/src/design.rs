//! Muscles put to use: the questions of `bulge-design` and membrane cases, with their documents and drawings.

use bulge_design::gas::{FillQuestion, Moves, ShutQuestion, StrokeQuestion, Valve};
use bulge_design::heat::{HeatProblem, HeatQuestion, Pipe};
use bulge_design::joint::{Checks, JointGas, JointParts};
use bulge_design::sensing::{RESISTANCE_UNITS, Range, SenseQuestion};
use bulge_design::size::{Candidates, LoadCase, LoadPoint, OwnLimits, SizeQuestion, force_or_weight};
use bulge_design::{Lines, QuestionError};
use bulge_effects::known;
use bulge_membrane::case::{Case, CaseError, CaseRun, Row, Written};
use bulge_muscles::{Fault, preset, units};
use bulge_report::cloth::{self, ClothDocument};
use bulge_sweep::JointTable;
use bulge_vtk::CaseFolder;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

use crate::error::{OrRaise, Raised, input, of_fault};
use crate::muscle::{Muscle, catalogue};
use crate::task::{Watch, beside};

/// Title, names of both axes, name and points of each line.
type Drawn = (String, &'static str, &'static str, Vec<(String, Vec<[f64; 2]>)>);
/// Makes the drawing of an answer when it is asked for.
type Draw = Box<dyn Fn() -> PyResult<Lines> + Send + Sync>;

/// An answer with its drawing.
#[pyclass(frozen, module = "bulge._bulge")]
pub(crate) struct Answer {
    document: String,
    draw: Draw,
}

impl Answer {
    fn new(
        document: serde_json::Result<String>,
        draw: impl Fn() -> PyResult<Lines> + Send + Sync + 'static,
    ) -> PyResult<Self> {
        Ok(Self { document: document.or_raise()?, draw: Box::new(draw) })
    }
}

#[pymethods]
impl Answer {
    /// The JSON document.
    fn document(&self) -> &str {
        &self.document
    }

    /// What the command draws.
    fn drawing(&self, py: Python<'_>) -> PyResult<Drawn> {
        let Lines { title, axes: [x, y], lines } = py.detach(|| (self.draw)())?;
        Ok((title, x, y, lines))
    }
}

/// Options of the command line in a sentence as arguments: `--dead-volume` is `dead_volume`.
fn in_python(says: &str) -> String {
    let mut text = String::new();
    for (k, part) in says.split("--").enumerate() {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        let (name, rest) = part.split_at(end);
        if k > 0 && !name.is_empty() {
            text.push_str(&name.replace('-', "_"));
            text.push_str(rest);
        } else {
            text.push_str(if k > 0 { "--" } else { "" });
            text.push_str(part);
        }
    }
    text
}

/// An error of a question, about a part of it or of its answer.
fn asked<T, E: Raised + std::error::Error>(found: Result<T, QuestionError<E>>) -> PyResult<T> {
    found.map_err(|error| match error {
        QuestionError::Part { about, what } => of_fault(Fault::Input, in_python(&format!("{about}: {what}"))),
        QuestionError::Answer(error) => of_fault(error.fault(), in_python(&error.to_string())),
    })
}

/// A force [N] from text, or the weight of a mass.
#[pyfunction]
pub(crate) fn weight(name: &str, text: &str) -> PyResult<f64> {
    force_or_weight(text).map_err(|what| input(format!("{name}: {what}")))
}

/// A resistance [ohm] from text.
#[pyfunction]
pub(crate) fn resistance(name: &str, text: &str) -> PyResult<f64> {
    units::in_one_of(text, &RESISTANCE_UNITS).map_err(|what| input(format!("{name}: {what}")))
}

/// Which muscle for a load; see `bulge.size`. `limits` are pressure, start, contraction, length and force.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn size(
    py: Python<'_>,
    load: Vec<(f64, f64)>,
    muscles: Vec<(String, Option<PyRef<'_, Muscle>>)>,
    law: Option<&str>,
    table: Option<&str>,
    pressures: Option<Vec<f64>>,
    lengths: Vec<f64>,
    limits: [Option<f64>; 5],
    margin: f64,
    step: f64,
) -> PyResult<Answer> {
    let points = load.into_iter().map(|(travel_m, force_n)| LoadPoint { travel_m, force_n });
    let load = LoadCase::new(points.collect()).or_raise()?;
    let [pressure_pa, start, contraction, length_m, force_n] = limits;
    let own = OwnLimits { pressure_pa, start, contraction, length_m, force_n };
    let mut all = asked(Candidates::new(&load, law, table, own, !lengths.is_empty()))?;
    for (name, given) in &muscles {
        let known = |muscle: &bulge_muscles::Muscle, own: &str| known(muscle, &catalogue(own)?).or_raise();
        match given {
            Some(given) => asked(all.add(name, &given.muscle, known(&given.muscle, &given.own)?))?,
            None if all.is_fluidic(name) => asked(all.add_fluidic(name))?,
            None => {
                let muscle = preset(name).or_raise()?;
                let known = known(&muscle, "")?;
                asked(all.add(name, &muscle, known))?;
            }
        }
    }
    let families = all.families().to_vec();
    let question =
        SizeQuestion { load, families, pressures_pa: pressures, lengths_m: lengths, margin, step_m: step };
    let (question, sizing) = beside(py, None, move |_| {
        let sizing = question.answer();
        (question, sizing)
    })?;
    let sizing = sizing.or_raise()?;
    let Some(best) = sizing.choices.first().cloned() else {
        return Err(of_fault(Fault::NoSolution, sizing.nothing().trim_end().to_owned()));
    };
    Answer::new(serde_json::to_string(&sizing.document()), move || {
        let percent = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| [100.0 * x, y]).collect();
        let isobars = question.isobars(&best).or_raise()?.into_iter();
        let mut lines: Vec<(String, Vec<[f64; 2]>)> = isobars
            .map(|(pressure, points)| {
                (format!("{} bar", units::significant(1e-5 * pressure, 3)), percent(points))
            })
            .collect();
        lines.push(("load".to_owned(), percent(best.way())));
        Ok(Lines { title: best.title(), axes: ["contraction [%]", "force [N]"], lines })
    })
}

/// A joint file: its path, or its text.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) struct Source(Option<String>, PathBuf);

impl Source {
    fn joint(&self, checks: Checks) -> PyResult<bulge_design::joint::Joint> {
        let Self(text, path) = self;
        let found = match text {
            Some(text) => JointTable::from_toml(text, &path.display().to_string(), None, checks),
            None => JointTable::read(path, checks),
        };
        Ok(found.or_raise()?.joint)
    }

    fn case(&self) -> PyResult<Case> {
        let Self(text, path) = self;
        match text {
            Some(text) => Case::from_toml(text, &path.display().to_string(), None).or_raise(),
            None => Case::read(path).or_raise(),
        }
    }
}

/// Two muscles on a joint; see `bulge.joint`. `readings` are the deviations of pressure, angle and force.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn joint(
    py: Python<'_>,
    source: Source,
    pressures: Option<Vec<f64>>,
    angle: Option<f64>,
    stiffness: Option<f64>,
    torque: Option<f64>,
    closed: Option<&str>,
    dead_volume: Option<f64>,
    readings: [Option<f64>; 3],
) -> PyResult<Answer> {
    let closed = match closed {
        None => None,
        Some("isothermal") => Some(JointGas::Isothermal),
        Some("adiabatic") => Some(JointGas::Adiabatic),
        Some(other) => {
            return Err(input(format!(
                "closed: there is no `{other}`; write \"isothermal\" or \"adiabatic\""
            )));
        }
    };
    let parts = JointParts {
        pressures_pa: pressures,
        angle_rad: angle,
        stiffness,
        torque_nm: torque,
        closed,
        dead_volume_m3: dead_volume,
        readings,
    };
    let question = asked(parts.question())?;
    let checks = if question.is_point() { Checks::Linkage } else { Checks::Everywhere };
    let joint = source.joint(checks)?;
    let found = beside(py, None, move |_| {
        let answer = joint.answer(&question)?;
        Ok(serde_json::to_string(&joint.document(&question, &answer)))
    })?;
    let document: Result<_, bulge_design::joint::JointError> = found;
    // A drawing needs both muscles to pull over all of the file's ranges.
    Answer::new(document.or_raise()?, move || source.joint(Checks::Everywhere)?.drawing().or_raise())
}

/// The air in a muscle whose valve is shut; see `bulge.air.shut`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn air_shut(
    py: Python<'_>,
    muscle: &Muscle,
    pressure: f64,
    contraction: f64,
    range: Option<[f64; 2]>,
    exponent: f64,
    force: Option<f64>,
    dead_volume: f64,
) -> PyResult<Answer> {
    let extended = muscle.extended()?;
    let question = ShutQuestion {
        pressure_pa: pressure,
        contraction,
        range,
        exponent,
        force_n: force,
        dead_volume_m3: dead_volume,
    };
    let (extended, found) = beside(py, None, move |_| {
        let found = question.answer(&extended);
        (extended, found)
    })?;
    let found = found.or_raise()?;
    let document = serde_json::to_string(&found);
    Answer::new(document, move || found.drawing(&extended, pressure).or_raise())
}

/// Filling or venting over time; see `bulge.air.fill`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn air_fill(
    py: Python<'_>,
    muscle: &Muscle,
    supply: f64,
    vessel: Option<f64>,
    start: f64,
    conductance: Option<(f64, f64)>,
    hole: Option<f64>,
    held: Option<f64>,
    load: Option<(f64, Option<f64>)>,
    adiabatic: bool,
    longest: f64,
    dead_volume: f64,
) -> PyResult<Answer> {
    let valve = match (conductance, hole) {
        (Some((conductance, critical_ratio)), None) => Valve::Sheet { conductance, critical_ratio },
        (None, Some(diameter)) => Valve::Hole(diameter),
        _ => return Err(input("a valve is needed: give conductance or hole, and one of them")),
    };
    let moves = match (held, load) {
        (Some(contraction), None) => Moves::Held(contraction),
        (None, Some((force_n, support))) => Moves::Lifts { force_n, support },
        _ => return Err(input("a load is needed: give load or held, and one of them")),
    };
    let question = FillQuestion {
        supply_pa: supply,
        vessel_m3: vessel,
        start_pa: start,
        valve,
        moves,
        is_adiabatic: adiabatic,
        longest_s: longest,
        dead_volume_m3: dead_volume,
    };
    let extended = muscle.extended()?;
    let found = asked(beside(py, None, move |_| question.answer(&extended))?)?;
    let document = serde_json::to_string(&found);
    Answer::new(document, move || Ok(found.drawing()))
}

/// Air, energy and efficiency of a stroke; see `bulge.air.stroke`.
#[pyfunction]
pub(crate) fn air_stroke(
    py: Python<'_>,
    muscle: &Muscle,
    load: f64,
    stroke: [f64; 2],
    supply: f64,
    pressure: Option<f64>,
    dead_volume: f64,
) -> PyResult<Answer> {
    let question = StrokeQuestion {
        load_n: load,
        stroke,
        supply_pa: supply,
        pressure_pa: pressure,
        dead_volume_m3: dead_volume,
    };
    let extended = muscle.extended()?;
    let (extended, found) = beside(py, None, move |_| {
        let found = question.answer(&extended);
        (extended, found)
    })?;
    let found = found.or_raise()?;
    let document = serde_json::to_string(&found);
    Answer::new(document, move || question.drawing(&extended, &found).or_raise())
}

/// A channel of liquid metal around a muscle; see `bulge.sense`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by the Python part alone")]
pub(crate) fn sense(
    py: Python<'_>,
    muscle: &Muscle,
    pressure: f64,
    contraction: [f64; 2],
    points: usize,
    turns: f64,
    zone: [f64; 2],
    channel: f64,
    offset: f64,
    noise: f64,
    best: Option<f64>,
    least_gauge_factor: Option<f64>,
) -> PyResult<Answer> {
    let [from, to] = contraction;
    let question = SenseQuestion {
        pressure_pa: pressure,
        range: Range { from, to, points },
        turns,
        zone,
        channel_m: channel,
        offset_m: offset,
        noise_ohm: noise,
        best,
        least_gauge_factor,
    };
    let extended = muscle.extended()?;
    let found = beside(py, None, move |_| question.answer(&extended))?.or_raise()?;
    let document = serde_json::to_string(&found.document());
    Answer::new(document, move || Ok(found.drawing()))
}

/// How warm a muscle gets with each of some pipes (length and inner diameter); see `bulge.heat`. `tube` is
/// length, diameter, wall and port, `times` are period and ramp.
#[pyfunction]
pub(crate) fn heat(
    py: Python<'_>,
    tube: [f64; 4],
    pressure: [f64; 2],
    times: [f64; 2],
    duty: f64,
    pipes: Vec<Option<(f64, f64)>>,
    cells: usize,
) -> PyResult<Answer> {
    let mut problem = HeatProblem::default();
    let part = &mut problem.tube;
    [part.length_m, part.inner_diameter_m, part.wall_thickness_m, part.port_diameter_m] = tube;
    [problem.drive.low_pa, problem.drive.high_pa] = pressure;
    [problem.drive.period_s, problem.drive.ramp_s] = times;
    problem.drive.duty = duty;
    problem.numerics.cells = cells;
    let nylon = |(length, diameter)| Pipe::nylon(length, diameter);
    let question = HeatQuestion { problem, pipes: pipes.into_iter().map(|pipe| pipe.map(nylon)).collect() };
    let found = asked(beside(py, None, move |_| question.answer())?)?;
    let document = serde_json::to_string(&found.document());
    Answer::new(document, move || Ok(found.drawing()))
}

/// The states of a membrane case; see `bulge.membrane`. The JSON document.
#[pyfunction]
pub(crate) fn membrane(
    py: Python<'_>,
    source: Source,
    out: Option<PathBuf>,
    whole: bool,
    as_effect: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let case = source.case()?;
    if as_effect {
        cloth::muscle(&case).map_err(cloth_failed)?;
    }
    let origin = source.1.display().to_string();
    beside(py, progress, move |watch| {
        let refused = |error: CaseError| of_fault(error.fault(), format!("{origin}: {error}"));
        let mut run = case.start().map_err(refused)?;
        let mut folder =
            out.as_deref().map(|out| CaseFolder::new(out, &case, whole)).transpose().or_raise()?;
        let rows = states(&case, &mut run, folder.as_mut(), watch, &refused)?;
        let named = out.as_deref().unwrap_or(Path::new("the states")).join("forces.csv");
        let learnt = if as_effect {
            Some(cloth::learn(&case, &rows, &named.display().to_string()).map_err(cloth_failed)?)
        } else {
            None
        };
        let written = folder.as_ref().map_or_else(Written::default, CaseFolder::written);
        let effect = learnt.as_ref().map(ClothDocument::of);
        serde_json::to_string(&run.document(&rows, written, effect)).or_raise()
    })?
}

fn cloth_failed(error: cloth::ClothError) -> PyErr {
    of_fault(error.fault(), in_python(&error.to_string()))
}

/// Runs a case, and writes its states into a folder if there is one.
fn states(
    case: &Case,
    run: &mut CaseRun<'_>,
    mut folder: Option<&mut CaseFolder>,
    watch: &Watch,
    refused: &dyn Fn(CaseError) -> PyErr,
) -> PyResult<Vec<Row>> {
    let mut rows = Vec::new();
    let share = |done: usize| done as f64 / case.states().max(1) as f64;
    while let Some(next) = run.advance(|_, _| watch.look()) {
        let (row, state, fields) = match next {
            Ok(found) => found,
            Err(error) => {
                let rescued = run.rescued();
                if let (Some(folder), Some((row, state, fields))) = (folder.as_mut(), rescued) {
                    folder.take(row, state, fields).or_raise()?;
                }
                if let Some(folder) = folder {
                    folder.finish(run).or_raise()?;
                }
                return Err(refused(error));
            }
        };
        if let Some(folder) = folder.as_mut() {
            folder.take(row.clone(), state, fields).or_raise()?;
        }
        rows.push(row);
        watch.at(share(rows.len()), "states");
    }
    if let Some(folder) = folder {
        folder.finish(run).or_raise()?;
    }
    Ok(rows)
}
