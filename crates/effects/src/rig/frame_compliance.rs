//! Frame compliance: the frame gives under the force, and the displacement sensor doesn't see it (catalogue E3).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Setting};
use crate::mechanism::{Form, Mechanism};

/// `true contraction = measured + F/(k l0)`.
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
            about: "Frame, load cell and fittings give under the force. The muscle is then shorter than the displacement sensor says.",
            equation: "true contraction = measured + F/(k l0)",
            source: "geometry of the measurement",
            evidence: Evidence::Derived,
            group: Group::Rig,
            stage: Stage::Input,
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
            ParameterCard::new("compliance", ("um/N", 1e-6), (0.0, 20.0), 0.1, "displacement per force")
                .prior(0.0, 0.5)
                .plausible(0.0, 2.0)
                .reciprocal("stiffness", "N/mm", 1e3),
        ]
    }

    fn act(&self, _: &Moment, setting: &Setting, theta: &[Jet], _: &mut [Jet], place: Place<'_>) {
        if let Place::Input(input) = place {
            input.give_force += theta[0] / setting.length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_force_shortens() {
        // 10 kN/mm on 250 mm: 4e-7 per newton.
        assert!((input(&FrameCompliance, &[1e-7], |_| ()).give_force.value() / 4e-7 - 1.0).abs() < 1e-12);
    }
}
