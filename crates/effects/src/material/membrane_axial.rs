//! Axial stiffness of the membrane: cloth and coating resist a part of the shortening (neglected in S1;
//! catalogue E12).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON;

/// `dF = -k_a eps`.
#[derive(Debug)]
pub(crate) struct MembraneAxial;

impl Effect for MembraneAxial {
    fn card(&self) -> Card<'_> {
        Card {
            name: "membrane-axial",
            family: "membrane-axial",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Axial stiffness of the membrane",
            about: "The model lets the fibres alone carry the axial load. Cloth, coating and bladder are springs beside them: they have to be \
                    pushed together as the muscle shortens, which takes a force proportional to the contraction, at any pressure.",
            equation: "dF = -k_a eps",
            source: "S1, section 3.1, which assumes it away; linear spring",
            evidence: Evidence::Derived,
            group: Group::Material,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "-eps" },
            twins: &[
                Twin { name: "bladder-axial", how: "identical: the same spring in another part" },
                Twin { name: "force-offset", how: "0.983 (PPAM)" },
                Twin { name: "creep", how: "0.98 (PPAM)" },
                Twin { name: "pressure-droop", how: "0.975 (PPAM)" },
                Twin { name: "limited-unfolding", how: "0.97 if the cloth is taut early (PPAM)" },
            ],
            separate: "stretch and compress the muscle at zero pressure",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force per unit contraction";
        vec![
            ParameterCard::new("stiffness", NEWTON, (0.0, 5000.0), 150.0, about)
                .prior(0.0, 200.0)
                .plausible(0.0, 1000.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for MembraneAxial {
    fn act(&self, Row { theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.contraction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn a_tenth_of_the_stiffness_at_a_tenth() {
        assert!((load(&MembraneAxial, &[150.0], |_| ()) + 15.0).abs() < 1e-12);
    }
}
