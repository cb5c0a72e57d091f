//! Force lag: the force reading lags behind displacement and pressure (catalogue M10).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::SECOND;

/// `reading(t) = F(t - tau)`: contraction and pressure are taken tau earlier, that is at `eps - tau d eps/dt`
/// and `p - tau dp/dt`.
///
/// This is exact while both are linear over tau. The memory of friction isn't shifted.
#[derive(Debug)]
pub(crate) struct ForceLag;

impl Effect for ForceLag {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-lag",
            family: "force-lag",
            mechanism: Mechanism::LateReading,
            form: Form::Loose,
            title: "Force late against displacement",
            about: "The filter of the load cell or a second clock makes the force late (negative: early). While the muscle moves, the force \
                    belongs to where it was a moment ago: the loop opens, in proportion to the speed.",
            equation: "reading(t) = F(t - tau) = F(p - tau dp/dt, eps - tau d eps/dt)",
            source: "geometry of the measurement, first order in tau",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Odd, shape: "-dF/d eps times the speed" },
            twins: &[
                Twin { name: "force-filter", how: "0.99 where the time is a hundredth of a loop's" },
                Twin { name: "pressure-viscosity", how: "0.9975 in sine loops (with the other sign)" },
                Twin { name: "force-friction", how: "-0.99 (PPAM)" },
                Twin { name: "valve-hysteresis", how: "-0.93 (PPAM)" },
                Twin { name: "viscous-damping", how: "-0.90" },
            ],
            separate: "a knock that both sensors see; a step; a second speed",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how late the force is";
        vec![ParameterCard::new("time", SECOND, (0.0, 5.0), 0.0, about).prior(0.0, 0.2).plausible(0.0, 2.0)]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for ForceLag {
    fn act(&self, Row { moment, theta, .. }: Row<'_>, input: &mut Input) {
        input.contraction = input.contraction - theta[0] * moment.rate;
        input.pressure = lowered(input.pressure, theta[0] * moment.pressure_rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn contraction_and_pressure_are_those_of_a_moment_ago() {
        let found = input(&ForceLag, &[0.5], |moment| (moment.rate, moment.pressure_rate) = (0.01, -2e4));
        assert!((found.contraction.value() - 0.095).abs() < 1e-15);
        assert!((found.pressure.value() - 2.1e5).abs() < 1e-9);
        assert!(input(&ForceLag, &[5.0], |moment| moment.pressure_rate = 1e5).pressure.value() > 0.0);
    }
}
