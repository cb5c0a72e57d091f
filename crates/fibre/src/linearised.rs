//! A fast linearised answer for fits: force, meridional force, radius and volume with exact derivatives by the variables that are asked for.
//!
//! The equilibrium is found with two derivatives, those by the unknowns; only the last integration carries more, as few as the question needs.
//! Meridians are taken by quadrature where they can be, ten times faster than by the ODE. A start, from the answer at a neighbouring contraction,
//! pressure or parameter, is moved along its own derivatives, so that most of the search is saved as well.

use bulge_muscles::Parameter;
use bulge_numerics::{Dual, Real};

mod repeated;
mod straight;

pub use repeated::Repeated;

use crate::FibreError;
use crate::closed_form::Near;
use crate::outcome::{Approach, Outcome, Solution};
use crate::problem::{Problem, Variable};
use crate::shape::Convergence;
use crate::shooting::{BESIDE, FITTED, Total};
use crate::unknowns::Unknowns;

/// A value with its derivatives, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// The value.
    pub value: f64,
    /// Derivative by the contraction, at constant pressure.
    pub by_contraction: f64,
    /// Derivative by the pressure \[1/Pa\], at constant contraction.
    pub by_pressure: f64,
    by_variable: [f64; Variable::COUNT],
    asked: usize,
}

impl Linear {
    /// Derivatives by the variables, in the order in which they were asked for.
    #[must_use]
    pub fn by_variable(&self) -> &[f64] {
        &self.by_variable[..self.asked]
    }
}

/// An equilibrium with its exact first derivatives.
///
/// The sign conventions are those of [`crate::Response`]; the force may be negative, as in [`Problem::follow`].
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised {
    /// Contraction (l0 - l)/l0 \[-\].
    pub contraction: f64,
    /// Axial force F \[N\].
    pub force_n: Linear,
    /// Meridional force at mid-length, N = F + p A(r_mid) \[N\]: what all fibres and walls carry together there.
    pub equator_force_n: Linear,
    /// Radius of the fibres at mid-length, r_mid \[m\].
    pub mid_radius_m: Linear,
    /// Enclosed volume with the cross-section that carries the pressure \[m^3\].
    pub volume_polygon_m3: Linear,
    /// How the search converged.
    pub convergence: Convergence,
    start: Option<Start>,
}

impl Linearised {
    /// Where a search for a neighbouring equilibrium may start; none where nothing is searched for (closed forms), but
    /// [`Repeated`] has one for straight fibres.
    #[must_use]
    pub fn start(&self) -> Option<&Start> {
        self.start.as_ref()
    }

    /// The same to keep.
    #[must_use]
    pub fn into_start(self) -> Option<Start> {
        self.start
    }
}

/// An equilibrium from which to start a search for a neighbouring one: at another contraction, pressure, or parameters of a muscle of the same kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Start(Found);

/// What was found.
#[derive(Debug, Clone, PartialEq)]
enum Found {
    ClosedForm(Near),
    /// Much larger, and a small part of what finding it costs.
    Shooting(Box<Shot>),
}

/// A solved meridian that was shot for.
#[derive(Debug, Clone, PartialEq)]
struct Shot {
    unknowns: Unknowns,
    contraction: f64,
    /// Values of all variables, in the order of [`Variable::all`].
    values: [f64; Variable::COUNT],
    /// Derivatives of the unknowns by the contraction, and by the variables (0 where none was asked for).
    by_contraction: [f64; 2],
    by_variable: [[f64; Variable::COUNT]; 2],
}

/// Largest moves of the unknowns along their derivatives; beyond them the derivatives say little. (ln|k| of a long braid moves fast, but straight.)
const FARTHEST: [f64; 2] = [0.5, 20.0];

impl Shot {
    /// The unknowns to start with at a contraction of another problem.
    fn towards(&self, problem: &Problem, contraction: f64) -> Unknowns {
        let mut change = [0.0; Variable::COUNT];
        for (i, variable) in Variable::all().enumerate() {
            change[i] = problem.value(variable) - self.values[i];
        }
        let logs = std::array::from_fn(|z| {
            let along: f64 = self.by_variable[z].iter().zip(&change).map(|(slope, step)| slope * step).sum();
            let step = along + self.by_contraction[z] * (contraction - self.contraction);
            self.unknowns.logs[z] + if step.is_finite() { step.clamp(-FARTHEST[z], FARTHEST[z]) } else { 0.0 }
        });
        Unknowns { logs, ..self.unknowns }
    }
}

impl Problem {
    /// Force, meridional force, radius at mid-length and volume at a contraction, with exact derivatives by the contraction, the pressure and
    /// `variables`; also where the force is negative.
    ///
    /// A derivative is that of [`bulge_muscles::Muscle::with`] at constant contraction; the number of fibres counts as continuous.
    ///
    /// # Errors
    /// [`FibreError::NoVariable`] for a variable that this muscle doesn't have, [`FibreError::AskedTwice`], and what else [`FibreError`] says.
    pub fn linearised(
        &self,
        contraction: f64,
        variables: &[Variable],
        approach: Approach,
    ) -> Result<Linearised, FibreError> {
        let found = self.linearised_from(None, contraction, variables, approach);
        found.map_err(|error| self.explained(error, contraction, approach))
    }

