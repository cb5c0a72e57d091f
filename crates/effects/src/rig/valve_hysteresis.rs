//! Valve hysteresis: the pressure falls a little before the valve opens (catalogue P4).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::KILOPASCAL;

/// `p = reading - s dp`. s is +1 while the muscle takes gas (it shortens, or is filled at held length), and
/// -1 while it gives gas back.
#[derive(Debug)]
pub(crate) struct ValveHysteresis;

impl Effect for ValveHysteresis {
    fn card(&self) -> Card<'_> {
        Card {
            name: "valve-hysteresis",
            family: "regulator-lag",
            mechanism: Mechanism::Regulator,
            form: Form::Loose,
            title: "Dead band of the pressure valve",
            about: "The valve acts only when the pressure has left a band. A muscle that shortens draws the pressure to the lower edge of the \
                    band, one that lengthens pushes it to the upper one, whatever the speed.",
            equation: "p = reading - s dp,   s = +1 while shortening or filled at held length, -1 while lengthening or vented, 0 at rest",
            source: "data sheets of proportional valves: 0.5 to 1 % of full scale",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Odd, shape: "F/p" },
            twins: &[
                Twin { name: "regulator-lag", how: "0.962 (PPAM)" },
                Twin { name: "coulomb-friction", how: "0.92" },
                Twin { name: "force-lag", how: "0.93 (PPAM)" },
                Twin { name: "force-friction", how: "0.90" },
                Twin { name: "asymmetric-friction", how: "0.90" },
            ],
            separate: "a pressure sensor in the muscle itself",
            needs: Needs::Motion,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "half the width of the band";
        vec![
            ParameterCard::new("pressure", KILOPASCAL, (0.0, 30.0), 2.0, about)
                .prior(0.0, 4.0)
                .plausible(0.0, 10.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for ValveHysteresis {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, input: &mut Input) {
        input.pressure = lowered(input.pressure, theta[0] * moment.branch());
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "differences of whole pascals are exact")]

    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_pressure_is_at_the_edge_of_the_band() {
        let [up, down, rest] = [1.0, -1.0, 0.0]
            .map(|s| input(&ValveHysteresis, &[2e3], |moment| moment.direction = s).pressure.value());
        assert_eq!([up, down, rest], [1.98e5, 2.02e5, 2e5]);
    }
}
