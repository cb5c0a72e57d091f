//! Bladder elasticity: the rubber tube inside a braid resists deformation (Mooney-Rivlin; catalogue E7 and
//! E8).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::MuscleError;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MEGAPASCAL;

/// Stored energy W = c10 (I1 - 3) of the rubber in the equilibrium of the net. A c01 stated by the muscle is
/// kept.
#[derive(Debug)]
pub(crate) struct BladderElasticity;

impl Effect for BladderElasticity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-elasticity",
            family: "bladder-elasticity",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Elasticity of the rubber bladder",
            about: "Part of the work of the gas goes into stretching the rubber tube inside the braid. It follows the net point by point, so \
                    it acts in the equilibrium. In Festo's muscles it is the largest missing effect (180 to 220 N of 1300 N).",
            equation: "W = c10 (l1^2 + l2^2 + 1/(l1 l2)^2 - 3),  l1 = cos(theta)/cos(alpha0),  l2 = r/r0,  wall thickness t: 2 pi r0 t W per length;   \
                       on a cylinder dF = 2 pi r0 t (W_1 + W_2 dl2/dl1)",
            source: "Mooney 1940, Rivlin 1948; energy of the net derived; 285 to 390 kPa fitted to published Festo data",
            evidence: Evidence::Derived,
            group: Group::Material,
            kind: BRAIDED,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "0 at eps = 0, falls steeply, levels off from 5 % on",
            },
            twins: &[
                Twin { name: "hoop-elasticity", how: "0.991" },
                Twin { name: "pressure-droop", how: "0.96" },
                Twin { name: "temperature", how: "a warmer bladder is a stiffer bladder" },
            ],
            separate: "a coupon of the rubber in a tensile test; stretching the muscle at zero pressure",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "Mooney-Rivlin constant c10 (its key in files), half the shear modulus at rest";
        vec![
            ParameterCard::new("modulus", MEGAPASCAL, (0.0, 3.0), 0.3, about)
                .key("c10")
                .prior(0.3, 0.3)
                // The range extends from a soft silicone (Ecoflex 00-30: 69 kPa at 100 %, six times c10) to a
                // hard polyurethane.
                .plausible(0.01, 1.2),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for BladderElasticity {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        parts.set_rubber("effects.bladder-elasticity.c10", theta[0], |rubber| &mut rubber.c10)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, pleated, with};
    use bulge_fibre::Rubber;
    use bulge_muscles::Parameter;
    use std::f64::consts::PI;

    #[test]
    fn a_cylinder_loses_what_the_energy_of_the_tube_says() {
        let muscle = cylinder().with(Parameter::Wall, 0.002).unwrap();
        let (c10, wall, radius, contraction) = (3e5, 0.002, 0.01, 0.1);
        let rubber = with(&BladderElasticity, &[c10], &muscle).unwrap();
        let (s, c) = 25.0_f64.to_radians().sin_cos();
        let l1: f64 = 1.0 - contraction;
        let l2 = (1.0 - (l1 * c).powi(2)).sqrt() / s;
        let w_1 = 2.0 * c10 * (l1 - 1.0 / (l1.powi(3) * l2 * l2));
        let w_2 = 2.0 * c10 * (l2 - 1.0 / (l2.powi(3) * l1 * l1));
        let expected = 2.0 * PI * radius * wall * (w_1 - w_2 * l1 * (c / s).powi(2) / l2);
        let found = force(&rubber, 2.0, contraction) - force(&muscle, 2.0, contraction);
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }

    #[test]
    fn no_modulus_is_the_same_muscle() {
        // At 0 this also holds for a muscle that can't have a bladder because it has no wall.
        assert_eq!(with(&BladderElasticity, &[0.0], &cylinder()).unwrap(), Parts::of(&cylinder()));
        assert!(with(&BladderElasticity, &[3e5], &cylinder()).is_err());
        assert!(with(&BladderElasticity, &[3e5], &pleated()).is_err());
        let stated = cylinder().with(Parameter::Wall, 0.002).unwrap().with(Parameter::C10, 2e5).unwrap();
        assert_eq!(with(&BladderElasticity, &[0.0], &stated).unwrap(), Parts::of(&stated));
        let other = with(&BladderElasticity, &[3e5], &stated).unwrap();
        assert_eq!(other.rubber.unwrap(), Rubber { c10: 3e5, c01: 0.0, wall: 0.002 });
    }
}
