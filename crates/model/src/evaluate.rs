//! A model along a history: the force of every row, with exact derivatives.

use bulge_effects::law::LawPoint;
use bulge_effects::{Balance, Effect, Input, Jet, LANES, Moment, Place, Stage};
use bulge_fibre::FibreError;
use bulge_numerics::{Dual, Real};
use rayon::prelude::*;
use std::ops::Range;

use crate::answer::{Carried, SHAPE};
use crate::base::Equilibrium;
use crate::error::ModelError;
use crate::lattice::{self, Lattice};
use crate::model::{AtRest, Base, Model};
use crate::record::Record;

/// What is wanted of [`Model::evaluate`] besides the force.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Derivatives by these parameters, by their place in [`Model::parameters`].
    pub parameters: Vec<usize>,
    /// Derivatives by the readings of pressure and contraction.
    pub readings: bool,
}

/// The force of every row.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// What the load cell should read \[N\].
    pub force: Vec<f64>,
    /// Derivatives by the wanted parameters, row by row.
    pub jacobian: Vec<f64>,
    /// dF/d(pressure reading) \[N/Pa\], if wanted.
    pub by_pressure: Vec<f64>,
    /// dF/d(contraction reading) \[N\], if wanted.
    pub by_contraction: Vec<f64>,
}

/// Rows up to which shooting muscles are solved row by row.
const FEW_ROWS: usize = 150;
/// Rows handed to one core at a time, where nothing is remembered from row to row. Fixed, so that results don't depend on the number of threads.
const CHUNK: usize = 2048;
/// Newton steps for a contraction that depends on the force.
const MOST_GIVE_STEPS: usize = 50;
/// Nodes and weights of the Gauss-Hermite rule of degree 5 for a standard normal number.
const NORMAL: [(f64, f64); 3] =
    [(0.0, 2.0 / 3.0), (1.732_050_807_568_877_2, 1.0 / 6.0), (-1.732_050_807_568_877_2, 1.0 / 6.0)];

/// Everything that stays the same for all rows of one evaluation.
struct Run<'a> {
    model: &'a Model,
    theta: &'a [f64],
    /// Parameters that change the shape, in the order of the answers' derivatives.
    shapes: Vec<usize>,
    equilibrium: Option<Equilibrium>,
    lattice: Option<Lattice>,
}

/// Which variable each lane carries in one pass.
struct Pass {
    theta: Vec<Jet>,
    pressure_lane: Option<usize>,
    contraction_lane: Option<usize>,
    /// Lane of each shape parameter.
    shape_lanes: Vec<Option<usize>>,
    /// (lane, place among the wanted parameters)
    columns: Vec<(usize, usize)>,
}

/// Why a row has no force.
enum RowError {
    Solver { pressure: f64, contraction: f64, source: FibreError },
    NotFinite,
}

struct Part {
    force: Vec<f64>,
    /// Column by column of the wanted parameters.
    jacobian: Vec<f64>,
    by_pressure: Vec<f64>,
    by_contraction: Vec<f64>,
    failed: Vec<(usize, RowError)>,
}

impl Model {
    /// The force of every row with the parameters `theta`, and what else is wanted.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle, or rows have no equilibrium: the error lists them.
    pub fn evaluate(
        &self,
        record: &Record,
        theta: &[f64],
        wanted: &Wanted,
    ) -> Result<Prediction, ModelError> {
        let run = self.run(record, theta, &wanted.parameters)?;
        let passes = Self::passes(theta, wanted, &run.shapes);
        let segments = self.segments(record);
        let columns = wanted.parameters.len();
        let parts: Vec<Part> = segments
            .par_iter()
            .map(|rows| run.segment(record, rows.clone(), &passes, columns, wanted.readings))
            .collect();
        gather(parts, record.len())
    }

