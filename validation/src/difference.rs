//! Derivatives by central differences, and orders of convergence: simple tools that need no further
//! verification.

/// First derivative by the central difference of sixth order, for one or more outputs:
/// `(45 d1 - 9 d2 + d3)/(60 h)` with `dk = f(x + k h) - f(x - k h)`. Its error is `h^6 f^(7)/140`.
pub(crate) fn derivative<E, const N: usize>(
    mut f: impl FnMut(f64) -> Result<[f64; N], E>,
    x: f64,
    h: f64,
) -> Result<[f64; N], E> {
    let mut sum = [0.0; N];
    for (k, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        let (up, down) = (f(x + k * h)?, f(x - k * h)?);
        for i in 0..N {
            sum[i] += weight * (up[i] - down[i]) / (60.0 * h);
        }
    }
    Ok(sum)
}

/// Order of an error that falls from `coarse` to `fine` as its cause falls by `factor`.
pub(crate) fn order(coarse: f64, fine: f64, factor: f64) -> f64 {
    (coarse / fine).abs().ln() / factor.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn exact_to_degree_six() {
        let f = |x: f64| Ok::<_, Infallible>([x.powi(6), x.powi(7)]);
        let Ok([six, seven]) = derivative(f, 1.0, 0.1);
        assert!((six - 6.0).abs() < 1e-13);
        // The error of x^7 is 36 h^6.
        assert!((seven - 7.0 - 36e-6).abs() < 1e-12);
        assert!((order(4.0, 1.0, 2.0) - 2.0).abs() < 1e-15);
    }
}
