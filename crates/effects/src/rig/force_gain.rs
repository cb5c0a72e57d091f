//! Force gain: the scale of the load cell is wrong (catalogue M4).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `reading = F (1 + g)`.
#[derive(Debug)]
pub(crate) struct ForceGain;

impl Effect for ForceGain {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-gain",
            family: "force-gain",
            mechanism: Mechanism::ForceChain,
            form: Form::Loose,
            title: "Gain of the load cell",
            about: "The load cell or its amplifier reads a fixed part too much or too little.",
            equation: "reading = F (1 + g)",
            source: "data sheets of load cells: 0.05 to 0.5 %",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "load-misalignment", how: "identical" },
                Twin {
                    name: "pressure-gain",
                    how: "identical where the force is proportional to the pressure",
                },
                Twin { name: "line-drop", how: "identical where the force is proportional to the pressure" },
                Twin {
                    name: "fibre-count",
                    how: "identical where the force is proportional to the pressure",
                },
                Twin { name: "specimen-spread", how: "identical for a single specimen" },
                Twin { name: "fibre-misalignment", how: "0.999 (PPAM)" },
            ],
            separate: "dead weights on the load cell",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("gain", PERCENT, (-20.0, 20.0), 0.0, "relative error")
                .prior(0.0, 1.0)
                .plausible(-5.0, 5.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for ForceGain {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading = *reading * (theta[0] + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::reading;

    #[test]
    fn the_force_is_scaled() {
        assert!((reading(&ForceGain, &[0.02], |_| ()) - 510.0).abs() < 1e-12);
    }
}
