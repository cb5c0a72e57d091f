//! Pressure viscosity: damping that grows with the pressure (Reynolds et al. 2003; catalogue R2).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `dF = -c1 p d eps/dt`.
#[derive(Debug)]
pub(crate) struct PressureViscosity;

impl Effect for PressureViscosity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-viscosity",
            family: "viscous-damping",
            mechanism: Mechanism::Rate,
            form: Form::Loose,
            title: "Damping in proportion to speed and pressure",
            about: "Strands that the gas presses into the rubber drag it along: the higher the pressure, the more of it is sheared. The loop \
                    widens with the speed and with the pressure.",
            equation: "dF = -c1 p d eps/dt",
            source: "three-element models of fluidic muscles with a damper that depends on the pressure, Reynolds et al. 2003 and Serres et al.",
            evidence: Evidence::LookedUp,
            group: Group::Load,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Odd, shape: "as the speed" },
            twins: &[
                Twin { name: "force-lag", how: "0.9975 in sine loops" },
                Twin { name: "viscous-damping", how: "0.90" },
                Twin { name: "pressure-friction", how: "0.90 at one speed" },
            ],
            separate: "a second speed; against force-lag a step, or one clock for both sensors",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "force per rate of contraction and pressure";
        vec![
            ParameterCard::new("damping", ("N s/bar", 1e-5), (0.0, 1e5), 1300.0, about)
                .prior(0.0, 2000.0)
                .plausible(0.0, 1e4),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for PressureViscosity {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        *force = *force - theta[0] * balance.pressure * moment.rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::load;

    #[test]
    fn the_force_follows_speed_and_pressure() {
        // 1300 N s/bar at 2 bar and 0.5 % per second.
        let up = load(&PressureViscosity, &[0.013], |moment| moment.rate = 5e-3);
        let down = load(&PressureViscosity, &[0.013], |moment| moment.rate = -5e-3);
        assert!((up + 13.0).abs() < 1e-12 && (down - 13.0).abs() < 1e-12);
    }
}
