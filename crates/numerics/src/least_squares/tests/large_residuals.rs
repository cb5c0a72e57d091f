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
