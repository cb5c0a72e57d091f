//! Uneven fibres: the fibres of a pleated muscle differ in length (catalogue G8).

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// The force is averaged over contractions `eps + sigma z`, where z is a standard normal number.
#[derive(Debug)]
pub(crate) struct UnevenFibres;

impl Effect for UnevenFibres {
    fn card(&self) -> Card<'_> {
        Card {
            name: "uneven-fibres",
            family: "uneven-fibres",
            mechanism: Mechanism::ClothAndFibres,
            form: Form::Loose,
            title: "Fibres of different lengths",
            about: "In a handmade muscle some fibres are a little longer than others. The short ones pull more than the long ones pull less, \
                    because the force rises ever more steeply towards small contractions: on the average the muscle is stronger there.",
            equation: "F = mean of F(eps + sigma z),   z standard normal;   dF = (1/2) F'' sigma^2 for small sigma, so its derivative at 0 vanishes",
            source: "expansion of the equilibrium for stiff fibres, derived",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: PLEATED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "F'': like 1/eps^3, gone beyond 5 %",
            },
            twins: &[
                Twin { name: "frame-compliance", how: "-0.97" },
                Twin { name: "fibre-stretch", how: "-0.95" },
            ],
            separate: "force against pressure at 1 to 2 % of contraction: proportional here, less than that with stretch",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "standard deviation of the fibres' lengths over l0";
        vec![
            ParameterCard::new("spread", PERCENT, (0.0, 2.0), 0.3, about).prior(0.0, 0.4).plausible(0.0, 1.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for UnevenFibres {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.spread += theta[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_spread_is_the_parameter() {
        let spread = input(&UnevenFibres, &[0.003], |_| ()).spread.value();
        assert_eq!(spread.to_bits(), 0.003_f64.to_bits());
    }
}
