//! General exponential functions of Festo muscles: isobaric (S3 eq. 3) and with pressure (S3 eq. 4).

use super::coefficient::{Coefficient, CoefficientTable};
use super::definition::{Form, Law};
use super::point::LawPoint;
use super::sarosi::{TABLE_1, TABLE_2};
use crate::Evidence;
use crate::card::BRAIDED;
use bulge_numerics::Real;

const AT_3_BAR: [f64; 5] = isobar(TABLE_1, 3.0);
const EIGHT_200: [f64; 8] = as_eight(TABLE_1);

pub(super) const ISOBARIC: Law = Law {
    name: "s3-exponential",
    aliases: &[],
    title: "exponential function of one isobar",
    source: "S3 eq. 3",
    evidence: Evidence::Paper,
    equation: "F = a exp(b kappa + c) + d kappa + e\nF in N, kappa in %",
    kind: BRAIDED,
    directional: false,
    range: "one pressure: it does not read the pressure, and every isobar has its own coefficients",
    coefficients: &[
        Coefficient::linear("a", "N", "take-up of the bladder at rest", AT_3_BAR[0], 30.0),
        Coefficient::nonlinear("b", "1/%", "decay of the take-up", AT_3_BAR[1], 0.1).within(-10.0, 0.0),
        Coefficient::nonlinear("c", "1", "the same as a", AT_3_BAR[2], 0.1).redundant(),
        Coefficient::linear("d", "N/%", "slope of the braid", AT_3_BAR[3], 1.5),
        Coefficient::linear("e", "N", "force of the braid, contracted bladder", AT_3_BAR[4], 30.0),
    ],
    tables: &[
        at_pressure("DMSP-20-200N at 1 bar", &isobar(TABLE_1, 1.0)),
        at_pressure("DMSP-20-200N at 3 bar", &AT_3_BAR),
        at_pressure("DMSP-20-200N at 5 bar", &isobar(TABLE_1, 5.0)),
    ],
    notes: &[
        "S3 prints no coefficients and no units. Those of the tables are S2 eq. 16 with Table 1 at that pressure: a is a p + b of it, \
         d is d p, e is e p + f.",
        "Five coefficients of rank 4: a e^c is one number. A fit keeps c = 0.",
    ],
    form: Form::Isobaric,
};

pub(super) const EIGHT: Law = Law {
    name: "s3-eight",
    aliases: &[],
    title: "eight-parameter function of Festo muscles",
    source: "S3 eq. 4",
    evidence: Evidence::Paper,
    equation: "F = (a p + b) exp(c kappa + d) + (e p + f) kappa + g p + h\nF in N, p in bar, kappa in %",
    kind: BRAIDED,
    directional: false,
    range: "Festo muscles; the tables about 1 to 5 bar, 0 to 25 % and F > 0",
    coefficients: &[
        Coefficient::linear("a", "N/bar", "take-up at rest that grows with pressure", EIGHT_200[0], 10.0),
        Coefficient::linear("b", "N", "take-up of the bladder at rest", EIGHT_200[1], 30.0),
        Coefficient::nonlinear("c", "1/%", "decay of the take-up", EIGHT_200[2], 0.1).within(-10.0, 0.0),
        Coefficient::nonlinear("d", "1", "the same as a and b together", EIGHT_200[3], 0.1).redundant(),
        Coefficient::linear("e", "N/(bar %)", "slope of the braid", EIGHT_200[4], 0.5),
        Coefficient::linear("f", "N/%", "axial stiffness of the bladder", EIGHT_200[5], 1.5),
        Coefficient::linear("g", "N/bar", "force of the braid at rest", EIGHT_200[6], 10.0),
        Coefficient::linear("h", "N", "pull of the bladder, contracted", EIGHT_200[7], 30.0),
    ],
    tables: &[
        CoefficientTable {
            name: "DMSP-20-200N",
            muscle: Some("DMSP-20-200"),
            source: "S2 Table 1 with f = 0",
            evidence: Evidence::Derived,
            values: &EIGHT_200,
        },
        CoefficientTable {
            name: "DMSP-20-400N",
            muscle: Some("DMSP-20-400"),
            source: "S2 Table 2 with f = 0",
            evidence: Evidence::Derived,
            values: &as_eight(TABLE_2),
        },
    ],
    notes: &[
        "S3 prints no coefficients and no units. Those of the tables are S2 eq. 16, of which this is the general form: d = 0, f = 0.",
        "Eight coefficients of rank 7: e^d multiplies a and b. A fit keeps d = 0.",
    ],
    form: Form::Eight,
};

const fn at_pressure(name: &'static str, values: &'static [f64; 5]) -> CoefficientTable {
    CoefficientTable {
        name,
        muscle: None,
        source: "S2 Table 1 at that pressure",
        evidence: Evidence::Derived,
        values,
    }
}

