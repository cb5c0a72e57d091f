//! Fibre misalignment: the fibres of a pleated muscle form a slight helix (catalogue G7).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::MuscleError;
use bulge_numerics::Real;
use std::f64::consts::FRAC_PI_2;

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::DEGREE;

/// `sin(theta) = r sin(gamma)/R` in the equilibrium of the net.
#[derive(Debug)]
pub(crate) struct FibreMisalignment;

impl Effect for FibreMisalignment {
    fn card(&self) -> Card<'_> {
        Card {
            name: "fibre-misalignment",
            family: "fibre-misalignment",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Fibres laid at an angle",
            about: "The fibres don't run along the meridians but as a slight helix, a braid of very small angle. The further out they get, the \
                    more of their length goes around the muscle, and the force falls. One sense of the helix twists the muscle; the force is \
                    the same for both, so a small angle acts with its square.",
            equation: "sin(theta) = (r/R) sin(gamma),   fibre length l0/cos(gamma);   dF ~ gamma^2, so its derivative at 0 vanishes",
            source: "equilibrium of the net, derived; the law of pinned crossings",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: PLEATED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "as the force, the loss growing with eps",
            },
            twins: &[
                Twin { name: "pressure-gain", how: "0.999" },
                Twin { name: "fibre-count", how: "0.999" },
                Twin { name: "lobes", how: "0.956 far from the stop" },
                Twin { name: "end-radius", how: "near" },
            ],
            separate: "look along the muscle: twist or torque under pressure; a photograph of the fibres",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about =
            "angle gamma between fibre and meridian at the fitting; replaces an angle that the muscle states";
        vec![ParameterCard::new("angle", DEGREE, (0.0, 10.0), 3.0, about).prior(0.0, 3.0).plausible(0.0, 6.0)]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for FibreMisalignment {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let angle = theta[0];
        // The force is even in the angle, so its derivative at 0 vanishes. At 0 the parts stay unchanged.
        if angle.value() == 0.0 {
            return Ok(());
        }
        if angle.value().abs() >= FRAC_PI_2 || angle.value().is_nan() {
            return Err(MuscleError::Misalignment { degrees: angle.value().to_degrees() });
        }
        parts.angle = angle;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{force, pleated, with};

    #[test]
    fn the_loss_is_even_in_the_angle_and_goes_with_its_square() {
        let muscle = pleated();
        let loss = |degrees: f64, contraction: f64| {
            let helix = with(&FibreMisalignment, &[degrees.to_radians()], &muscle).unwrap();
            force(&helix, 1.0, contraction) - force(&muscle, 1.0, contraction)
        };
        for contraction in [0.1, 0.2] {
            let [one, two, back] = [1.0, 2.0, -2.0].map(|angle| loss(angle, contraction));
            assert!(one < 0.0 && (two - back).abs() < 1e-6 * two.abs(), "{two} {back}");
            assert!((two / one - 4.0).abs() < 0.05, "{}", two / one);
        }
    }

    #[test]
    fn straight_fibres_are_the_same_muscle() {
        assert_eq!(with(&FibreMisalignment, &[0.0], &pleated()).unwrap(), Parts::of(&pleated()));
        let helix = with(&FibreMisalignment, &[0.05], &pleated()).unwrap();
        assert_eq!(helix, Parts { angle: 0.05, ..Parts::of(&pleated()) });
        assert!(with(&FibreMisalignment, &[1.6], &pleated()).is_err());
    }
}
