//! Crossing friction: crossing strands rotate against each other under the gas pressure (catalogue F3;
//! virtual work derived).

use std::f64::consts::PI;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `dF = -s 4 pi (mu rho_e) (r0/sin a0) cos a0 p (1 - eps)`.
///
/// The angle between the two families changes by 2 dtheta, with dtheta/deps = cos(a0)/sin(theta). A contact
/// of force N_c resists with the moment mu rho_e N_c. All contacts together carry p 2 pi r l, with r = r0
/// sin(theta)/sin(a0) and l = l0 (1 - eps). Dividing the work by l0 deps cancels theta. If the inner family
/// bears half of the pressure itself, the contacts carry only half, and mu rho_e is twice as large.
#[derive(Debug)]
pub(crate) struct CrossingFriction;

impl Effect for CrossingFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "crossing-friction",
            family: "pressure-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Strands that turn on each other",
            about: "At every crossing two strands lie on each other, pressed together by the gas, and turn like the blades of scissors when \
                    the muscle moves. The friction is in proportion to the pressure and falls a little as the muscle gets shorter.",
            equation: "dF = -s 4 pi (mu rho_e) (r0/sin a0) cos a0 p (1 - eps),   mu coefficient of friction, rho_e effective radius of a contact",
            source: "virtual work on the contacts, which carry p on the whole wall; mu 0.1 to 0.4, rho_e 0.1 to 0.5 mm",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: BRAIDED,
            signature: Signature { pressure: "1", parity: Parity::Odd, shape: "1 - eps" },
            twins: &[
                Twin { name: "contact-friction", how: "0.999" },
                Twin { name: "pressure-friction", how: "0.995" },
                Twin { name: "force-friction", how: "0.956" },
            ],
            separate: "a second length (this one doesn't change with it, contact-friction does)",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "coefficient of friction times effective radius of a contact, mu rho_e";
        vec![
            ParameterCard::new("arm", MILLIMETRE, (0.0, 4.0), 0.075, about)
                .prior(0.0, 0.1)
                .plausible(0.0, 0.3),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for CrossingFriction {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let area_per_arm = 4.0 * PI * setting.radius / setting.braid_angle.tan();
        let loss = theta[0] * area_per_arm * balance.pressure * (-balance.contraction + 1.0);
        *force = *force - loss * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn a_braid_of_20_mm_loses_two_newtons_per_bar() {
        // 4 pi 0.075 mm 10 mm cot(25 deg) = 2.02115 N/bar at eps = 0 (catalogue: 2.0). At 2 bar and 10 % this
        // is 3.63807 N.
        let up = load(&CrossingFriction, &[7.5e-5], |moment| moment.direction = 1.0);
        let down = load(&CrossingFriction, &[7.5e-5], |moment| moment.direction = -1.0);
        assert!((up + 3.638_07).abs() < 1e-5 && (down + up).abs() < 1e-15, "{up}");
    }
}
