//! Helpers for the tests of shape effects: muscles, and the force of their equilibrium.

use bulge_fibre::{Approach, Parts, Problem};
use bulge_muscles::{Angle, Braided, Construction, Ends, Length, Muscle, MuscleError, Pressure, preset};

use crate::effect::Effect;

/// The textbook cylinder of a 20 mm muscle: r0 = 10 mm, 25 deg, 250 mm.
pub(crate) fn cylinder() -> Muscle {
    let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0)).unwrap().with_ends(Ends::Cylinder);
    Muscle::new("cylinder", Length::mm(250.0), Construction::Braided(braided)).unwrap()
}

/// The second-generation PPAM: R = 16 mm, 110 mm, 40 fibres.
pub(crate) fn pleated() -> Muscle {
    preset("ppam-2-r16").unwrap()
}

/// The parts of a muscle as changed by an effect.
pub(crate) fn with(effect: &dyn Effect, theta: &[f64], muscle: &Muscle) -> Result<Parts, MuscleError> {
    effect.reshaped(theta, muscle)
}

/// Force of the equilibrium \[N\] at a pressure in bar.
pub(crate) fn force<'a, P>(parts: &'a P, bar: f64, contraction: f64) -> f64
where
    Parts: From<&'a P>,
{
    let problem = Problem::new(parts, Pressure::bar(bar)).unwrap();
    problem.follow(contraction, Approach::Auto).unwrap().force_n
}
