//! Force offset: the load cell doesn't read zero without load (catalogue M3).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `reading = F + F_z`.
#[derive(Debug)]
pub(crate) struct ForceOffset;

impl Effect for ForceOffset {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-offset",
            family: "force-offset",
            mechanism: Mechanism::ForceChain,
            form: Form::Exact,
            title: "Zero of the load cell",
            about: "The load cell reads something without load, or was set to zero with something hanging from it.",
            equation: "reading = F + F_z",
            source: "data sheets of load cells: 0 to 1 % of full scale",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "constant" },
            twins: &[
                Twin { name: "weight", how: "identical; turn the rig over" },
                Twin { name: "bladder-prestrain", how: "1.000 at first order" },
                Twin { name: "membrane-axial", how: "0.98 (PPAM)" },
            ],
            separate: "unload the cell and tare it; turn the rig over",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "what the cell reads without load";
        vec![
            ParameterCard::new("offset", NEWTON, (-300.0, 300.0), 0.0, about)
                .prior(0.0, 10.0)
                .plausible(-50.0, 50.0),
        ]
    }

    fn is_of_mounting(&self) -> bool {
        true
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for ForceOffset {
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
    fn the_zero_is_added() {
        assert_eq!(reading(&ForceOffset, &[-7.0], |_| ()), 493.0);
    }
}
