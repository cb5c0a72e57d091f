//! Specimen spread: muscles of the same make differ in force (catalogue H1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `F -> F (1 + g_s)` with one number per specimen s, drawn from N(0, 1 %).
#[derive(Debug)]
pub(crate) struct SpecimenSpread;

impl Effect for SpecimenSpread {
    fn card(&self) -> Card<'_> {
        Card {
            name: "specimen-spread",
            family: "specimen-spread",
            mechanism: Mechanism::Specimens,
            form: Form::Exact,
            title: "Spread between specimens",
            about: "Handmade muscles differ: each specimen has its own factor of force, which stands for small differences in radius, \
                    length and rubber. What all specimens have in common is physics; what differs is this.",
            equation: "F -> F (1 + g_s),   one g_s for each specimen, spread about 0",
            source: "S1 (three handmade muscles, 'very satisfactory'); S2 table 2 against S4 table 1, the same type: 1.4 to 9.9 N rms",
            evidence: Evidence::Paper,
            group: Group::Specimen,
            kind: None,
            signature: Signature {
                pressure: "any",
                parity: Parity::Even,
                shape: "differs from specimen to specimen",
            },
            twins: &[Twin { name: "force-gain", how: "identical for a single specimen" }],
            separate: "three specimens or more on the same rig",
            needs: Needs::Specimens,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("factor", PERCENT, (-20.0, 20.0), 0.0, "relative difference of this specimen")
                .prior(0.0, 1.0)
                .plausible(-5.0, 5.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for SpecimenSpread {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading = *reading * (theta[0] + 1.0);
    }
}
