//! Bladder elasticity: the rubber tube inside a braid resists being deformed (Mooney-Rivlin; catalogue E7 and E8).

use bulge_muscles::{Kind, Muscle, MuscleError, Parameter};

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Reshaped, Setting};
use crate::unit::MEGAPASCAL;

/// Stored energy W = c10 (I1 - 3) of the rubber in the equilibrium of the net; c01 of the muscle, if any, stays.
#[derive(Debug)]
pub(crate) struct BladderElasticity;

impl Effect for BladderElasticity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-elasticity",
            family: "bladder-elasticity",
            title: "Elasticity of the rubber bladder",
            about: "Part of the work of the gas goes into stretching the rubber tube inside the braid. It follows the net point by point, so \
                    it acts in the equilibrium. In Festo's muscles it is the largest missing effect (180 to 220 N of 1300 N).",
            equation: "W = c10 (l1^2 + l2^2 + 1/(l1 l2)^2 - 3),  l1 = cos(theta)/cos(alpha0),  l2 = r/r0,  wall thickness t: 2 pi r0 t W per length; \
                       on a cylinder dF = 2 pi r0 t (W_1 + W_2 dl2/dl1)",
            source: "Mooney 1940, Rivlin 1948; energy of the net derived; 285 to 390 kPa fitted to published Festo data",
            evidence: Evidence::Derived,
            group: Group::Material,
            stage: Stage::Shape,
            kind: Some(Kind::Braided),
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
        let about = "Mooney-Rivlin constant c10, half the shear modulus at rest";
        vec![
            ParameterCard::new("modulus", MEGAPASCAL, (0.0, 3.0), 0.3, about)
                .key("c10")
                .prior(0.3, 0.3)
                .plausible(0.03, 1.2),
        ]
    }

    fn act(&self, _: &Moment, _: &Setting, _: &[Jet], _: &mut [Jet], _: Place<'_>) {}

    fn reshape(&self, muscle: &Muscle, theta: &[f64]) -> Result<Reshaped, MuscleError> {
        if theta[0] == 0.0 && muscle.bladder().is_none() {
            return Ok(Reshaped { muscle: muscle.clone(), moves: vec![(0, Parameter::C10, 1.0)] });
        }
        Reshaped::setting(muscle, &[(Parameter::C10, theta[0])])
    }
}
