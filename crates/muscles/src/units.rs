//! Units in text: "110 mm", "2 bar", "110 mm +- 0.2 mm", "1,2,3 bar", "0 %..35 %", "4 N s", "1e-3 1/K".

use crate::digits::shortest;
pub use crate::digits::{rounded, significant};
use crate::dimension::Dimension;
use crate::quantity::Ratio;
use crate::quantity::in_unit;
pub use crate::quantity::to_si;
use crate::shown::shortened;
pub use crate::unit_error::{UnitError, Wanted};
pub use crate::unit_expression::unit;
use crate::unit_table::{Units, measured, nearest, normalised};

/// A dimension with its units: the properties of a type that [`parse`] needs.
pub trait Quantity: Copy {
    /// Its name in words, such as "length".
    const NAME: &'static str;
    /// Its physical dimension.
    const DIMENSION: Dimension;
    /// A value written as it should be, such as "110 mm".
    const EXAMPLE: &'static str;
    /// The natural unit for people, with its factor.
    const SHOWN: (&'static str, f64);
    /// Every unit symbol that is understood, with its size in SI units. Case matters.
    const UNITS: &'static [(&'static str, f64)];
    /// From the SI value.
    fn from_si(value: f64) -> Self;
    /// The SI value.
    fn si(self) -> f64;
}

/// A number with its unit, of any dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Any {
    /// The value in SI units.
    pub si: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit as it was written, with µ as u, ° as deg and ² as ^2; empty for a pure number.
    pub unit: String,
}

/// Reads one quantity, such as "110 mm", "110mm", "1e-3 m", "0.3 mm²" or "5 µm".
///
/// A pure number is a [`Ratio`] ("0.2" is 20 %) and nothing else.
///
/// ```
/// use bulge_muscles::{Length, Pressure, units};
/// assert_eq!(units::parse::<Length>("110 mm"), Ok(Length::m(0.11)));
/// let error = units::parse::<Pressure>("2 Bar").unwrap_err();
/// assert!(error.to_string().contains("did you mean `bar`?"));
/// ```
///
/// # Errors
/// If the text is not a finite number with a unit of the dimension.
pub fn parse<Q: Quantity>(text: &str) -> Result<Q, UnitError> {
    Ok(Q::from_si(read(Wanted::of::<Q>(), text)?.si))
}

/// Reads a number with a unit of any dimension, such as "4 N s", "0.2" or "1e-3 1/K".
///
/// ```
/// use bulge_muscles::units;
/// let drag = units::any("4 N s/mm")?;
/// assert_eq!((drag.si, drag.dimension.to_string(), drag.unit), (4000.0, "N s/m".to_owned(), "N s/mm".to_owned()));
/// # Ok::<(), units::UnitError>(())
/// ```
///
/// # Errors
/// If the text is not a finite number with such a unit, see [`unit()`].
pub fn any(text: &str) -> Result<Any, UnitError> {
    read(Wanted::ANY, text)
}

/// Reads a number with one of the given units, into the first one: for units that no [`Quantity`] has.
///
/// ```
/// use bulge_muscles::units;
/// assert_eq!(units::in_one_of("2 min", &[("s", 1.0), ("min", 60.0)]), Ok(120.0));
/// ```
///
/// # Errors
/// The text is no finite number with such a unit; the message says what to write.
pub fn in_one_of(text: &str, units: &[(&str, f64)]) -> Result<f64, String> {
    let text = text.trim();
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.eE".contains(c));
    let (number, unit) = (&text[..text.len() - unit.len()], unit.trim());
    let factor = units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor);
    match (number.trim().parse::<f64>(), factor) {
        (Ok(number), Some(factor)) if number.is_finite() => Ok(number * factor),
        _ => {
            let known: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
            let first = known.first().unwrap_or(&"");
            Err(format!("`{text}` can't be read: write such as \"2 {first}\" (known: {})", known.join(", ")))
        }
    }
}

/// The size of a unit in SI units, such as 0.001 for `Length` and "mm": for CSV headers like `length [mm]`.
///
/// For a [`Ratio`], "", "1" and "-" also mean a pure number.
///
/// # Errors
/// If the unit is not of the dimension.
pub fn factor<Q: Quantity>(unit: &str) -> Result<f64, UnitError> {
    Wanted::of::<Q>().factor(unit)
}

