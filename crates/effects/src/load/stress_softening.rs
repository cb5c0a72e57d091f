//! Stress softening: rubber is stiffer in its first cycles (Mullins 1948; catalogue R7).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Jet, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NUMBER, PERCENT};

/// `factor = 1 + D exp(-N/N0)`, where N is the number of loops so far, including the completed part of the
/// current one. The factor acts on the modulus of the bladder, or on the whole force if there is no bladder.
///
/// Filler breaks along the way, most of it on the first one, and nothing jumps from loop to loop. Within the
/// first loop rubber is also stiffer while it is stretched further than ever before, and softer on the way
/// back. This part looks like friction in one loop and is left out.
#[derive(Debug)]
pub(crate) struct StressSoftening;

impl Effect for StressSoftening {
    fn card(&self) -> Card<'_> {
        Card {
            name: "stress-softening",
            family: "stress-softening",
            mechanism: Mechanism::SofteningAndHeat,
            form: Form::Loose,
            title: "Softening in the first cycles",
            about: "New rubber is stiffer: the first cycles break up its filler, and it settles down to its later stiffness within a few. \
                    Where the muscle has no bladder, all of its force settles in the same way.",
            equation: "modulus x (1 + D exp(-N/N0)),   N loops so far, with the part of the one under way;   without a bladder the force x the same",
            source: "Mullins 1948; exponential form of conditioning; 10 to 40 % in the first cycle",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "as the bladder's force, dying out with the cycles",
            },
            twins: &[
                Twin { name: "bladder-elasticity", how: "identical within one cycle" },
                Twin { name: "force-drift", how: "over a few cycles" },
                Twin { name: "self-heating", how: "a change of the modulus with time instead of cycles" },
            ],
            separate: "five cycles of a new muscle, a pause, and five more: what stays is softening, what comes back is heat",
            needs: Needs::Cycles,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "amplitude",
                PERCENT,
                (0.0, 100.0),
                20.0,
                "how much stiffer the first cycle is",
            )
            .prior(0.0, 30.0)
            .plausible(0.0, 50.0),
            ParameterCard::new(
                "cycles",
                NUMBER,
                (0.2, 30.0),
                1.0,
                "number of cycles within which it settles",
            )
            .off_at(1.0)
            .logarithmic(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for StressSoftening {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, input: &mut Input) {
        input.multiply_modulus(theta[0] * (-(Jet::from(moment.cycle) / theta[1])).exp() + 1.0, setting);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Moment, Setting};
    use crate::probe::{SETTING, input};

    #[test]
    fn the_force_settles_with_the_cycles() {
        for (cycle, expected) in [(0.0, 1.2), (1.0, 1.073_575_888), (40.0, 1.0)] {
            let found = input(&StressSoftening, &[0.2, 1.0], |moment| moment.cycle = cycle);
            assert!((found.wall.value() - expected).abs() < 1e-9, "{cycle}");
            assert_eq!(found.wall, found.area);
        }
    }

    #[test]
    fn of_a_bladder_it_is_the_modulus() {
        let setting = Setting { has_bladder: true, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let moment = Moment { cycle: 2.0, ..Moment::at_rest(2e5, 0.1) };
        StressSoftening.act(
            Row { moment: &moment, setting: &setting, theta: &[0.2, 2.0].map(Jet::from), memory: &mut [] },
            &mut input,
        );
        assert!((input.wall.value() - 1.073_575_888).abs() < 1e-9);
        assert_eq!(input.area, Jet::from(1.0));
    }
}
