//! Polynomials for a pleated muscle: force (S1 eq. 31, Table 1) and enclosed volume (S1 eq. 32, Table 2).

use super::coefficient::{Coefficient, CoefficientTable};
use super::definition::{Form, Law};
use super::point::LawPoint;
use crate::Evidence;
use crate::card::PLEATED;
use bulge_muscles::Kind;
use bulge_numerics::Real;
use serde::Serialize;

/// S1 Table 1: f4, f3, f2, f1, f0.
const TABLE_1: [f64; 5] = [-2.0413, 171.623, -7178.93, 128_611.6, 146_099.0];
/// S1 Table 2: v5, v4, v3, v2, v1, v0.
const TABLE_2: [f64; 6] = [0.022_54, -2.6296, 113.82, -2386.3, 30_080.0, 71_728.0];

pub(super) const LAW: Law = Law {
    name: "s1-polynomial",
    aliases: &[],
    title: "polynomial of the second-generation pleated muscle",
    source: "S1 eq. 31, Table 1",
    evidence: Evidence::Paper,
    equation: "F = p l0^2 (f4 kappa^3 + f3 kappa^2 + f2 kappa + f1 + f0/kappa)\nF in N, p in bar, l0 in m, kappa in %",
    kind: PLEATED,
    directional: false,
    range: "100 to 3000 N at 1 to 3 bar, slenderness l0/R = 110/16 = 6.9; the force is 0 at 36.5 % and infinite at 0 %",
    coefficients: &[
        Coefficient::linear("f4", "N/(bar m^2 %^3)", "cubic term", TABLE_1[0], 0.05),
        Coefficient::linear("f3", "N/(bar m^2 %^2)", "quadratic term", TABLE_1[1], 1.5),
        Coefficient::linear("f2", "N/(bar m^2 %)", "linear term", TABLE_1[2], 40.0),
        Coefficient::linear("f1", "N/(bar m^2)", "constant term", TABLE_1[3], 1500.0),
        Coefficient::linear("f0", "N %/(bar m^2)", "rise towards zero contraction", TABLE_1[4], 5000.0),
    ],
    tables: &[CoefficientTable {
        name: "PPAM",
        muscle: Some("PPAM-2-R16"),
        source: "S1 Table 1",
        evidence: Evidence::Paper,
        values: &TABLE_1,
    }],
    notes: &[
        "The coefficients are not dimensionless: they hold for F in N, p in bar, l0 in m and kappa in % only.",
        "Another slenderness than 6.9 needs other coefficients: l0^2 scales the force of muscles of one shape only.",
        "A fit of measurements on three muscles, hysteresis averaged. What it holds that the inelastic closed form does not \
         (2.9 % of 3 kN at R = 16 mm) is physics left out there.",
    ],
    form: Form::PleatedPolynomial,
};

/// S1 eq. 31: F \[N\] of a muscle of length l0 \[m\].
///
/// ```text
/// F = p l0^2 (f4 kappa^3 + f3 kappa^2 + f2 kappa + f1 + f0/kappa)
/// ```
pub(super) fn force<D: Real, const N: usize>(at: LawPoint<D>, length: f64, coefficients: [D; N]) -> D {
    let kappa = at.percent();
    let polynomial = horner(&coefficients[..4], kappa) + coefficients[4] / kappa;
    at.bar() * (length * length) * polynomial
}

/// A polynomial with the highest power first.
fn horner<D: Real>(coefficients: &[D], x: D) -> D {
    coefficients.iter().fold(D::from(0.0), |sum, coefficient| sum * x + *coefficient)
}

/// A formula for the volume of a muscle. It is not a force law.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct VolumeLaw {
    /// The name.
    pub name: &'static str,
    /// A short description.
    pub title: &'static str,
    /// Paper and equation.
    pub source: &'static str,
    /// The reliability of the equation.
    pub evidence: Evidence,
    /// The equation in plain text.
    pub equation: &'static str,
    /// The kind of muscle it is for; none if for both.
    pub kind: Option<Kind>,
    /// The range of validity.
    pub range: &'static str,
    /// Coefficients, in order. All are linear.
    pub coefficients: &'static [Coefficient],
    /// Sets of coefficients.
    pub tables: &'static [CoefficientTable],
    /// Errata and cautions.
    pub notes: &'static [&'static str],
}

