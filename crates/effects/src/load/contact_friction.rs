//! Contact friction: friction on the contact area between braid and bladder (Tondu and Lopez 2000; catalogue
//! F4).

use bulge_numerics::Real;
use std::f64::consts::PI;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NUMBER;

/// Lower limit of sin^2 of the braid angle. A braid drawn straight has no radius left.
const LEAST_SINE_SQUARED: f64 = 1e-3;

/// `dF = -s f S p`, `S = 2 pi r0 l0 sin a0/((1 - eps) sqrt(1 - cos^2 a0 (1 - eps)^2))`.
///
/// The factor by which f decreases with speed (from sticking to sliding) is left out. At the speeds of force
/// maps it is constant.
#[derive(Debug)]
pub(crate) struct ContactFriction;

impl Effect for ContactFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "contact-friction",
            family: "pressure-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction on the contact area of the braid",
            about: "The strands slide on what they touch, pressed on by the gas. The area grows with the muscle's length and radius, so a \
                    muscle twice as long loses twice the force; other friction in proportion to the pressure doesn't know the length.",
            equation: "dF = -s f S p,   S = 2 pi r0 l0 sin a0/((1 - eps) sqrt(1 - cos^2 a0 (1 - eps)^2))",
            source: "Tondu and Lopez 2000, as coded in a public repository; f about 0.015 there (24 N/bar at 250 mm), 0.001 for Festo's muscles",
            evidence: Evidence::LookedUp,
            group: Group::Load,
            kind: BRAIDED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Odd,
                shape: "falls a little with eps; in proportion to l0",
            },
            twins: &[
                Twin { name: "crossing-friction", how: "0.999" },
                Twin { name: "pressure-friction", how: "0.995" },
                Twin { name: "force-friction", how: "0.952" },
            ],
            separate: "a second length",
            needs: Needs::Path,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "friction force per force that presses on the contact area";
        vec![
            ParameterCard::new("coefficient", NUMBER, (0.0, 0.1), 0.001, about)
                .prior(0.0, 0.005)
                .plausible(0.0, 0.03),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for ContactFriction {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let (sine, cosine) = setting.braid_angle.sin_cos();
        let stretch = -balance.contraction + 1.0;
        let squared = -(stretch * cosine).squared() + 1.0;
        let squared =
            if squared.value() < LEAST_SINE_SQUARED { Jet::from(LEAST_SINE_SQUARED) } else { squared };
        let area = Jet::from(2.0 * PI * setting.radius * setting.length * sine) / (stretch * squared.sqrt());
        *force = *force - theta[0] * area * balance.pressure * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Moment, Setting};
    use crate::probe::{SETTING, balance, load};

    #[test]
    fn the_area_of_a_braid() {
        // S(0) = 2 pi r0 l0 = 157.080 cm^2 and S(10 %) = 66.3847 cm^2/(0.9 * 0.578508) = 127.502 cm^2, with
        // f = 0.001 at 2 bar.
        let up = load(&ContactFriction, &[1e-3], |moment| moment.direction = 1.0);
        assert!((up + 2.550_04).abs() < 1e-4, "{up}");
    }

    #[test]
    fn twice_the_length_rubs_twice_as_much_and_a_straight_braid_is_no_error() {
        let run = |length: f64, contraction: f64| {
            let setting = Setting { length, ..SETTING };
            let moment = Moment { direction: -1.0, ..Moment::at_rest(2e5, contraction) };
            let mut force = Jet::from(0.0);
            ContactFriction.act(
                Row { moment: &moment, setting: &setting, theta: &[Jet::from(1e-3)], memory: &mut [] },
                &balance(contraction),
                &mut force,
            );
            force.value()
        };
        assert!((run(0.5, 0.1) - 2.0 * run(0.25, 0.1)).abs() < 1e-12);
        assert!((run(0.25, 0.0) - 1e-3 * 0.015_707_963 * 2e5).abs() < 1e-6);
        assert!(run(0.25, -0.2).is_finite());
    }
}
