//! Formatting of numbers: three significant digits, a true minus sign, pressure in bar, contraction in per
//! cent.

/// Three significant digits.
///
/// Beyond 10^6 and below 10^-4 the number is a power of ten. A value that isn't finite is `unbounded`.
pub(crate) fn three(value: f64) -> String {
    if !value.is_finite() {
        return "unbounded".to_owned();
    }
    // Rounding comes first, since 999.7 becomes 1000 with another leading digit.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        return "0".to_owned();
    }
    let size = rounded.abs();
    let text = if (1e-4..1e6).contains(&size) {
        // 12340 has one digit before 10^4, 0.0123 has its first at 10^-2.
        let decimals = (0..9).find(|d| size * 10_f64.powi(*d) >= 100.0 * (1.0 - 1e-12));
        format!("{size:.*}", usize::try_from(decimals.unwrap_or(0)).unwrap_or(0))
    } else {
        let text = format!("{size:.2e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{mantissa} × 10{}", raised(exponent))
    };
    if rounded < 0.0 { format!("−{text}") } else { text }
}

/// A fraction of variance: four decimals near 1, where three digits say nothing.
pub(crate) fn share(value: f64) -> String {
    if (0.99..1.0).contains(&value) { format!("{value:.4}") } else { three(value) }
}

/// A whole number as an exponent.
fn raised(exponent: &str) -> String {
    exponent
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            // The superscripts of 0 and 4 to 9 have consecutive code points.
            c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
        })
        .collect()
}

/// A force: `12.3 N`.
pub(crate) fn newton(force_n: f64) -> String {
    format!("{} N", three(force_n))
}

/// A force with its sign: `+12.3 N`.
pub(crate) fn signed_newton(force_n: f64) -> String {
    let text = newton(force_n);
    if text.starts_with(['−', '0', 'u']) { text } else { format!("+{text}") }
}

/// A pressure in bar: three digits without trailing zeros, as on a gauge.
pub(crate) fn bar(pressure_pa: f64) -> String {
    format!("{} bar", level(pressure_pa / 1e5))
}

/// A contraction: `12.5 %`.
pub(crate) fn percent(share: f64) -> String {
    format!("{} %", level(100.0 * share))
}

/// Three digits without trailing zeros.
pub(crate) fn level(value: f64) -> String {
    let text = three(value);
    let (digits, power) = text.split_once(' ').map_or((text.as_str(), None), |(d, p)| (d, Some(p)));
    let digits =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
    power.map_or_else(|| digits.to_owned(), |power| format!("{digits} {power}"))
}

/// Labels of evenly spaced values, with the fewest decimals that round each by at most a twentieth of the
/// smallest spacing.
pub(crate) fn ticks(values: &[f64]) -> Vec<String> {
    let gaps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let gap = gaps.filter(|gap| *gap > 0.0).fold(f64::INFINITY, f64::min);
    let shown = |decimals: usize| -> Vec<String> {
        values.iter().map(|value| format!("{:.decimals$}", value + 0.0)).collect()
    };
    let is_near = |decimals: &usize| {
        shown(*decimals).iter().zip(values).all(|(text, value)| {
            text.parse::<f64>().is_ok_and(|rounded| (rounded - value).abs() <= 0.05 * gap)
        })
    };
    match (0..5).find(is_near).filter(|_| gap.is_finite() && values.iter().all(|v| v.abs() < 1e6)) {
        Some(decimals) => shown(decimals).into_iter().map(|text| text.replace('-', "−")).collect(),
        None => values.iter().copied().map(level).collect(),
    }
}

/// `1 row`, `2 rows`.
pub(crate) fn count(number: usize, one: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {one}s") }
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn and(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_at_any_size() {
        let shown =
            [0.0, -0.0, 1.0, 12.345, -38.16, 0.012_34, 999.7, 12_345.0, 7e-12, -2.5e9, 0.999_96].map(three);
        let hoped = [
            "0",
            "0",
            "1.00",
            "12.3",
            "−38.2",
            "0.0123",
            "1000",
            "12300",
            "7.00 × 10⁻¹²",
            "−2.50 × 10⁹",
            "1.00",
        ];
        assert_eq!(shown, hoped);
        assert_eq!([0.5, 0.998_76, 1.0, -3.0].map(share), ["0.500", "0.9988", "1.00", "−3.00"]);
        assert_eq!(three(f64::INFINITY), "unbounded");
    }

    #[test]
    fn levels_have_no_trailing_zeros() {
        assert_eq!([1e5, 2.5e5, 12_500.0, 0.0].map(bar), ["1 bar", "2.5 bar", "0.125 bar", "0 bar"]);
        assert_eq!([0.1, 0.125, -0.02].map(percent), ["10 %", "12.5 %", "−2 %"]);
    }

    #[test]
    fn ticks_have_equally_many_decimals() {
        assert_eq!(ticks(&[1.75, 4.25, 6.75, 11.75]), ["1.8", "4.2", "6.8", "11.8"]);
        assert_eq!(ticks(&[-8.99, 26.97, 44.95]), ["−9", "27", "45"]);
        assert_eq!(ticks(&[0.0, 2e7]), ["0", "2 × 10⁷"]);
        assert_eq!(ticks(&[12.34]), ["12.3"]);
        assert_eq!(ticks(&[]), [""; 0]);
    }

    #[test]
    fn signs_counts_and_lists() {
        assert_eq!([3.0, -3.0, 0.0].map(signed_newton), ["+3.00 N", "−3.00 N", "0 N"]);
        assert_eq!([count(1, "row"), count(0, "row")], ["1 row", "0 rows"]);
        let words = ["a".to_owned(), "b".to_owned(), "c".to_owned()];
        assert_eq!([and(&words), and(&words[..2]), and(&words[..1])], ["a, b and c", "a and b", "a"]);
    }
}
