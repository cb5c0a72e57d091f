//! Numbers with a unit of whatever dimension: "4 N s", "0.2", "1 N +- 0.2 N", "1e-3 1/K".

use crate::any_unit_error::AnyUnitError;
use crate::digits::shortest;
use crate::dimension::Dimension;
use crate::quantity::{Ratio, in_unit, to_si};
use crate::unit_expression::{normalised, unit};
use crate::units::{Quantity, is_not_finite, number_length, shortened};

/// A number with its unit, of whatever dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Any {
    /// The value in SI units.
    pub si: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit as it was written, with µ as u, ° as deg and ² as ^2; empty for a pure number.
    pub unit: String,
}

/// Reads a number with a unit of any dimension, such as "4 N s", "0.2" or "1e-3 1/K".
///
/// ```
/// use bulge_muscles::units;
/// let drag = units::any("4 N s/mm")?;
/// assert_eq!((drag.si, drag.dimension.to_string(), drag.unit), (4000.0, "N s/m".to_owned(), "N s/mm".to_owned()));
/// # Ok::<(), units::AnyUnitError>(())
/// ```
///
/// # Errors
/// If the text is not a finite number with such a unit, see [`unit()`].
pub fn any(text: &str) -> Result<Any, AnyUnitError> {
    let (number, unit) = split(text)?;
    in_any(text, number, unit)
}

/// Reads a value with an optional width (one standard deviation): "1 N +- 0.2 N", "50 ± 30 N", "1 N s +- 5 %".
///
/// A percentage is relative to the value, except where the value is itself a ratio: then it is absolute. `+- 0`, with or
/// without a unit, says that the value is exact.
///
/// # Errors
/// If either part is not a number with a unit, their dimensions differ, or the width is negative.
pub fn any_with_width(text: &str) -> Result<(Any, Option<f64>), AnyUnitError> {
    let Some((value_text, width_text)) =
        ["+-", "+/-", "\u{b1}"].iter().find_map(|sign| text.split_once(sign))
    else {
        return Ok((any(text)?, None));
    };
    let (value_number, value_unit) = split(value_text)?;
    let (width_number, width_unit) = split(width_text)?;
    if width_number == 0.0 && width_unit.is_empty() {
        return Ok((in_any(value_text, value_number, value_unit)?, Some(0.0)));
    }
    let is_ratio = |unit: &str| {
        normalised(unit)
            .is_ok_and(|unit| !unit.is_empty() && Ratio::UNITS.iter().any(|(symbol, _)| *symbol == unit))
    };
    let is_relative = is_ratio(width_unit) && !value_unit.is_empty() && !is_ratio(value_unit);
    // "50 +- 30 N": one unit for both.
    let value =
        in_any(value_text, value_number, if value_unit.is_empty() { width_unit } else { value_unit })?;
    let stated = in_any(width_text, width_number, width_unit)?;
    if !is_relative && stated.dimension != value.dimension {
        let (found, wanted) = (stated.dimension.describe(), value.dimension.describe());
        return Err(AnyUnitError::OtherDimension { text: shortened(text), found, wanted });
    }
    let width = if is_relative { value.si.abs() * stated.si } else { stated.si };
    if width >= 0.0 && width.is_finite() {
        Ok((value, Some(width.abs())))
    } else {
        Err(AnyUnitError::NegativeWidth { text: shortened(text), width })
    }
}

/// Writes an SI value in a unit so that [`any`] gives back exactly the same number, with as few digits as that takes;
/// where the unit cannot do that, in SI units; as a pure number if the unit is none that [`unit()`] reads.
///
/// ```
/// use bulge_muscles::units;
/// assert_eq!(units::exact_any_text(4000.0, "N s/mm"), "4 N s/mm");
/// assert_eq!(units::exact_any_text(0.25, "%"), "25 %");
/// ```
#[must_use]
pub fn exact_any_text(si: f64, unit: &str) -> String {
    let Ok((factor, dimension)) = crate::unit_expression::unit(unit) else { return plain_number(si) };
    let shown = in_unit(si, factor);
    let (number, unit) = match shortest(shown, |value| to_si(value, factor).to_bits() == si.to_bits()) {
        Some(value) => {
            (plain_number(value), if is_pure(unit) { String::new() } else { unit.trim().to_owned() })
        }
        None => (plain_number(si), if dimension.is_none() { String::new() } else { dimension.to_string() }),
    };
    format!("{number} {unit}").trim_end().to_owned()
}

