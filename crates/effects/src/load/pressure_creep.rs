//! Pressure creep: creep in proportion to the pressure (catalogue R5 with A proportional to p).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `dF = -a p log10(1 + t/1 s)`, where t is the time since the sweep began.
#[derive(Debug)]
pub(crate) struct PressureCreep;

impl Effect for PressureCreep {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-creep",
            family: "creep",
            mechanism: Mechanism::Relaxation,
            form: Form::Loose,
            title: "Creep in proportion to the pressure",
            about: "The walls yield to the gas with the logarithm of time, the more the higher the pressure: the muscle loses the same part \
                    of its pressure force in each decade.",
            equation: "dF = -a p log10(1 + t/1 s),   t since the sweep began",
            source: "logarithmic relaxation, up to 3 % of the force per decade",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "logarithm of the time since the sweep began",
            },
            twins: &[
                Twin { name: "creep", how: "at one pressure" },
                Twin { name: "fibre-creep", how: "at one contraction" },
            ],
            separate: "holds of three decades of time at two pressures",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force lost per pressure and factor of ten in time";
        vec![
            ParameterCard::new("coefficient", ("N/(bar decade)", 1e-5), (0.0, 100.0), 1.0, about)
                .prior(0.0, 2.0)
                .plausible(0.0, 15.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for PressureCreep {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.pressure * (1.0 + moment.time).log10();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn the_same_loss_in_every_decade() {
        // 1 N/(bar decade) at 2 bar.
        for (time, loss) in [(0.0, 0.0), (9.0, 2.0), (99.0, 4.0)] {
            assert!((load(&PressureCreep, &[1e-5], |moment| moment.time = time) + loss).abs() < 1e-12);
        }
    }
}
