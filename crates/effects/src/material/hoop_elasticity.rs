//! Hoop elasticity: a bladder that resists widening linearly (catalogue E6).

use std::f64::consts::TAU;

use super::tube::Tube;
use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::KILONEWTON_PER_METRE;

/// `dF = 2 pi r0 E_h t (l2 - 1) dl2/dl1` with the kinematics of a cylinder.
#[derive(Debug)]
pub(crate) struct HoopElasticity;

impl Effect for HoopElasticity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "hoop-elasticity",
            family: "bladder-elasticity",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Hoop stiffness of the bladder, linear",
            about: "The wall is stretched around the muscle as that swells, like a ring of linear rubber. This is the simplest bladder: one \
                    line stiffness for modulus times thickness, on a cylinder. It needs no wall thickness, but rubber is linear only for \
                    small stretches, and a muscle at 20 % is stretched by 60 %.",
            equation: "dF = 2 pi r0 (E_h t) (l2 - 1) dl2/dl1,   l1 = 1 - eps,   l2 = sqrt(1 - l1^2 cos^2(alpha0))/sin(alpha0),   \
                       dl2/dl1 = -l1 cot^2(alpha0)/l2",
            source: "virtual work; Martens and Boblan 2017 use it with a modulus that depends on the length (DMSP-20, t = 1.8 mm)",
            evidence: Evidence::LookedUp,
            group: Group::Material,
            kind: BRAIDED,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "0 at eps = 0, falls steeply, levels off from 10 % on",
            },
            twins: &[
                Twin { name: "bladder-elasticity", how: "0.991" },
                Twin { name: "bladder-c01", how: "-0.991 once c10 is calibrated" },
                Twin { name: "pressure-droop", how: "near" },
            ],
            separate: "a coupon of the rubber in a tensile test; stretching the muscle at zero pressure (0.95)",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "hoop modulus times wall thickness, E_h t";
        vec![
            ParameterCard::new("stiffness", KILONEWTON_PER_METRE, (0.0, 50.0), 2.0, about)
                .prior(0.0, 3.0)
                .plausible(0.0, 15.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for HoopElasticity {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        if let Some(tube) = Tube::at(balance.contraction, setting) {
            *force += theta[0] * (tube.hoop + -1.0) * tube.slope * (TAU * setting.radius);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    /// The tube of area 2 pi r0 l0 has the energy E_h t/2 (l2 - 1)^2 per area. The derivative of the energy
    /// by the length is the force.
    #[test]
    fn the_force_is_the_derivative_of_the_energy() {
        let (stiffness, length, radius) = (2e3, 0.25, 0.01);
        let energy = |contraction: f64| {
            let (s, c) = 25.0_f64.to_radians().sin_cos();
            let l2 = (1.0 - ((1.0 - contraction) * c).powi(2)).sqrt() / s;
            0.5 * stiffness * (l2 - 1.0).powi(2) * TAU * radius * length
        };
        let h = 1e-5;
        let expected = -(energy(0.1 + h) - energy(0.1 - h)) / (2.0 * h * length);
        let found = load(&HoopElasticity, &[stiffness], |_| ());
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        assert!((found + 140.157).abs() < 1e-3, "{found}");
    }
}