fn is_pure(unit: &str) -> bool {
    matches!(unit.trim(), "" | "1" | "-")
}

/// A double as people write it, and with an exponent where that would take many zeros.
fn plain_number(value: f64) -> String {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

/// Splits "4 N s" into the number and the unit, which may be empty.
fn split(text: &str) -> Result<(f64, &str), AnyUnitError> {
    let body = text.trim();
    if body.is_empty() {
        return Err(AnyUnitError::Empty);
    }
    let (is_minus, unsigned) = match body.strip_prefix('\u{2212}') {
        Some(rest) if !rest.starts_with(['+', '-']) => (true, rest),
        _ => (false, body),
    };
    let (number, rest) = unsigned.split_at(number_length(unsigned));
    let Ok(value) = number.parse::<f64>() else {
        let text = shortened(text);
        return Err(if is_not_finite(unsigned) {
            AnyUnitError::NotFinite { text }
        } else {
            AnyUnitError::NotANumber { text }
        });
    };
    let rest = rest.trim_start();
    if rest.strip_prefix(',').is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_digit())) {
        let fixed = shortened(&body.replacen(',', ".", 1));
        return Err(AnyUnitError::DecimalComma { text: shortened(text), fixed });
    }
    Ok((if is_minus { -value } else { value }, rest))
}

