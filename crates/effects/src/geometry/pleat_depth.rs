//! Pleat depth: under pressure the crests of the cloth stand outside the fibres (catalogue G3).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `A = (n/2) sin(2 pi/n) (r + h)^2` with `r + h` in place of `r`.
#[derive(Debug)]
pub(crate) struct PleatDepth;

impl Effect for PleatDepth {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pleat-depth",
            family: "pleat-depth",
            mechanism: Mechanism::Section,
            form: Form::Exact,
            title: "Depth of the pleats under pressure",
            about: "The crests of the pleats stand outside the fibres and enclose gas there too, so the pressure acts out to r + h. In force \
                    this is exactly a muscle with fittings of radius R + h: another reading of why the second-generation PPAM, with fibres laid \
                    at 11.5 mm, pulls like one of 16 mm.",
            equation: "A(r) = (n/2) sin(2 pi/n) (r + h)^2;   F(R, h) = F(R + h, 0)",
            source: "equilibrium of the fibres, derived; S1 discusses 11.5 mm against 16 mm",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: PLEATED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "dF/dR: more force at small contractions, less at large ones",
            },
            twins: &[
                Twin { name: "end-radius", how: "identical in force; only a photograph of the fibres tells" },
                Twin { name: "displacement-gain", how: "0.997" },
            ],
            separate: "photograph the fibres at the fitting under pressure; neither force nor volume tells",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "height h of the crests above the fibres; replaces a depth that the muscle states";
        let card = ParameterCard::multiple("depth", MILLIMETRE, Parameter::Radius, (0.0, 0.6), about);
        vec![ParameterCard { typical: 0.25, ..card }.off_at(0.0).prior(0.0, 0.3).plausible(0.0, 0.45)]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for PleatDepth {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let depth = theta[0];
        check::not_negative("effects.pleat-depth.depth", Length::from_si(depth.value()))?;
        // At 0 the muscle keeps its stated depth.
        if depth.value() != 0.0 || parts.depth.value() == 0.0 {
            parts.depth = depth;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, pleated, with};
    use bulge_muscles::preset;

    #[test]
    fn it_pulls_as_fittings_of_the_radius_of_the_crests() {
        let narrow = preset("ppam-2-r11.5").unwrap();
        let deep = with(&PleatDepth, &[0.0045], &narrow).unwrap();
        for contraction in [0.03, 0.1, 0.3] {
            let (found, expected) = (force(&deep, 2.0, contraction), force(&pleated(), 2.0, contraction));
            assert!((found / expected - 1.0).abs() < 1e-9, "{contraction}: {found} {expected}");
        }
    }

    #[test]
    fn no_depth_is_the_same_muscle() {
        let muscle = pleated();
        assert_eq!(with(&PleatDepth, &[0.0], &muscle).unwrap(), Parts::of(&muscle));
        let deep = muscle.with(Parameter::PleatDepth, 0.001).unwrap();
        assert_eq!(with(&PleatDepth, &[0.0], &deep).unwrap(), Parts::of(&deep));
        assert!(with(&PleatDepth, &[0.001], &cylinder()).is_err());
        assert!(with(&PleatDepth, &[-0.001], &muscle).is_err());
    }
}
