//! Frame compliance: the frame gives way under the force, which the displacement sensor doesn't see
//! (catalogue E3).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NUMBER;

/// `true contraction = measured + F/(k l0) (|F|/1 kN)^(n - 1)`.
///
/// A beam gives in proportion to the force (n = 1). Dry contacts stiffen as they are pressed together, from
/// n = 2/3 for round ones (Hertz) to 1/2 for rough ones. A part that slips in its clamps softens as the pull
/// grows.
#[derive(Debug)]
pub(crate) struct FrameCompliance;

impl Effect for FrameCompliance {
    fn card(&self) -> Card<'_> {
        Card {
            name: "frame-compliance",
            family: "frame-compliance",
            mechanism: Mechanism::GiveOfTheRig,
            form: Form::Loose,
            title: "Compliance of frame and load train",
            about: "Frame, load cell and fittings give under the force. The muscle is then shorter than the displacement sensor says. Joints and \
                    pins stiffen as they are pressed together, which a power below one says.",
            equation: "true contraction = measured + F/(k l0) (|F|/1 kN)^(n - 1),   n = 1 elastic, 2/3 dry contact",
            source: "geometry of the measurement; Hertz 1882: a contact gives with the power 2/3",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature {
                pressure: "2",
                parity: Parity::Even,
                shape: "F dF/d eps: vanishes where the force does",
            },
            twins: &[
                Twin { name: "force-nonlinearity", how: "0.958 (braid)" },
                Twin { name: "fibre-stretch", how: "0.93 (braid), 0.974 (PPAM)" },
                Twin { name: "end-slip", how: "near for a PPAM" },
            ],
            separate: "a stiff dummy instead of the muscle; an extensometer across the fittings; a second length",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "compliance",
                ("um/N", 1e-6),
                (0.0, 20.0),
                0.1,
                "displacement per force at 1 kN",
            )
            .prior(0.0, 0.5)
            .plausible(0.0, 2.0)
            .reciprocal("stiffness", "N/mm", 1e3),
            power("power of the force with which the frame gives"),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for FrameCompliance {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, input: &mut Input) {
        (input.give_force.joint, input.give_force.power) = (theta[0] / setting.length, theta[1]);
    }
}

/// The power with which a joint gives ([`crate::Give`]). It is 1 in files from before this parameter existed.
pub(super) fn power(about: &str) -> ParameterCard<'_> {
    ParameterCard::new("power", NUMBER, (0.4, 3.0), 1.0, about)
        .plausible(0.5, 2.0)
        .off_at(1.0)
        .off_if_absent()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Jet;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_force_shortens() {
        // 10 kN/mm on 250 mm gives 4e-7 per newton.
        let give = input(&FrameCompliance, &[1e-7, 1.0], |_| ()).give_force;
        assert!((give.under(Jet::from(300.0)).value() / 1.2e-4 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_contact_stiffens_under_the_force() {
        // Hertz: eight times the force gives four times the approach.
        let give = input(&FrameCompliance, &[1e-7, 2.0 / 3.0], |_| ()).give_force;
        let [light, heavy] = [1e3, 8e3].map(|force| give.under(Jet::from(force)).value());
        assert!((light / 4e-4 - 1.0).abs() < 1e-6 && (heavy / light / 4.0 - 1.0).abs() < 1e-6);
        // Under a push the joint gives in the other direction. The slope is that of the curve.
        assert!((give.under(Jet::from(-1e3)).value() + light).abs() < 1e-18);
        let across = give.under(Jet::from(501.0)).value() - give.under(Jet::from(499.0)).value();
        assert!((give.slope(500.0) / (0.5 * across) - 1.0).abs() < 1e-5);
    }
}
