//! Fibre length: the fibres are longer than the stated length of the muscle (catalogue G4 and M8).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, Row, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT;

/// `l0 -> l0 (1 + delta)` at the same distance between the fittings: `eps -> (eps + delta)/(1 + delta)`.
#[derive(Debug)]
pub(crate) struct FibreLength;

impl Effect for FibreLength {
    fn card(&self) -> Card<'_> {
        Card {
            name: "fibre-length",
            family: "fibre-length",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Length of the fibres",
            about: "The fibres are a little longer or shorter than the stated length: they are clamped deeper in the fitting than the drawing \
                    says, or the length was measured over something else. The distance of the fittings is read rightly, so the muscle is more \
                    contracted than the stated length makes it.",
            equation: "l0' = l0 (1 + delta),   l = l0 (1 - eps) = l0' (1 - eps'):   eps' = (eps + delta)/(1 + delta)",
            source: "geometry",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "(1 - eps) dF/d eps, and a little of the force itself: largest at small contractions",
            },
            twins: &[
                Twin { name: "length-zero-error", how: "0.98 (PPAM)" },
                Twin { name: "fibre-stretch", how: "0.955 (PPAM)" },
                Twin { name: "radius-error", how: "with the braid angle, identical on a cylinder" },
                Twin { name: "displacement-gain", how: "near" },
            ],
            separate: "measure the fibres; two lengths of the same make",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how much longer than stated, over l0";
        vec![
            ParameterCard::new("excess", PERCENT, (-5.0, 5.0), 0.0, about)
                .prior(0.0, 0.5)
                .plausible(-2.0, 2.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for FibreLength {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        parts.length = parts.length * (theta[0] + 1.0);
        check::positive("length", Length::from_si(parts.length.value()))
    }

    fn act(&self, Row { theta, .. }: Row<'_>, input: &mut Input) {
        input.contraction = (input.contraction + theta[0]) / (theta[0] + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, pleated, with};
    use crate::probe::input;
    use bulge_numerics::Real;

    #[test]
    fn the_distance_of_the_fittings_stays() {
        let longer = with(&FibreLength, &[0.01], &pleated()).unwrap();
        let length = longer.length;
        let contraction = input(&FibreLength, &[0.01], |_| ()).contraction.value();
        assert!((length - 0.1111).abs() < 1e-15);
        assert!((length * (1.0 - contraction) - 0.11 * 0.9).abs() < 1e-15);
    }

    /// The force of a cylinder depends only on the contraction: (1 - eps)^2 over (1 + delta)^2.
    #[test]
    fn a_cylinder_only_sees_the_contraction() {
        let muscle = with(&FibreLength, &[-0.02], &cylinder()).unwrap();
        let contraction = input(&FibreLength, &[-0.02], |_| ()).contraction.value();
        let (a, b) = (3.0 / 25.0_f64.to_radians().tan().powi(2), 1.0 / 25.0_f64.to_radians().sin().powi(2));
        let expected = std::f64::consts::PI * 1e-4 * 3e5 * (a * (0.9_f64 / 0.98).powi(2) - b);
        assert!((force(&muscle, 3.0, contraction) / expected - 1.0).abs() < 1e-9);
    }
}
