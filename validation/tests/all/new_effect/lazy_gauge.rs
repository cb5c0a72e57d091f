//! A gauge that reads too much: The gauge shows more than the pressure in the muscle.

use bulge_effects::{
    Action, Card, Effect, Evidence, Form, Group, Input, InputEffect, Mechanism, Needs, ParameterCard, Parity,
    Row, Signature,
};

#[derive(Debug)]
pub(super) struct LazyGauge;

impl Effect for LazyGauge {
    fn card(&self) -> Card<'_> {
        Card {
            name: "lazy-gauge",
            family: "lazy-gauge",
            mechanism: Mechanism::GiveOfTheRig,
            form: Form::Near,
            title: "A gauge that reads too much",
            about: "The gauge shows more than the pressure in the muscle.",
            equation: "p (1 - part)",
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
        Action::Input(self)
    }
}

impl InputEffect for LazyGauge {
    fn act(&self, row: Row<'_>, input: &mut Input) {
        input.pressure = input.pressure * (-row.theta[0] + 1.0);
    }
}
