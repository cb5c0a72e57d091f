//! Pressure threshold: a part of the pressure is spent before the muscle responds (catalogue E10 and E11).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::rig::lowered_pressure::lowered;
use crate::unit::KILOPASCAL;

/// `p -> p - p_th`, and almost no pressure below the threshold.
#[derive(Debug)]
pub(crate) struct PressureThreshold;

impl Effect for PressureThreshold {
    fn card(&self) -> Card<'_> {
        Card {
            name: "pressure-threshold",
            family: "pressure-threshold",
            mechanism: Mechanism::PressureChain,
            form: Form::Near,
            title: "Pressure that is needed to begin",
            about: "The gas must first press the bladder against the braid, or open the folds of the cloth, before it loads the fibres. That \
                    much pressure is missing ever after. Below it the muscle does nothing.",
            equation: "p -> max(p - p_th, 1 mbar);   a thin tube across a gap: p_th = 2 c10 (t/r) (1 - 1/lg^4), lg = radius at contact/at rest",
            source: "gap closure of a neo-Hookean tube derived (10 to 450 mbar); a PPAM works from 20 mbar on (S1), so below 2 kPa there",
            evidence: Evidence::Derived,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0",
                parity: Parity::Even,
                shape: "-F/p; dead below the threshold",
            },
            twins: &[
                Twin { name: "pressure-offset", how: "identical above the threshold" },
                Twin { name: "force-offset", how: "0.92 (braid), 0.94 (PPAM)" },
                Twin { name: "length-zero-error", how: "fits a single force map as well" },
            ],
            separate: "the reading of the vented pressure sensor; the force at zero pressure; the pressure at which the force begins",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "pressure that doesn't act";
        vec![
            ParameterCard::new("pressure", KILOPASCAL, (0.0, 150.0), 20.0, about)
                .prior(0.0, 30.0)
                .plausible(0.0, 60.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for PressureThreshold {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.pressure = lowered(input.pressure, theta[0]);
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "differences of whole pascals are exact")]

    use super::*;
    use crate::effect::{Jet, Moment};
    use crate::probe::{SETTING, input};
    use bulge_numerics::Real;

    #[test]
    fn the_threshold_is_missing_above_and_all_below() {
        assert_eq!(input(&PressureThreshold, &[2e4], |_| ()).pressure.value(), 1.8e5);
        assert_eq!(input(&PressureThreshold, &[2.5e5], |_| ()).pressure.value(), 100.0);
    }

    #[test]
    fn a_screen_sees_it_at_zero() {
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let theta = [Jet::variable(0.0, 3)];
        let moment = Moment::at_rest(2e5, 0.1);
        PressureThreshold
            .act(Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut [] }, &mut input);
        assert_eq!((input.pressure.value(), input.pressure.gradient()[3]), (2e5, -1.0));
    }
}
