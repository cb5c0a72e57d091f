//! Digits of numbers: rounded as values, and written for people.

/// Rounds to `digits` significant decimal digits, so that 0.11 m reads "110 mm", not "110.00000000000001 mm".
///
/// ```
/// assert_eq!(bulge_muscles::units::rounded(0.1 + 0.2, 15).to_string(), "0.3");
/// ```
#[must_use]
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// The value with the fewest digits (of a few numbers of digits) that is exact.
pub(crate) fn shortest(value: f64, is_exact: impl Fn(f64) -> bool) -> Option<f64> {
    [3, 6, 9, 12, 15, 16, 17].into_iter().map(|digits| rounded(value, digits)).find(|value| is_exact(*value))
}

/// `digits` significant digits, without an exponent for usual sizes.
#[must_use]
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor();
    if !(-4.0..9.0).contains(&exponent) {
        return format!("{value:.*e}", usize::try_from(digits - 1).unwrap_or(0));
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent between -4 and 9")]
    let decimals = usize::try_from(digits - 1 - exponent as i32).unwrap_or(0);
    let rounded = format!("{value:.decimals$}");
    // "-0.00" says no more than "0.00".
    if rounded.trim_start_matches(['-', '0', '.']).is_empty() {
        return rounded.trim_start_matches('-').to_owned();
    }
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        assert_eq!(significant(1438.0439, 5), "1438.0");
        assert_eq!(significant(0.012_345, 3), "0.0123");
        assert_eq!(significant(-0.0, 3), "-0");
        assert_eq!(significant(1.5e12, 3), "1.50e12");
        assert_eq!(significant(123_456.7, 4), "123457");
    }
}
