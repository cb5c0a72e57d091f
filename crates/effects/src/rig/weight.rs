//! Weight: the load cell also carries the parts that hang from it (catalogue M12).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `reading = F + W`.
#[derive(Debug)]
pub(crate) struct Weight;

impl Effect for Weight {
    fn card(&self) -> Card<'_> {
        Card {
            name: "weight",
            family: "force-offset",
            mechanism: Mechanism::ForceChain,
            form: Form::Exact,
            title: "Weight that hangs from the load cell",
            about: "Muscle and fittings hang from the load cell, and it was set to zero without them.",
            equation: "reading = F + W",
            source: "a muscle of 20 mm with its fittings weighs 0.2 to 0.5 kg",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "constant" },
            twins: &[Twin { name: "force-offset", how: "identical; turn the rig over" }],
            separate: "turn the rig over: the weight changes its sign, an offset doesn't; tare without the muscle",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "weight below the load cell";
        vec![
            ParameterCard::new("weight", NEWTON, (0.0, 300.0), 4.0, about)
                .prior(0.0, 6.0)
                .plausible(0.0, 50.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for Weight {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading += theta[0];
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "a sum of whole newtons is exact")]

    use super::*;
    use crate::probe::reading;

    #[test]
    fn the_weight_is_added() {
        assert_eq!(reading(&Weight, &[4.0], |_| ()), 504.0);
    }
}