impl Wanted {
    /// The same for a wanted quantity.
    ///
    /// # Errors
    /// If the unit is not of the dimension.
    pub fn factor(&'static self, unit: &str) -> Result<f64, UnitError> {
        let unit = compact(unit);
        let is_pure = matches!(unit.as_str(), "1" | "-") && self.quantity == Ratio::NAME;
        if is_pure { Ok(1.0) } else { factor_in(self, &unit, &unit) }
    }
}

/// Reads a value with an optional width: "110 mm", "110 mm +- 0.2 mm", "110 ± 0.2 mm", "110 mm +- 0.5 %".
///
/// The width (one standard deviation) has the same dimension, or is a percentage of the value; for a
/// [`Ratio`], whose own unit is the percentage, it is absolute. `+- 0`, with or without a unit, says that the
/// value is exact.
///
/// # Errors
/// If either part is not a quantity of the dimension or the width is negative.
pub fn parse_with_width<Q: Quantity>(text: &str) -> Result<(Q, Option<Q>), UnitError> {
    let (value, width) = read_with_width(Wanted::of::<Q>(), text)?;
    Ok((Q::from_si(value.si), width.map(Q::from_si)))
}

/// The same for any dimension: "1 N +- 0.2 N", "50 ± 30 N", "1 N s +- 5 %".
///
/// # Errors
/// If either part is not a number with a unit, their dimensions differ, or the width is negative.
pub fn any_with_width(text: &str) -> Result<(Any, Option<f64>), UnitError> {
    read_with_width(Wanted::ANY, text)
}

/// Reads a list: "1 bar,2 bar,3 bar" or "1,2,3 bar", where numbers without a unit take that of the last item.
///
/// # Errors
/// If an item is empty or is not a quantity of the dimension.
pub fn parse_list<Q: Quantity>(text: &str) -> Result<Vec<Q>, UnitError> {
    Ok(read_list(Wanted::of::<Q>(), text)?.into_iter().map(Q::from_si).collect())
}

/// The same for a wanted quantity, into SI.
pub(crate) fn read_list(wanted: &'static Wanted, text: &str) -> Result<Vec<f64>, UnitError> {
    read_all(wanted, &text.split(',').collect::<Vec<_>>())
}

/// Reads a range: "0 %..35 %" or "0..35 %", in the order written (a range may run downwards).
///
/// # Errors
/// If there is no `..` or an end is not a quantity of the dimension.
pub fn parse_range<Q: Quantity>(text: &str) -> Result<(Q, Q), UnitError> {
    let not_a_range = || UnitError::NotARange { text: shortened(text), wanted: Wanted::of::<Q>() };
    let (from, to) = text.split_once("..").ok_or_else(not_a_range)?;
    let ends = read_all(Wanted::of::<Q>(), &[from, to])?;
    Ok((Q::from_si(ends[0]), Q::from_si(ends[1])))
}

/// Writes a quantity so that [`parse`] gives back exactly the same number: in the natural unit with as few
/// digits as possible, else in SI.
#[must_use]
pub fn exact_text<Q: Quantity>(quantity: Q) -> String {
    exact_text_of(Wanted::of::<Q>(), quantity.si(), Q::SHOWN.0)
}

/// The same for an SI value in another unit of the dimension. An unknown unit gives SI.
pub(crate) fn exact_text_of(wanted: &Wanted, si: f64, unit: &str) -> String {
    let in_si = wanted.known.first().map_or("", |first| first.0);
    let (unit, factor) = find(wanted.known, unit).unwrap_or((in_si, 1.0));
    exact(si, unit, factor, in_si)
}

/// Writes an SI value in a unit so that [`any`] gives back exactly the same number, with as few digits as
/// possible. If the unit cannot do that, the value is written in SI units. If [`unit()`] does not read the
/// unit, it is written as a pure number.
///
/// ```
/// use bulge_muscles::units;
/// assert_eq!(units::exact_any_text(4000.0, "N s/mm"), "4 N s/mm");
/// assert_eq!(units::exact_any_text(0.25, "%"), "25 %");
/// ```
#[must_use]
pub fn exact_any_text(si: f64, unit: &str) -> String {
    let Ok((factor, dimension)) = crate::unit_expression::unit(unit) else { return plain_number(si) };
    let in_si = if dimension.is_none() { String::new() } else { dimension.to_string() };
    exact(si, if is_pure(unit) { "" } else { unit.trim() }, factor, &in_si)
}

