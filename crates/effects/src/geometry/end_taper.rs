//! End taper: the ends of the braid are clamped rather than cylindrical (catalogue G11; theory of Adkins and
//! Rivlin, Liu and Rahn).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Ends, MuscleError};

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};

/// `ends = "cylinder"` becomes `ends = "clamped"`, with the exact shape of the net. There is no parameter.
#[derive(Debug)]
pub(crate) struct EndTaper;

impl Effect for EndTaper {
    fn card(&self) -> Card<'_> {
        Card {
            name: "end-taper",
            family: "end-taper",
            mechanism: Mechanism::Ends,
            form: Form::Exact,
            title: "Taper at the clamped ends",
            about: "The textbook formula takes the muscle for a cylinder up to its fittings. Really the braid is clamped there and swells over \
                    a length of some radii, so that the middle is more contracted than the muscle as a whole. A muscle of 25 radii loses an \
                    eighth of its force at 20 % by it, one of 3 radii four fifths. There is nothing to fit: the shape follows from the net.",
            equation: "1 - eps = cos(theta_c)/cos(alpha0) + delta/l0,   F = pi p r0^2 (3 cos^2(theta_c) - 1)/sin^2(alpha0),   \
                       delta: what the two ends lack to a cylinder, from the equilibrium of the clamped net",
            source: "equilibrium of the pinned net, as Adkins and Rivlin 1955, Liu and Rahn 2003; checked by an independent energy method",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: BRAIDED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "dF/d eps times the taper's length: grows with eps, levels off near 15 %",
            },
            twins: &[
                Twin { name: "wall-thickness", how: "-0.995" },
                Twin { name: "end-factor", how: "0.983" },
                Twin { name: "length-zero-error", how: "0.98" },
                Twin { name: "displacement-gain", how: "0.98" },
            ],
            separate: "two lengths of the same hose (0.98 falls to 0.57); a photograph of the profile",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        Vec::new()
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for EndTaper {
    fn reshape(&self, _: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        parts.ends = Ends::Clamped;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, with};
    use bulge_muscles::{Parameter, preset};

    #[test]
    fn clamped_ends_cost_what_an_independent_method_says() {
        let muscle = cylinder();
        assert!((force(&muscle, 3.0, 0.2) - 304.5).abs() < 0.05);
        for (length, expected) in [(0.25, 265.7), (0.06, 159.3), (0.03, 60.7)] {
            let short = muscle.with(Parameter::Length, length).unwrap();
            let clamped = with(&EndTaper, &[], &short).unwrap();
            assert!((force(&clamped, 3.0, 0.2) - expected).abs() < 0.05, "{length}");
        }
    }

    #[test]
    fn nothing_else_changes() {
        let full = cylinder().with(Parameter::Wall, 0.002).unwrap().with_gas_wall(None).unwrap();
        let full = full.with_width(Parameter::Length, 2e-4).unwrap();
        let clamped = with(&EndTaper, &[], &full).unwrap();
        assert_eq!(clamped, Parts { ends: Ends::Clamped, ..Parts::of(&full) });
    }

    #[test]
    fn what_is_clamped_or_pleated_stays() {
        for name in ["dmsp-20-250", "ppam-2-r16"] {
            let muscle = preset(name).unwrap();
            assert_eq!(
                with(&EndTaper, &[], &muscle).ok(),
                (!muscle.is_pleated()).then(|| Parts::of(&muscle))
            );
        }
    }
}