/// Enclosed volume of the second-generation pleated muscle, S1 eq. 32 with Table 2.
///
/// Never derive a force from it. At 1 bar and 10 %, -p dV/dl is 860 N, but the muscle pulls 1047 N. At 33 %
/// the derivative changes sign.
pub static S1_VOLUME: VolumeLaw = VolumeLaw {
    name: "s1-volume",
    title: "volume polynomial of the second-generation pleated muscle",
    source: "S1 eq. 32, Table 2",
    evidence: Evidence::Paper,
    equation: "V = l0^3 (v5 kappa^5 + v4 kappa^4 + v3 kappa^3 + v2 kappa^2 + v1 kappa + v0)\nV in ml, l0 in m, kappa in %",
    kind: PLEATED,
    range: "0 to 35 %, slenderness l0/R = 110/16 = 6.9",
    coefficients: &[
        Coefficient::linear("v5", "ml/(m^3 %^5)", "fifth power", TABLE_2[0], 1e-4),
        Coefficient::linear("v4", "ml/(m^3 %^4)", "fourth power", TABLE_2[1], 5e-3),
        Coefficient::linear("v3", "ml/(m^3 %^3)", "third power", TABLE_2[2], 0.15),
        Coefficient::linear("v2", "ml/(m^3 %^2)", "second power", TABLE_2[3], 5.0),
        Coefficient::linear("v1", "ml/(m^3 %)", "first power", TABLE_2[4], 150.0),
        Coefficient::linear("v0", "ml/m^3", "volume at rest", TABLE_2[5], 4000.0),
    ],
    tables: &[CoefficientTable {
        name: "PPAM",
        muscle: Some("PPAM-2-R16"),
        source: "S1 Table 2",
        evidence: Evidence::Paper,
        values: &TABLE_2,
    }],
    notes: &[
        "Not a force law: -p dV/dl of it misses the force by 18 % at 10 % contraction and has the wrong sign beyond 33 %.",
        "It fits computed volumes of R = 16 mm (88.5 ml at rest), not of the R = 11.5 mm (45.7 ml) that the text names \
         beside the figure: the polynomial gives 95.5 ml at rest and 373.7 ml at 20 %.",
        "Not monotone near 35 to 40 % (424.8 ml at 35 %, 422.2 ml at 39 %), where the volume of the muscle still grows.",
    ],
};

impl VolumeLaw {
    /// Enclosed volume V \[m^3\] of a muscle of length l0 \[m\] at a contraction (a fraction), without end
    /// fittings and tubing.
    ///
    /// ```text
    /// V = l0^3 (v5 kappa^5 + v4 kappa^4 + v3 kappa^3 + v2 kappa^2 + v1 kappa + v0)
    /// ```
    /// Trailing coefficients that are left out are those of S1 Table 2.
    #[must_use]
    pub fn volume<D: Real>(&self, contraction: D, length: f64, coefficients: &[D]) -> D {
        let own = |(i, coefficient): (usize, &Coefficient)| {
            coefficients.get(i).copied().unwrap_or_else(|| D::from(coefficient.typical))
        };
        let kappa = contraction * 100.0;
        let sum = self.coefficients.iter().enumerate().map(own).fold(D::from(0.0), |sum, v| sum * kappa + v);
        sum * (length.powi(3) * 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::super::LawGeometry;
    use super::*;
    use bulge_numerics::Dual;

    const MUSCLE: LawGeometry =
        LawGeometry { length: 0.11, radius: 0.016, braid_angle: 0.0, fibres: Some(40) };

    fn force_at_1_bar(percent: f64) -> f64 {
        LAW.force(LawPoint::mean(1e5, percent / 100.0), &MUSCLE, &[])
    }

    #[test]
    fn forces_of_table_1() {
        for (percent, force) in [(5.0, 1524.0), (10.0, 1047.0), (20.0, 540.0), (30.0, 211.0), (35.0, 51.0)] {
            assert!(
                (force_at_1_bar(percent) - force).abs() < 0.5,
                "{percent} %: {}",
                force_at_1_bar(percent)
            );
        }
        assert!(force_at_1_bar(36.48) > 0.0 && force_at_1_bar(36.50) < 0.0);
        assert!(force_at_1_bar(1e-6) > 1e8 && force_at_1_bar(40.0) < -100.0);
        // The force is proportional to the pressure and to l0^2.
        let longer = LawGeometry { length: 0.22, ..MUSCLE };
        let force: f64 = LAW.force(LawPoint::mean(3e5, 0.1), &longer, &[]);
        assert!((force / force_at_1_bar(10.0) - 12.0).abs() < 1e-12);
    }

    #[test]
    fn it_has_no_value_at_rest() {
        for (contraction, is_defined) in
            [(0.0, false), (-0.01, false), (1e-6, true), (0.3, true), (f64::NAN, false)]
        {
            assert_eq!(LAW.is_defined_at(LawPoint::mean(1e5, contraction)), is_defined, "{contraction}");
        }
    }

    #[test]
    fn volumes_of_table_2() {
        let ml = |percent: f64| S1_VOLUME.volume(percent / 100.0, 0.11, &[]) * 1e6;
        for (percent, volume) in [(0.0, 95.5), (20.0, 373.7), (35.0, 424.8), (39.0, 422.2)] {
            assert!((ml(percent) - volume).abs() < 0.05, "{percent} %: {}", ml(percent));
        }
        assert!(ml(35.0) > ml(37.0) && ml(37.0) > ml(38.8) && ml(38.9) < ml(40.0));
    }

    /// The volume gives no force law: S1 erratum, -p dV/dl at 1 bar.
    #[test]
    fn no_force_comes_of_the_volume() {
        let from_volume = |contraction: f64| {
            let volume = S1_VOLUME.volume(Dual::<1>::variable(contraction, 0), 0.11, &[]);
            // l = l0 (1 - kappa)
            1e5 * volume.gradient()[0] / 0.11
        };
        assert!((from_volume(0.10) - 860.1).abs() < 0.1, "{}", from_volume(0.10));
        assert!((from_volume(0.35) + 63.9).abs() < 0.1, "{}", from_volume(0.35));
        assert!(from_volume(0.33) > 0.0 && from_volume(0.3325) < 0.0);
        assert!(force_at_1_bar(10.0) > 1.2 * from_volume(0.10) && force_at_1_bar(35.0) > 0.0);
    }
}
