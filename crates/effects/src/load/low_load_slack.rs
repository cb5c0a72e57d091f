//! Low-load slack: a muscle under compression goes slack or buckles, and the load cell reads about zero
//! (catalogue E13).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NEWTON, PERCENT};

/// `reading = F + a F_c ln(1 + exp(-F/F_c))`.
///
/// This combines both forms of the catalogue. For a pulling muscle the excess is a F_c exp(-F/F_c). A pushing
/// one reads (1 - a) F, and with a = 1 the reading is a rounded max(F, 0).
#[derive(Debug)]
pub(crate) struct LowLoadSlack;

impl Effect for LowLoadSlack {
    fn card(&self) -> Card<'_> {
        Card {
            name: "low-load-slack",
            family: "low-load-slack",
            mechanism: Mechanism::ClothAndFibres,
            form: Form::Loose,
            title: "Slack at low load",
            about: "Near its shortest length a muscle doesn't push: it buckles or goes slack, or the rig can't transmit a push. Readings level \
                    off towards zero where the model's force goes on falling through it.",
            equation: "reading = F + a F_c ln(1 + exp(-F/F_c)):   F + a F_c exp(-F/F_c) for a pull, (1 - a) F for a push",
            source: "readings cut off at 0 in a published force map (Martens and Boblan 2017); rounded cut derived",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "all",
                parity: Parity::Even,
                shape: "exp(-F/F_c): only at small forces",
            },
            twins: &[
                Twin { name: "bladder-axial", how: "-0.90 (braid)" },
                Twin { name: "limited-unfolding", how: "near where tests end at small forces (PPAM)" },
            ],
            separate: "leave out forces under 3 % of full scale; hang a weight on the muscle so that it always pulls",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        vec![
            ParameterCard::new("share", PERCENT, (0.0, 100.0), 100.0, "part of a push that is not read")
                .prior(0.0, 100.0),
            ParameterCard::new("scale", NEWTON, (1.0, 200.0), 20.0, "force below which it begins")
                .plausible(2.0, 100.0)
                .off_at(20.0)
                .logarithmic(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for LowLoadSlack {
    fn act(&self, Row { theta, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        let pull = *reading / theta[1];
        // ln(1 + exp(-x)) without overflow.
        let excess =
            if pull.value() < 0.0 { (pull.exp() + 1.0).ln() - pull } else { ((-pull).exp() + 1.0).ln() };
        *reading += theta[0] * theta[1] * excess;
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "off means the same number")]

    use super::*;
    use crate::effect::Moment;
    use crate::probe::{SETTING, balance};

    fn read(theta: [f64; 2], force: f64) -> Jet {
        let mut reading = Jet::variable(force, 0);
        let moment = Moment::at_rest(2e5, 0.1);
        LowLoadSlack.act(
            Row { moment: &moment, setting: &SETTING, theta: &theta.map(Jet::from), memory: &mut [] },
            &balance(0.1),
            &mut reading,
        );
        reading
    }

    #[test]
    fn a_push_is_not_read_and_a_pull_is() {
        // F_c ln 2 at 0; F + F_c exp(-F/F_c) (1 - ...) at 5 F_c; (1 - a) F far below.
        assert!((read([1.0, 20.0], 0.0).value() - 13.862_943_6).abs() < 1e-6);
        assert!((read([1.0, 20.0], 100.0).value() - 100.134_306_968).abs() < 1e-8);
        assert!(read([1.0, 20.0], -2000.0).value().abs() < 1e-9);
        assert!((read([0.4, 20.0], -2000.0).value() + 1200.0).abs() < 1e-9);
        assert_eq!(read([0.0, 20.0], -37.0).value(), -37.0);
    }

    #[test]
    fn it_is_smooth_at_zero_force() {
        let (below, at, above) = (read([1.0, 20.0], -1e-9), read([1.0, 20.0], 0.0), read([1.0, 20.0], 1e-9));
        for near in [below, above] {
            assert!((near.value() - at.value()).abs() < 1e-8);
            assert!((near.gradient()[0] - 0.5).abs() < 1e-9);
        }
        assert!((at.gradient()[0] - 0.5).abs() < 1e-9);
    }
}
