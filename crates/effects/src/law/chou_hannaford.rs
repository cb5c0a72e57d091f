//! The braid described by fibre length and turns (S5 eqs. 9, 11, 12, Table 2), and its efficiency (S5 eq.
//! 13).

use super::coefficient::{Coefficient, CoefficientTable, Measure};
use super::definition::{Form, Law};
use super::point::LawPoint;
use crate::Evidence;
use crate::card::BRAIDED;
use bulge_numerics::Real;
use std::f64::consts::PI;

pub(super) const LAW: Law = Law {
    name: "chou-hannaford",
    aliases: &["s5-braid"],
    title: "ideal braid by fibre length and turns",
    source: "S5 eq. 11, Table 2",
    evidence: Evidence::Paper,
    equation: "F = p (3 l0^2 (1 - kappa)^2 - b^2)/(4 pi N^2)\n\
               = (pi/4) D_M^2 p (3 cos^2(alpha) - 1), D_M = b/(pi N), cos(alpha) = l/b\n\
               kappa a fraction",
    kind: BRAIDED,
    directional: false,
    range: "a long thin braid without ends, wall, bladder and friction; no force at alpha = 54.7 deg",
    coefficients: &[
        Coefficient::nonlinear("b", "mm", "fibre length", 275.85, 3.0)
            .within(1.0, 1e5)
            .measured(Measure::FibreLength),
        Coefficient::nonlinear("N", "1", "turns of a fibre around the axis", 1.73, 0.02)
            .within(1e-3, 1e4)
            .measured(Measure::Turns),
    ],
    tables: &[CoefficientTable {
        name: "DMSP-20-250",
        // b belongs to l0 = 250 mm, so the table fits no other length.
        muscle: None,
        source: "S5 Table 2",
        evidence: Evidence::Paper,
        values: &[275.85, 1.73],
    }],
    notes: &[
        "The same law as s2-cylinder with r0 = b sin(alpha0)/(2 pi N). Table 2 gives r0 = 10.725 mm, the middle of the wall, \
         where the fibres are embedded: 296.2 N/bar at rest. The inner radius 9.75 mm would need N = 1.903.",
        "N is printed with three digits: 0.6 % of the force. b cos(25 deg) = 250.005 mm agrees with l0.",
        "S5 eq. 8 begins F = -p dV/d(alpha); it is -p (dV/d(alpha))/(dl/d(alpha)). What follows is right.",
        "The efficiency F/F_t (eq. 13) is 0/0 at the largest contraction, 36.3 %, and mixes every effect left out.",
        "The table holds for l0 = 250 mm only and has to be asked for; otherwise b and N follow from the muscle's own measures.",
    ],
    form: Form::ChouHannaford,
};

/// S5 eq. 11: F \[N\] of a muscle of length l0 \[m\].
///
/// ```text
/// F = p (3 l0^2 (1 - kappa)^2 - b^2)/(4 pi N^2)
/// ```
pub(super) fn force<D: Real, const N: usize>(at: LawPoint<D>, length: f64, c: [D; N]) -> D {
    let (b, turns) = (c[0] / 1e3, c[1]);
    let l = (-at.contraction + 1.0) * length;
    at.pressure * (l.squared() * 3.0 - b.squared()) / (turns.squared() * (4.0 * PI))
}

/// Efficiency eta = F/F_t of a muscle (S5 eq. 13): the measured force F over the force F_t of the ideal
/// braid, both in N.
///
/// None if the ideal braid doesn't pull (F_t below 1 uN, which is rounding error). At its largest contraction
/// the ratio is 0/0.
///
/// ```
/// use bulge_effects::law::efficiency;
/// assert_eq!(efficiency(240.0, 300.0), Some(0.8));
/// assert_eq!(efficiency(1.0, 0.0), None);
/// ```
#[must_use]
pub fn efficiency(force: f64, theoretical: f64) -> Option<f64> {
    const LEAST: f64 = 1e-6;
    let is_fraction = force.is_finite() && theoretical.is_finite() && theoretical > LEAST;
    is_fraction.then(|| force / theoretical)
}

#[cfg(test)]
mod tests {
    use super::super::{LawGeometry, cylinder, sarosi};
    use super::*;

