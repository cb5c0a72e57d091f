//! End factor: a factor on the contraction that represents the taper of the ends (Tondu and Lopez 2000;
//! catalogue G10).

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NUMBER;

/// `1 - eps -> 1 - k eps` in the equilibrium.
#[derive(Debug)]
pub(crate) struct EndFactor;

impl Effect for EndFactor {
    fn card(&self) -> Card<'_> {
        Card {
            name: "end-factor",
            family: "end-taper",
            mechanism: Mechanism::Ends,
            form: Form::Near,
            title: "Taper at the ends, as a factor",
            about: "Because the ends taper, the middle of the muscle is more contracted than the whole. Tondu and Lopez put a constant \
                    factor on the contraction for it. It is an empirical stand-in: the exact taper gives 1.24 at 2 % and 1.09 at 20 % for a \
                    muscle of 25 radii, and depends on the length.",
            equation: "1 - eps -> 1 - k eps;   (k - 1) ~ r0/l0",
            source: "Tondu and Lopez 2000, as used in S2 eq. 15; k = 1.25 to 1.35 from memory",
            evidence: Evidence::Literature,
            group: Group::Geometry,
            kind: BRAIDED,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "eps dF/d eps" },
            twins: &[
                Twin { name: "displacement-gain", how: "identical" },
                Twin { name: "end-taper", how: "0.983" },
                Twin { name: "length-zero-error", how: "1.000 on a calibrated cylinder" },
                Twin { name: "wall-thickness", how: "-0.961" },
            ],
            separate: "two lengths of the same hose: this factor's excess goes with 1/length, that of a sensor does not",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("factor", NUMBER, (0.7, 2.0), 1.25, "factor k on the contraction")
                .off_at(1.0)
                .prior(1.0, 0.25)
                .plausible(1.0, 1.6),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for EndFactor {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.contraction = input.contraction * theta[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force};
    use crate::probe::input;
    use bulge_muscles::{Angle, Braided, Construction, Length, Muscle};
    use bulge_numerics::Real;

    #[test]
    fn a_factor_on_the_contraction_alone() {
        let changed = input(&EndFactor, &[1.25], |_| ());
        assert!((changed.contraction.value() - 0.125).abs() < 1e-15);
        assert_eq!(changed.pressure.value().to_bits(), 2e5_f64.to_bits());
    }

    /// A factor calibrated on the exact taper at one contraction is wrong at another, because it only stands
    /// in for the taper.
    #[test]
    fn the_exact_taper_asks_for_a_factor_that_falls() {
        let braid = Braided::new(Length::mm(10.0), Angle::deg(25.0)).unwrap();
        let clamped = Muscle::new("clamped", Length::mm(250.0), Construction::Braided(braid)).unwrap();
        for (contraction, expected) in [(0.08, 1.17), (0.14, 1.13), (0.20, 1.09)] {
            let factored = |k: f64| {
                let at_a_tenth = input(&EndFactor, &[k], |_| ()).contraction.value();
                force(&cylinder(), 3.0, contraction * at_a_tenth / 0.1)
            };
            let exact = force(&clamped, 3.0, contraction);
            assert!(
                (factored(expected - 0.01) - exact) * (factored(expected + 0.01) - exact) < 0.0,
                "{expected}"
            );
        }
    }
}
