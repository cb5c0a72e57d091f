//! Lobes: inextensible cloth bulges between the fibres and stops the unfolding (catalogue G5).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// Cloth of circumference `C_f` forms n circular lobes outside the polygon of the fibres.
#[derive(Debug)]
pub(crate) struct Lobes;

impl Effect for Lobes {
    fn card(&self) -> Card<'_> {
        Card {
            name: "lobes",
            family: "lobes",
            mechanism: Mechanism::Section,
            form: Form::Near,
            title: "Lobes of cloth between the fibres",
            about: "The cloth between two fibres is longer than their distance and bulges into a lobe, which adds up to 12 % of area to the \
                    polygon. As the muscle swells the lobes flatten, so the area grows less than without them and the force falls short at \
                    large contractions, steeply near the radius at which they are gone.",
            equation: "A(r) = (n/2) sin(2 pi/n) r^2 + n rho^2 (b - sin(b) cos(b)),   s = C_f/n,   w = r sin(pi/n),   \
                       sin(b)/b = 2 w/s,   rho = s/(2 b),   b <= 90 deg: deeper cloth stands in semicircles on pleats;   \
                       stop at r = C_f/(2 n sin(pi/n))",
            source: "geometry and virtual work, derived",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: PLEATED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "some per cent more at small contractions, less at large ones, a steep loss as the equator nears C_f/(2 pi)",
            },
            twins: &[
                Twin { name: "fibre-misalignment", how: "0.956 far from the stop" },
                Twin { name: "end-radius", how: "near, far from the stop" },
                Twin { name: "pleat-depth", how: "near, far from the stop" },
                Twin { name: "limited-unfolding", how: "the same with cloth that stretches" },
            ],
            separate: "measure the diameter at mid-length up to the largest contractions; measure the cloth",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "circumference C_f of the cloth; 0: flat between the fibres, without limit. \
                     There is no small effect: between 0 and 2 pi R there is no muscle";
        let card =
            ParameterCard::multiple("circumference", MILLIMETRE, Parameter::Radius, (8.0, 75.0), about);
        vec![ParameterCard { typical: 25.0, ..card }.off_at(0.0).prior(25.0, 8.0).plausible(15.0, 45.0)]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for Lobes {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let circumference = theta[0];
        if circumference.value() == 0.0 {
            return Ok(());
        }
        check::positive("effects.lobes.circumference", Length::from_si(circumference.value()))?;
        if parts.fibres.is_none() {
            return Err(MuscleError::LobesOfContinuous);
        }
        parts.lobes = Some(circumference);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{force, pleated, with};
    use bulge_muscles::preset;

    #[test]
    fn cloth_holds_the_muscle_back() {
        let muscle = pleated();
        // Without lobes the equator of the muscle is at 44.8 mm at 20 % and at 53.6 mm at 40 %. A cloth of 2
        // pi 47 mm stops it in between.
        let lobed = with(&Lobes, &[2.0 * std::f64::consts::PI * 0.047], &muscle).unwrap();
        let gain = |contraction| force(&lobed, 1.0, contraction) / force(&muscle, 1.0, contraction);
        let gains = [0.02, 0.1, 0.2, 0.3].map(gain);
        assert!(gains.is_sorted_by(|a, b| a > b), "{gains:?}");
        assert!(gains[0] > 1.0 && gains[2] > 0.8 && gains[3] < 0.2, "{gains:?}");
    }

    #[test]
    fn none_is_the_same_muscle_and_a_membrane_has_none() {
        assert_eq!(with(&Lobes, &[0.0], &pleated()).unwrap(), Parts::of(&pleated()));
        assert!(with(&Lobes, &[0.4], &preset("ppam-1").unwrap()).is_err());
        assert!(with(&Lobes, &[0.4], &preset("dmsp-20-250").unwrap()).is_err());
    }
}
