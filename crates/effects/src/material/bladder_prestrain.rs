//! Bladder pre-strain: the bladder was wider or narrower than the braid before assembly (Ball and Garcia
//! 2016; catalogue E9).

use bulge_numerics::Real;
use std::f64::consts::TAU;

use super::tube::Tube;
use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NEWTON_PER_METRE;

/// `dF = 2 pi r0 tau (2 l2 - 1) dl2/dl1`: a linear tube, to first order in its pre-strain.
#[derive(Debug)]
pub(crate) struct BladderPrestrain;

impl Effect for BladderPrestrain {
    fn card(&self) -> Card<'_> {
        Card {
            name: "bladder-prestrain",
            family: "bladder-prestrain",
            mechanism: Mechanism::Rubber,
            form: Form::Loose,
            title: "Bladder stretched on assembly",
            about: "A bladder narrower than the braid is stretched already when the muscle hangs there at rest, and pushes the ends apart; a \
                    wider one does the opposite. Between 0 and 25 % that force is constant to within 7 %, so a force map takes it for the zero \
                    of the load cell.",
            equation: "dF = 2 pi r0 tau (2 l2 - 1) dl2/dl1,   tau = E_h t (r0/r_b - 1),   r_b: radius of the free bladder,   l2 as for hoop-elasticity;   \
                       from the energy (E_h t/2) (l2 r0/r_b - 1)^2 per area, to first order in the pre-strain",
            source: "Ball and Garcia 2016 for the idea, by memory; formula derived",
            evidence: Evidence::Literature,
            group: Group::Material,
            kind: BRAIDED,
            signature: Signature { pressure: "0", parity: Parity::Even, shape: "constant to within 7 %" },
            twins: &[
                Twin { name: "force-offset", how: "1.000 at first order" },
                Twin { name: "weight", how: "1.000 at first order" },
                Twin { name: "bladder-axial", how: "0.816" },
            ],
            separate: "vent the muscle and detach it: the zero of the cell stays, this goes; stretching at zero pressure",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about =
            "hoop tension tau of the wall at rest; positive if the bladder was narrower than the braid";
        vec![
            ParameterCard::new("tension", NEWTON_PER_METRE, (-1000.0, 1000.0), 0.0, about)
                .prior(0.0, 100.0)
                .plausible(-300.0, 300.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for BladderPrestrain {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        if let Some(tube) = Tube::at(balance.contraction, setting) {
            *force +=
                theta[0] * tube.hoop.scale_add(2.0, Jet::from(-1.0)) * tube.slope * (TAU * setting.radius);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::probe::{SETTING, balance};

    fn force(tension: f64, contraction: f64) -> f64 {
        let mut force = Jet::from(0.0);
        let (moment, theta) = (Moment::at_rest(2e5, contraction), [Jet::from(tension)]);
        BladderPrestrain.act(
            Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut [] },
            &balance(contraction),
            &mut force,
        );
        force.value()
    }

    /// The force of a tube of E_h t = 2 kN/m with a pre-strain of e0, minus that without pre-strain, to first
    /// order in e0.
    #[test]
    fn the_force_is_what_a_strained_tube_adds() {
        let (stiffness, radius) = (2e3, 0.01);
        let energy = |prestrain: f64, contraction: f64| {
            let (s, c) = 25.0_f64.to_radians().sin_cos();
            let l2 = (1.0 - ((1.0 - contraction) * c).powi(2)).sqrt() / s;
            0.5 * stiffness * (l2 * (1.0 + prestrain) - 1.0).powi(2) * TAU * radius
        };
        let (h, e0) = (1e-4, 1e-3);
        for contraction in [0.0, 0.1, 0.25] {
            let pull = |e0: f64| -(energy(e0, contraction + h) - energy(e0, contraction - h)) / (2.0 * h);
            let expected = (pull(e0) - pull(-e0)) / 2.0;
            let found = force(stiffness * e0, contraction);
            assert!((found / expected - 1.0).abs() < 1e-5, "{contraction}: {found} {expected}");
        }
    }

    #[test]
    fn it_is_nearly_constant() {
        let rest = force(100.0, 0.0);
        assert!((rest + 28.896).abs() < 1e-3, "{rest}");
        let largest = (0..=25).map(|i| force(100.0, 0.01 * f64::from(i)) / rest).fold(0.0, f64::max);
        let mean = 0.5 * (largest + 1.0);
        assert!((largest / mean - 1.0).abs() < 0.07, "{largest}");
    }
}
