//! A fast linearised answer for fits: force, meridional force, radius and volume, with exact derivatives by
//! the requested variables.
//!
//! The search for the equilibrium carries two derivatives, those by the unknowns. Only the last integration
//! carries more, as few as the question needs. Meridians are computed by quadrature where possible, ten times
//! faster than by the ODE. A start, from the answer at a neighbouring contraction, pressure or parameter, is
//! moved along its own derivatives. This saves most of the search as well.

use bulge_numerics::{Dual, Real};

mod repeated;
mod straight;

pub use repeated::Repeated;

use crate::FibreError;
use crate::closed_form::Near;
use crate::net::{Net, OWN_NUMBERS};
use crate::outcome::Follow;
use crate::outcome::{Approach, Outcome, Solution};
use crate::parts::{Jet, LANES, Parts};
use crate::problem::Problem;
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
    /// Derivatives by the variables in the lanes of the parts.
    pub by_lane: [f64; LANES],
}

/// An equilibrium with its exact first derivatives.
///
/// The sign conventions are those of [`crate::Response`]; the force may be negative, as in
/// [`Problem::follow`].
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised {
    /// Contraction (l0 - l)/l0 \[-\].
    pub contraction: f64,
    /// Axial force F \[N\].
    pub force_n: Linear,
    /// Meridional force at mid-length, N = F + p A(r_mid) \[N\]: the force that all fibres and walls
    /// carry together there.
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
    /// A start for the search for a neighbouring equilibrium. `None` where nothing is searched for
    /// (closed forms), except that [`Repeated`] has one for straight fibres.
    #[must_use]
    pub fn start(&self) -> Option<&Start> {
        self.start.as_ref()
    }

    /// The same start, to keep.
    #[must_use]
    pub fn into_start(self) -> Option<Start> {
        self.start
    }
}

/// An equilibrium from which the search for a neighbouring one can start: at another contraction or pressure,
/// or for other parameters of a muscle of the same kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Start(Found);

/// The solution that was found.
#[derive(Debug, Clone, PartialEq)]
enum Found {
    ClosedForm(Near),
    /// Boxed, because it is much larger. The box costs a small part of the search.
    Shooting(Box<Shot>),
}

/// A meridian that was found by shooting.
#[derive(Debug, Clone, PartialEq)]
struct Shot {
    unknowns: Unknowns,
    contraction: f64,
    /// The numbers of its net.
    numbers: [f64; OWN_NUMBERS],
    follow: Follow,
}

/// Largest moves of the unknowns along their derivatives. Beyond them the derivatives say little. (ln|k| of a
/// long braid moves fast, but straight.)
const FARTHEST: [f64; 2] = [0.5, 20.0];

impl Shot {
    /// The unknowns from which to start at a contraction of another problem.
    fn towards(&self, problem: &Problem, contraction: f64) -> Unknowns {
        let mut change = numbers_of(&problem.net);
        for (change, before) in change.iter_mut().zip(self.numbers) {
            *change -= before;
        }
        let logs = std::array::from_fn(|z| {
            let along: f64 =
                self.follow.by_number[z].iter().zip(&change).map(|(slope, step)| slope * step).sum();
            let step = along + self.follow.by_contraction[z] * (contraction - self.contraction);
            self.unknowns.logs[z] + if step.is_finite() { step.clamp(-FARTHEST[z], FARTHEST[z]) } else { 0.0 }
        });
        Unknowns { logs, ..self.unknowns }
    }
}

impl Problem {
    /// Force, meridional force, radius at mid-length and volume at a contraction, also where the force is
    /// negative. The derivatives by the contraction, the pressure and the variables of the parts are exact.
    /// `moving` are the parts of this problem with derivatives.
    ///
    /// # Errors
    /// See [`FibreError`].
    pub fn linearised(
        &self,
        contraction: f64,
        moving: &Parts<Jet>,
        approach: Approach,
    ) -> Result<Linearised, FibreError> {
        let found = self.linearised_from(None, contraction, moving, approach);
        found.map_err(|error| self.explained(error, contraction, approach))
    }

