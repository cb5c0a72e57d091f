//! Number of decimals that show an interval.

/// A value and the ends of its interval, with as many decimals as two digits of the width need, so that the
/// interval is visible in the printed numbers; `None` if no such number of decimals exists.
///
/// ```
/// let shown = bulge_report::with_interval(0.310_14, [0.309_81, 0.310_46]);
/// assert_eq!(shown, Some(["0.31014", "0.30981", "0.31046"].map(String::from)));
/// assert_eq!(bulge_report::with_interval(1.0, [1.0, 1.0]), None);
/// ```
#[must_use]
pub fn with_interval(value: f64, [low, high]: [f64; 2]) -> Option<[String; 3]> {
    let width = high - low;
    let decimals = 1.0 - width.log10().floor();
    // Also rejects a width that is zero, negative or NaN.
    if !(-1.0..=9.0).contains(&decimals) || !value.is_finite() {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
    let decimals = decimals.max(0.0) as usize;
    // Adding 0 removes the sign of -0.
    Some([value, low, high].map(|x| format!("{:.decimals$}", x + 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_of_the_width_are_seen() {
        for (value, ends, shown) in [
            (14.02, [13.8, 14.24], ["14.02", "13.80", "14.24"]),
            (-1234.0, [-1500.0, -900.0], ["-1234", "-1500", "-900"]),
            (0.0, [-0.5, 0.5], ["0.0", "-0.5", "0.5"]),
        ] {
            assert_eq!(with_interval(value, ends), Some(shown.map(String::from)));
        }
        assert_eq!(with_interval(1.0, [f64::NEG_INFINITY, 2.0]), None);
        assert_eq!(with_interval(1e12, [0.0, 1e12]), None);
        assert_eq!(with_interval(1.0, [2.0, 1.0]), None);
    }
}
