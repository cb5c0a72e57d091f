//! End radius: the radius at which the fibres leave the fittings differs from the stated one (S1, section
//! 3.1).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `R -> radius` in the end condition r = R of the equilibrium.
#[derive(Debug)]
pub(crate) struct EndRadius;

impl Effect for EndRadius {
    fn card(&self) -> Card<'_> {
        Card {
            name: "end-radius",
            family: "end-radius",
            mechanism: Mechanism::Section,
            form: Form::Exact,
            title: "Radius at the end fittings",
            about: "Under pressure the fibres are held at another radius than the drawing says. In the second-generation PPAM the epoxy \
                    ends a centimetre inside the fitting, and the fibres move from 11.5 mm out to the rim of the basin at 16 mm.",
            equation: "r = radius at both fittings, in the equilibrium of the fibre net",
            source: "S1, eqs. 15 and 24 to 28 and the discussion of figure 12",
            evidence: Evidence::Paper,
            group: Group::Geometry,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "more force at small contractions, less at large ones (PPAM: crossing near 24 %)",
            },
            twins: &[
                Twin {
                    name: "pleat-depth",
                    how: "identical in force; only a photograph of the fibres tells",
                },
                Twin { name: "displacement-gain", how: "0.997 (PPAM)" },
            ],
            separate: "photograph the fibres at the fitting under pressure; measure a second slenderness l0/R",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "radius of the fibres at the fittings";
        vec![
            ParameterCard::multiple("radius", MILLIMETRE, Parameter::FittingRadius, (0.5, 2.0), about)
                .prior(1.0, 0.2)
                .plausible(0.65, 1.5),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for EndRadius {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        check::positive("effects.end-radius.radius", Length::from_si(theta[0].value()))?;
        parts.set_fitting(theta[0]);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::with;
    use bulge_muscles::preset;

    #[test]
    fn the_radius_moves_and_nothing_else() {
        let muscle = preset("ppam-2-r11.5").unwrap();
        let same = with(&EndRadius, &[0.0115], &muscle).unwrap();
        assert_eq!(same, Parts::of(&muscle));
        let wide = with(&EndRadius, &[0.016], &muscle).unwrap();
        assert_eq!(wide, Parts { radius: 0.016, ..Parts::of(&muscle) });
        let braid = preset("dmsp-20-250").unwrap();
        let narrow = with(&EndRadius, &[0.009], &braid).unwrap();
        assert_eq!(narrow, Parts { fitting: Some(0.009), ..Parts::of(&braid) });
        assert!(with(&EndRadius, &[-0.016], &muscle).is_err());
    }
}