    /// The same, started from a neighbouring equilibrium of this muscle or a similar one. The answer is the
    /// same within its accuracy.
    ///
    /// # Errors
    /// Those of [`Problem::linearised`], but where nothing is found the limit isn't searched for. See
    /// [`Problem::explained`].
    pub fn linearised_from(
        &self,
        start: Option<&Start>,
        contraction: f64,
        moving: &Parts<Jet>,
        approach: Approach,
    ) -> Result<Linearised, FibreError> {
        let ask = Question { start, contraction, moving, approach };
        // The derivatives by the unknowns, the pressure and the lanes that are used.
        match used_lanes(moving) {
            0..=1 => self.answer::<4>(&ask),
            2..=3 => self.answer::<6>(&ask),
            _ => self.answer::<{ 3 + LANES }>(&ask),
        }
    }

    fn answer<const N: usize>(&self, ask: &Question<'_>) -> Result<Linearised, FibreError> {
        let pressure = Dual::variable(self.pressure, 2);
        let parts: Parts<Dual<N>> = ask.moving.map(|_, number| widened(&number));
        let net = parts.net(pressure);
        let from = ask.start.and_then(|start| match &start.0 {
            Found::Shooting(shot) => Some(shot.towards(self, ask.contraction)),
            Found::ClosedForm(_) => None,
        });
        let ending = if from.is_some() { BESIDE } else { FITTED };
        let outcome =
            self.outcome_of_many(self.scheme(ask.approach)?, ask.contraction, &net, from, ending)?;
        let with_contraction = |total: &Total<N>| {
            let mut gradient = total.by_parameter;
            gradient[0] = total.by_contraction;
            Dual::new(total.value, gradient)
        };
        let mid = with_contraction(&outcome.mid_radius);
        let radius = parts.radius;
        let unit_force = pressure * radius * radius;
        let force = with_contraction(&outcome.force);
        let section = net.acting_at(mid.value()).area(mid);
        let volume = with_contraction(&outcome.volume) * net.volume_factor() * radius * radius * radius;
        let linear = |out: Dual<N>| Linear {
            value: out.value(),
            by_contraction: out.gradient()[0],
            by_pressure: out.gradient()[2],
            by_lane: std::array::from_fn(|lane| out.gradient().get(3 + lane).copied().unwrap_or(0.0)),
        };
        Ok(Linearised {
            contraction: ask.contraction,
            force_n: linear(unit_force * force),
            equator_force_n: linear(unit_force * (force + section)),
            mid_radius_m: linear(radius * mid),
            volume_polygon_m3: linear(volume),
            convergence: outcome.convergence,
            start: self.start_of(ask.contraction, &outcome),
        })
    }

    fn start_of<const N: usize>(&self, contraction: f64, outcome: &Outcome<N>) -> Option<Start> {
        let Solution::Shooting(unknowns) = outcome.solution else { return None };
        let follow = outcome.follow.clone()?;
        let numbers = numbers_of(&self.net);
        Some(Start(Found::Shooting(Box::new(Shot { unknowns, contraction, numbers, follow }))))
    }
}

/// The numbers of a net in their places, without those of formulas.
fn numbers_of(net: &Net<f64>) -> [f64; OWN_NUMBERS] {
    let mut numbers = [0.0; OWN_NUMBERS];
    net.each(|place, number| {
        if let Some(own) = numbers.get_mut(place) {
            *own = number;
        }
    });
    numbers
}

/// The question for which an answer is computed.
struct Question<'a> {
    start: Option<&'a Start>,
    contraction: f64,
    moving: &'a Parts<Jet>,
    approach: Approach,
}

/// Number of lanes up to the last one that carries derivatives.
fn used_lanes(moving: &Parts<Jet>) -> usize {
    let mut used = 0;
    moving.map(|_, number| {
        let last = number.gradient().iter().rposition(|slope| *slope != 0.0);
        used = used.max(last.map_or(0, |last| last + 1));
    });
    used
}

/// The same number with the derivatives of its lanes in the places 3 .., after the two unknowns and the
/// pressure.
fn widened<const N: usize>(number: &Jet) -> Dual<N> {
    let slope = |i: usize| i.checked_sub(3).and_then(|lane| number.gradient().get(lane)).copied();
    Dual::new(number.value(), std::array::from_fn(|i| slope(i).unwrap_or(0.0)))
}
