//! Radius error: the braid radius at rest differs from the stated one (S5, table 2: three candidates for one
//! muscle).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `r0 -> radius` in the equilibrium of the net. Fittings without a radius of their own follow.
#[derive(Debug)]
pub(crate) struct RadiusError;

impl Effect for RadiusError {
    fn card(&self) -> Card<'_> {
        Card {
            name: "radius-error",
            family: "radius-error",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Radius of the braid",
            about: "The braid lies at another radius than stated: the nominal diameter of a hose is that of its bore, the braid is embedded in \
                    the wall. In a muscle of 20 mm it was found at 10.7 mm, between a bore of 9.75 and an outside of 11.75 mm; the force goes \
                    with the square.",
            equation: "r0 = radius of the braid at rest;   on a cylinder F ~ r0^2",
            source: "S5, table 2: b sin(alpha0)/(2 pi N) = 10.725 mm, the middle of the wall",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: BRAIDED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "as the force; with clamped ends a little less at large contractions",
            },
            twins: &[
                Twin { name: "pressure-gain", how: "identical on a cylinder" },
                Twin { name: "force-gain", how: "identical on a cylinder without bladder" },
                Twin {
                    name: "braid-angle-error",
                    how: "together they are all that the force of a cylinder shows",
                },
            ],
            separate: "measure fibre length b and turns N of a dissected muscle: r0 = b sin(alpha0)/(2 pi N)",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        // A hose of 20 mm has a bore of 9.75 to 10 mm and an outside of 11.75 to 11.8 mm. The braid lies in
        // between.
        let about = "radius of the braid at rest";
        vec![
            ParameterCard::multiple("radius", MILLIMETRE, Parameter::Radius, (0.5, 2.0), about)
                .prior(1.0, 0.03)
                .plausible(0.93, 1.18),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for RadiusError {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        check::positive("radius", Length::from_si(theta[0].value()))?;
        parts.radius = theta[0];
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, with};
    use bulge_muscles::preset;

    #[test]
    fn the_force_of_a_cylinder_goes_with_the_square() {
        let muscle = cylinder();
        let wide = with(&RadiusError, &[0.01 * 1.07], &muscle).unwrap();
        assert!((force(&wide, 3.0, 0.2) / force(&muscle, 3.0, 0.2) - 1.1449).abs() < 1e-9);
        // S5's muscle compared with its nominal radius: 296.2 and 257.5 N per bar.
        let found = with(&RadiusError, &[0.010_725], &muscle).unwrap();
        assert!((force(&found, 1.0, 0.0) - 296.2).abs() < 0.1);
    }

    #[test]
    fn fittings_follow() {
        let muscle = preset("dmsp-20-250").unwrap();
        let wide = with(&RadiusError, &[0.012], &muscle).unwrap();
        assert_eq!((wide.radius, wide.fitting), (0.012, None));
        assert!(with(&RadiusError, &[0.0], &muscle).is_err());
    }
}