/// S2 eq. 16 at one pressure \[bar\], as coefficients of S3 eq. 3.
const fn isobar([a, b, c, d, e, f]: [f64; 6], p: f64) -> [f64; 5] {
    [a * p + b, c, 0.0, d * p, e * p + f]
}

/// S2 eq. 16 as coefficients of S3 eq. 4.
const fn as_eight([a, b, c, d, e, f]: [f64; 6]) -> [f64; 8] {
    [a, b, c, 0.0, d, 0.0, e, f]
}

/// S3 eq. 3: `F = a e^(b kappa + c) + d kappa + e`.
pub(super) fn isobaric<D: Real, const N: usize>(at: LawPoint<D>, coefficients: [D; N]) -> D {
    let kappa = at.percent();
    let [a, b, c, d, e] = std::array::from_fn(|i| coefficients[i]);
    a * (b * kappa + c).exp() + d * kappa + e
}

/// S3 eq. 4: `F = (a p + b) e^(c kappa + d) + (e p + f) kappa + g p + h`.
pub(super) fn eight<D: Real, const N: usize>(at: LawPoint<D>, coefficients: [D; N]) -> D {
    let (p, kappa) = (at.bar(), at.percent());
    let [a, b, c, d, e, f, g, h] = std::array::from_fn(|i| coefficients[i]);
    (a * p + b) * (c * kappa + d).exp() + (e * p + f) * kappa + g * p + h
}

#[cfg(test)]
mod tests {
    use super::super::{LawGeometry, sarosi};
    use super::*;
    use bulge_numerics::Dual;

    const MUSCLE: LawGeometry = LawGeometry { length: 0.2, radius: 0.01, braid_angle: 0.436, fibres: None };

    #[test]
    fn tables_are_the_six_parameters() {
        for percent in [0.0, 3.0, 12.0, 25.0] {
            for (bar, table) in [1.0, 3.0, 5.0].into_iter().zip(ISOBARIC.tables) {
                let at = LawPoint::mean(bar * 1e5, percent / 100.0);
                let six: f64 = sarosi::SIX.force(at, &MUSCLE, &TABLE_1);
                assert!((ISOBARIC.force(at, &MUSCLE, table.values) - six).abs() < 1e-10);
                for table in EIGHT.tables {
                    let six: f64 =
                        sarosi::SIX.force(at, &MUSCLE, sarosi::SIX.table(table.name).unwrap().values);
                    assert!((EIGHT.force(at, &MUSCLE, table.values) - six).abs() < 1e-10);
                }
            }
        }
        assert!(ISOBARIC.table_for("DMSP-20-200N").is_none(), "an isobar is asked for by name");
    }

    /// The terms that are 0 in the tables: c and d multiply the take-up by e^.., and f is a stiffness in N/%.
    #[test]
    fn terms_of_s3_alone() {
        let at = LawPoint::mean(3e5, 0.1);
        let force: f64 = ISOBARIC.force(at, &MUSCLE, &[200.0, -0.3, 0.5, -20.0, 400.0]);
        assert!((force - (200.0 * (-2.5_f64).exp() + 200.0)).abs() < 1e-10);
        let force: f64 = EIGHT.force(at, &MUSCLE, &[10.0, 200.0, -0.3, 0.5, -9.0, -2.0, 300.0, -250.0]);
        assert!((force - (230.0 * (-2.5_f64).exp() - 290.0 + 900.0 - 250.0)).abs() < 1e-10);
    }

    /// dF/dc = a dF/da and dF/dd = a dF/da + b dF/db everywhere, so no data can distinguish them.
    #[test]
    fn one_coefficient_is_redundant() {
        for (p, kappa) in [(1e5, 0.0), (2e5, 0.07), (5e5, 0.2)] {
            let at = LawPoint::mean(Dual::from(p), Dual::from(kappa));
            let five: [Dual<5>; 5] =
                std::array::from_fn(|i| Dual::variable([250.0, -0.3, 0.1, -20.0, 500.0][i], i));
            let gradient = *ISOBARIC.force(at, &MUSCLE, &five).gradient();
            assert!((gradient[2] - 250.0 * gradient[0]).abs() < 1e-10 * gradient[2].abs());

            let at = LawPoint::mean(Dual::from(p), Dual::from(kappa));
            let values = [-4.0, 290.0, -0.33, 0.2, -9.3, -1.0, 294.0, -280.0];
            let eight: [Dual<8>; 8] = std::array::from_fn(|i| Dual::variable(values[i], i));
            let gradient = *EIGHT.force(at, &MUSCLE, &eight).gradient();
            let combined = values[0] * gradient[0] + values[1] * gradient[1];
            assert!((gradient[3] - combined).abs() < 1e-10 * gradient[3].abs());
        }
    }
}
