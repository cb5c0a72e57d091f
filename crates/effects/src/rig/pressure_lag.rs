//! Pressure lag: the pressure reading lags behind the force.

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::SECOND;

/// `p = reading + tau dp/dt`, exact for a first-order filter while the pressure is linear over tau.
#[derive(Debug)]
pub(crate) struct PressureLag;

impl Effect for PressureLag {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-lag",
            family: "pressure-lag",
            mechanism: Mechanism::LateReading,
            form: Form::Loose,
            title: "Pressure reading late",
            about: "A filter or a long thin line makes the pressure reading late. While the muscle is filled there is more pressure in it than the \
                    sensor says, while it is vented less: the loop opens in proportion to the speed.",
            equation: "p = reading + tau dp/dt",
            source: "filter of first order; lines of 2 m and 2 to 4 mm bore, 0.01 to 0.2 s",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "dF/dp times the speed of the pressure",
            },
            twins: &[
                Twin { name: "force-lag", how: "at held length the same with the other sign" },
                Twin { name: "pressure-hysteresis", how: "at one speed" },
            ],
            separate: "the same cycle ten times slower; a pressure sensor in the muscle itself",
            needs: Needs::PressurePath,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how late the pressure reading is";
        vec![ParameterCard::new("time", SECOND, (0.0, 5.0), 0.05, about).prior(0.0, 0.1).plausible(0.0, 1.0)]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for PressureLag {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, input: &mut Input) {
        input.pressure = lowered(input.pressure, -(theta[0] * moment.pressure_rate));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn there_is_more_than_it_reads_while_the_pressure_rises() {
        for (rate, expected) in [(1e5, 2.1e5), (-1e5, 1.9e5), (0.0, 2e5)] {
            let found = input(&PressureLag, &[0.1], |moment| moment.pressure_rate = rate).pressure.value();
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
    }
}
