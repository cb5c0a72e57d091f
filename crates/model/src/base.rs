//! The base law at one pressure and contraction: the equilibrium of the reshaped muscle, with derivatives by what reshaped it.

use bulge_fibre::{Approach, FibreError, Linear, Linearised, Problem, Start, Variable};
use bulge_muscles::{Muscle, Parameter, Pressure};

use crate::answer::{Answer, Graded, SHAPE};

/// How the equilibrium depends on one parameter of an effect.
#[derive(Debug, Clone)]
pub(crate) enum ShapeVariable {
    /// Through numbers of the muscle, each with d(number)/d(parameter).
    Numbers(Vec<(Parameter, f64)>),
    /// The same at a neighbour: where the effect is off, and the number that it moves doesn't exist yet, the muscle has it a very small
    /// part of its usual size further on.
    Beside { muscle: Box<Muscle>, moved: Vec<(Parameter, f64)> },
    /// By differences to the muscles at one, one half and one quarter of a step: where nothing says which numbers move.
    Difference { muscles: Box<[Muscle; 3]>, step: f64 },
}

/// A muscle to be solved, with the parameters by which its answers are differentiated.
#[derive(Debug, Clone)]
pub(crate) struct Equilibrium {
    /// At 1 bar; other pressures are derived from it.
    problem: Problem,
    /// What moves, without doubles.
    numbers: Vec<Variable>,
    slopes: Vec<Slope>,
}

/// Where the derivatives by one parameter come from.
#[derive(Debug, Clone)]
enum Slope {
    /// (place among the numbers, factor)
    Own(Vec<(usize, f64)>),
    Beside {
        problem: Box<Problem>,
        numbers: Vec<Variable>,
        places: Vec<(usize, f64)>,
    },
    Difference {
        problems: Box<[Problem; 3]>,
        step: f64,
    },
}

/// Any pressure will do to make the problem.
const REFERENCE: f64 = 1e5;
/// Weights of the values here and at one, one half and one quarter of a step in the derivative here, times the step: three forward differences,
/// extrapolated to no step (Richardson).
const WEIGHTS: [f64; 4] = [-7.0, 1.0 / 3.0, -4.0, 32.0 / 3.0];

fn places(moved: &[(Parameter, f64)], numbers: &mut Vec<Variable>) -> Vec<(usize, f64)> {
    let place = |(parameter, factor): &(Parameter, f64)| {
        let number = Variable::Parameter(*parameter);
        let place = numbers.iter().position(|other| *other == number).unwrap_or_else(|| {
            numbers.push(number);
            numbers.len() - 1
        });
        (place, *factor)
    };
    moved.iter().map(place).collect()
}

impl Equilibrium {
    pub(crate) fn new(muscle: &Muscle, variables: Vec<ShapeVariable>) -> Result<Self, FibreError> {
        let problem_of = |muscle: &Muscle| Problem::new(muscle, Pressure::pa(REFERENCE));
        let mut numbers: Vec<Variable> = Vec::new();
        let slope_of = |variable| {
            Ok(match variable {
                ShapeVariable::Numbers(moved) => Slope::Own(places(&moved, &mut numbers)),
                ShapeVariable::Beside { muscle, moved } => {
                    let mut numbers = Vec::new();
                    let places = places(&moved, &mut numbers);
                    Slope::Beside { problem: Box::new(problem_of(&muscle)?), numbers, places }
                }
                ShapeVariable::Difference { muscles, step } => {
                    let [a, b, c] = &*muscles;
                    let problems = Box::new([problem_of(a)?, problem_of(b)?, problem_of(c)?]);
                    Slope::Difference { problems, step }
                }
            })
        };
        let slopes = variables.into_iter().map(slope_of).collect::<Result<_, FibreError>>()?;
        Ok(Self { problem: problem_of(muscle)?, numbers, slopes })
    }

    fn problems(&self) -> impl Iterator<Item = &Problem> {
        let others = |slope| match slope {
            &Slope::Own(_) => [].as_slice(),
            Slope::Beside { problem, .. } => std::slice::from_ref(problem.as_ref()),
            Slope::Difference { problems, .. } => problems.as_slice(),
        };
        std::iter::once(&self.problem).chain(self.slopes.iter().flat_map(others))
    }

    /// Whether force/p, shape and volume don't depend on the pressure.
    pub(crate) fn is_scale_free(&self) -> bool {
        self.problems().all(Problem::is_scale_free)
    }

    /// Whether each answer takes a search for the equilibrium, and a lattice is worth its while.
    pub(crate) fn is_costly(&self) -> bool {
        self.problems().any(Problem::shoots)
    }

    /// Whether the force grows without bound towards contraction 0.
    pub(crate) fn is_singular(&self) -> bool {
        self.problem.is_singular()
    }

    /// The answer at a pressure \[Pa\] and a contraction, and where a search for a similar one may start.
    pub(crate) fn answer(
        &self,
        pressure: f64,
        contraction: f64,
        from: Option<&Start>,
    ) -> Result<(Answer, Option<Start>), FibreError> {
        let pressure = Pressure::pa(pressure);
        let here = self.problem.at_pressure(pressure)?;
        let found = here.linearised_from(from, contraction, &self.numbers, Approach::Auto)?;
        let mut answer = Answer {
            force: plain(&found.force_n),
            tension: plain(&found.equator_force_n),
            mid_radius: plain(&found.mid_radius_m),
            volume: plain(&found.volume_polygon_m3),
        };
        let near = |problem: &Problem, numbers: &[Variable]| {
            problem.at_pressure(pressure)?.linearised_from(
                found.start(),
                contraction,
                numbers,
                Approach::Auto,
            )
        };
        for (j, slope) in self.slopes.iter().enumerate().take(SHAPE) {
            let slopes = match slope {
                Slope::Own(places) => along(&found, places),
                Slope::Beside { problem, numbers, places } => along(&near(problem, numbers)?, places),
                Slope::Difference { problems, step } => {
                    let mut sum = outputs(&found).map(|output| WEIGHTS[0] * output.value);
                    for (problem, weight) in problems.iter().zip(&WEIGHTS[1..]) {
                        let moved = near(problem, &[])?;
                        for (sum, output) in sum.iter_mut().zip(outputs(&moved)) {
                            *sum += weight * output.value;
                        }
                    }
                    sum.map(|sum| sum / step)
                }
            };
            let graded = [&mut answer.force, &mut answer.tension, &mut answer.mid_radius, &mut answer.volume];
            for (graded, slope) in graded.into_iter().zip(slopes) {
                graded.by_shape[j] = slope;
            }
        }
        Ok((answer, found.start().copied()))
    }
}

/// Force, meridional force, radius and volume.
fn outputs(found: &Linearised) -> [&Linear; 4] {
    [&found.force_n, &found.equator_force_n, &found.mid_radius_m, &found.volume_polygon_m3]
}

/// Their derivatives by a parameter that moves the variables at `places`.
fn along(found: &Linearised, places: &[(usize, f64)]) -> [f64; 4] {
    outputs(found)
        .map(|output| places.iter().map(|(place, factor)| factor * output.by_variable()[*place]).sum())
}

/// One of the outputs without derivatives by the shape.
fn plain(output: &Linear) -> Graded {
    Graded {
        value: output.value,
        by_pressure: output.by_pressure,
        by_contraction: output.by_contraction,
        by_shape: [0.0; SHAPE],
    }
}
