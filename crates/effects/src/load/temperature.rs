//! Temperature: the force and the modulus of the rubber change in proportion to the temperature (catalogue
//! T1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `F -> F (1 + alpha dT)`, and with a bladder also `modulus -> modulus (1 + alpha_b dT)`, where dT is the
/// temperature above that of the first row.
#[derive(Debug)]
pub(crate) struct Temperature;

impl Effect for Temperature {
    fn card(&self) -> Card<'_> {
        Card {
            name: "temperature",
            family: "temperature",
            mechanism: Mechanism::SofteningAndHeat,
            form: Form::Loose,
            title: "Temperature of muscle and rig",
            about: "Warm rubber is stiffer: its elasticity comes from the motion of its molecules, which grows by a three-hundredth per \
                    degree. Everything else that warmth does to force and load cell is a relative change of the force. At a regulated \
                    pressure the gas itself doesn't change the force.",
            equation: "F x (1 + alpha dT),   bladder's modulus x (1 + alpha_b dT),   dT = temperature above that of the first row",
            source: "elasticity of rubber from entropy, modulus in proportion to the absolute temperature: 1/293 K = 0.0034 per kelvin",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0 and 1",
                parity: Parity::Even,
                shape: "as the force, and as the bladder's force, times the temperature",
            },
            twins: &[
                Twin {
                    name: "self-heating",
                    how: "0.999 where the measured temperature only rises, 0.2 where it goes up and down",
                },
                Twin { name: "force-drift", how: "where the temperature rises steadily" },
                Twin { name: "bladder-elasticity", how: "at one temperature" },
                Twin { name: "force-gain", how: "at one temperature" },
            ],
            separate: "the same loop at two room temperatures, warm, cold and warm again: the muscle's own heat follows the clock instead",
            needs: Needs::Temperature,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let per_kelvin = ("1/K", 1.0);
        vec![
            ParameterCard::new(
                "force",
                per_kelvin,
                (-0.05, 0.05),
                0.001,
                "relative change of the force per kelvin",
            )
            .prior(0.0, 0.003)
            .plausible(-0.015, 0.015),
            ParameterCard::new(
                "modulus",
                per_kelvin,
                (-0.05, 0.05),
                0.0034,
                "relative change of the bladder's modulus per kelvin; of no account without a bladder",
            )
            .prior(0.0, 0.005)
            .plausible(-0.015, 0.01),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for Temperature {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, input: &mut Input) {
        input.multiply_force(theta[0] * moment.temperature + 1.0);
        if setting.has_bladder {
            input.multiply_modulus(theta[1] * moment.temperature + 1.0, setting);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Jet, Moment, Setting};
    use crate::probe::{SETTING, input};
    use bulge_numerics::Real;

    #[test]
    fn the_whole_force_changes_without_a_bladder() {
        let found = input(&Temperature, &[0.002, 0.0034], |moment| moment.temperature = 10.0);
        assert!((found.area.value() - 1.02).abs() < 1e-15);
        assert_eq!(found.area, found.wall);
    }

    #[test]
    fn the_modulus_changes_with_a_bladder() {
        let setting = Setting { has_bladder: true, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let moment = Moment { temperature: 10.0, ..Moment::at_rest(2e5, 0.1) };
        Temperature.act(
            Row {
                moment: &moment,
                setting: &setting,
                theta: &[0.002, 0.0034].map(Jet::from),
                memory: &mut [],
            },
            &mut input,
        );
        assert!((input.area.value() - 1.02).abs() < 1e-15);
        assert!((input.wall.value() - 1.02 * 1.034).abs() < 1e-15);
    }
}
