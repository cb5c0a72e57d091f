//! Square root without std: `core` has none on stable Rust.

/// 1/sqrt(x) of a normal positive x, to 2 units in the last place; an arbitrary number for any other x.
///
/// It starts from Lomont's constant (relative error 3.4 %). A cubic in z = x y^2, the best approximation of
/// 1/sqrt(z) over the z that occur, brings the error to 7.5e-7. A step of third order follows: with e = 1 - x
/// y^2
///
/// ```text
/// 1/sqrt(x) = y (1 - e)^(-1/2) = y (1 + e/2 + 3 e^2/8 + ...)
/// ```
#[inline]
pub(crate) fn reciprocal_root(x: f64) -> f64 {
    let y = f64::from_bits(0x5FE6_EB50_C7B5_37A9_u64.wrapping_sub(x.to_bits() >> 1));
    let z = x * y * y;
    let y = y * ((2.189_332_75 - 2.191_720_62 * z) + z * z * (1.315_441_19 - 0.313_054_06 * z));
    let e = 1.0 - x * y * y;
    y + (y * e) * (0.5 + 0.375 * e)
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