    /// The same from a neighbouring equilibrium, of this muscle or a similar one. The answer is the same within its accuracy.
    ///
    /// # Errors
    /// Those of [`Problem::linearised`], but where nothing is found the limit isn't searched for: see [`Problem::explained`].
    pub fn linearised_from(
        &self,
        start: Option<&Start>,
        contraction: f64,
        variables: &[Variable],
        approach: Approach,
    ) -> Result<Linearised, FibreError> {
        let seeds = self.seeds(variables)?;
        let ask = Question { start, contraction, variables, approach };
        match seeds.count {
            0..=2 => self.answer::<4>(&ask, &seeds),
            3..=4 => self.answer::<6>(&ask, &seeds),
            5..=8 => self.answer::<10>(&ask, &seeds),
            _ => self.answer::<{ 2 + Variable::COUNT }>(&ask, &seeds),
        }
    }

    /// Places for the variables.
    fn seeds(&self, variables: &[Variable]) -> Result<Seeds, FibreError> {
        let mut seeds =
            Seeds { places: [usize::MAX; Variable::COUNT], asked: [false; Variable::COUNT], count: 1 };
        seeds.places[Variable::Pressure.index()] = 2;
        for variable in variables {
            if let Variable::Parameter(parameter) = *variable
                && self.muscle.get(parameter).is_none()
            {
                return Err(FibreError::NoVariable { name: parameter.name() });
            }
            seeds.add(*variable)?;
        }
        Ok(seeds)
    }

    fn answer<const N: usize>(&self, ask: &Question<'_>, seeds: &Seeds) -> Result<Linearised, FibreError> {
        let seeded = self.seeded::<N>(|variable| seeds.places[variable.index()]);
        let net = self.net_of(&seeded);
        let from = ask.start.and_then(|start| match &start.0 {
            Found::Shooting(shot) => Some(shot.towards(self, ask.contraction)),
            Found::ClosedForm(_) => None,
        });
        let ending = if from.is_some() { BESIDE } else { FITTED };
        let outcome =
            self.outcome_of_many(self.method(ask.approach)?, ask.contraction, &net, from, ending)?;
        let with_contraction = |total: &Total<N>| {
            let mut gradient = total.by_parameter;
            gradient[0] = total.by_contraction;
            Dual::new(total.value, gradient)
        };
        let mid = with_contraction(&outcome.mid_radius);
        let radius = seeded(Variable::Parameter(Parameter::Radius));
        let unit_force = seeded(Variable::Pressure) * radius * radius;
        let force = with_contraction(&outcome.force);
        let section = net.acting_at(mid.value()).area(mid);
        let volume = with_contraction(&outcome.volume) * net.volume_factor() * radius * radius * radius;
        let linear = |out: Dual<N>| {
            let mut by_variable = [0.0; Variable::COUNT];
            for (slot, variable) in by_variable.iter_mut().zip(ask.variables) {
                *slot = out.gradient()[seeds.places[variable.index()]];
            }
            let [by_contraction, by_pressure] = [0, 2].map(|place| out.gradient()[place]);
            Linear {
                value: out.value(),
                by_contraction,
                by_pressure,
                by_variable,
                asked: ask.variables.len(),
            }
        };
        Ok(Linearised {
            contraction: ask.contraction,
            force_n: linear(unit_force * force),
            equator_force_n: linear(unit_force * (force + section)),
            mid_radius_m: linear(radius * mid),
            volume_polygon_m3: linear(volume),
            convergence: outcome.convergence,
            start: self.start_of(ask.contraction, &outcome, seeds),
        })
    }

    fn start_of<const N: usize>(
        &self,
        contraction: f64,
        outcome: &Outcome<N>,
        seeds: &Seeds,
    ) -> Option<Start> {
        let Solution::Shooting(unknowns) = outcome.solution else { return None };
        let follow = outcome.follow.as_ref()?;
        let mut values = [0.0; Variable::COUNT];
        let mut by_variable = [[0.0; Variable::COUNT]; 2];
        for (i, variable) in Variable::all().enumerate() {
            values[i] = self.value(variable);
            for (z, total) in follow.iter().enumerate() {
                by_variable[z][i] = total.by_parameter.get(seeds.places[i]).copied().unwrap_or(0.0);
            }
        }
        let by_contraction = [follow[0].by_contraction, follow[1].by_contraction];
        let shot = Shot { unknowns, contraction, values, by_contraction, by_variable };
        Some(Start(Found::Shooting(Box::new(shot))))
    }
}

/// What is asked for.
struct Question<'a> {
    start: Option<&'a Start>,
    contraction: f64,
    variables: &'a [Variable],
    approach: Approach,
}

/// The places of the variables in the dual numbers, by [`Variable::index`]: 0 and 1 are the unknowns, 2 the pressure, whether asked for or not.
struct Seeds {
    places: [usize; Variable::COUNT],
    asked: [bool; Variable::COUNT],
    count: usize,
}

impl Seeds {
    fn add(&mut self, variable: Variable) -> Result<(), FibreError> {
        let index = variable.index();
        if std::mem::replace(&mut self.asked[index], true) {
            return Err(FibreError::AskedTwice { variable });
        }
        if variable != Variable::Pressure {
            self.places[index] = 2 + self.count;
            self.count += 1;
        }
        Ok(())
    }
}
