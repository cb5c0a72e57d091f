//! Floating-point numbers as hexadecimal literals, which C reads exactly.

/// A double: `-0x1.8p-1` is -0.75.
pub(super) fn double(x: f64) -> String {
    let bits = x.to_bits();
    let sign = if x.is_sign_negative() { "-" } else { "" };
    let (exponent, fraction) = ((bits >> 52) & 0x7FF, bits & ((1 << 52) - 1));
    if exponent == 0 && fraction == 0 {
        return format!("{sign}0.0");
    }
    // Subnormal numbers have the leading digit 0.
    let (lead, power) = if exponent == 0 { (0, -1022) } else { (1, exponent.cast_signed() - 1023) };
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x{lead}{point}{digits}p{power:+}")
}

/// A float; `x` must be representable as one.
pub(super) fn single(x: f64) -> String {
    format!("{}f", double(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_and_powers() {
        for (x, wanted) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "0x1p+0"),
            (-0.75, "-0x1.8p-1"),
            (0.1, "0x1.999999999999ap-4"),
            (f64::MAX, "0x1.fffffffffffffp+1023"),
            (f64::MIN_POSITIVE, "0x1p-1022"),
            (5e-324, "0x0.0000000000001p-1022"),
        ] {
            assert_eq!(double(x), wanted);
        }
        assert_eq!(single(f64::from(0.1_f32)), "0x1.99999ap-4f");
    }
}
