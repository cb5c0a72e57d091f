//! Line drop: a leak in the muscle draws gas through the line, which lowers the pressure (catalogue P1).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{NUMBER, PERCENT};

/// The pressure at which the loss is stated \[Pa\], in the middle of the range in which these muscles are
/// used.
const REFERENCE: f64 = 3e5;

/// `p = reading (1 - phi (reading/3 bar)^(k - 1))`.
///
/// The mass flow of the leak is proportional to the pressure. The loss in the line follows the difference of
/// the squared absolute pressures (laminar) or the square of the flow (turbulent). k is therefore 1 for
/// pressures that are small compared with that of the air, about 1.5 at some bar, and up to 2 in turbulent
/// flow.
#[derive(Debug)]
pub(crate) struct LineDrop;

impl Effect for LineDrop {
    fn card(&self) -> Card<'_> {
        Card {
            name: "line-drop",
            family: "pressure-gain",
            mechanism: Mechanism::PressureChain,
            form: Form::Loose,
            title: "Leak behind a thin line",
            about: "A small leak in the muscle is fed through the line, and the flow costs pressure on the way. Leak and drop grow with the \
                    pressure, so the muscle always has a part less than the sensor at the other end says, and a larger part at high pressure, where the line \
                    loses with the square of the flow.",
            equation: "p = reading (1 - phi (reading/3 bar)^(k - 1)),   k = 1 laminar and slow to 2 turbulent",
            source: "ISO 6358: flow through a leak in proportion to the pressure; isothermal gas in a laminar line, p1^2 - p2^2 ~ flow; in a turbulent one ~ flow^2",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "pressure-gain", how: "identical where k = 1" },
                Twin { name: "force-gain", how: "identical where the force is proportional to the pressure" },
                Twin { name: "fibre-count", how: "identical where k = 1" },
                Twin {
                    name: "load-misalignment",
                    how: "identical where the force is proportional to the pressure",
                },
                Twin { name: "fibre-misalignment", how: "0.999 (PPAM)" },
            ],
            separate: "a pressure sensor at the muscle; closing the supply and watching the pressure fall",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "part of the pressure that is lost at 3 bar";
        let power = "power of the pressure with which the loss grows";
        vec![
            ParameterCard::new("loss", PERCENT, (0.0, 20.0), 1.0, about).prior(0.0, 1.0).plausible(0.0, 5.0),
            ParameterCard::new("power", NUMBER, (0.5, 4.0), 1.0, power)
                .plausible(1.0, 2.2)
                .off_at(1.0)
                .off_if_absent(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for LineDrop {
    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        let part = input.pressure.value() / REFERENCE;
        // Without pressure there is no flow.
        if part > 0.0 {
            let loss = theta[0] * ((theta[1] - 1.0) * (input.pressure / REFERENCE).ln()).exp();
            input.pressure = input.pressure * (-loss + 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Jet, Moment};
    use crate::probe::{SETTING, input};

    #[test]
    fn a_part_of_the_pressure_is_lost() {
        let left = |power: f64| input(&LineDrop, &[0.03, power], |_| ()).pressure.value();
        // At 2 bar the loss is 3 %, and two thirds of that in turbulent flow.
        assert!((left(1.0) - 1.94e5).abs() < 1e-9 && (left(2.0) - 1.96e5).abs() < 1e-9);
        let mut vented = Input::of(Jet::from(0.0), Jet::from(0.1));
        let theta = [0.03, 2.0].map(Jet::from);
        LineDrop.act(
            Row { moment: &Moment::at_rest(0.0, 0.1), setting: &SETTING, theta: &theta, memory: &mut [] },
            &mut vented,
        );
        assert!(vented.pressure.value().abs() < 1e-12);
    }
}
