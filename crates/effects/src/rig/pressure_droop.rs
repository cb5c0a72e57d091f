//! Pressure droop: the pressure of the regulator falls with the amount of gas that the muscle has taken
//! (catalogue P5).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::ideal_volume::IdealVolume;
use crate::rig::lowered_pressure::lowered;
use crate::unit::KILOPASCAL;

/// `p = reading - c (V/V0 - 1)` with the volume V of a muscle of inextensible fibres ([`IdealVolume`]).
#[derive(Debug)]
pub(crate) struct PressureDroop;

impl Effect for PressureDroop {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-droop",
            family: "regulator-lag",
            mechanism: Mechanism::Regulator,
            form: Form::Loose,
            title: "Droop of the pressure with the volume",
            about: "A simple regulator holds its pressure less well the more gas flows or leaks behind it, and a bulging muscle has more wall \
                    to leak through. The pressure falls as the volume grows, seen by a sensor before the regulator only.",
            equation: "p = reading - c (V/V0 - 1),   V0 at eps = 0,   V of inextensible fibres",
            source: "linear droop of regulators, from data sheets",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "-(V/V0 - 1) F/p" },
            twins: &[
                Twin { name: "bladder-elasticity", how: "0.962 (braid)" },
                Twin { name: "bladder-c01", how: "0.957 (braid)" },
                Twin { name: "hoop-elasticity", how: "0.941 (braid)" },
                Twin { name: "limited-unfolding", how: "0.949 (PPAM)" },
                Twin { name: "force-offset", how: "0.91 (PPAM)" },
            ],
            separate: "a pressure sensor in the muscle itself",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "pressure lost while the volume grows by V0";
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

impl InputEffect for PressureDroop {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, input: &mut Input) {
        let grown = IdealVolume::at(input.contraction, setting).ratio - 1.0;
        input.pressure = lowered(input.pressure, theta[0] * grown);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_pressure_falls_as_the_volume_grows() {
        // V/V0 = 1.686414 at 25 deg and 10 %.
        let found = input(&PressureDroop, &[2e3], |_| ()).pressure.value();
        assert!((2e5 - found - 1372.83).abs() < 0.02, "{found}");
    }
}
