//! Force nonlinearity: the load cell's characteristic is bent (catalogue M5).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Setting};
use crate::mechanism::{Form, Mechanism};

/// `reading = F + q F^2`.
#[derive(Debug)]
pub(crate) struct ForceNonlinearity;

impl Effect for ForceNonlinearity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-nonlinearity",
            family: "force-nonlinearity",
            mechanism: Mechanism::ForceChain,
            form: Form::Loose,
            title: "Bent characteristic of the load cell",
            about: "The load cell reads right at small loads and a little too much or too little at large ones.",
            equation: "reading = F + q F^2",
            source: "data sheets of load cells: 0.02 to 0.5 % of full scale",
            evidence: Evidence::Derived,
            group: Group::Rig,
            stage: Stage::Output,
            kind: None,
            signature: Signature { pressure: "2", parity: Parity::Even, shape: "square of the force" },
            twins: &[
                Twin { name: "frame-compliance", how: "-0.958 (braid)" },
                Twin { name: "fibre-stretch", how: "0.81 (braid)" },
                Twin { name: "force-gain", how: "0.91 (PPAM)" },
            ],
            separate: "dead weights on the load cell, at three loads or more",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "relative error per force";
        vec![
            ParameterCard::new("curvature", ("%/kN", 1e-5), (-20.0, 20.0), 0.0, about)
                .prior(0.0, 0.5)
                .plausible(-2.0, 2.0),
        ]
    }

    fn act(&self, _: &Moment, _: &Setting, theta: &[Jet], _: &mut [Jet], place: Place<'_>) {
        if let Place::Output(_, reading) = place {
            *reading += theta[0] * reading.squared();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::reading;

    #[test]
    fn the_square_of_the_force_is_added() {
        // 2 %/kN of 500 N: 1 % of 500 N.
        assert!((reading(&ForceNonlinearity, &[2e-5], |_| ()) - 505.0).abs() < 1e-12);
    }
}
