//! Parses one field of a table as its column requires, or returns why it can't.

use crate::cell_error::{CellError, OTHER_UNIT};
use crate::quote::quoted;

/// A finite number, as it is read or in another spelling of it.
fn number(text: &str) -> Result<f64, CellError> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(CellError::not_finite(quoted(text))),
        Err(_) => unusual(text.trim()),
    }
}

/// The decimal sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decimal {
    Point,
    /// A comma; points separate thousands.
    Comma,
    /// A comma in some columns, a point in others.
    Either,
}

/// A finite number in any spelling that is unambiguous.
pub(crate) fn written(text: &str, decimal: Decimal) -> Result<f64, CellError> {
    match decimal {
        Decimal::Comma if is_in_thousands(text) => number(&text.replace('.', "")),
        Decimal::Comma | Decimal::Either if text.contains(',') && !text.contains('.') => {
            number(&text.replacen(',', ".", 1))
        }
        _ => number(text),
    }
}

/// Whether points are placed as between thousands: 1.234 and 1.234.567, but not 0.234.
pub(crate) fn is_in_thousands(text: &str) -> bool {
    let mut groups = text.trim_start_matches(['+', '-']).split('.');
    let is_number = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let first = groups.next().unwrap_or_default();
    let is_first = (1..=3).contains(&first.len()) && is_number(first) && !first.starts_with('0');
    is_first && text.contains('.') && groups.all(|group| group.len() == 3 && is_number(group))
}

/// Larger numbers can't be measurements; up to this limit no square of a sum overflows.
const LARGEST: f64 = 1e30;

/// Whether a value in SI could have been measured.
pub(crate) fn measurable(value: f64, text: impl Fn() -> String) -> Result<f64, CellError> {
    if !value.is_finite() {
        Err(CellError::not_finite(text()))
    } else if value.abs() > LARGEST {
        Err(CellError::new("larger than anything that is measured", text()))
    } else {
        Ok(value)
    }
}

/// A whole number.
pub(crate) fn whole(text: &str, decimal: Decimal) -> Result<i64, CellError> {
    text.parse::<i64>().or_else(|_| whole_of(written(text, decimal)?, text))
}

/// A whole number written with a decimal point, such as 3.0.
pub(crate) fn whole_of(value: f64, text: &str) -> Result<i64, CellError> {
    /// Whole numbers up to here are exact in a double.
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() <= LARGEST {
        #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
        return Ok(value as i64);
    }
    Err(CellError::new("not a whole number", quoted(text)))
}

/// A direction: +1 shortening, -1 lengthening, 0 at rest.
pub(crate) fn direction(text: &str) -> Result<i8, CellError> {
    let is_one_of = |words: &[&str]| words.iter().any(|word| text.eq_ignore_ascii_case(word));
    if text.is_empty() {
        Err(CellError::empty())
    } else if is_one_of(&["up", "shortening", "contracting"]) {
        Ok(1)
    } else if is_one_of(&["down", "lengthening", "extending"]) {
        Ok(-1)
    } else if is_one_of(&["rest", "hold"]) {
        Ok(0)
    } else {
        text.parse().ok().and_then(sign).ok_or_else(|| CellError::not_a_direction(quoted(text)))
    }
}

/// A direction written as a number.
pub(crate) fn sign(value: f64) -> Option<i8> {
    [-1_i8, 0, 1].into_iter().find(|sign| (f64::from(*sign) - value).abs() == 0.0)
}

/// The number in another spelling, or why the text isn't a number.
#[cold]
fn unusual(text: &str) -> Result<f64, CellError> {
    let kind = if text.is_empty() {
        return Err(CellError::empty());
    } else if text.matches(',').count() == 1 && text.replacen(',', ".", 1).parse::<f64>().is_ok() {
        "a decimal comma among points"
    } else if let Some(number) = respelt(text) {
        return Ok(number);
    } else if text.split_once('#').is_some_and(|(before, _)| before.trim_end().parse::<f64>().is_ok()) {
        // A number with a comment behind it.
        "not a number"
    } else if with_unit(text).is_some() {
        OTHER_UNIT
    } else if crate::clock::instant(text).is_some() {
        "a time of day among numbers"
    } else {
        "not a number"
    };
    Err(CellError::new(kind, quoted(text)))
}

