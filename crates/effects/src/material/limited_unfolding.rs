//! Limited unfolding: the cloth of a pleated muscle unfolds to a limit and then stretches (S1, section 2;
//! catalogue G6).

use bulge_fibre::{Jet, Parts, TautCloth};
use bulge_muscles::{Length, LineStiffness, MuscleError, Parameter, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{KILONEWTON_PER_METRE, MILLIMETRE};

/// Hoop energy `u(r) = K (2 pi (r - r_u))^2/(2 * 2 pi r_u)` of the cloth beyond r_u, in the equilibrium.
#[derive(Debug)]
pub(crate) struct LimitedUnfolding;

impl Effect for LimitedUnfolding {
    fn card(&self) -> Card<'_> {
        Card {
            name: "limited-unfolding",
            family: "limited-unfolding",
            mechanism: Mechanism::ClothAndFibres,
            form: Form::Loose,
            title: "Cloth that stops unfolding",
            about: "The pleats hold only so much cloth. Beyond the radius at which they are flat the cloth is stretched around the muscle and \
                    holds it back, so the force falls short at large contractions. A test that ends before that radius is reached shows nothing: \
                    up to 25 % if the cloth is taut from three radii of the fittings on.",
            equation: "u(r) = K_h (2 pi (r - r_u))^2/(4 pi r_u) for r > r_u, per meridian length;   cos(psi) (C + u) = F + p A(r)",
            source: "S1 (unfolding seen in photographs); derived; 81 kN/m and 52.6 mm fitted to S1, table 1",
            evidence: Evidence::Derived,
            group: Group::Material,
            kind: PLEATED,
            signature: Signature {
                pressure: "0 and 1",
                parity: Parity::Even,
                shape: "none until the equator reaches r_u, then a growing loss",
            },
            twins: &[
                Twin { name: "membrane-axial", how: "0.97 if the cloth is taut early" },
                Twin { name: "lobes", how: "the same with cloth that doesn't stretch" },
            ],
            separate: "measure the diameter up to 40 %; several pressures at 35 %",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let (stiffness, radius) =
            ("hoop stiffness E t of the cloth; 0: it unfolds without limit", "radius at which it is taut");
        let taut =
            ParameterCard::multiple("unfolded_radius", MILLIMETRE, Parameter::Radius, (1.05, 8.0), radius);
        vec![
            ParameterCard::new("hoop_stiffness", KILONEWTON_PER_METRE, (1.0, 1000.0), 80.0, stiffness)
                .logarithmic()
                .prior(80.0, 80.0),
            ParameterCard { typical: 3.2, ..taut }.off_at(3.2).prior(3.2, 0.8).plausible(1.5, 4.0),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for LimitedUnfolding {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let [stiffness, radius] = [theta[0], theta[1]];
        if stiffness.value() == 0.0 {
            return Ok(());
        }
        let stiff = LineStiffness::from_si(stiffness.value());
        check::positive("effects.limited-unfolding.hoop_stiffness", stiff)?;
        check::positive("effects.limited-unfolding.unfolded_radius", Length::from_si(radius.value()))?;
        parts.cloth = Some(TautCloth { stiffness, radius });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{force, pleated, with};

    #[test]
    fn it_acts_only_beyond_its_radius() {
        // The equator is at 44.8 mm at 20 % and at 53.6 mm at 40 % (catalogue G5).
        let cloth = with(&LimitedUnfolding, &[8e4, 0.0526], &pleated()).unwrap();
        let part = |contraction| force(&cloth, 2.0, contraction) / force(&pleated(), 2.0, contraction);
        assert!((part(0.2) - 1.0).abs() < 1e-9 && (part(0.3) - 1.0).abs() < 1e-9);
        assert!(part(0.4) < 0.99, "{}", part(0.4));
        let early = with(&LimitedUnfolding, &[8e4, 0.040], &pleated()).unwrap();
        assert!(force(&early, 2.0, 0.2) < 0.99 * force(&pleated(), 2.0, 0.2));
        // For soft cloth the effect is proportional to the stiffness.
        let soft = |stiffness| {
            let soft = with(&LimitedUnfolding, &[stiffness, 0.040], &pleated()).unwrap();
            force(&soft, 2.0, 0.25) - force(&pleated(), 2.0, 0.25)
        };
        assert!((soft(20.0) / soft(10.0) - 2.0).abs() < 1e-2);
    }

    #[test]
    fn both_numbers_are_set_together() {
        let cloth = with(&LimitedUnfolding, &[8e4, 0.05], &pleated()).unwrap();
        assert_eq!(cloth.cloth, Some(TautCloth { stiffness: 8e4, radius: 0.05 }));
        assert_eq!(with(&LimitedUnfolding, &[0.0, 0.05], &pleated()).unwrap(), Parts::of(&pleated()));
        assert!(with(&LimitedUnfolding, &[-1.0, 0.05], &pleated()).is_err());
    }
}
