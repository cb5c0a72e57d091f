//! Braid angle error: the braid angle differs from the stated one (catalogue G14).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::MuscleError;
use bulge_numerics::Real;
use std::f64::consts::FRAC_PI_2;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::DEGREE;

/// `alpha0 -> alpha0 + error` in the equilibrium of the net.
#[derive(Debug)]
pub(crate) struct BraidAngleError;

impl Effect for BraidAngleError {
    fn card(&self) -> Card<'_> {
        Card {
            name: "braid-angle-error",
            family: "braid-angle-error",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Angle of the braid",
            about: "The fibres run at another angle to the axis than stated. Half a degree too steep costs 5 % of the force at full length \
                    and moves the contraction at which the muscle stops pulling.",
            equation: "alpha0 -> alpha0 + error;   on a cylinder F = pi r0^2 p (3 (1 - eps)^2/tan^2(alpha0) - 1/sin^2(alpha0))",
            source: "derivative of S2 eq. 12; 23.5 to 28.6 deg are reported for muscles of the same make (S5 and later work)",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: BRAIDED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "3 (1 - eps)^2 - 1: largest at eps = 0, zero where the fibres cross at their neutral angle",
            },
            twins: &[
                Twin {
                    name: "radius-error",
                    how: "together they are all that the force of a cylinder shows",
                },
                Twin { name: "fibre-length", how: "absorbed once radius and angle are calibrated" },
                Twin { name: "displacement-gain", how: "near" },
                Twin { name: "end-factor", how: "near" },
            ],
            separate: "measure fibre length and turns of a dissected muscle; a photograph of the braid at rest",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        // Muscles sold as one type were found to have angles of 23 to 25 deg (S2, S5).
        let about = "true angle at rest minus the stated one";
        vec![
            ParameterCard::new("error", DEGREE, (-12.0, 12.0), 0.0, about)
                .prior(0.0, 0.5)
                .plausible(-3.0, 3.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for BraidAngleError {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let angle = parts.angle + theta[0];
        if !(angle.value() > 0.0 && angle.value() < FRAC_PI_2) {
            return Err(MuscleError::BraidAngle { degrees: angle.value().to_degrees() });
        }
        parts.angle = angle;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, with};
    use bulge_muscles::preset;

    #[test]
    fn half_a_degree_is_five_per_cent() {
        let muscle = cylinder();
        let steep = with(&BraidAngleError, &[0.5_f64.to_radians()], &muscle).unwrap();
        let shape = |degrees: f64| {
            let (s, c) = degrees.to_radians().sin_cos();
            (3.0 * c * c - 1.0) / (s * s)
        };
        let ratio = force(&steep, 3.0, 0.0) / force(&muscle, 3.0, 0.0);
        assert!((ratio - shape(25.5) / shape(25.0)).abs() < 1e-9);
        assert!((ratio - 0.950).abs() < 2e-3, "{ratio}");
    }

    #[test]
    fn angles_that_are_none_and_other_muscles_are_refused() {
        assert!(with(&BraidAngleError, &[-0.5], &cylinder()).is_err());
        assert!(with(&BraidAngleError, &[0.01], &preset("ppam-2-r16").unwrap()).is_err());
    }
}
