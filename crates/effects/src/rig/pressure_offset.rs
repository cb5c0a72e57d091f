//! Pressure offset: the pressure sensor doesn't read zero when vented (catalogue M1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::KILOPASCAL;

/// `reading = p + zero`, so the pressure in the muscle is `p = reading - zero`.
#[derive(Debug)]
pub(crate) struct PressureOffset;

impl Effect for PressureOffset {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-offset",
            family: "pressure-offset",
            mechanism: Mechanism::PressureChain,
            form: Form::Loose,
            title: "Zero of the pressure sensor",
            about: "The pressure sensor reads something when it is vented: its zero has drifted, or an absolute sensor was corrected by \
                    another day's air pressure. The force is off by the same amount at every pressure.",
            equation: "reading = p + zero",
            source: "data sheets of pressure sensors: 0.1 to 1 % of full scale; the weather moves 1 kPa",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "-F/p" },
            twins: &[
                Twin { name: "pressure-threshold", how: "identical above the threshold" },
                Twin { name: "force-offset", how: "0.92 (braid), 0.94 (PPAM)" },
            ],
            separate: "vent the sensor and read it",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "what the sensor reads when vented";
        vec![
            ParameterCard::new("offset", KILOPASCAL, (-50.0, 50.0), 0.0, about)
                .prior(0.0, 1.0)
                .plausible(-10.0, 10.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for PressureOffset {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.pressure = lowered(input.pressure, theta[0]);
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "differences of whole pascals are exact")]

    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_zero_is_taken_off() {
        assert_eq!(input(&PressureOffset, &[1e3], |_| ()).pressure.value(), 1.99e5);
        assert_eq!(input(&PressureOffset, &[-1e3], |_| ()).pressure.value(), 2.01e5);
        assert_eq!(input(&PressureOffset, &[3e5], |_| ()).pressure.value(), 100.0);
    }
}
