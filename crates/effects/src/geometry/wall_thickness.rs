//! Wall thickness: the gas acts on the inside of a wall of constant thickness rather than at the braid (Chou
//! and Hannaford 1996; catalogue G9).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Length, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{BRAIDED, Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::MILLIMETRE;

/// `A = pi (r - t)^2` instead of `pi r^2` in the equilibrium of the net.
#[derive(Debug)]
pub(crate) struct WallThickness;

impl Effect for WallThickness {
    fn card(&self) -> Card<'_> {
        Card {
            name: "wall-thickness",
            family: "wall-thickness",
            mechanism: Mechanism::FibreGeometry,
            form: Form::Exact,
            title: "Thickness of the wall",
            about: "The gas acts on the inner face of the wall, at a smaller radius than the braid. This is the correction for a wall that keeps \
                    its thickness. Rubber keeps its volume instead: where the stated radius is that of the braid, nothing is to correct, and a \
                    thickness found here says that the radius is not.",
            equation: "A(r) = pi (r - t)^2;   on a cylinder dF = pi p (D0 t (2 sin(theta) - 1/sin(theta)) - t^2),   D0 = 2 r0/sin(alpha0)",
            source: "Chou and Hannaford 1996; formula derived again",
            evidence: Evidence::Derived,
            group: Group::Geometry,
            kind: BRAIDED,
            signature: Signature {
                pressure: "1",
                parity: Parity::Even,
                shape: "2 sin(theta) - 1/sin(theta): a loss that fades as the muscle swells",
            },
            twins: &[
                Twin { name: "end-taper", how: "-0.995" },
                Twin { name: "end-factor", how: "-0.961" },
                Twin { name: "radius-error", how: "near" },
            ],
            separate: "dissect a muscle: thickness of the wall and depth of the braid in it",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "how far inside the braid the gas acts; replaces a depth that the muscle states";
        let card = ParameterCard::multiple("thickness", MILLIMETRE, Parameter::Radius, (0.0, 0.5), about);
        vec![ParameterCard { typical: 0.2, ..card }.off_at(0.0).prior(0.0, 0.2).plausible(0.0, 0.35)]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for WallThickness {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let thickness = theta[0];
        check::not_negative("effects.wall-thickness.thickness", Length::from_si(thickness.value()))?;
        // At 0 the gas stays at the radius that the muscle states.
        if thickness.value() != 0.0 || parts.depth.value() == 0.0 {
            parts.depth = -thickness;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, pleated, with};
    use std::f64::consts::PI;

    #[test]
    fn a_cylinder_loses_what_chou_and_hannaford_say() {
        let muscle = cylinder();
        let (thickness, p) = (0.002, 3e5);
        let thick = with(&WallThickness, &[thickness], &muscle).unwrap();
        for contraction in [0.0, 0.1, 0.25] {
            let cos = (1.0 - contraction) * 25.0_f64.to_radians().cos();
            let sin = (1.0 - cos * cos).sqrt();
            let across = 2.0 * 0.01 / 25.0_f64.to_radians().sin();
            let expected = PI * p * (across * thickness * (2.0 * sin - 1.0 / sin) - thickness * thickness);
            let found = force(&thick, 3.0, contraction) - force(&muscle, 3.0, contraction);
            assert!((found / expected - 1.0).abs() < 1e-9, "{contraction}: {found} {expected}");
        }
    }

    #[test]
    fn none_is_the_same_muscle() {
        assert_eq!(with(&WallThickness, &[0.0], &cylinder()).unwrap(), Parts::of(&cylinder()));
        // What the muscle states stays without an effect, and is replaced by one.
        let stated = cylinder().with_gas_wall(Some(Length::mm(1.0))).unwrap();
        assert_eq!(with(&WallThickness, &[0.0], &stated).unwrap(), Parts::of(&stated));
        assert_eq!(with(&WallThickness, &[0.002], &stated), with(&WallThickness, &[0.002], &cylinder()));
        assert!(with(&WallThickness, &[-0.001], &cylinder()).is_err());
        assert!(with(&WallThickness, &[0.002], &pleated()).is_err());
    }
}
