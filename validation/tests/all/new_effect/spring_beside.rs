//! A spring beside the muscle: A return spring pushes as the muscle shortens.

use bulge_effects::{
    Action, Balance, Card, Effect, Evidence, Form, Group, Jet, LoadEffect, Mechanism, Needs, ParameterCard,
    Parity, Row, Signature,
};

#[derive(Debug)]
pub(super) struct SpringBeside;

impl Effect for SpringBeside {
    fn card(&self) -> Card<'_> {
        Card {
            name: "spring-beside",
            family: "spring-beside",
            mechanism: Mechanism::GiveOfTheRig,
            form: Form::Near,
            title: "A spring beside the muscle",
            about: "A return spring pushes as the muscle shortens.",
            equation: "F - k eps",
            source: "a test",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as its equation" },
            twins: &[],
            separate: "a second instrument",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![ParameterCard::new("stiffness", ("N", 1.0), (-2000.0, 2000.0), 100.0, "force per contraction")]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for SpringBeside {
    fn act(&self, row: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - row.theta[0] * balance.contraction;
    }
}
