//! Units of any dimension in text: "N s/Pa", "1/K", "mm^2", "N/(m s)".

use crate::dimension::Dimension;
use crate::quantity::in_unit;
use crate::shown::shortened;
use crate::unit_error::{UnitError, Wanted};
use crate::unit_table::{nearest, normalised, symbols};

/// The longest unit that is read, in bytes.
pub(crate) const MAX_UNIT: usize = 64;
/// The largest power of one unit, and of one pair of parentheses.
pub(crate) const MAX_POWER: f64 = 12.0;

/// Temperature scales with an offset.
const OFFSET: &[&str] = &["degC", "degF", "celsius", "fahrenheit"];

/// Reads a unit of any dimension, such as "N s/Pa", "1/K", "mm^2" or "N/(m s)": its size in SI units and its
/// dimension.
///
/// Products are written with a blank, `*` or `.`, quotients with `/`, powers with `^` and a whole number (or
/// one and a half, as in `m^1.5`). Nothing, "1" and "-" mean a pure number. The divisor behind a `/` ends at
/// the next `/`: a product there needs parentheses. Symbols are those of the quantities of this crate and s,
/// ms, us, min, h, K, kg, g, J, Hz and decade.
///
/// ```
/// use bulge_muscles::{Dimension, units};
/// assert_eq!(units::unit("N/mm^2"), Ok((1e6, Dimension::PRESSURE)));
/// assert!(units::unit("J/kg K").is_err());
/// ```
///
/// # Errors
/// If the text has more than 64 bytes or is no such unit; a temperature scale with an offset (degC) is
/// refused.
pub fn unit(text: &str) -> Result<(f64, Dimension), UnitError> {
    let length = text.trim().len();
    if length > MAX_UNIT {
        return Err(UnitError::TooLong { text: shortened(text), length });
    }
    let plain = normalised(text);
    if matches!(plain.as_str(), "" | "-") {
        return Ok((1.0, Dimension::NONE));
    }
    let mut reader = Reader { text: &plain, at: 0 };
    let size = reader.product()?;
    if reader.at < plain.len() {
        return Err(reader.lacks("an opening parenthesis"));
    }
    let factor = size.above / size.below;
    if factor.is_normal() { Ok((factor, size.dimension)) } else { Err(reader.too_large()) }
}

/// A unit as a fraction, so that decimal units stay exact: mm^2 is 1/1000000, not 0.001 * 0.001.
#[derive(Debug, Clone, Copy)]
struct Size {
    above: f64,
    below: f64,
    dimension: Dimension,
}

impl Size {
    const ONE: Self = Self { above: 1.0, below: 1.0, dimension: Dimension::NONE };

    fn of(factor: f64, dimension: Dimension) -> Self {
        let inverse = in_unit(1.0, factor);
        if inverse > 1.0 && inverse.fract() == 0.0 {
            Self { above: 1.0, below: inverse, dimension }
        } else {
            Self { above: factor, below: 1.0, dimension }
        }
    }

    fn times(self, other: Self) -> Option<Self> {
        let dimension = self.dimension.times(other.dimension)?;
        Some(Self { above: self.above * other.above, below: self.below * other.below, dimension })
    }

    fn power(self, exponent: f64) -> Option<Self> {
        let dimension = self.dimension.power(exponent)?;
        let magnitude = exponent.abs();
        let (above, below) = (raise(self.above, magnitude), raise(self.below, magnitude));
        let (above, below) = if exponent < 0.0 { (below, above) } else { (above, below) };
        Some(Self { above, below, dimension })
    }
}

/// A power with a multiple of 1/2 as exponent. Whole numbers stay whole.
fn raise(value: f64, exponent: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "at most MAX_POWER")]
    let whole = value.powi(exponent.trunc() as i32);
    if exponent.fract() == 0.0 { whole } else { whole * value.sqrt() }
}

