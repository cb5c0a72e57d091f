//! Line drop: a leak in the muscle draws gas through the line, which costs pressure (catalogue P1).

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage, Twin};
use crate::effect::{Effect, Jet, Moment, Place, Setting};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `p = reading (1 - phi)`.
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
                    pressure, so the muscle always has the same part less than the sensor at the other end says.",
            equation: "p = reading (1 - phi)",
            source: "ISO 6358: flow through a leak in proportion to the pressure; laminar line",
            evidence: Evidence::Derived,
            group: Group::Rig,
            stage: Stage::Input,
            kind: None,
            signature: Signature { pressure: "1", parity: Parity::Even, shape: "as the force" },
            twins: &[
                Twin { name: "pressure-gain", how: "identical" },
                Twin { name: "force-gain", how: "identical where the force is proportional to the pressure" },
                Twin { name: "fibre-count", how: "identical" },
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
        let about = "part of the pressure that is lost";
        vec![ParameterCard::new("loss", PERCENT, (0.0, 20.0), 1.0, about).prior(0.0, 1.0).plausible(0.0, 5.0)]
    }

    fn act(&self, _: &Moment, _: &Setting, theta: &[Jet], _: &mut [Jet], place: Place<'_>) {
        if let Place::Input(input) = place {
            input.pressure = input.pressure * (-theta[0] + 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn a_part_of_the_pressure_is_lost() {
        assert!((input(&LineDrop, &[0.02], |_| ()).pressure.value() - 1.96e5).abs() < 1e-9);
    }
}
