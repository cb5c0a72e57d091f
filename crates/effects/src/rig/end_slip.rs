//! End slip: the fibres give in their fittings under their tension (catalogue E4).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Setting};
use crate::mechanism::{Form, Mechanism};

/// `true contraction = measured + N/(k l0)`, N = F + p A(r).
#[derive(Debug)]
pub(crate) struct EndSlip;

impl Effect for EndSlip {
    fn card(&self) -> Card<'_> {
        Card {
            name: "end-slip",
            family: "end-slip",
            mechanism: Mechanism::GiveOfTheRig,
            form: Form::Loose,
            title: "Fibres that give in their fittings",
            about: "The fibres slip a little in epoxy or clamp, elastically, pulled by their whole tension: by the force and by the gas that \
                    acts on the cross-section. Unlike a soft frame it gives also where the muscle doesn't pull.",
            equation: "true contraction = measured + N/(k l0),   N = F + p A(r) at mid-length",
            source: "shear of the bond, linear",
            evidence: Evidence::Derived,
            group: Group::Rig,
            stage: Stage::Input,
            kind: None,
            signature: Signature { pressure: "2", parity: Parity::Even, shape: "N dF/d eps" },
            twins: &[
                Twin { name: "fibre-stretch", how: "0.991 (PPAM)" },
                Twin { name: "frame-compliance", how: "0.98 (PPAM)" },
                Twin { name: "length-zero-error", how: "0.97 (PPAM)" },
                Twin { name: "fibre-length", how: "0.958 (PPAM)" },
            ],
            separate: "a gauge across the fitting; a second length (fibres stretch in proportion to it, fittings don't)",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "compliance",
                ("um/N", 1e-6),
                (0.0, 10.0),
                0.02,
                "slip of both ends per tension",
            )
            .prior(0.0, 0.1)
            .plausible(0.0, 0.4)
            .reciprocal("stiffness", "N/mm", 1e3),
        ]
    }

    fn act(&self, _: &Moment, setting: &Setting, theta: &[Jet], _: &mut [Jet], place: Place<'_>) {
        if let Place::Input(input) = place {
            input.give_tension += theta[0] / setting.length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_tension_shortens() {
        // 50 kN/mm on 250 mm: 8e-8 per newton.
        assert!((input(&EndSlip, &[2e-8], |_| ()).give_tension.value() / 8e-8 - 1.0).abs() < 1e-12);
    }
}
