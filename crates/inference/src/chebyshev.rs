//! Chebyshev polynomials of the first kind.

/// T_degree(x) by the recurrence T_(n+1) = 2 x T_n - T_(n-1).
pub(crate) fn chebyshev(degree: usize, x: f64) -> f64 {
    let (mut before, mut now) = (1.0, x);
    if degree == 0 {
        return before;
    }
    for _ in 1..degree {
        (before, now) = (now, 2.0 * x * now - before);
    }
    now
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_cosines_of_multiples() {
        for degree in 0..9 {
            for angle in [0.1_f64, 0.7, 1.9, 3.0] {
                let exact = (degree as f64 * angle).cos();
                assert!((chebyshev(degree, angle.cos()) - exact).abs() < 1e-12);
            }
        }
    }
}
