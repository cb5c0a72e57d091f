//! Force nonlinearity: the characteristic of the load cell is curved (catalogue M5).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NUMBER;

/// The force at which the curvature is stated \[N\].
const REFERENCE: f64 = 1e3;

/// `reading = F + q F |F| (|F|/1 kN)^(k - 2)`, for a pull.
///
/// k = 2 describes a bridge that bends one way. A cell that is symmetric for pull and push has k = 3.
#[derive(Debug)]
pub(crate) struct ForceNonlinearity;

impl Effect for ForceNonlinearity {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-nonlinearity",
            family: "force-nonlinearity",
            mechanism: Mechanism::ForceChain,
            form: Form::Loose,
            title: "Bent characteristic of the load cell",
            about: "The load cell reads right at small loads and a little too much or too little at large ones.",
            equation: "reading = F + q F^2 (F/1 kN)^(k - 2),   k = 2 a bent characteristic, 3 one that is alike for pulls and pushes",
            source: "data sheets of load cells: 0.02 to 0.5 % of full scale",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "2", parity: Parity::Even, shape: "square of the force" },
            twins: &[
                Twin { name: "frame-compliance", how: "-0.958 (braid)" },
                Twin { name: "fibre-stretch", how: "0.81 (braid)" },
                Twin { name: "force-gain", how: "0.91 (PPAM)" },
            ],
            separate: "dead weights on the load cell, at three loads or more",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "relative error per force, at 1 kN";
        let power = "power of the force with which the error grows";
        vec![
            ParameterCard::new("curvature", ("%/kN", 1e-5), (-20.0, 20.0), 0.0, about)
                .prior(0.0, 0.5)
                .plausible(-2.0, 2.0),
            ParameterCard::new("power", NUMBER, (1.2, 6.0), 2.0, power)
                .plausible(1.5, 3.5)
                .off_at(2.0)
                .off_if_absent(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for ForceNonlinearity {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        let size = reading.abs();
        if size.value() > 0.0 {
            *reading += theta[0] * size * size * ((theta[1] - 2.0) * (size / REFERENCE).ln()).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::reading;

    #[test]
    fn the_square_of_the_force_is_added() {
        // 2 %/kN at 500 N is 1 % of 500 N.
        assert!((reading(&ForceNonlinearity, &[2e-5, 2.0], |_| ()) - 505.0).abs() < 1e-9);
        // At 1 kN the error is the same for any power. At half of that it is a quarter or an eighth.
        assert!((reading(&ForceNonlinearity, &[2e-5, 3.0], |_| ()) - 502.5).abs() < 1e-9);
    }
}
