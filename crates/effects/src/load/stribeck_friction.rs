//! Stribeck friction: friction that is larger in slow motion (Stribeck 1902, Bo and Pavelescu 1982).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT, PERCENT_PER_SECOND};

/// `dF = -s F_c (1 + r exp(-(v/v_s)^2))`, with v = d eps/dt, s = +1 while shortening and -1 while
/// lengthening.
///
/// r = F_s/F_c - 1 is the excess of the static friction F_s over that in fast motion. It is a parameter of
/// the form and not a size of its own. If all speeds are alike, the data determine only the product, and
/// constant friction fits as well with fewer parameters.
#[derive(Debug)]
pub(crate) struct StribeckFriction;

impl Effect for StribeckFriction {
    fn card(&self) -> Card<'_> {
        Card {
            name: "stribeck-friction",
            family: "coulomb-friction",
            mechanism: Mechanism::DryFriction,
            form: Form::Loose,
            title: "Friction that is larger in slow motion",
            about: "Lubricated guides and seals, and rubber on cloth, hold harder than they slide: the friction is largest where the motion is \
                    slow and falls to its constant value within a speed v_s. A quick loop is narrower than a slow one, and widest near its turns.",
            equation: "dF = -s F_c (1 + r exp(-(v/v_s)^2)),   v = d eps/dt,   s = +1 while shortening, -1 while lengthening, 0 at rest",
            source: "Stribeck 1902; Gaussian form of Bo and Pavelescu 1982, in Armstrong-Helouvry, Dupont and Canudas de Wit 1994; seals of \
                     pneumatic cylinders: static friction 1.2 to 2 times sliding friction, below some mm/s",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "constant, with a rise where the speed is small",
            },
            twins: &[
                Twin { name: "coulomb-friction", how: "identical at one speed" },
                Twin { name: "asymmetric-friction", how: "0.98" },
                Twin {
                    name: "viscous-damping",
                    how: "the rise -0.99 beside constant friction, where all speeds are below v_s",
                },
            ],
            separate: "the same loop at three speeds a factor of ten apart: this one gets narrower with the speed, viscosity wider",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("force", NEWTON, (0.0, 200.0), 12.0, "friction in quick motion")
                .prior(0.0, 20.0),
            ParameterCard::new(
                "rise",
                PERCENT,
                (10.0, 300.0),
                50.0,
                "by how much it is larger in the slowest motion",
            )
            .plausible(20.0, 200.0)
            .off_at(50.0)
            .logarithmic(),
            // 1 to 10 mm/s for seals corresponds to 0.4 to 4 %/s for a muscle of 250 mm.
            ParameterCard::new(
                "speed",
                PERCENT_PER_SECOND,
                (1e-3, 100.0),
                1.0,
                "contraction per time within which it falls",
            )
            .plausible(0.02, 20.0)
            .off_at(1.0)
            .logarithmic(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for StribeckFriction {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, force: &mut Jet) {
        let slow = (-(Jet::from(moment.rate) / theta[2]).squared()).exp();
        *force = *force - theta[0] * (theta[1] * slow + 1.0) * moment.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::load::coulomb_friction::CoulombFriction;
    use crate::probe::load;

    const NUMBERS: [f64; 3] = [12.0, 0.5, 0.01];

    #[test]
    fn it_falls_from_static_to_sliding_friction_within_its_speed() {
        // 12 N + 6 N exp(-(v/1 %/s)^2).
        for (rate, expected) in [
            (0.0, 18.0),
            (0.005, 16.672_804_698),
            (0.01, 14.207_276_647),
            (0.02, 12.109_893_833),
            (0.1, 12.0),
        ] {
            for s in [1.0, -1.0] {
                let found = load(&StribeckFriction, &NUMBERS, |moment| {
                    (moment.rate, moment.direction) = (s * rate, s);
                });
                assert!((found + s * expected).abs() < 1e-9, "{rate}: {found}");
            }
        }
        let at_rest = load(&StribeckFriction, &NUMBERS, |moment| moment.rate = 1e-5);
        assert!(at_rest.abs() < 1e-15);
    }

    #[test]
    fn without_a_rise_it_is_constant_friction() {
        for rate in [1e-4, 1e-2, 1.0] {
            let moving = |moment: &mut Moment| (moment.rate, moment.direction) = (rate, 1.0);
            let found = load(&StribeckFriction, &[12.0, 0.0, 0.01], moving);
            assert!((found - load(&CoulombFriction, &[12.0], moving)).abs() < 1e-15, "{rate}");
        }
    }
}
