//! Bladder relaxation: rubber that was stretched by filling or shortening relaxes with a time constant.

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::filled_bladder::filled;
use crate::load::relaxed::relaxed;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, SECOND};

/// `dQ/dt = g db/dt - Q/tau`, `dF = -Q`, where b is the force of the filled bladder relative to its largest
/// value ([`filled`]).
#[derive(Debug)]
pub(crate) struct BladderRelaxation;

impl Effect for BladderRelaxation {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-relaxation",
            family: "bladder-hysteresis",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Rubber of the bladder that relaxes",
            about: "The bladder answers a quick stretch stiffly and yields within a time tau. After filling at held length the muscle gains force by \
                    itself, and while it is vented it pulls more than while it was filled, most at low pressure.",
            equation: "dQ/dt = g db/dt - Q/tau,   dF = -Q,   b = B(eps)/B_max tanh(p/1 bar), B the force of the bladder,   Q = 0 when a sweep begins",
            source: "Zener 1948 for the rubber; exact for a stretch that runs straight between two rows",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: BRAIDED,
            signature: Signature {
                pressure: "0",
                parity: Parity::Mixed,
                shape: "as the bladder's force, forgotten within tau",
            },
            twins: &[
                Twin { name: "bladder-hysteresis", how: "same family; the speed" },
                Twin { name: "standard-linear-solid", how: "0.95 at held pressure" },
                Twin { name: "creep", how: "similar in a hold" },
            ],
            separate: "the same cycle ten times slower; a hold after filling",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("force", NEWTON, (0.0, 500.0), 10.0, "force of a quick full stretch")
                .prior(0.0, 20.0)
                .plausible(0.0, 150.0),
            ParameterCard::new("time", SECOND, (0.1, 1e4), 30.0, "time within which it relaxes")
                .plausible(0.5, 1e3)
                .off_at(30.0)
                .logarithmic(),
        ]
    }

    fn memory(&self) -> usize {
        2
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for BladderRelaxation {
    fn act(&self, Row { moment, setting, theta, memory }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let now = filled(balance, setting);
        let change = if moment.begins { Jet::from(0.0) } else { now - memory[1] };
        memory[1] = now;
        memory[0] = relaxed(memory[0], change, moment.since, theta[1]);
        *force = *force - theta[0] * memory[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::{balance, driven};
    use bulge_numerics::Real;

    #[test]
    fn a_quick_filling_is_forgotten_in_a_hold() {
        // From 0 to 2 bar in 1 s with tau = 2 s: g b 2 (1 - exp(-1/2)), followed by a factor of exp(-1/2) per
        // second.
        let rows = [[0.0, 0.1], [2e5, 0.1], [2e5, 0.1], [2e5, 0.1]];
        let out = driven(&BladderRelaxation, &[15.0, 2.0], &rows);
        let first =
            15.0 * filled(&balance(0.1), &crate::probe::SETTING).value() * 2.0 * (1.0 - (-0.5_f64).exp());
        for (found, expected) in
            out.iter().zip([0.0, -first, -first * (-0.5_f64).exp(), -first * (-1.0_f64).exp()])
        {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
