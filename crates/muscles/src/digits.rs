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

/// From this size on, digits before the point say less than an exponent.
const USUAL: f64 = 1e12;

/// As many decimals as asked for, else the shortest form; with an exponent where these would say nothing: from 1e12 on, or where all
/// decimals would be zero.
pub(crate) fn plain(value: f64, decimals: Option<usize>) -> String {
    let is_large = value.is_finite() && value.abs() >= USUAL;
    let Some(decimals) = decimals else {
        return if is_large { format!("{value:e}") } else { format!("{value}") };
    };
    let fixed = format!("{value:.decimals$}");
    let is_lost = value.abs() > 0.0 && fixed.trim_matches(['-', '0', '.']).is_empty();
    if is_large || is_lost { format!("{value:.decimals$e}") } else { fixed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_say_something() {
        for (value, shown) in [
            (0.0, "0.0000"),
            (2.5, "2.5000"),
            (-3e11, "-300000000000.0000"),
            (f64::INFINITY, "inf"),
            (5.1e-5, "0.0001"),
            (4.9e-5, "4.9000e-5"),
            (1e-300, "1.0000e-300"),
            (1e12, "1.0000e12"),
            (-1e290, "-1.0000e290"),
        ] {
            assert_eq!(plain(value, Some(4)), shown);
        }
        assert_eq!([plain(2.5, None), plain(1e290, None)], ["2.5", "1e290"]);
    }

    #[test]
    fn significant_digits() {
        assert_eq!(significant(1438.0439, 5), "1438.0");
        assert_eq!(significant(0.012_345, 3), "0.0123");
        assert_eq!(significant(-0.0, 3), "-0");
        assert_eq!(significant(1.5e12, 3), "1.50e12");
        assert_eq!(significant(123_456.7, 4), "123457");
    }
}