/// Recursive descent over at most 64 bytes, so it is never deep.
struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl Reader<'_> {
    /// Factors with blanks, `*`, `.` or `/` between them, up to a closing parenthesis or the end.
    fn product(&mut self) -> Result<Size, UnitError> {
        let mut size = self.factor()?;
        let mut is_divided = false;
        loop {
            self.blanks();
            let (exponent, is_ended) = match self.peek() {
                None | Some(')') => (1.0, true),
                Some('/') => (-1.0, false),
                Some(_) => (1.0, false),
            };
            if is_ended {
                return Ok(size);
            }
            if exponent > 0.0 && is_divided {
                return Err(UnitError::Ambiguous { text: shortened(self.text) });
            }
            is_divided |= exponent < 0.0;
            if self.peek().is_some_and(|c| matches!(c, '/' | '*' | '.')) {
                self.at += 1;
            }
            let factor = self.factor()?;
            let raised = factor.power(exponent).and_then(|factor| size.times(factor));
            size = raised.ok_or_else(|| self.too_large())?;
        }
    }

    /// A symbol, a 1 or a product in parentheses, with its power.
    fn factor(&mut self) -> Result<Size, UnitError> {
        self.blanks();
        let size = match self.peek() {
            Some('(') => {
                self.at += 1;
                let inner = self.product()?;
                if self.peek() != Some(')') {
                    return Err(self.lacks("a closing parenthesis"));
                }
                self.at += 1;
                inner
            }
            Some('1') if !self.text[self.at + 1..].starts_with(|c: char| c.is_alphanumeric() || c == '.') => {
                self.at += 1;
                Size::ONE
            }
            Some(c) if c.is_alphanumeric() || c == '%' => self.symbol()?,
            Some('^') => return Err(self.lacks("a unit before `^`")),
            _ => return Err(self.lacks("a unit between its operators")),
        };
        self.blanks();
        if self.peek() != Some('^') {
            return Ok(size);
        }
        self.at += 1;
        let exponent = self.exponent()?;
        size.power(exponent).ok_or_else(|| self.too_large())
    }

    fn symbol(&mut self) -> Result<Size, UnitError> {
        let rest = &self.text[self.at..];
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with('%') { 1 } else { rest.find(|c| !is_part(c)).unwrap_or(rest.len()) };
        let symbol = &rest[..length];
        self.at += length;
        if let Some((_, factor, dimension)) = symbols().find(|(known, ..)| *known == symbol) {
            return Ok(Size::of(factor, dimension));
        }
        let (text, unit) = (shortened(self.text), shortened(symbol));
        if OFFSET.iter().any(|scale| scale.eq_ignore_ascii_case(symbol)) {
            return Err(UnitError::Offset { text, unit });
        }
        let suggestion = nearest(symbol, &symbols().map(|(known, ..)| known));
        Err(UnitError::UnknownUnit { text, unit, suggestion, wanted: Wanted::ANY })
    }

    /// A whole number or one and a half, with a sign and perhaps in parentheses.
    fn exponent(&mut self) -> Result<f64, UnitError> {
        self.blanks();
        let is_bracketed = self.peek() == Some('(');
        self.at += usize::from(is_bracketed);
        let rest = &self.text[self.at..];
        let sign = usize::from(rest.starts_with(['+', '-']));
        let digits = |from: usize| rest.bytes().skip(from).take_while(u8::is_ascii_digit).count();
        let whole = digits(sign);
        let mut end = sign + whole;
        // A point that no digit follows is a product: "m^2.s".
        if rest[end..].starts_with('.') && digits(end + 1) > 0 {
            end += 1 + digits(end + 1);
        }
        let exponent = rest[..end].parse::<f64>().ok().filter(|_| whole > 0);
        let exponent = exponent.ok_or_else(|| self.lacks("a whole number behind `^`"))?;
        self.at += end;
        if is_bracketed {
            if self.peek() != Some(')') {
                return Err(self.lacks("a closing parenthesis"));
            }
            self.at += 1;
        }
        if (exponent * 2.0).fract() != 0.0 {
            return Err(self.lacks("a whole number behind `^`"));
        }
        if exponent.abs() <= MAX_POWER { Ok(exponent) } else { Err(self.too_large()) }
    }

    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn blanks(&mut self) {
        self.at = self.text.len() - self.text[self.at..].trim_start().len();
    }

    fn lacks(&self, lacking: &'static str) -> UnitError {
        UnitError::Malformed { text: shortened(self.text), lacking }
    }

    fn too_large(&self) -> UnitError {
        UnitError::TooLarge { text: shortened(self.text) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn reads(text: &str, factor: f64, dimension: &str) {
        let found = unit(text).map(|(factor, dimension)| (factor, dimension.to_string()));
        assert_eq!(found, Ok((factor, dimension.to_owned())), "{text}");
    }

    #[track_caller]
    fn refuses(text: &str, parts: &[&str]) {
        let message = unit(text).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{text}: {message:?} does not say {part:?}");
        }
    }

    #[test]
    fn products_quotients_and_powers() {
        reads("", 1.0, "1");
        reads("1", 1.0, "1");
        reads("-", 1.0, "1");
        reads("N s/Pa", 1.0, "m^2 s");
        reads("N s/MPa", 1e-6, "m^2 s");
        reads("N*s", 1.0, "N s");
        reads("N.s", 1.0, "N s");
        reads("N\u{b7}s", 1.0, "N s");
        reads("m\u{b7}s\u{207b}\u{b2}", 1.0, "m/s^2");
        reads(" kN / mm ", 1e6, "N/m");
        reads("1/K", 1.0, "1/K");
        reads("1/min", 1.0 / 60.0, "1/s");
        reads("%/K", 0.01, "1/K");
        reads("N/decade", 1.0, "N");
        reads("mm\u{b2}", 1e-6, "m^2");
        reads("mm^3", 1e-9, "m^3");
        reads("\u{b5}m^-1", 1e6, "1/m");
        reads("m^2.s", 1.0, "m^2 s");
        reads("m^0.5", 1.0, "m^0.5");
        reads("m^(-1.5)", 1.0, "1/m^1.5");
        reads("J/(kg K)", 1.0, "m^2/(s^2 K)");
        reads("(N/m)^2 s", 1.0, "N^2 s/m^2");
        reads("N/m/s", 1.0, "N/(m s)");
        reads("g", 1e-3, "kg");
        reads("N/(bar h)", 1.0 / (1e5 * 3600.0), "m^2/s");
        reads("Hz", 1.0, "1/s");
    }

    #[test]
    fn every_unit_of_every_quantity_is_the_same_number() {
        // A stiffness per width has no symbol of its own, so all symbols of all quantities are tried.
        for (name, known, dimension) in crate::unit_table::TABLE {
            for (symbol, factor) in *known {
                let (found, found_dimension) = unit(symbol).unwrap();
                assert_eq!(found.to_bits(), factor.to_bits(), "{name} {symbol}");
                assert_eq!(found_dimension, *dimension, "{name} {symbol}");
            }
        }
    }

    #[test]
    fn every_message_says_what_to_write() {
        refuses("nmm", &["unknown unit `nmm`", "did you mean `mm`?"]);
        refuses("newtons s", &["unknown unit `newtons`", "did you mean `N`?"]);
        refuses("N/pa", &["`N/pa` has the unknown unit `pa`", "did you mean `Pa`?"]);
        refuses("seconds", &["did you mean `s`?"]);
        refuses("N parsec", &["unknown unit `parsec`", "decade"]);
        refuses("N/\u{b0}C", &["`degC`", "write K", "293.15 K"]);
        refuses("degC", &["write K"]);
        refuses("J/kg K", &["two ways", "`J/(kg K)`"]);
        refuses("N/m*s", &["two ways"]);
        refuses("N//s", &["lacks a unit between its operators"]);
        refuses("N/", &["lacks a unit"]);
        refuses("^2", &["a unit before `^`"]);
        refuses("N^", &["a whole number behind `^`"]);
        refuses("N^x", &["a whole number behind `^`"]);
        refuses("N^0.3", &["a whole number behind `^`"]);
        refuses("(N s", &["a closing parenthesis"]);
        refuses("N s)", &["an opening parenthesis"]);
        refuses("m^13", &["beyond 12"]);
        refuses("(m^12)^12", &["beyond 12"]);
        refuses("ppm^12 ppm^12 ppm^12 ppm^12 ppm^12", &["too large or small"]);
        refuses("10 N", &["unknown unit `10`"]);
        refuses(&"m".repeat(65), &["65 bytes", "at most 64"]);
        refuses(&"(".repeat(64), &["lacks"]);
        refuses("\u{1f600}", &["lacks a unit"]);
    }
}