fn exact(si: f64, unit: &str, factor: f64, in_si: &str) -> String {
    let shown = shortest(in_unit(si, factor), |value| to_si(value, factor).to_bits() == si.to_bits());
    let (number, unit) = shown.map_or((si, in_si), |value| (value, unit));
    format!("{} {unit}", plain_number(number)).trim_end().to_owned()
}

/// A double as people write it, with an exponent if it would take many zeros otherwise.
fn plain_number(value: f64) -> String {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

fn is_pure(unit: &str) -> bool {
    matches!(unit.trim(), "" | "1" | "-")
}

pub(crate) fn read(wanted: &'static Wanted, text: &str) -> Result<Any, UnitError> {
    let (number, unit) = split(wanted, text)?;
    scaled(wanted, text, number, &unit)
}

pub(crate) fn read_with_width(wanted: &'static Wanted, text: &str) -> Result<(Any, Option<f64>), UnitError> {
    let Some((value_text, width_text)) = ["+-", "+/-", "±"].iter().find_map(|sign| text.split_once(sign))
    else {
        return Ok((read(wanted, text)?, None));
    };
    let (value_number, value_unit) = split(wanted, value_text)?;
    let (width_number, width_unit) = split(wanted, width_text)?;
    if width_number == 0.0 && width_unit.is_empty() {
        return Ok((scaled(wanted, value_text, value_number, &value_unit)?, Some(0.0)));
    }
    let is_ratio = |unit: &str| !unit.is_empty() && find(Ratio::UNITS, &normalised(unit)).is_some();
    // If the value may be a pure number, "20 +- 1 %" has one unit for both, as "110 ± 0.2 mm" has.
    let may_be_pure = wanted.dimension.is_none() || find(wanted.known, "").is_some();
    let is_relative =
        is_ratio(&width_unit) && !is_ratio(&value_unit) && !(may_be_pure && value_unit.is_empty());
    let shares_unit = value_unit.is_empty() && !is_relative;
    let value =
        scaled(wanted, value_text, value_number, if shares_unit { &width_unit } else { &value_unit })?;
    let width =
        scaled(if is_relative { Wanted::ANY } else { wanted }, width_text, width_number, &width_unit)?;
    if !is_relative && width.dimension != value.dimension {
        let (found, value) = (width.dimension.describe(), value.dimension.describe());
        return Err(UnitError::OtherWidth { text: shortened(text), found, value });
    }
    let width = if is_relative { value.si.abs() * width.si } else { width.si };
    if width >= 0.0 && width.is_finite() {
        // The sign of a zero is dropped, because nobody writes it back.
        Ok((value, Some(width.abs())))
    } else {
        Err(UnitError::NegativeWidth { text: shortened(text), width, wanted })
    }
}

/// A list of values. Those without a unit take that of the last.
fn read_all(wanted: &'static Wanted, items: &[&str]) -> Result<Vec<f64>, UnitError> {
    let parts = items.iter().map(|item| split(wanted, item)).collect::<Result<Vec<_>, _>>()?;
    let last_unit = parts.last().map_or("", |(_, unit)| unit);
    let one = |(item, (number, unit)): (&&str, &(f64, String))| {
        let unit = if unit.is_empty() { last_unit } else { unit };
        Ok(scaled(wanted, item, *number, unit)?.si)
    };
    items.iter().zip(&parts).map(one).collect()
}

/// Splits "110 mm" into the number and the unit, which may be empty.
fn split(wanted: &'static Wanted, text: &str) -> Result<(f64, String), UnitError> {
    let body = text.trim().replace('\u{2212}', "-");
    if body.is_empty() {
        return Err(UnitError::Empty { wanted });
    }
    let (number, rest) = body.split_at(number_length(&body));
    let rest = rest.trim_start();
    let not_a_number = || UnitError::NotANumber { text: shortened(text), wanted };
    let Ok(value) = number.parse::<f64>() else {
        let is_not_finite = is_not_finite(&body);
        return Err(if is_not_finite { not_finite(wanted, text) } else { not_a_number() });
    };
    match rest.chars().next() {
        Some(',') if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            let fixed = shortened(&body.replacen(',', ".", 1));
            Err(UnitError::DecimalComma { text: shortened(text), fixed })
        }
        // Only the reader of units can judge the beginning of a unit of any dimension.
        Some(c)
            if wanted.dimension.is_some()
                && !(c.is_alphabetic() || matches!(c, '%' | '\u{2030}' | '\u{b0}' | '\u{b5}')) =>
        {
            Err(not_a_number())
        }
        _ => Ok((value, rest.to_owned())),
    }
}

