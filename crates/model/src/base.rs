//! The base law at one pressure and contraction: the equilibrium of the reshaped muscle, with derivatives by what reshaped it.

use bulge_fibre::{FibreError, Linear, Linearised, Problem, Repeated, Start, Variable};
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
    /// With derivatives by what moves, without doubles.
    here: Repeated,
    slopes: Vec<Slope>,
    /// Whether each answer takes a search for the equilibrium, and a lattice is worth its while.
    costly: bool,
}

/// Where the derivatives by one parameter come from.
#[derive(Debug, Clone)]
enum Slope {
    /// (place among the numbers, factor)
    Own(Vec<(usize, f64)>),
    Beside {
        there: Box<Repeated>,
        places: Vec<(usize, f64)>,
    },
    Difference {
        there: Box<[Repeated; 3]>,
        step: f64,
    },
}

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
        let mut numbers: Vec<Variable> = Vec::new();
        let slope_of = |variable| {
            Ok(match variable {
                ShapeVariable::Numbers(moved) => Slope::Own(places(&moved, &mut numbers)),
                ShapeVariable::Beside { muscle, moved } => {
                    let mut numbers = Vec::new();
                    let places = places(&moved, &mut numbers);
                    Slope::Beside { there: Box::new(Repeated::new(&muscle, numbers)?), places }
                }
                ShapeVariable::Difference { muscles, step } => {
                    let [a, b, c] = &*muscles;
                    let at = |muscle| Repeated::new(muscle, Vec::new());
                    Slope::Difference { there: Box::new([at(a)?, at(b)?, at(c)?]), step }
                }
            })
        };
        let slopes = variables.into_iter().map(slope_of).collect::<Result<_, FibreError>>()?;
        let mut equilibrium = Self { here: Repeated::new(muscle, numbers)?, slopes, costly: false };
        let costly = equilibrium.problems().any(Problem::shoots);
        equilibrium.costly = costly;
        Ok(equilibrium)
    }

    fn problems(&self) -> impl Iterator<Item = &Problem> {
        let others = |slope| match slope {
            &Slope::Own(_) => [].as_slice(),
            Slope::Beside { there, .. } => std::slice::from_ref(there.as_ref()),
            Slope::Difference { there, .. } => there.as_slice(),
        };
        std::iter::once(&self.here).chain(self.slopes.iter().flat_map(others)).map(Repeated::problem)
    }

    /// Whether force/p, shape and volume don't depend on the pressure.
    pub(crate) fn is_scale_free(&self) -> bool {
        self.problems().all(Problem::is_scale_free)
    }

    /// Whether each answer takes a search for the equilibrium, and a lattice is worth its while.
    pub(crate) fn is_costly(&self) -> bool {
        self.costly
    }

    /// Whether the force grows without bound towards contraction 0.
    pub(crate) fn is_singular(&self) -> bool {
        self.here.problem().is_singular()
    }

    /// The answer at a pressure \[Pa\] and a contraction, and where a search for a similar one may start.
    pub(crate) fn answer(
        &self,
        pressure: f64,
        contraction: f64,
        from: Option<&Start>,
    ) -> Result<(Answer, Option<Start>), FibreError> {
        let pressure = Pressure::pa(pressure);
        let found = self.here.linearised_from(from, pressure, contraction)?;
        let mut answer = Answer {
            force: plain(&found.force_n),
            tension: plain(&found.equator_force_n),
            mid_radius: plain(&found.mid_radius_m),
            volume: plain(&found.volume_polygon_m3),
        };
        let near = |there: &Repeated| there.linearised_from(found.start(), pressure, contraction);
        for (j, slope) in self.slopes.iter().enumerate().take(SHAPE) {
            let slopes = match slope {
                Slope::Own(places) => along(&found, places),
                Slope::Beside { there, places } => along(&near(there)?, places),
                Slope::Difference { there, step } => {
                    let mut sum = outputs(&found).map(|output| WEIGHTS[0] * output.value);
                    for (there, weight) in there.iter().zip(&WEIGHTS[1..]) {
                        let moved = near(there)?;
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
        Ok((answer, found.into_start()))
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
