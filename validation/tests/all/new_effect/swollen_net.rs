//! A net that has swollen: The fibres have taken up water and lie on a larger radius.

use bulge_effects::{
    Action, Card, Effect, Evidence, Form, Group, Jet, Mechanism, Needs, ParameterCard, Parity, ShapeEffect,
    Signature,
};
use bulge_fibre::Parts;
use bulge_muscles::MuscleError;

#[derive(Debug)]
pub(super) struct SwollenNet;

impl Effect for SwollenNet {
    fn card(&self) -> Card<'_> {
        Card {
            name: "swollen-net",
            family: "swollen-net",
            mechanism: Mechanism::ClothAndFibres,
            form: Form::Near,
            title: "A net that has swollen",
            about: "The fibres have taken up water and lie on a larger radius.",
            equation: "R (1 + part)",
            source: "a test",
            evidence: Evidence::Derived,
            group: Group::Geometry,
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
        Action::Shape(self)
    }
}

impl ShapeEffect for SwollenNet {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        parts.radius = parts.radius * (theta[0] + 1.0);
        Ok(())
    }
}
