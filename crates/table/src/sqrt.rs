//! Square root without std: `core` has none on stable Rust.

/// 1/sqrt(x) of a normal positive x, to 2 units in the last place.
///
/// From Lomont's constant (3.4 % off) by a step of fifth and one of third order: with e = 1 - x y^2
///
/// ```text
/// 1/sqrt(x) = y (1 - e)^(-1/2) = y (1 + e/2 + 3 e^2/8 + 5 e^3/16 + 35 e^4/128 + ...)
/// ```
#[inline]
pub(crate) fn reciprocal_root(x: f64) -> f64 {
    let y = f64::from_bits(0x5FE6_EB50_C7B5_37A9 - (x.to_bits() >> 1));
    let e = 1.0 - x * y * y;
    let y = y + y * e * ((0.5 + 0.375 * e) + e * e * (0.3125 + 0.273_437_5 * e));
    let e = 1.0 - x * y * y;
    y + y * e * (0.5 + 0.375 * e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_root_of_std() {
        let mut worst = 0.0_f64;
        for i in 1..400_000_u32 {
            let x = f64::from(i) * 1.7e-6 * 10_f64.powi((i % 17).cast_signed() - 12);
            let exact = 1.0 / x.sqrt();
            worst = worst.max((reciprocal_root(x) / exact - 1.0).abs());
        }
        assert!(worst < 4.5e-16, "{worst:e}");
    }
}