    fn run<'a>(&'a self, record: &Record, theta: &'a [f64], wanted: &[usize]) -> Result<Run<'a>, ModelError> {
        if theta.len() != self.parameters().len() {
            return Err(ModelError::Values { given: theta.len(), expected: self.parameters().len() });
        }
        let mut run = Run { model: self, theta, shapes: Vec::new(), equilibrium: None, lattice: None };
        if let Base::Law { .. } = self.base {
            return Ok(run);
        }
        let (muscle, variables) = self.reshape(theta, wanted)?;
        if variables.len() > SHAPE {
            return Err(ModelError::TooManyShapes { count: variables.len(), most: SHAPE });
        }
        let all = || (0..record.len()).collect();
        let first = record.moments().first();
        let no_problem = |source| ModelError::NoEquilibrium {
            rows: all(),
            pressure_pa: first.map_or(0.0, |m| m.pressure),
            contraction: first.map_or(0.0, |m| m.contraction),
            source: Box::new(source),
        };
        let equilibrium = Self::equilibrium(&muscle, &variables).map_err(no_problem)?;
        run.shapes = variables.iter().map(|(index, _)| *index).collect();
        if equilibrium.is_costly() && record.len() > FEW_ROWS {
            let rows = run.inputs(record);
            run.lattice = Some(Lattice::around(&equilibrium, run.shapes.len(), self.refinement, &rows));
        }
        run.equilibrium = Some(equilibrium);
        Ok(run)
    }

    /// Sweeps where something is remembered along them, else chunks of equal size.
    fn segments(&self, record: &Record) -> Vec<Range<usize>> {
        if self.effects.iter().any(|chosen| chosen.effect.memory() > 0) {
            return record.sweeps().to_vec();
        }
        (0..record.len()).step_by(CHUNK).map(|start| start..(start + CHUNK).min(record.len())).collect()
    }

    fn passes(theta: &[f64], wanted: &Wanted, shapes: &[usize]) -> Vec<Pass> {
        // Variables in order: pressure and contraction if wanted, then the parameters.
        let readings = if wanted.readings { 2 } else { 0 };
        let all = readings + wanted.parameters.len();
        let mut passes = Vec::new();
        for first in (0..all.max(1)).step_by(LANES) {
            let lane_of = |variable: usize| {
                (variable >= first && variable < first + LANES && variable < all).then(|| variable - first)
            };
            let lane = |parameter: usize| {
                let place = wanted.parameters.iter().position(|other| *other == parameter)?;
                lane_of(readings + place)
            };
            let seeded = |(i, value): (usize, &f64)| match lane(i) {
                Some(lane) => Jet::variable(*value, lane),
                None => Jet::from(*value),
            };
            passes.push(Pass {
                theta: theta.iter().enumerate().map(seeded).collect(),
                pressure_lane: if wanted.readings { lane_of(0) } else { None },
                contraction_lane: if wanted.readings { lane_of(1) } else { None },
                shape_lanes: shapes.iter().map(|parameter| lane(*parameter)).collect(),
                columns: (0..wanted.parameters.len())
                    .filter_map(|place| lane_of(readings + place).map(|lane| (lane, place)))
                    .collect(),
            });
        }
        passes
    }

    /// Force at one moment of rest.
    pub(crate) fn rest(&self, theta: &[f64], moment: &Moment) -> Result<AtRest, ModelError> {
        let record = Record::from_moments(vec![*moment], vec![0.0], std::iter::once(0..1).collect());
        let Some(record) = record else { return Err(ModelError::Values { given: 0, expected: 1 }) };
        let run = self.run(&record, theta, &[])?;
        let pass = Pass {
            theta: theta.iter().map(|v| Jet::from(*v)).collect(),
            pressure_lane: None,
            contraction_lane: None,
            shape_lanes: vec![None; run.shapes.len()],
            columns: Vec::new(),
        };
        let mut memory = run.memory();
        match run.row(moment, &pass, &mut memory) {
            Ok(row) => Ok(AtRest {
                equilibrium_n: row.equilibrium.value(),
                force_n: row.force.value(),
                reading_n: row.reading.value(),
            }),
            Err(error) => Err(failure(vec![(0, error)])),
        }
    }
}

