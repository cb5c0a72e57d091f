//! Second constant of the bladder: the part of the rubber's elasticity that a neo-Hookean law lacks
//! (Mooney-Rivlin; catalogue E8).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::MuscleError;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MEGAPASCAL;

/// Stored energy W = c01 (I2 - 3) of the rubber, in addition to its c10 term if it has one.
#[derive(Debug)]
pub(crate) struct BladderC01;

impl Effect for BladderC01 {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-c01",
            family: "bladder-elasticity",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Second constant of the rubber bladder",
            about: "Rubber that is stretched in two directions is stiffer than the simplest law says. The second constant of Mooney and Rivlin \
                    stands for that. In a force map it looks nearly like the first: fit one of the two, or test the rubber by itself.",
            equation: "W = c01 (1/l1^2 + 1/l2^2 + (l1 l2)^2 - 3),   beside c10 (I1 - 3);   l1, l2 as for bladder-elasticity",
            source: "Mooney 1940, Rivlin 1948; latex c10 = 118.4 and c01 = 105.7 kPa after Klute and Hannaford 2000",
            evidence: Evidence::Literature,
            group: Group::Material,
            kind: BRAIDED,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "0 at eps = 0, falls steeply, and goes on falling where that of c10 levels off",
            },
            twins: &[
                Twin { name: "bladder-elasticity", how: "0.982" },
                Twin { name: "hoop-elasticity", how: "-0.991 once c10 is calibrated" },
            ],
            separate: "a coupon of the rubber stretched in two directions",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "Mooney-Rivlin constant c01";
        vec![
            ParameterCard::new("modulus", MEGAPASCAL, (0.0, 3.0), 0.1, about)
                .key("c01")
                .prior(0.0, 0.15)
                .plausible(0.0, 1.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for BladderC01 {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        parts.set_rubber("effects.bladder-elasticity.c01", theta[0], |rubber| &mut rubber.c01)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, with};
    use bulge_muscles::Parameter;
    use std::f64::consts::PI;

    #[test]
    fn a_cylinder_loses_what_the_energy_of_the_tube_says() {
        let muscle = cylinder().with(Parameter::Wall, 0.002).unwrap();
        let (c01, wall, radius, contraction) = (1e5, 0.002, 0.01, 0.1);
        let rubber = with(&BladderC01, &[c01], &muscle).unwrap();
        let (s, c) = 25.0_f64.to_radians().sin_cos();
        let l1: f64 = 1.0 - contraction;
        let l2 = (1.0 - (l1 * c).powi(2)).sqrt() / s;
        let w_1 = 2.0 * c01 * (l1 * l2 * l2 - 1.0 / l1.powi(3));
        let w_2 = 2.0 * c01 * (l2 * l1 * l1 - 1.0 / l2.powi(3));
        let expected = 2.0 * PI * radius * wall * (w_1 - w_2 * l1 * (c / s).powi(2) / l2);
        let found = force(&rubber, 2.0, contraction) - force(&muscle, 2.0, contraction);
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }

    #[test]
    fn it_leaves_the_first_constant() {
        let neo = cylinder().with(Parameter::Wall, 0.002).unwrap().with(Parameter::C10, 3e5).unwrap();
        let both = with(&BladderC01, &[1e5], &neo).unwrap();
        let rubber = both.rubber.unwrap();
        assert_eq!((rubber.c10, rubber.c01), (3e5, 1e5));
        assert_eq!(with(&BladderC01, &[0.0], &neo).unwrap(), Parts::of(&neo));
    }
}
