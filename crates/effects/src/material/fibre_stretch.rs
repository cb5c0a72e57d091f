//! Fibre stretch: the fibres are not inextensible (Daerden 1999 for the PPAM, Davis 2003 for the braid;
//! catalogue E1, E2 and B3).

use bulge_fibre::{Jet, Parts};
use bulge_muscles::{Force, MuscleError, Quantity, check};
use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, ShapeEffect};
use crate::mechanism::{Form, Mechanism};
use crate::unit::PERCENT_PER_KILONEWTON;

/// The number of fibres assumed for a braid that doesn't state it. Only the total stiffness of the fibres
/// affects the force.
const ASSUMED_FIBRES: f64 = 100.0;

/// Every fibre elongates by T/EA in the equilibrium. The parameter is 1/(n EA).
#[derive(Debug)]
pub(crate) struct FibreStretch;

impl Effect for FibreStretch {
    fn card(&self) -> Card<'_> {
        Card {
            name: "fibre-stretch",
            family: "fibre-stretch",
            mechanism: Mechanism::ClothAndFibres,
            form: Form::Loose,
            title: "Stretch of the fibres",
            about: "Loaded fibres get longer, by a per cent or so, which shifts the force curve towards larger contractions. A pleated muscle \
                    feels it at small contractions, where the force would rise without bound and now ends at a finite value; in a braid it acts \
                    at any contraction. It grows with the square of the pressure.",
            equation: "strain of a fibre e = T/EA, in the equilibrium;   parameter c = 1/(n EA), the compliance of all n fibres together;   \
                       to first order dF = dF/d eps T c with T the tension of all fibres (PPAM)",
            source: "S1 with the elastic fibre length of Daerden 1999; aramid yarn 8 to 12 kN, 40 of them 0.3 to 0.5 MN; nylon braids 0.01 to 0.2 MN",
            evidence: Evidence::Derived,
            group: Group::Material,
            kind: None,
            signature: Signature {
                pressure: "2",
                parity: Parity::Even,
                shape: "dF/d eps times the tension: steep at small eps (PPAM), flat like 1 - eps (braid)",
            },
            twins: &[
                Twin { name: "end-slip", how: "0.991 (PPAM)" },
                Twin { name: "frame-compliance", how: "0.974 (PPAM), 0.93 (braid)" },
                Twin { name: "length-zero-error", how: "0.966 (PPAM)" },
                Twin { name: "fibre-length", how: "0.955 (PPAM)" },
                Twin { name: "uneven-fibres", how: "-0.95 (PPAM)" },
                Twin { name: "force-nonlinearity", how: "0.81 (braid)" },
                Twin { name: "fibre-creep", how: "the same stretch, growing with time" },
            ],
            separate: "a stiff dummy tells the frame; two lengths (0.98 falls to 0.88); marks on a fibre, filmed; several pressures at one length",
            needs: Needs::Nothing,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about =
            "strain per force of all fibres together, 1/(n EA); replaces a stiffness that the muscle states";
        vec![
            ParameterCard::new("compliance", PERCENT_PER_KILONEWTON, (0.0, 5.0), 0.2, about)
                .prior(0.0, 0.3)
                .plausible(0.0, 2.0)
                .reciprocal("EA of all fibres", "kN", 1e3),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Shape(self)
    }
}

impl ShapeEffect for FibreStretch {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let compliance = theta[0];
        // Inextensible fibres have another solution method, which has no stretch.
        if compliance.value() == 0.0 {
            return Ok(());
        }
        check::positive("fibre.stiffness", Force::from_si(compliance.value().recip()))?;
        // Tension and stress are reported for a single fibre, so a number of fibres is needed.
        if !parts.is_pleated() && parts.fibres.is_none() {
            parts.fibres = Some(Jet::from(ASSUMED_FIBRES));
        }
        parts.compliance = compliance;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bench::{cylinder, force, pleated, with};
    use bulge_muscles::{Parameter, preset};

    #[test]
    fn forces_of_an_independent_solution() {
        // Catalogue B3: 40 fibres of 12.3 and 8.2 kN at 3 bar, with R = 16 mm.
        let at = [0.0, 0.02, 0.05, 0.1, 0.2];
        for (each, forces) in [
            (12.3e3, [7237.0, 5352.0, 4031.0, 2885.0, 1596.0]),
            (8.2e3, [6443.0, 5057.0, 3917.0, 2840.0, 1578.0]),
        ] {
            let elastic = with(&FibreStretch, &[1.0 / (40.0 * each)], &pleated()).unwrap();
            for (contraction, expected) in at.into_iter().zip(forces) {
                let found = force(&elastic, 3.0, contraction);
                assert!((found - expected).abs() < 0.6, "{each} {contraction}: {found} {expected}");
            }
        }
    }

    #[test]
    fn one_fibre_has_its_part_of_the_stiffness() {
        let elastic = with(&FibreStretch, &[2e-6], &pleated()).unwrap();
        assert_eq!((elastic.compliance, elastic.fibres), (2e-6, Some(40.0)));
        let continuous = with(&FibreStretch, &[2e-6], &preset("ppam-1").unwrap()).unwrap();
        assert_eq!((continuous.compliance, continuous.fibres), (2e-6, None));
    }

    /// Catalogue E2: dF = -4 pi^2 p^2 cos(theta)/(k^4 K) to first order, with 1/k = r0/sin(alpha0).
    #[test]
    fn a_braid_stretches_whatever_its_count() {
        let (muscle, compliance, contraction) = (cylinder(), 1e-8, 0.1);
        let elastic = with(&FibreStretch, &[compliance], &muscle).unwrap();
        let counted = muscle.with(Parameter::Fibres, 48.0).unwrap();
        let again = with(&FibreStretch, &[compliance], &counted).unwrap();
        let found = force(&elastic, 3.0, contraction) - force(&muscle, 3.0, contraction);
        assert!((force(&elastic, 3.0, contraction) / force(&again, 3.0, contraction) - 1.0).abs() < 1e-12);
        let (s, c) = 25.0_f64.to_radians().sin_cos();
        let (turn, cos) = (0.01 / s, (1.0 - contraction) * c);
        let expected = -4.0 * std::f64::consts::PI.powi(2) * 9e10 * cos * turn.powi(4) * compliance;
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }

    #[test]
    fn no_compliance_is_the_same_muscle() {
        for muscle in [pleated(), cylinder()] {
            assert_eq!(with(&FibreStretch, &[0.0], &muscle).unwrap(), Parts::of(&muscle));
            assert!(with(&FibreStretch, &[-1e-6], &muscle).is_err());
        }
    }
}