/// A number in a unit; `text` is the whole value, for the message.
fn scaled(wanted: &'static Wanted, text: &str, number: f64, unit: &str) -> Result<Any, UnitError> {
    let (factor, dimension) = match wanted.dimension {
        Some(dimension) => (factor_in(wanted, text, &compact(unit))?, dimension),
        None => crate::unit_expression::unit(unit)?,
    };
    let si = to_si(number, factor);
    if !si.is_finite() {
        return Err(not_finite(wanted, text));
    }
    Ok(Any { si, dimension, unit: if is_pure(unit) { String::new() } else { normalised(unit) } })
}

fn not_finite(wanted: &'static Wanted, text: &str) -> UnitError {
    UnitError::NotFinite { text: shortened(text), wanted }
}

/// How many bytes at the beginning are a decimal number: sign, digits, point, exponent ("12e" has no
/// exponent).
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// Whether the text begins with one of the words that stand for no finite number.
fn is_not_finite(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']).split_whitespace().next().unwrap_or("");
    ["nan", "inf", "infinity", "\u{221e}"].iter().any(|other| word.eq_ignore_ascii_case(other))
}

/// A unit of a dimension in its one spelling, without blanks.
fn compact(unit: &str) -> String {
    normalised(unit).replace(' ', "")
}

fn find(units: Units, unit: &str) -> Option<(&'static str, f64)> {
    units.iter().copied().find(|(symbol, _)| *symbol == unit)
}