/// The number and the unit of a field that has both.
pub(crate) fn with_unit(text: &str) -> Option<(f64, &str)> {
    // The longest prefix that is a number; numbers are short.
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8()).take(40);
    let number = |end: usize| text[..end].trim_end().parse::<f64>().ok().filter(|number| number.is_finite());
    let (end, number) = ends.filter_map(|end| Some((end, number(end)?))).last()?;
    let unit = text[end..].trim_start();
    // 0x1F isn't a number with the unit x.
    let is_unit = unit.starts_with(|c: char| (c.is_alphabetic() && c != 'x') || "%\u{b0}".contains(c));
    is_unit.then_some((number, unit))
}

/// The number, read without separators between thousands, with a decimal point, a plain minus and an `e`.
fn respelt(text: &str) -> Option<f64> {
    let separators = [' ', '\'', '\u{a0}', '\u{2009}', '\u{2019}', '\u{202f}', ',', '.'];
    let text = text.replace(['\u{2212}', '\u{2013}'], "-").replace(['D', 'd'], "e");
    // The last point or comma is the decimal sign, unless it occurs twice.
    let decimal = text.rfind(['.', ',']).filter(|at| text.matches(&text[*at..=*at]).count() == 1);
    let (whole, rest) = text.split_at(decimal.unwrap_or(text.len()));
    let mut groups = whole.split(separators);
    let mut fixed = groups.next()?.to_owned();
    for group in groups {
        if group.len() != 3 || !group.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        fixed.push_str(group);
    }
    fixed.push_str(&rest.replacen(',', ".", 1));
    fixed.parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        for (text, value) in [("1", 1.0), ("-2.5e3", -2500.0), ("+.5", 0.5), ("1E-3", 1e-3)] {
            assert_eq!(number(text), Ok(value));
        }
        let whole = |text| whole(text, Decimal::Point);
        assert_eq!(whole("7"), Ok(7));
        assert_eq!(whole("-3.0"), Ok(-3));
        for text in ["3.5", "1e300"] {
            assert_eq!(whole(text), Err(CellError::new("not a whole number", text)));
        }
    }

    #[test]
    fn numbers_as_people_write_them() {
        for (text, decimal, value) in [
            ("1 000", Decimal::Point, 1000.0),
            ("1,234.5", Decimal::Point, 1234.5),
            ("1.234,5", Decimal::Point, 1234.5),
            ("1'234'567,5", Decimal::Point, 1_234_567.5),
            ("1,234,567", Decimal::Point, 1_234_567.0),
            ("\u{2212}5", Decimal::Point, -5.0),
            ("1.5D3", Decimal::Point, 1500.0),
            ("1,5", Decimal::Comma, 1.5),
            ("-0,25e-3", Decimal::Comma, -0.25e-3),
            ("1.234", Decimal::Comma, 1234.0),
            ("1.234.567", Decimal::Comma, 1_234_567.0),
            ("1.234,5", Decimal::Comma, 1234.5),
            ("0.234", Decimal::Comma, 0.234),
            ("1.234", Decimal::Either, 1.234),
            ("1,234", Decimal::Either, 1.234),
        ] {
            assert_eq!(written(text, decimal), Ok(value), "{text}");
        }
    }

    #[test]
    fn no_numbers_and_why() {
        for (kind, texts) in [
            ("empty", &[""][..]),
            ("not a finite number", &["nan", "-inf", "1e999"]),
            ("a decimal comma among points", &["1,5", "-0,25", "1,234"]),
            (OTHER_UNIT, &["2 bar", "20%", "1.5e1N"]),
            ("a time of day among numbers", &["12:00:01.5", "2026-03-01 12:00"]),
            ("not a number", &["10 # slip", "0x1F", "1 2", "abc", "#N/A", "1.2.3", "\u{1f600}"]),
        ] {
            for text in texts {
                assert_eq!(written(text, Decimal::Point), Err(CellError::new(kind, *text)));
            }
        }
    }

    #[test]
    fn directions() {
        for (text, sign) in [
            ("up", 1),
            ("Shortening", 1),
            ("contracting", 1),
            ("+1", 1),
            ("1.0", 1),
            ("DOWN", -1),
            ("lengthening", -1),
            ("extending", -1),
            ("-1", -1),
            ("0", 0),
            ("rest", 0),
        ] {
            assert_eq!(direction(text), Ok(sign), "{text}");
        }
        assert_eq!(direction("2"), Err(CellError::not_a_direction("2".to_owned())));
        assert_eq!(direction(""), Err(CellError::empty()));
    }
}
