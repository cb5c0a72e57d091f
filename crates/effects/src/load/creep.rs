//! Creep: the force changes with the logarithm of the time under load (catalogue R5).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `dF = -A log10(1 + t/1 s)`, where t is the time since the sweep began.
#[derive(Debug)]
pub(crate) struct Creep;

impl Effect for Creep {
    fn card(&self) -> Card<'_> {
        Card {
            name: "creep",
            family: "creep",
            mechanism: Mechanism::Relaxation,
            form: Form::Loose,
            title: "Creep and relaxation with the logarithm of time",
            about: "Held in one place, a muscle loses a little force: as much from 1 to 10 s as from 10 to 100 s. Rubber and fibres \
                    rearrange, and never quite stop.",
            equation: "dF = -A log10(1 + t/1 s),   t since the sweep began",
            source: "logarithmic relaxation of rubber; data sheets of fluidic muscles state up to 5 % of relaxation",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "logarithm of the time since the sweep began",
            },
            twins: &[
                Twin { name: "force-offset", how: "0.90 (braid), 0.99 (PPAM) unless the sweep is long" },
                Twin { name: "force-drift", how: "in short tests" },
                Twin { name: "pressure-creep", how: "at one pressure" },
                Twin { name: "standard-linear-solid", how: "similar in a hold" },
                Twin { name: "generalised-maxwell", how: "0.95 in a hold, beside a force-offset" },
            ],
            separate: "a hold of three decades of time; the zero of the load cell after it",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force lost per factor of ten in time";
        vec![
            ParameterCard::new("force", ("N/decade", 1.0), (0.0, 200.0), 4.0, about)
                .prior(0.0, 6.0)
                .plausible(0.0, 30.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for Creep {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, _: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * (1.0 + moment.time).log10();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn the_same_loss_in_every_decade() {
        for (time, loss) in [(0.0, 0.0), (9.0, 4.0), (99.0, 8.0), (999.0, 12.0)] {
            assert!((load(&Creep, &[4.0], |moment| moment.time = time) + loss).abs() < 1e-12);
        }
    }
}