/// The factor of a unit in its one spelling; `text` is the whole value, for the message.
fn factor_in(wanted: &'static Wanted, text: &str, unit: &str) -> Result<f64, UnitError> {
    if let Some((_, factor)) = find(wanted.known, unit) {
        return Ok(factor);
    }
    let text = shortened(text);
    if unit.is_empty() {
        return Err(UnitError::NoUnit { text, wanted });
    }
    let suggestion = nearest(unit, &wanted.known.iter().map(|(symbol, _)| *symbol));
    let is_like = |symbol: &str| suggestion.is_none() && symbol.eq_ignore_ascii_case(unit);
    Err(match measured(|symbol| symbol == unit).or_else(|| measured(is_like)) {
        Some(found) => UnitError::OtherDimension { text, found, wanted },
        None => UnitError::UnknownUnit { text, unit: shortened(unit), suggestion, wanted },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::{Angle, Area, Force, Length, LineStiffness, Pressure, Time, Volume};

    #[track_caller]
    fn reads<Q: Quantity>(text: &str, si: f64) {
        let found = parse::<Q>(text).map(Quantity::si);
        assert_eq!(found, Ok(si), "{text}");
    }

    #[track_caller]
    fn says<T: std::fmt::Debug>(found: Result<T, UnitError>, parts: &[&str]) {
        let message = found.unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[track_caller]
    fn refuses<Q: Quantity + std::fmt::Debug>(text: &str, parts: &[&str]) {
        says(parse::<Q>(text), parts);
    }

    /// Numbers that look random.
    fn next(state: &mut u64) -> u64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *state
    }

    #[test]
    fn values_with_units() {
        reads::<Length>("110 mm", 0.11);
        reads::<Length>("110mm", 0.11);
        reads::<Length>("  110\tmm ", 0.11);
        reads::<Length>("1e-3 m", 1e-3);
        reads::<Length>("1E+1cm", 0.1);
        reads::<Length>(".5 mm", 0.5e-3);
        reads::<Length>("5. mm", 5e-3);
        reads::<Length>("5 um", 5e-6);
        reads::<Length>("5 \u{b5}m", 5e-6);
        reads::<Length>("5 \u{3bc}m", 5e-6);
        reads::<Length>("\u{2212}5 mm", -5e-3);
        reads::<Length>("+2 in", 0.0508);
        reads::<Pressure>("2 bar", 2e5);
        reads::<Pressure>("30 Pa", 30.0);
        reads::<Pressure>("0.2 MPa", 2e5);
        reads::<Pressure>("10 hPa", 1e3);
        reads::<Force>("12 kN", 12e3);
        reads::<Force>("2 kgf", 19.6133);
        reads::<Angle>("180 deg", std::f64::consts::PI);
        reads::<Angle>("180\u{b0}", std::f64::consts::PI);
        reads::<Area>("0.3 mm^2", 0.3e-6);
        reads::<Area>("0.3 mm\u{b2}", 0.3e-6);
        reads::<Volume>("1 m\u{b3}", 1.0);
        reads::<Volume>("400 mL", 400e-6);
        reads::<LineStiffness>("80 kN/m", 80e3);
        reads::<LineStiffness>("81 N / mm", 81e3);
        reads::<Ratio>("20 %", 0.2);
        reads::<Ratio>("0.2", 0.2);
        reads::<Ratio>("3 \u{2030}", 0.003);
    }

    #[test]
    fn every_unit_of_every_dimension_is_read() {
        fn all<Q: Quantity>() {
            for (symbol, factor) in Q::UNITS {
                assert_eq!(
                    parse::<Q>(&format!("3 {symbol}")).map(Quantity::si),
                    Ok(to_si(3.0, *factor)),
                    "{symbol}"
                );
            }
            assert!(parse::<Q>(Q::EXAMPLE).is_ok());
            assert!(Q::UNITS.contains(&Q::SHOWN));
        }
        all::<Length>();
        all::<Pressure>();
        all::<Force>();
        all::<Angle>();
        all::<Area>();
        all::<Volume>();
        all::<LineStiffness>();
        all::<Ratio>();
        all::<Time>();
    }

    #[test]
    fn every_message_says_what_to_write() {
        refuses::<Length>("110", &["`110` has no unit", "a length such as \"110 mm\"", "m, cm, mm, um, in"]);
        refuses::<Angle>("0.4", &["an angle such as \"25 deg\""]);
        refuses::<Pressure>("2 Bar", &["unknown unit `Bar`", "did you mean `bar`?"]);
        refuses::<Pressure>("2 kpa", &["did you mean `kPa`?"]);
        refuses::<Pressure>("2 bars", &["did you mean `bar`?"]);
        refuses::<Length>("2 millimetres", &["did you mean `mm`?"]);
        refuses::<Length>("2 ft", &["unknown unit `ft`", "known: m, cm"]);
        refuses::<Length>("2 parsec", &["unknown unit `parsec`: write a length"]);
        refuses::<Length>("2 s", &["`2 s` is a time, here a length is needed", "\"110 mm\""]);
        refuses::<Length>("2 bar", &["`2 bar` is a pressure, here a length is needed", "\"110 mm\""]);
        refuses::<Length>("2 Bar", &["is a pressure"]);
        refuses::<Pressure>("25 deg", &["is an angle, here a pressure is needed"]);
        refuses::<Length>("20 %", &["is a ratio"]);
        refuses::<Ratio>("20 mm", &["is a length"]);
        refuses::<Length>("long", &["does not begin with a number", "\"110 mm\""]);
        refuses::<Length>("1_000 mm", &["does not begin with a number"]);
        refuses::<Length>("--5 mm", &["does not begin with a number"]);
        refuses::<Length>("1,5 mm", &["comma", "\"1.5 mm\""]);
        refuses::<Length>("nan mm", &["not finite"]);
        refuses::<Length>("-inf mm", &["not finite"]);
        refuses::<Length>("1e999 m", &["not finite"]);
        refuses::<Pressure>("1e305 bar", &["not finite"]);
        refuses::<Length>("  ", &["no length is given", "\"110 mm\""]);
        refuses::<Length>("5 \u{1b}[31m", &["\u{fffd}"]);
        refuses::<Length>(&"9".repeat(100), &["\u{2026}`"]);
    }

    #[test]
    fn values_with_widths() {
        let read = |text| parse_with_width::<Length>(text).map(|(v, w)| (v.to_mm(), w.map(Length::to_mm)));
        assert_eq!(read("110 mm"), Ok((110.0, None)));
        for text in ["110 mm +- 0.2 mm", "110 mm \u{b1} 0.2mm", "110 mm +/- 200 um", "110 +- 0.2 mm"] {
            assert_eq!(read(text), Ok((110.0, Some(0.2))), "{text}");
        }
        for text in ["110 mm +- 0", "110 mm +- 0 mm", "110 mm \u{b1} 0 %", "110 +- -0 mm"] {
            let (value, width) = read(text).unwrap();
            assert_eq!((value, width.map(f64::to_bits)), (110.0, Some(0.0_f64.to_bits())), "{text}");
        }
        assert_eq!(read("200 mm +- 1 %"), Ok((200.0, Some(2.0))));
        assert_eq!(read("-200 mm +- 1 %"), Ok((-200.0, Some(2.0))));
        let ratio = parse_with_width::<Ratio>("20 % +- 1 %");
        assert_eq!(ratio, Ok((Ratio::percent(20.0), Some(Ratio::percent(1.0)))));
        for (text, part) in [
            ("25 +- 1 %", "no unit"),
            ("110 mm +- -2 mm", "can't be negative"),
            ("110 +- 0", "no unit"),
            ("110 mm +- ", "no length"),
            ("110 mm +- 2 bar", "a pressure"),
            ("110 mm +- 0.2", "no unit"),
            ("110 +- 1 %", "no unit"),
            ("+- 1 mm", "no length"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn numbers_of_any_dimension() {
        let read = |text| any(text).map(|any| (any.si, any.dimension.to_string(), any.unit));
        for (text, si, dimension, unit) in [
            ("4 N s", 4.0, "N s", "N s"),
            ("4N s", 4.0, "N s", "N s"),
            ("0.2", 0.2, "1", ""),
            ("0.2 1", 0.2, "1", ""),
            ("20 %", 0.2, "1", "%"),
            ("\u{2212}3 \u{b5}m", -3e-6, "m", "um"),
            ("1e-3 1/K", 1e-3, "1/K", "1/K"),
            ("1e\u{2212}3 s", 1e-3, "s", "s"),
            ("+2 mm\u{b2}", 2e-6, "m^2", "mm^2"),
            ("5 ms", 5e-3, "s", "ms"),
        ] {
            assert_eq!(read(text), Ok((si, dimension.to_owned(), unit.to_owned())), "{text}");
        }
        says(any(""), &["no number is given", "\"4 N s\""]);
        says(any("N s"), &["does not begin with a number"]);
        says(any("\u{2212}-3 N"), &["does not begin with a number"]);
        says(any("1e400 N"), &["not a finite number"]);
        says(any("1e305 MPa"), &["not a finite number"]);
        says(any("20 degC"), &["293.15 K"]);
        says(any("3 Nm"), &["unknown unit `Nm`"]);
    }

    #[test]
    fn widths_of_any_dimension() {
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
        says(any_with_width("1 N +- 0.2 bar"), &["is a pressure (Pa)", "the value is a force (N)"]);
        says(any_with_width("1 N +- 0.2"), &["a pure number"]);
        for text in ["1 N +- 0 N", "1 N +- 0", "1 N +- 0 %"] {
            assert_eq!(read(text), Ok((1.0, Some(0.0))), "{text}");
        }
        says(any_with_width("1 N +- -1 N"), &["can't be negative"]);
        says(any_with_width("1 N +- "), &["no number"]);
        says(any_with_width("+- 1 N"), &["no number"]);
    }

    #[test]
    fn lists_and_ranges() {
        let bars = |text| {
            parse_list::<Pressure>(text).map(|list| list.iter().map(|p| p.to_bar()).collect::<Vec<_>>())
        };
        assert_eq!(bars("1 bar,2 bar, 3 bar"), Ok(vec![1.0, 2.0, 3.0]));
        assert_eq!(bars("1,2,3 bar"), Ok(vec![1.0, 2.0, 3.0]));
        assert_eq!(bars("50 kPa, 1, 2 bar"), Ok(vec![0.5, 1.0, 2.0]));
        assert_eq!(parse_list::<Ratio>("0.1, 0.2"), Ok(vec![Ratio::one(0.1), Ratio::one(0.2)]));
        assert_eq!(parse_list::<Ratio>("10,20 %"), Ok(vec![Ratio::percent(10.0), Ratio::percent(20.0)]));
        for text in ["", "1 bar,,2 bar", "1 bar,", "1,2,3", "1 bar, 2"] {
            assert!(bars(text).is_err(), "{text}");
        }
        let range = |text| parse_range::<Ratio>(text);
        assert_eq!(range("0 %..35 %"), Ok((Ratio::one(0.0), Ratio::percent(35.0))));
        assert_eq!(range("0 .. 35 %"), Ok((Ratio::one(0.0), Ratio::percent(35.0))));
        assert_eq!(range("0.3..0.1"), Ok((Ratio::one(0.3), Ratio::one(0.1))));
        assert!(range("35 %").unwrap_err().to_string().contains("\"0 %..20 %\""));
        assert!(range("0 %..").is_err());
        assert!(parse_range::<Pressure>("0..3").unwrap_err().to_string().contains("no unit"));
    }

    #[test]
    fn factors_for_headers() {
        assert_eq!(factor::<Length>("mm"), Ok(1e-3));
        assert_eq!(factor::<Ratio>("1"), Ok(1.0));
        assert_eq!(factor::<Ratio>("-"), Ok(1.0));
        assert_eq!(factor::<Ratio>("%"), Ok(0.01));
        assert!(factor::<Length>("1").is_err());
        assert!(factor::<Length>("bar").unwrap_err().to_string().contains("pressure"));
    }

    #[test]
    fn exact_text_is_read_back_bit_for_bit() {
        #[track_caller]
        fn check<Q: Quantity>(si: f64) {
            let text = exact_text(Q::from_si(si));
            assert_eq!(parse::<Q>(&text).map(|q| q.si().to_bits()), Ok(si.to_bits()), "{text}");
        }
        assert_eq!(exact_text(Length::mm(110.0)), "110 mm");
        assert_eq!(exact_text(Length::mm(3e-7)), "3e-7 mm");
        assert_eq!(exact_text(Angle::deg(25.0)), "25 deg");
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
        let mut state = 7;
        for _ in 0..20_000 {
            let si = f64::from_bits(next(&mut state) ^ (state >> 17));
            if !si.is_finite() {
                continue;
            }
            check::<Length>(si);
            check::<Pressure>(si);
            check::<Angle>(si);
            check::<Ratio>(si);
            check::<Area>(si);
            for unit in ["", "mm", "deg", "%", "psi", "N s/MPa", "1/(K min)", "lbf^0.5", "decade"] {
                let text = exact_any_text(si, unit);
                let back = any(&text).unwrap();
                assert_eq!(back.si.to_bits(), si.to_bits(), "{text}");
                assert_eq!(Ok(back.dimension), super::unit(unit).map(|(_, dimension)| dimension), "{text}");
            }
        }
    }

    #[test]
    fn no_text_panics() {
        let pieces =
            "1|e|-|+|.|,| |mm|N|bar|\u{b5}|\u{b1}|..|/|^|2|(|)|%|nan|\0|\u{1f600}|\u{207b}|\u{b0}|degC|*";
        let pieces: Vec<&str> = pieces.split('|').collect();
        let mut state = 1;
        for _ in 0..50_000 {
            let text: String = (0..8)
                .map(|_| pieces[usize::try_from(next(&mut state) >> 33).unwrap() % pieces.len()])
                .collect();
            let _ = (parse::<Length>(&text), parse_with_width::<Ratio>(&text), parse_list::<Force>(&text));
            let _ = (parse_range::<Angle>(&text), any_with_width(&text), super::unit(&text));
            if let Ok(found) = any(&text) {
                let back = any(&exact_any_text(found.si, &found.unit)).map(|back| back.si);
                assert_eq!(back, Ok(found.si), "{text}");
            }
        }
    }
}