    const B: f64 = 275.85;
    const N: f64 = 1.73;
    const ALPHA0: f64 = 25.0 * PI / 180.0;

    fn braid(radius: f64) -> LawGeometry {
        LawGeometry { length: 0.25, radius, braid_angle: ALPHA0, fibres: None }
    }

    #[test]
    fn numbers_of_table_2() {
        let at_rest: f64 = LAW.force(LawPoint::mean(1e5, 0.0), &braid(0.01), LAW.tables[0].values);
        assert!((at_rest - 296.2).abs() < 0.05, "{at_rest}");
        assert!((B * ALPHA0.cos() - 250.005).abs() < 5e-4);
        let turns_of = |radius: f64| B * ALPHA0.sin() / (2.0 * PI * radius);
        assert!((turns_of(N) - 10.725).abs() < 5e-4);
        for (radius, turns) in [(9.75, 1.903), (10.0, 1.855), (11.75, 1.579)] {
            assert!((turns_of(radius) - turns).abs() < 5e-4);
        }
        // The change of the force by half a unit of the last printed digit of N.
        let other: f64 = LAW.force(LawPoint::mean(1e5, 0.0), &braid(0.01), &[B, N + 0.005]);
        assert!((1.0 - other / at_rest - 0.0058).abs() < 1e-4);
    }

    #[test]
    fn both_forms_and_the_cylinder_agree() {
        let largest_diameter = B / (PI * N);
        assert!((largest_diameter - 50.75).abs() < 5e-3, "{largest_diameter}");
        let radius = B * ALPHA0.sin() / (2.0 * PI * N) / 1e3;
        // The exact braid angle from b and l0. It is 25 deg to 1e-5.
        let braid_angle = (250.0 / B).acos();
        let geometry =
            LawGeometry { radius: radius * braid_angle.sin() / ALPHA0.sin(), braid_angle, ..braid(0.0) };
        for kappa in [-0.02, 0.0, 0.1, 0.25, 0.4] {
            let at = LawPoint::mean(3e5, kappa);
            let force: f64 = LAW.force(at, &geometry, &[B, N]);
            let cos = 250.0 * (1.0 - kappa) / B;
            let eq_12 = PI * (largest_diameter / 1e3).powi(2) * 3e5 / 4.0 * (3.0 * cos * cos - 1.0);
            assert!((force - eq_12).abs() < 1e-9);
            let cylinder: f64 = cylinder::CYLINDER.force(at, &geometry, &[]);
            assert!((force - cylinder).abs() < 1e-9);
            // Without coefficients b and N come from the muscle.
            assert!((LAW.force(at, &geometry, &[]) - force).abs() < 1e-9);
        }
    }

    #[test]
    fn efficiency_falls_from_one_with_contraction() {
        // The measurements in Fig. 10 aren't printed. S2 Table 1 is the nearest function of a muscle of the
        // same type.
        let measured = sarosi::SIX.table("DMSP-20-200N").unwrap().values;
        let eta = |kappa: f64| {
            let at = LawPoint::mean(3e5, kappa);
            let theoretical = LAW.force(at, &braid(0.01), &[B, N]);
            efficiency(sarosi::SIX.force(at, &braid(0.01), measured), theoretical)
        };
        assert!((eta(0.0).unwrap() - 1.0).abs() < 0.01, "{:?}", eta(0.0));
        let values: Vec<f64> = (0..=20).map(|percent| eta(f64::from(percent) / 100.0).unwrap()).collect();
        assert!(values.windows(2).all(|pair| pair[1] < pair[0]), "{values:?}");
        assert!((values[10] - 0.5492).abs() < 1e-3 && (values[20] - 0.1197).abs() < 1e-3, "{values:?}");
        // 1 - b/(sqrt(3) l0) = 36.3 %
        let largest = 1.0 - B / (3_f64.sqrt() * 250.0);
        assert!((largest - 0.363).abs() < 5e-4);
        assert_eq!((eta(largest), eta(0.4)), (None, None));
        assert_eq!((efficiency(f64::NAN, 1.0), efficiency(1.0, f64::INFINITY)), (None, None));
    }
}