/// The force of one row at three stages.
struct Row {
    equilibrium: Jet,
    force: Jet,
    reading: Jet,
}

impl Run<'_> {
    fn memory(&self) -> Vec<Vec<Jet>> {
        self.model.effects.iter().map(|chosen| vec![Jet::from(0.0); chosen.effect.memory()]).collect()
    }

    /// Effects that act at a stage, with their numbers and memory. Effects of the shape may also change the input.
    fn act(
        &self,
        moment: &Moment,
        pass: &Pass,
        memory: &mut [Vec<Jet>],
        stages: &[Stage],
        mut place: impl FnMut(&dyn Effect, &[Jet], &mut [Jet]),
    ) {
        for (chosen, memory) in self.model.effects.iter().zip(memory) {
            if stages.contains(&chosen.effect.card().stage) {
                let range = self.model.range(chosen, moment.specimen);
                place(chosen.effect.as_ref(), &pass.theta[range], memory);
            }
        }
    }

    fn input(&self, moment: &Moment, pass: &Pass, memory: &mut [Vec<Jet>]) -> Input {
        let seeded = |value: f64, lane: Option<usize>| match lane {
            Some(lane) => Dual::variable(value, lane),
            None => Jet::from(value),
        };
        let mut input = Input::of(
            seeded(moment.pressure, pass.pressure_lane),
            seeded(moment.contraction, pass.contraction_lane),
        );
        let setting = &self.model.setting;
        self.act(moment, pass, memory, &[Stage::Shape, Stage::Input], |effect, theta, memory| {
            effect.act(moment, setting, theta, memory, Place::Input(&mut input));
        });
        input
    }

    /// Pressures and ranges of contraction at which equilibria will be asked for.
    fn inputs(&self, record: &Record) -> Vec<(f64, [f64; 2])> {
        let pass = Pass {
            theta: self.theta.iter().map(|v| Jet::from(*v)).collect(),
            pressure_lane: None,
            contraction_lane: None,
            shape_lanes: Vec::new(),
            columns: Vec::new(),
        };
        let row = |memory: &mut Vec<Vec<Jet>>, moment: &Moment| {
            if moment.begins {
                *memory = self.memory();
            }
            let input = self.input(moment, &pass, memory);
            let pressure = (input.pressure * input.area / input.wall).value();
            let e = input.contraction.value();
            // The force is not known yet: p pi (3 r0)^2 is more than any muscle has at usable contractions.
            let most = pressure * std::f64::consts::PI * (3.0 * self.model.setting.radius).powi(2);
            let give = (input.give_force.value() + input.give_tension.value()) * most;
            let spread = NORMAL[1].0 * input.spread.value().abs();
            (pressure, [e - spread + give.min(0.0), e + spread + give.max(0.0)])
        };
        let of_segment = |rows: &Range<usize>| {
            let mut memory = self.memory();
            record.moments()[rows.clone()].iter().map(|moment| row(&mut memory, moment)).collect::<Vec<_>>()
        };
        let segments = self.model.segments(record);
        segments.par_iter().map(of_segment).collect::<Vec<_>>().into_iter().flatten().collect()
    }

    fn segment(
        &self,
        record: &Record,
        rows: Range<usize>,
        passes: &[Pass],
        columns: usize,
        readings: bool,
    ) -> Part {
        let count = rows.len();
        let sized = |wanted: bool| if wanted { vec![0.0; count] } else { Vec::new() };
        let mut part = Part {
            force: vec![0.0; count],
            jacobian: vec![0.0; count * columns],
            by_pressure: sized(readings),
            by_contraction: sized(readings),
            failed: Vec::new(),
        };
        for (number, pass) in passes.iter().enumerate() {
            let mut memory = self.memory();
            for (i, row) in rows.clone().enumerate() {
                let moment = &record.moments()[row];
                if moment.begins {
                    memory.iter_mut().flatten().for_each(|m| *m = Jet::from(0.0));
                }
                let reading = match self.row(moment, pass, &mut memory) {
                    Ok(row) => row.reading,
                    Err(error) => {
                        if number == 0 {
                            part.failed.push((row, error));
                        }
                        continue;
                    }
                };
                if number == 0 {
                    part.force[i] = reading.value();
                }
                let gradient = reading.gradient();
                for (lane, column) in &pass.columns {
                    part.jacobian[i * columns + column] = gradient[*lane];
                }
                if let Some(lane) = pass.pressure_lane {
                    part.by_pressure[i] = gradient[lane];
                }
                if let Some(lane) = pass.contraction_lane {
                    part.by_contraction[i] = gradient[lane];
                }
            }
        }
        part
    }

    fn row(&self, moment: &Moment, pass: &Pass, memory: &mut [Vec<Jet>]) -> Result<Row, RowError> {
        let input = self.input(moment, pass, memory);
        let (found, contraction) = self.balance(moment, &input, pass)?;
        let balance = Balance {
            pressure: input.pressure,
            contraction,
            force: found.force,
            tension: found.tension,
            mid_radius: found.mid_radius,
            volume: found.volume,
            slope: found.slope[0],
        };
        let setting = &self.model.setting;
        let mut load = Jet::from(0.0);
        self.act(moment, pass, memory, &[Stage::Load], |effect, theta, memory| {
            effect.act(moment, setting, theta, memory, Place::Load(&balance, &mut load));
        });
        let force = found.force + load;
        let mut reading = force;
        self.act(moment, pass, memory, &[Stage::Output], |effect, theta, memory| {
            effect.act(moment, setting, theta, memory, Place::Output(&balance, &mut reading));
        });
        let is_finite = reading.value().is_finite() && reading.gradient().iter().all(|g| g.is_finite());
        if is_finite {
            Ok(Row { equilibrium: found.force, force, reading })
        } else {
            Err(RowError::NotFinite)
        }
    }

    /// The equilibrium behind an input, and the contraction at which it is.
    ///
    /// ```text
    /// e = contraction + give_force F(e) + give_tension N(e)        Newton's method, then one step more that carries the derivatives
    /// ```
    fn balance(&self, moment: &Moment, input: &Input, pass: &Pass) -> Result<(Carried, Jet), RowError> {
        let pressure = input.pressure * input.area / input.wall;
        let gives = [input.give_force, input.give_tension];
        let rigid = gives.iter().all(|g| g.value() == 0.0 && g.gradient().iter().all(|d| *d == 0.0));
        let mut e = input.contraction;
        if !rigid {
            let mut at = input.contraction.value();
            for _ in 0..MOST_GIVE_STEPS {
                let found = self.averaged(moment, pressure, Jet::from(at), input, pass)?;
                let gap =
                    Jet::from(at) - input.contraction - gives[0] * found.force - gives[1] * found.tension;
                let slope = 1.0 - gives[0].value() * found.slope[0] - gives[1].value() * found.slope[1];
                // With derivatives: those of the gap at fixed e, over the slope.
                e = Jet::from(at) - gap / slope;
                let step = e.value() - at;
                if step.abs() <= 1e-14 + 1e-13 * at.abs() {
                    break;
                }
                at = e.value();
            }
        }
        let found = self.averaged(moment, pressure, e, input, pass)?;
        Ok((found, e))
    }

    /// Averaged over fibres of unequal length.
    fn averaged(
        &self,
        moment: &Moment,
        pressure: Jet,
        e: Jet,
        input: &Input,
        pass: &Pass,
    ) -> Result<Carried, RowError> {
        let stiffen = |found: Carried| found.stiffened(input.wall);
        let spread = input.spread;
        if spread.value() == 0.0 {
            return self.base(moment, pressure, e, pass).map(stiffen);
        }
        let mut sum: Option<Carried> = None;
        for (z, weight) in NORMAL {
            let part = self.base(moment, pressure, e + spread * z, pass)?.scaled(weight);
            sum = Some(sum.map_or(part, |sum| sum.plus(part)));
        }
        sum.map(stiffen).ok_or(RowError::NotFinite)
    }

    /// The base law.
    fn base(&self, moment: &Moment, pressure: Jet, e: Jet, pass: &Pass) -> Result<Carried, RowError> {
        match (&self.model.base, &self.equilibrium) {
            (Base::Law { law, geometry }, _) => {
                let point = LawPoint { pressure, contraction: e, direction: moment.direction };
                let count = law.coefficients.len();
                let force = law.force(point, geometry, &pass.theta[..count]);
                // Laws know no shape: a cylinder of the muscle's radius stands for it.
                let radius = Jet::from(geometry.radius);
                let area = std::f64::consts::PI * geometry.radius * geometry.radius;
                let slope = self.law_slope(moment, pressure.value(), e.value());
                Ok(Carried {
                    force,
                    tension: force + pressure * area,
                    mid_radius: radius,
                    volume: (-e + 1.0) * (area * geometry.length),
                    slope: [slope, slope],
                })
            }
            (Base::Equilibrium, Some(equilibrium)) => {
                let (p, at) = (pressure.value(), e.value());
                let answer = lattice::answer(self.lattice.as_ref(), equilibrium, p, at)
                    .map_err(|source| RowError::Solver { pressure: p, contraction: at, source })?;
                let lanes = &pass.shape_lanes;
                Ok(Carried {
                    force: answer.force.carry(pressure, e, lanes),
                    tension: answer.tension.carry(pressure, e, lanes),
                    mid_radius: answer.mid_radius.carry(pressure, e, lanes),
                    volume: answer.volume.carry(pressure, e, lanes),
                    slope: [answer.force.by_contraction, answer.tension.by_contraction],
                })
            }
            (Base::Equilibrium, None) => Err(RowError::NotFinite),
        }
    }

    fn law_slope(&self, moment: &Moment, pressure: f64, e: f64) -> f64 {
        let Base::Law { law, geometry } = &self.model.base else { return 0.0 };
        let constant = |v: f64| Dual::<1>::from(v);
        let point = LawPoint {
            pressure: constant(pressure),
            contraction: Dual::<1>::variable(e, 0),
            direction: moment.direction,
        };
        let coefficients: Vec<_> =
            self.theta[..law.coefficients.len()].iter().map(|v| constant(*v)).collect();
        law.force(point, geometry, &coefficients).gradient()[0]
    }
}

fn gather(parts: Vec<Part>, rows: usize) -> Result<Prediction, ModelError> {
    let mut all = Prediction {
        force: Vec::with_capacity(rows),
        jacobian: Vec::new(),
        by_pressure: Vec::new(),
        by_contraction: Vec::new(),
    };
    let mut failed = Vec::new();
    for part in parts {
        all.force.extend(part.force);
        all.jacobian.extend(part.jacobian);
        all.by_pressure.extend(part.by_pressure);
        all.by_contraction.extend(part.by_contraction);
        failed.extend(part.failed);
    }
    if failed.is_empty() { Ok(all) } else { Err(failure(failed)) }
}

fn failure(failed: Vec<(usize, RowError)>) -> ModelError {
    let mut rows = Vec::with_capacity(failed.len());
    let mut first = None;
    for (row, error) in failed {
        rows.push(row);
        if let (None, RowError::Solver { .. }) = (&first, &error) {
            first = Some(error);
        }
    }
    match first {
        Some(RowError::Solver { pressure, contraction, source }) => {
            ModelError::NoEquilibrium { rows, pressure_pa: pressure, contraction, source: Box::new(source) }
        }
        _ => ModelError::NotFinite { rows, what: "look at the readings of these rows and at the parameters" },
    }
}
