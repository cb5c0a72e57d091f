//! A load cell that reads too much: The amplifier has another gain than stated.

use bulge_effects::{
    Action, Balance, Card, Effect, Evidence, Form, Group, Jet, Mechanism, Needs, OutputEffect, ParameterCard,
    Parity, Row, Signature,
};

#[derive(Debug)]
pub(super) struct HeavyCell;

impl Effect for HeavyCell {
    fn card(&self) -> Card<'_> {
        Card {
            name: "heavy-cell",
            family: "heavy-cell",
            mechanism: Mechanism::GiveOfTheRig,
            form: Form::Near,
            title: "A load cell that reads too much",
            about: "The amplifier has another gain than stated.",
            equation: "F (1 + part)",
            source: "a test",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as its equation" },
            twins: &[],
            separate: "a second instrument",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![ParameterCard::new("part", ("%", 0.01), (-20.0, 20.0), 2.0, "how much")]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for HeavyCell {
    fn act(&self, row: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading = *reading * (row.theta[0] + 1.0);
    }
}
