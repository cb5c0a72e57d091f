//! Fibre count: a pleated muscle has a different number of fibres than stated (S1, eqs. 5 and 29; catalogue
//! G1).

use bulge_muscles::Parameter;
use bulge_numerics::Real;
use std::f64::consts::TAU;

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Jet, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::NUMBER;

/// The smallest number of fibres that enclose an area.
const LEAST: f64 = 3.0;

/// `area -> area n' sin(2 pi/n')/(n sin(2 pi/n))`: the polygon has n' corners instead of n.
#[derive(Debug)]
pub(crate) struct FibreCount;

/// n sin(2 pi/n), the area of the polygon divided by half the square of its radius.
fn polygon(n: Jet) -> Jet {
    n * (Jet::from(TAU) / n).sin_cos().0
}

impl Effect for FibreCount {
    fn card(&self) -> Card<'_> {
        Card {
            name: "fibre-count",
            family: "fibre-count",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Number of fibres",
            about: "Between n fibres the cloth is flat, so the gas acts on a polygon instead of a circle: 0.4 % less area with 40 fibres, \
                    2.9 % with 15. A muscle with another number of fibres than stated is a little stronger or weaker at every contraction. \
                    Fibres are counted, not fitted: a force map cannot tell this from a gain.",
            equation: "area -> area n' sin(2 pi/n')/(n sin(2 pi/n)),   n stated, n' true (taken as a real number)",
            source: "S1, eqs. 5, 28 and 29; lobes instead of flat cloth are another effect",
            evidence: Evidence::Paper,
            group: Group::Geometry,
            kind: PLEATED,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "pressure-gain", how: "identical" },
                Twin { name: "force-gain", how: "identical where the force is proportional to the pressure" },
                Twin { name: "fibre-misalignment", how: "0.999" },
                Twin { name: "end-radius", how: "near" },
            ],
            separate: "count the fibres",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "number of fibres";
        vec![
            ParameterCard::multiple("count", NUMBER, Parameter::Fibres, (0.5, 2.0), about)
                .prior(1.0, 0.02)
                .plausible(0.9, 1.1),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for FibreCount {
    fn act(&self, Row { setting, theta, .. }: Row<'_>, input: &mut Input) {
        if setting.is_pleated()
            && let Some(stated) = setting.fibres
        {
            let count = if theta[0].value() < LEAST { Jet::from(LEAST) } else { theta[0] };
            // The same function is used for both, so that equal numbers give a quotient of exactly 1.
            let area = polygon(count) / polygon(Jet::from(f64::from(stated))).value();
            input.area = input.area * area;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Moment, Setting};
    use crate::probe::SETTING;
    use bulge_muscles::Kind;

    fn area(stated: Option<u32>, count: f64) -> f64 {
        let setting = Setting { kind: Kind::Pleated, fibres: stated, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let theta = [Jet::from(count)];
        FibreCount.act(
            Row { moment: &Moment::at_rest(2e5, 0.1), setting: &setting, theta: &theta, memory: &mut [] },
            &mut input,
        );
        input.area.value()
    }

    #[test]
    fn a_polygon_loses_what_s1_says() {
        // S1: 0.41 % with 40 fibres, 2.9 % with 15. Many fibres approach a circle.
        assert!((area(Some(40), 1e6) - 1.0 / 0.995_893).abs() < 1e-6);
        assert!((area(Some(15), 1e6) - 1.0 / 0.971_012).abs() < 1e-6);
        // 20 sin 18 deg/(40 sin 9 deg)
        assert!((area(Some(40), 20.0) - 0.987_688_340_595_137_7).abs() < 1e-12);
    }

    #[test]
    fn the_stated_number_and_a_continuous_membrane_stay() {
        for n in 3..200 {
            assert_eq!(area(Some(n), f64::from(n)).to_bits(), 1.0_f64.to_bits());
        }
        assert_eq!(area(None, 20.0).to_bits(), 1.0_f64.to_bits());
        assert_eq!(area(Some(4), 1.0).to_bits(), area(Some(4), 3.0).to_bits());
    }
}
