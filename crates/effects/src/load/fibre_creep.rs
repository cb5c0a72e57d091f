//! Fibre creep: fibres under tension elongate with the logarithm of time (catalogue R6).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};

/// `e_f = c T log10(1 + t/1 s)`, where T is the total tension of all fibres. Relative to the longer fibre the
/// contraction grows by `e_f (1 - eps)`.
///
/// A muscle with longer fibres, l0 (1 + e_f), held at the same length has the contraction 1 - l/(l0 (1 +
/// e_f)) = (eps + e_f)/(1 + e_f), to first order eps + e_f (1 - eps). The muscle is also larger by e_f in all
/// directions. This is neglected; it changes the force by a fraction of 2 e_f, which is below 0.2 %. In a
/// pleated muscle T is the meridional force N. In a braid T = N/cos(theta), and (1 - eps) T = N/cos(a0).
#[derive(Debug)]
pub(crate) struct FibreCreep;

impl Effect for FibreCreep {
    fn card(&self) -> Card<'_> {
        Card {
            name: "fibre-creep",
            family: "creep",
            mechanism: Mechanism::Relaxation,
            form: Form::Loose,
            title: "Fibres that get longer under tension",
            about: "Fibres creep: under tension they get longer, by the same strain in each decade of time. At the same length the muscle is \
                    then a little more contracted than it seems, which counts most at small contractions and high pressure.",
            equation: "e_f = c T log10(1 + t/1 s),   contraction of the longer fibre = eps + e_f (1 - eps),   T tension of all fibres",
            source: "aramid (Kevlar 49) creeps by 0.01 to 0.1 % per decade at working loads; equation from the fibre length condition",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "2",
                parity: Parity::Even,
                shape: "dF/d eps times tension, with the logarithm of the time",
            },
            twins: &[
                Twin { name: "fibre-stretch", how: "identical at one time" },
                Twin { name: "end-slip", how: "near at one time" },
                Twin { name: "pressure-creep", how: "at one contraction" },
            ],
            separate: "a hold of three decades of time at high pressure and small contraction; marks on a fibre",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "strain per tension of all fibres and factor of ten in time";
        vec![
            ParameterCard::new("compliance", ("%/(kN decade)", 1e-5), (0.0, 1.0), 0.006, about)
                .prior(0.0, 0.012)
                .plausible(0.0, 0.1),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for FibreCreep {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, input: &mut Input) {
        let strain = theta[0] * (1.0 + moment.time).log10();
        input.give_tension.linear += if setting.is_pleated() {
            strain * (-input.contraction + 1.0)
        } else {
            strain / setting.braid_angle.cos()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Jet, Moment, Setting};
    use crate::probe::{SETTING, input};
    use bulge_muscles::Kind;
    use bulge_numerics::Real;

    #[test]
    fn a_braid_gives_by_its_fibre_tension() {
        // 0.006 %/(kN decade) over two decades, divided by cos(25 deg) = 0.906308.
        let found = input(&FibreCreep, &[6e-8], |moment| moment.time = 99.0).give_tension.linear.value();
        assert!((found / (1.2e-7 / 0.906_307_787) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_pleated_muscle_gives_by_its_meridional_force() {
        let setting = Setting { kind: Kind::Pleated, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let moment = Moment { time: 9.0, ..Moment::at_rest(2e5, 0.1) };
        FibreCreep.act(
            Row { moment: &moment, setting: &setting, theta: &[Jet::from(6e-8)], memory: &mut [] },
            &mut input,
        );
        assert!((input.give_tension.linear.value() / 5.4e-8 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn it_is_the_contraction_of_a_longer_fibre() {
        // 800 N and a strain of 1e-6: (eps + e)/(1 + e), up to e^2.
        let (e, eps) = (1e-6, 0.1);
        let setting = Setting { kind: Kind::Pleated, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(eps));
        let moment = Moment { time: 9.0, ..Moment::at_rest(2e5, eps) };
        FibreCreep.act(
            Row { moment: &moment, setting: &setting, theta: &[Jet::from(e / 800.0)], memory: &mut [] },
            &mut input,
        );
        let seen = eps + input.give_tension.linear.value() * 800.0;
        assert!((seen - (eps + e) / (1.0 + e)).abs() < 2.0 * e * e);
    }
}
