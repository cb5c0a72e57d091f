//! Residuals that stay large where the model curves: without their second derivatives, steps are too long.

use super::*;

/// Problem 16 of J. J. Moré, B. S. Garbow, K. E. Hillstrom (ACM Trans. Math. Softw. 7 (1981) 17), of Brown and Dennis: twenty
/// residuals of 65 on average, four parameters.
#[test]
fn brown_and_dennis() {
    let problem = model(20, 4, |p, i| {
        let t = (i as f64 + 1.0) / 5.0;
        let (a, b) = (p[0] + p[1] * t - t.exp(), p[2] + p[3] * t.sin() - t.cos());
        Some((a * a + b * b, vec![2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin()]))
    });
    let found = free(&problem, &[25.0, 5.0, -5.0, -1.0]);
    assert!(found.certificate.converged, "{:?}", found.certificate);
    assert!((found.cost - 85_822.201_626_356_3).abs() < 1e-6, "{}", found.cost);
    assert_close(&found.theta, &[-11.594_439_9, 13.203_630_0, -0.403_439_49, 0.236_778_77], 1e-6);
    assert!(found.iterations <= 30, "{} iterations", found.iterations);
}

const MEYER: [f64; 16] = [
    34_780.0, 28_610.0, 23_650.0, 19_630.0, 16_370.0, 13_720.0, 11_540.0, 9744.0, 8261.0, 7030.0, 6005.0,
    5147.0, 4427.0, 3820.0, 3307.0, 2872.0,
];

/// Problem 10, of Meyer: numbers of very different size, and second derivatives that lead astray far from the minimum. The trust
/// region must outlive them.
#[test]
fn second_derivatives_that_lead_astray_are_dropped() {
    let problem = model(16, 3, |p, i| {
        let t = 50.0 + 5.0 * i as f64 + p[2];
        let e = (p[1] / t).exp();
        let by_quotient = p[0] * e;
        Some((by_quotient - MEYER[i], vec![e, by_quotient / t, -by_quotient * p[1] / (t * t)]))
    });
    for start in [[0.02, 4000.0, 250.0], [0.02, 17_200.0, 244.0], [-0.16, 17_200.0, 244.0]] {
        let found = free(&problem, &start);
        assert!(found.certificate.converged, "{start:?}: {:?}", found.certificate);
        assert!((found.cost - 87.945_855_170_9).abs() < 1e-6, "{start:?}: {}", found.cost);
        assert!(
            found.evaluations + found.linearisations < 420,
            "{}",
            found.evaluations + found.linearisations
        );
    }
}
