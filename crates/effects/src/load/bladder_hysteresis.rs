//! Bladder hysteresis: the rubber of the bladder dissipates work when the gas fills it out and when the
//! muscle stretches it.

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::load::dragged::dragged;
use crate::load::filled_bladder::filled;
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT};

/// `z -> s + (z - s) exp(-|db|/delta)`, `dF = -w b z`, where b is the force of the filled bladder relative to
/// its largest value ([`filled`]).
#[derive(Debug)]
pub(crate) struct BladderHysteresis;

impl Effect for BladderHysteresis {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-hysteresis",
            family: "bladder-hysteresis",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Rubber of the bladder that loses work",
            about: "Rubber gives back less than it took. In filling at held length the bladder is stretched until the net is taut, and the muscle \
                    pulls less than while it is vented; above that pressure the loop is closed. At rest length the bladder isn't stretched, and \
                    there is no loop.",
            equation: "z -> s + (z - s) exp(-|db|/delta),   dF = -w b z,   s = sign(db),   b = B(eps)/B_max tanh(p/1 bar), B the force of the bladder",
            source: "loss factors of 0.05 to 0.2 of filled rubber; loops of 3 to 20 % of the bladder's force in filling and venting of fluidic muscles",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: BRAIDED,
            signature: Signature {
                pressure: "0",
                parity: Parity::Odd,
                shape: "as the bladder's force: 0 at rest length, flat beyond 10 %",
            },
            twins: &[
                Twin { name: "bladder-relaxation", how: "same family; the speed" },
                Twin { name: "pressure-presliding", how: "in filling and venting from 0 bar at one length" },
                Twin { name: "presliding-hysteresis", how: "0.95 at held pressure" },
                Twin { name: "coulomb-friction", how: "0.90 at held pressure" },
            ],
            separate: "filling and venting from 2 bar instead of 0: this loop is gone; another length: none at rest length",
            needs: Needs::Motion,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new(
                "force",
                NEWTON,
                (0.0, 200.0),
                10.0,
                "half the width of the loop where the bladder is fully stretched",
            )
            .prior(0.0, 15.0)
            .plausible(0.0, 100.0),
            ParameterCard::new(
                "share",
                PERCENT,
                (1.0, 200.0),
                20.0,
                "part of the stretch over which it turns over",
            )
            .off_at(20.0)
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

impl LoadEffect for BladderHysteresis {
    fn act(&self, Row { moment, setting, theta, memory }: Row<'_>, balance: &Balance, force: &mut Jet) {
        let now = filled(balance, setting);
        let change = if moment.begins { Jet::from(0.0) } else { now - memory[1] };
        memory[1] = now;
        memory[0] = dragged(memory[0], change, theta[1], Jet::from(1.0));
        *force = *force - theta[0] * now * memory[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::{balance, driven};
    use bulge_numerics::Real;

    #[test]
    fn the_loop_is_there_in_filling_from_zero_and_gone_above() {
        // At 10 %, from 0 to 6 bar and back: b grows to B and z to 1 - exp(-B/delta). Venting to 2 bar hardly
        // changes b.
        let bars = [0.0, 1.0, 2.0, 4.0, 6.0, 4.0, 2.0, 1.0, 0.0];
        let rows: Vec<[f64; 2]> = bars.iter().map(|bar| [1e5 * bar, 0.1]).collect();
        let out = driven(&BladderHysteresis, &[10.0, 0.1], &rows);
        let full = filled(&balance(0.1), &crate::probe::SETTING).value() / 2.0_f64.tanh();
        let fills = |bar: f64| full * bar.tanh();
        for (i, bar) in bars.iter().enumerate().take(5) {
            let b = fills(*bar);
            let expected = -10.0 * b * (1.0 - (-b / 0.1).exp());
            assert!((out[i] - expected).abs() < 1e-9, "{bar}: {} {expected}", out[i]);
        }
        assert!((out[5] - out[3]).abs() < 0.2 && out[6] > out[2] && out[7] > 0.0, "{out:?}");
    }
}
