//! Load misalignment: the load cell isn't aligned with the muscle (catalogue M11).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `reading = F (1 - loss)` with loss = 1 - cos(psi).
///
/// The parameter is the loss and not the angle psi, because the derivative by the angle vanishes at 0, where
/// a screen evaluates it.
#[derive(Debug)]
pub(crate) struct LoadMisalignment;

impl Effect for LoadMisalignment {
    fn card(&self) -> Card<'_> {
        Card {
            name: "load-misalignment",
            family: "force-gain",
            mechanism: Mechanism::ForceChain,
            form: Form::Exact,
            title: "Load cell at an angle",
            about: "The muscle pulls at an angle psi to the axis of the load cell, which sees only its part along the axis. A loss of 0.4 % is \
                    an angle of 5 degrees, 1.5 % are 10, 3.4 % are 15.",
            equation: "reading = F (1 - loss),   loss = 1 - cos(psi)",
            source: "geometry of the measurement",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "force-gain", how: "identical" },
                Twin {
                    name: "pressure-gain",
                    how: "identical where the force is proportional to the pressure",
                },
                Twin { name: "line-drop", how: "identical where the force is proportional to the pressure" },
            ],
            separate: "a square",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "lost part of the force, 1 - cos(psi)";
        vec![ParameterCard::new("loss", PERCENT, (0.0, 20.0), 0.4, about).prior(0.0, 0.5).plausible(0.0, 3.5)]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for LoadMisalignment {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        *reading = *reading * (-theta[0] + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::reading;

    #[test]
    fn ten_degrees_cost_a_part_in_66() {
        let loss = 1.0 - 10_f64.to_radians().cos();
        assert!((reading(&LoadMisalignment, &[loss], |_| ()) - 492.403_876_5).abs() < 1e-6);
    }
}
