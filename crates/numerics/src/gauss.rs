//! Gauss-Legendre quadrature on the unit interval.

/// Nodes and weights of six points on \[0, 1\]: exact for polynomials of degree 11
/// (M. Abramowitz, I. Stegun, *Handbook of Mathematical Functions*, table 25.4, mapped from \[-1, 1\]).
pub const SIX: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_54, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// Integral of `f` from 0 to 1.
pub fn integrate(f: impl Fn(f64) -> f64) -> f64 {
    SIX.iter().map(|(x, w)| w * f(*x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_to_degree_eleven_and_no_further() {
        for degree in 0..=11 {
            let error = integrate(|x| x.powi(degree)) - 1.0 / f64::from(degree + 1);
            assert!(error.abs() < 1e-15, "degree {degree}: {error:e}");
        }
        assert!((integrate(|x| x.powi(12)) - 1.0 / 13.0).abs() > 1e-9);
    }
}
