//! End slip: the fibres give way in their fittings under tension (catalogue E4).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::frame_compliance::power;

/// `true contraction = measured + N/(k l0) (|N|/1 kN)^(n - 1)`, N = F + p A(r).
///
/// A bond gives in proportion to the tension (n = 1). A clamp that bites stiffens (n < 1). A clamp that
/// begins to slip softens (n > 1).
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
                    acts on the cross-section. Unlike a soft frame it gives also where the muscle doesn't pull. A clamp \
                    that bites stiffens (a power below one), one that begins to slip gives more and more (above one).",
            equation: "true contraction = measured + N/(k l0) (|N|/1 kN)^(n - 1),   N = F + p A(r) at mid-length",
            source: "shear of the bond: linear; Hertz 1882: a contact gives with the power 2/3",
            evidence: Evidence::Derived,
            group: Group::Rig,
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
                "slip of both ends per tension at 1 kN",
            )
            .prior(0.0, 0.1)
            .plausible(0.0, 0.4)
            .reciprocal("stiffness", "N/mm", 1e3),
            power("power of the tension with which the ends give"),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for EndSlip {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, input: &mut Input) {
        (input.give_tension.joint, input.give_tension.power) = (theta[0] / setting.length, theta[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Jet;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_tension_shortens() {
        // 50 kN/mm on 250 mm gives 8e-8 per newton.
        let give = input(&EndSlip, &[2e-8, 1.0], |_| ()).give_tension;
        assert!((give.under(Jet::from(1e3)).value() / 8e-5 - 1.0).abs() < 1e-12);
        // A clamp that begins to slip: four times the tension gives eight times the slip.
        let give = input(&EndSlip, &[2e-8, 1.5], |_| ()).give_tension;
        let [low, high] = [250.0, 1e3].map(|tension| give.under(Jet::from(tension)).value());
        assert!((high / low / 8.0 - 1.0).abs() < 1e-5);
    }
}
