//! Polynomials in the contraction, one multiplied by the pressure and one not (recalled from the literature).

use super::coefficient::{Coefficient, CoefficientTable};
use super::definition::{Form, Law};
use super::point::LawPoint;
use crate::Evidence;
use bulge_numerics::Real;

/// Least-squares fit to S2 eq. 16 with Table 1 at 1, 2, .. 5 bar and 0, 1, .. 25 %, where F > 0; 4.1 N rms.
const DMSP_20_200: [f64; 9] =
    [291.062, -899.350, 179.648, -1587.93, -0.948_318, 7555.918, -76_667.45, 343_937.4, -573_892.1];
/// The same fit with Table 2; 4.0 N rms.
const DMSP_20_400: [f64; 9] =
    [298.669, -868.770, -206.072, -21.463, -6.741_757, 7196.758, -72_077.58, 315_031.2, -502_879.1];

pub(super) const LAW: Law = Law {
    name: "hildebrandt",
    aliases: &[],
    title: "polynomials of the contraction, affine in pressure",
    source: "literature (two polynomials, P3 and Q4); in none of S1 to S5",
    evidence: Evidence::Literature,
    equation: "F = p (a0 + a1 kappa + a2 kappa^2 + a3 kappa^3) - (b0 + b1 kappa + b2 kappa^2 + b3 kappa^3 + b4 kappa^4)\n\
               F in N, p in bar, kappa a fraction",
    kind: None,
    directional: false,
    range: "that of its data, and not beyond: a polynomial of degree 4 turns soon",
    coefficients: &[
        Coefficient::linear("a0", "N/bar", "with pressure: force at rest", DMSP_20_200[0], 10.0),
        Coefficient::linear("a1", "N/bar", "with pressure: slope", DMSP_20_200[1], 80.0),
        Coefficient::linear("a2", "N/bar", "with pressure: curvature", DMSP_20_200[2], 300.0),
        Coefficient::linear("a3", "N/bar", "with pressure: cubic term", DMSP_20_200[3], 1000.0),
        Coefficient::linear("b0", "N", "without: pull of the bladder at rest", DMSP_20_200[4], 30.0),
        Coefficient::linear("b1", "N", "without: slope", DMSP_20_200[5], 200.0),
        Coefficient::linear("b2", "N", "without: curvature", DMSP_20_200[6], 800.0),
        Coefficient::linear("b3", "N", "without: cubic term", DMSP_20_200[7], 3000.0),
        Coefficient::linear("b4", "N", "without: quartic term", DMSP_20_200[8], 12_000.0),
    ],
    tables: &[
        CoefficientTable {
            name: "DMSP-20-200N",
            muscle: Some("DMSP-20-200"),
            source: "fitted to S2 eq. 16 with Table 1, 1 to 5 bar, 0 to 25 %, F > 0",
            evidence: Evidence::Derived,
            values: &DMSP_20_200,
        },
        CoefficientTable {
            name: "DMSP-20-400N",
            muscle: Some("DMSP-20-400"),
            source: "fitted to S2 eq. 16 with Table 2, likewise",
            evidence: Evidence::Derived,
            values: &DMSP_20_400,
        },
    ],
    notes: &[
        "The form, not its numbers, is from the literature. Linear in all coefficients: a fit needs no start.",
        "At a fixed length the force of a Festo muscle is affine in pressure to 0.3 % of full scale, so that this form lacks nothing but \
         the sharp take-up of the bladder below 5 % (4 N rms against sarosi-6).",
        "Needs at least five lengths; with just five it runs through all of them and proves nothing.",
    ],
    form: Form::Hildebrandt,
};

/// `F = p P3(kappa) - Q4(kappa)`, p in bar, kappa a fraction.
pub(super) fn force<D: Real, const N: usize>(at: LawPoint<D>, coefficients: [D; N]) -> D {
    at.bar() * polynomial(&coefficients[..4], at.contraction)
        - polynomial(&coefficients[4..9], at.contraction)
}

/// A polynomial with the lowest power first.
fn polynomial<D: Real>(coefficients: &[D], x: D) -> D {
    coefficients.iter().rev().fold(D::from(0.0), |sum, coefficient| sum * x + *coefficient)
}

#[cfg(test)]
mod tests {
    use super::super::{LawGeometry, sarosi};
    use super::*;

    const MUSCLE: LawGeometry = LawGeometry { length: 0.2, radius: 0.01, braid_angle: 0.436, fibres: None };

    #[test]
    fn two_polynomials() {
        let at = LawPoint::mean(2e5, 0.1);
        let force: f64 =
            LAW.force(at, &MUSCLE, &[300.0, -900.0, 100.0, 1000.0, 10.0, 200.0, 3000.0, 4e4, 5e5]);
        // 2 (300 - 90 + 1 + 1) - (10 + 20 + 30 + 40 + 50)
        assert!((force - 274.0).abs() < 1e-10, "{force}");
    }

    /// The tables are least-squares fits: the residual is orthogonal to every coefficient's derivative.
    #[test]
    fn tables_are_best_fits() {
        for (table, rms) in LAW.tables.iter().zip([4.106, 4.019]) {
            let six = sarosi::SIX.table(table.name).unwrap().values;
            let (mut squares, mut count, mut slopes) = (0.0, 0.0, [0.0; 9]);
            for (bar, percent) in (1..=5).flat_map(|bar| (0..=25).map(move |percent| (bar, percent))) {
                let (p, kappa) = (f64::from(bar), f64::from(percent) / 100.0);
                let at = LawPoint::mean(p * 1e5, kappa);
                let measured: f64 = sarosi::SIX.force(at, &MUSCLE, six);
                if measured <= 0.0 {
                    continue;
                }
                let residual = LAW.force(at, &MUSCLE, table.values) - measured;
                squares += residual * residual;
                count += 1.0;
                let powers = [0, 1, 2, 3, 4].map(|i| kappa.powi(i));
                let factors = powers[..4].iter().map(|power| p * power).chain(powers.map(|power| -power));
                for ((slope, factor), coefficient) in slopes.iter_mut().zip(factors).zip(LAW.coefficients) {
                    *slope += residual * factor * coefficient.scale;
                }
            }
            let found = f64::sqrt(squares / count);
            assert!((found - rms).abs() < 2e-3, "{found}");
            // The slopes are in N^2, from residuals times scales of some 1e5.
            assert!(slopes.iter().all(|slope| slope.abs() < 100.0), "{slopes:?}");
        }
    }
}