fn in_any(text: &str, number: f64, unit_text: &str) -> Result<Any, AnyUnitError> {
    let (factor, dimension) = unit(unit_text)?;
    let si = to_si(number, factor);
    if !si.is_finite() {
        return Err(AnyUnitError::NotFinite { text: shortened(text) });
    }
    let unit = if is_pure(unit_text) { String::new() } else { normalised(unit_text)? };
    Ok(Any { si, dimension, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn refuses<T: std::fmt::Debug>(found: Result<T, AnyUnitError>, parts: &[&str]) {
        let message = found.unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[test]
    fn numbers_with_units() {
        let read = |text| any(text).map(|any| (any.si, any.dimension.to_string(), any.unit));
        for (text, si, dimension, unit) in [
            ("4 N s", 4.0, "N s", "N s"),
            ("4N s", 4.0, "N s", "N s"),
            ("0.2", 0.2, "1", ""),
            ("0.2 1", 0.2, "1", ""),
            ("20 %", 0.2, "1", "%"),
            ("\u{2212}3 \u{b5}m", -3e-6, "m", "um"),
            ("1e-3 1/K", 1e-3, "1/K", "1/K"),
            ("+2 mm\u{b2}", 2e-6, "m^2", "mm^2"),
            ("5 ms", 5e-3, "s", "ms"),
        ] {
            assert_eq!(read(text), Ok((si, dimension.to_owned(), unit.to_owned())), "{text}");
        }
        refuses(any(""), &["no number is given", "\"4 N s\""]);
        refuses(any("N s"), &["does not begin with a number"]);
        refuses(any("\u{2212}-3 N"), &["does not begin with a number"]);
        refuses(any("1,5 N"), &["comma", "\"1.5 N\""]);
        refuses(any("1e400 N"), &["not a finite number"]);
        refuses(any("1e305 MPa"), &["not a finite number"]);
        refuses(any("nan"), &["not a finite number"]);
        refuses(any("20 degC"), &["293.15 K"]);
        refuses(any("3 Nm"), &["unknown unit `Nm`"]);
    }

    #[test]
    fn values_with_widths() {
        let read = |text| any_with_width(text).map(|(any, width)| (any.si, width));
        for (text, value, width) in [
            ("1 N", 1.0, None),
            ("1 N +- 0.2 N", 1.0, Some(0.2)),
            ("1 kN \u{b1} 200 N", 1e3, Some(200.0)),
            ("50 +/- 30 N s", 50.0, Some(30.0)),
            ("-2 N s +- 5 %", -2.0, Some(0.1)),
            ("20 deg +- 10 %", 20.0 * std::f64::consts::PI / 180.0, Some(2.0 * std::f64::consts::PI / 180.0)),
            ("20 % +- 1 %", 0.2, Some(0.01)),
            ("20 +- 1 %", 0.2, Some(0.01)),
            ("0.2 +- 0.1", 0.2, Some(0.1)),
        ] {
            let (found, found_width) = read(text).unwrap();
            let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
            assert!(near(found, value), "{text}: {found}");
            assert_eq!(found_width.is_some(), width.is_some(), "{text}");
            assert!(near(found_width.unwrap_or(1.0), width.unwrap_or(1.0)), "{text}: {found_width:?}");
        }
        refuses(any_with_width("1 N +- 0.2 bar"), &["is a pressure (Pa)", "the value is a force (N)"]);
        refuses(any_with_width("1 N +- 0.2"), &["a pure number"]);
        for text in ["1 N +- 0 N", "1 N +- 0", "1 N +- 0 %"] {
            assert_eq!(read(text), Ok((1.0, Some(0.0))), "{text}");
        }
        refuses(any_with_width("1 N +- -1 N"), &["can't be negative"]);
        refuses(any_with_width("1 N +- "), &["no number"]);
        refuses(any_with_width("+- 1 N"), &["no number"]);
    }

    #[test]
    fn exact_text_is_read_back_bit_for_bit() {
        for (si, unit, text) in [
            (0.11, "mm", "110 mm"),
            (50.0, "N", "50 N"),
            (0.25, "", "0.25"),
            (0.25, "1", "0.25"),
            (-1e-6, "N s/MPa", "-1 N s/MPa"),
            (0.0, "N", "0 N"),
            (1e300, "Pa", "1e300 Pa"),
            (3.0, "no unit", "3"),
        ] {
            assert_eq!(exact_any_text(si, unit), text);
        }
        let mut state = 7_u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let si = f64::from_bits(state ^ (state >> 17));
            if !si.is_finite() {
                continue;
            }
            for unit in ["", "mm", "deg", "%", "psi", "N s/MPa", "1/(K min)", "lbf^0.5", "decade"] {
                let text = exact_any_text(si, unit);
                let back = any(&text).unwrap();
                assert_eq!(back.si.to_bits(), si.to_bits(), "{text}");
                assert_eq!(
                    Ok(back.dimension),
                    crate::units::unit(unit).map(|(_, dimension)| dimension),
                    "{text}"
                );
            }
        }
    }

    #[test]
    fn no_text_panics() {
        let pieces = [
            "1",
            "e",
            "-",
            "+",
            ".",
            ",",
            " ",
            "mm",
            "N",
            "\u{b5}",
            "\u{b1}",
            "/",
            "^",
            "2",
            "(",
            ")",
            "%",
            "nan",
            "\u{0}",
            "\u{1f600}",
            "\u{207b}",
            "\u{b0}",
            "degC",
            "*",
        ];
        let mut state = 1_usize;
        for _ in 0..50_000 {
            let mut text = String::new();
            for _ in 0..8 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                text.push_str(pieces[(state >> 33) % pieces.len()]);
            }
            let _ = (any_with_width(&text), crate::units::unit(&text));
            if let Ok(found) = any(&text) {
                assert_eq!(
                    any(&exact_any_text(found.si, &found.unit)).map(|back| back.si),
                    Ok(found.si),
                    "{text}"
                );
            }
        }
    }
}
