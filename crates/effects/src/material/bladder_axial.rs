//! Axial bladder stiffness: the bladder resists shortening linearly (Chou and Hannaford 1996; catalogue E5).

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `dF = -k eps` with k = A_b E_a.
#[derive(Debug)]
pub(crate) struct BladderAxial;

impl Effect for BladderAxial {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-axial",
            family: "membrane-axial",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Axial stiffness of the bladder, linear",
            about: "The bladder is a spring along the axis: it pushes when the muscle shortens and pulls when it is drawn out. A tube of 20 mm \
                    with 2 mm of rubber of 1 MPa has about 126 N per unit contraction. The widening of the tube is another effect.",
            equation: "dF = -k eps,   k = A_b E_a (section of the bladder times its modulus)",
            source: "Chou and Hannaford 1996 (their passive stiffness), by memory",
            evidence: Evidence::Literature,
            group: Group::Material,
            kind: BRAIDED,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "-eps" },
            twins: &[
                Twin { name: "membrane-axial", how: "identical: the same spring in another part" },
                Twin { name: "hoop-elasticity", how: "0.913" },
                Twin { name: "standard-linear-solid", how: "0.9 if it relaxes slowly" },
                Twin { name: "bladder-prestrain", how: "0.816" },
            ],
            separate: "stretch the muscle at zero pressure",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force per unit contraction";
        vec![
            ParameterCard::new("stiffness", NEWTON, (0.0, 5000.0), 125.0, about)
                .prior(0.0, 200.0)
                .plausible(0.0, 2500.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for BladderAxial {
    fn act(&self, Row { theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.contraction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn a_spring_that_pushes_when_shortened() {
        // 2 pi 10 mm x 2 mm x 1 MPa = 125.66 N, and a tenth of it at 10 %.
        let stiffness = std::f64::consts::TAU * 0.01 * 0.002 * 1e6;
        assert!((load(&BladderAxial, &[stiffness], |_| ()) + 12.566_370_614).abs() < 1e-8);
    }
}
