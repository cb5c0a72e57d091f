//! The base law at one pressure and contraction: the equilibrium of the reshaped muscle, with derivatives by what reshaped it.

use bulge_fibre::{Approach, FibreError, Linearised, Problem, Variable};
use bulge_muscles::{Muscle, Parameter, Pressure};

use crate::answer::{Answer, Graded, SHAPE};

/// How the equilibrium depends on one parameter of an effect.
#[derive(Debug, Clone)]
pub(crate) enum ShapeVariable {
    /// Through numbers of the muscle, each with d(number)/d(parameter).
    Numbers(Vec<(Parameter, f64)>),
    /// By the quotient of a small change: where the effect is off, and the number that it moves doesn't exist yet.
    Quotient { muscle: Box<Muscle>, step: f64 },
}

/// A muscle to be solved, with the parameters by which its answers are differentiated.
#[derive(Debug, Clone)]
pub(crate) struct Equilibrium {
    /// At 1 bar; other pressures are derived from it.
    problem: Problem,
    /// What moves, in the order of `variables`, without doubles.
    numbers: Vec<Variable>,
    variables: Vec<ShapeVariable>,
    /// One for each quotient.
    neighbours: Vec<Option<(Problem, f64)>>,
}

/// Any pressure will do to make the problem.
const REFERENCE: f64 = 1e5;

impl Equilibrium {
    pub(crate) fn new(muscle: &Muscle, variables: Vec<ShapeVariable>) -> Result<Self, FibreError> {
        let problem = Problem::new(muscle, Pressure::pa(REFERENCE))?;
        let mut numbers: Vec<Variable> = Vec::new();
        let mut neighbours = Vec::new();
        for variable in &variables {
            match variable {
                ShapeVariable::Numbers(moved) => {
                    for (parameter, _) in moved {
                        let number = Variable::Parameter(*parameter);
                        if !numbers.contains(&number) {
                            numbers.push(number);
                        }
                    }
                    neighbours.push(None);
                }
                ShapeVariable::Quotient { muscle, step } => {
                    neighbours.push(Some((Problem::new(muscle, Pressure::pa(REFERENCE))?, *step)));
                }
            }
        }
        Ok(Self { problem, numbers, variables, neighbours })
    }

    /// Whether force/p, shape and volume don't depend on the pressure.
    pub(crate) fn is_scale_free(&self) -> bool {
        self.problem.is_scale_free() && self.neighbours.iter().flatten().all(|(p, _)| p.is_scale_free())
    }

    /// Whether each answer takes an integration of the equilibrium ODE, and a lattice is worth its while.
    pub(crate) fn is_costly(&self) -> bool {
        let shoots = |problem: &Problem| problem.shoots();
        shoots(&self.problem) || self.neighbours.iter().flatten().any(|(p, _)| shoots(p))
    }

    /// Whether the force grows without bound towards contraction 0.
    pub(crate) fn is_singular(&self) -> bool {
        self.problem.is_singular()
    }

    /// The answer at a pressure \[Pa\] and a contraction.
    pub(crate) fn answer(&self, pressure: f64, contraction: f64) -> Result<Answer, FibreError> {
        let here = self.problem.at_pressure(Pressure::pa(pressure))?;
        let found = here.linearised(contraction, &self.numbers, Approach::Auto)?;
        let mut answer = Answer {
            force: plain(&found.force_n),
            tension: plain(&found.equator_force_n),
            mid_radius: plain(&found.mid_radius_m),
            volume: plain(&found.volume_polygon_m3),
        };
        for (j, variable) in self.variables.iter().enumerate().take(SHAPE) {
            let slopes = self.by_shape(j, variable, &found, pressure, contraction)?;
            let places = [&mut answer.force, &mut answer.tension, &mut answer.mid_radius, &mut answer.volume];
            for (place, slope) in places.into_iter().zip(slopes) {
                place.by_shape[j] = slope;
            }
        }
        Ok(answer)
    }

    fn by_shape(
        &self,
        j: usize,
        variable: &ShapeVariable,
        found: &Linearised,
        pressure: f64,
        contraction: f64,
    ) -> Result<[f64; 4], FibreError> {
        if let (ShapeVariable::Quotient { .. }, Some((problem, step))) = (variable, &self.neighbours[j]) {
            let moved =
                problem.at_pressure(Pressure::pa(pressure))?.linearised(contraction, &[], Approach::Auto)?;
            return Ok([
                (moved.force_n.value - found.force_n.value) / step,
                (moved.equator_force_n.value - found.equator_force_n.value) / step,
                (moved.mid_radius_m.value - found.mid_radius_m.value) / step,
                (moved.volume_polygon_m3.value - found.volume_polygon_m3.value) / step,
            ]);
        }
        let ShapeVariable::Numbers(moved) = variable else { return Ok([0.0; 4]) };
        let mut slopes = [0.0; 4];
        for (parameter, factor) in moved {
            let place = self.numbers.iter().position(|number| *number == Variable::Parameter(*parameter));
            if let Some(place) = place {
                let outputs =
                    [&found.force_n, &found.equator_force_n, &found.mid_radius_m, &found.volume_polygon_m3];
                for (slope, output) in slopes.iter_mut().zip(outputs) {
                    *slope += factor * output.by_variable()[place];
                }
            }
        }
        Ok(slopes)
    }
}

/// One of the outputs without derivatives by the shape.
fn plain(output: &bulge_fibre::Linear) -> Graded {
    Graded {
        value: output.value,
        by_pressure: output.by_pressure,
        by_contraction: output.by_contraction,
        by_shape: [0.0; SHAPE],
    }
}
