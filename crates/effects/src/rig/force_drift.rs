//! Force drift: the zero of the load cell changes with the clock (catalogue M6).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `reading = F + a t`, where t is the time since the first row.
#[derive(Debug)]
pub(crate) struct ForceDrift;

impl Effect for ForceDrift {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-drift",
            family: "force-drift",
            mechanism: Mechanism::ForceChain,
            form: Form::Near,
            title: "Drift of the load cell",
            about: "The zero of load cell or amplifier moves steadily while the test runs, as it warms up. Loops are measured one above \
                    the other.",
            equation: "reading = F + a t,   t since the first row",
            source: "data sheets of load cells: creep 0.03 % of full scale in half an hour, more while an amplifier warms up",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "in proportion to the clock" },
            twins: &[
                Twin { name: "creep", how: "in short tests" },
                Twin { name: "self-heating", how: "in tests shorter than its time" },
                Twin {
                    name: "pressure-gain",
                    how: "0.97 where pressures were measured one after the other (PPAM)",
                },
            ],
            separate: "the zero of the load cell at the end of the test; pressures in random order",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "change of the zero per hour";
        vec![
            ParameterCard::new("rate", ("N/h", 1.0 / 3600.0), (-500.0, 500.0), 0.0, about)
                .prior(0.0, 5.0)
                .plausible(-30.0, 30.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for ForceDrift {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading += theta[0] * moment.clock;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::reading;

    #[test]
    fn the_zero_moves_with_the_clock() {
        // 6 N/h for half an hour.
        let found = reading(&ForceDrift, &[6.0 / 3600.0], |moment| moment.clock = 1800.0);
        assert!((found - 503.0).abs() < 1e-12);
    }
}
