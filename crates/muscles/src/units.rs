//! Units in text: "110 mm", "2 bar", "110 mm +- 0.2 mm", "1,2,3 bar", "0 %..35 %".

pub use crate::any_unit::{Any, any, any_with_width, exact_any_text};
pub use crate::any_unit_error::AnyUnitError;
use crate::digits::shortest;
pub use crate::digits::{rounded, significant};
use crate::quantity::{Angle, Area, Force, Length, LineStiffness, Pressure, Ratio, Volume, in_unit, to_si};
pub use crate::unit_error::UnitError;
pub use crate::unit_expression::unit;

/// A dimension with its units: what [`parse`] needs to know about a type.
pub trait Quantity: Copy {
    /// What it is in words, such as "length".
    const NAME: &'static str;
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

pub(crate) type Units = &'static [(&'static str, f64)];

/// Every dimension: a unit that is not of the dimension asked for is looked up here, to say what it is.
pub(crate) const DIMENSIONS: &[(&str, Units)] = &[
    (Length::NAME, Length::UNITS),
    (Pressure::NAME, Pressure::UNITS),
    (Force::NAME, Force::UNITS),
    (Angle::NAME, Angle::UNITS),
    (Area::NAME, Area::UNITS),
    (Volume::NAME, Volume::UNITS),
    (LineStiffness::NAME, LineStiffness::UNITS),
    (Ratio::NAME, Ratio::UNITS),
];

/// Units in words, which are not accepted (there would be no end of them) but recognised.
pub(crate) const WORDS: &[(&str, &str)] = &[
    ("meter", "m"),
    ("metre", "m"),
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("centimeter", "cm"),
    ("centimetre", "cm"),
    ("micrometer", "um"),
    ("micrometre", "um"),
    ("micron", "um"),
    ("inches", "in"),
    ("pascal", "Pa"),
    ("newton", "N"),
    ("kilonewton", "kN"),
    ("degree", "deg"),
    ("radian", "rad"),
    ("percent", "%"),
    ("litre", "l"),
    ("liter", "l"),
];

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
    let (number, unit) = split::<Q>(text)?;
    scaled(text, number, factor_in::<Q>(text, &unit)?)
}

/// The size of a unit in SI units, such as 0.001 for `Length` and "mm": for CSV headers like `length [mm]`.
///
/// For a [`Ratio`], "", "1" and "-" also mean a pure number.
///
/// # Errors
/// If the unit is not of the dimension.
pub fn factor<Q: Quantity>(unit: &str) -> Result<f64, UnitError> {
    let unit = normalised(unit);
    let pure = matches!(unit.as_str(), "1" | "-") && Q::NAME == Ratio::NAME;
    if pure { Ok(1.0) } else { factor_in::<Q>(&unit, &unit) }
}

/// Reads a value with an optional width: "110 mm", "110 mm +- 0.2 mm", "110 ± 0.2 mm", "110 mm +- 0.5 %".
///
/// The width (one standard deviation) has the same dimension, or is a percentage of the value; for a [`Ratio`], whose
/// own unit is the percentage, it is absolute. `+- 0`, with or without a unit, says that the value is exact.
///
/// # Errors
/// If either part is not a quantity of the dimension or the width is negative.
pub fn parse_with_width<Q: Quantity>(text: &str) -> Result<(Q, Option<Q>), UnitError> {
    let Some((value_text, width_text)) = ["+-", "+/-", "±"].iter().find_map(|sign| text.split_once(sign))
    else {
        return Ok((parse(text)?, None));
    };
    let (value_number, value_unit) = split::<Q>(value_text)?;
    let (width_number, width_unit) = split::<Q>(width_text)?;
    if width_number == 0.0 && width_unit.is_empty() {
        return Ok((parse(value_text)?, Some(Q::from_si(0.0))));
    }
    let is_relative = Q::NAME != Ratio::NAME && is_ratio_unit(&width_unit);
    // "110 ± 0.2 mm": one unit for both.
    let shares_unit = value_unit.is_empty() && !is_relative;
    let value_factor = factor_in::<Q>(value_text, if shares_unit { &width_unit } else { &value_unit })?;
    let value: Q = scaled(value_text, value_number, value_factor)?;
    let width = if is_relative {
        value.si().abs() * to_si(width_number, factor_in::<Ratio>(width_text, &width_unit)?)
    } else {
        scaled::<Q>(width_text, width_number, factor_in::<Q>(width_text, &width_unit)?)?.si()
    };
    if width >= 0.0 && width.is_finite() {
        // Without the sign of a zero, which nobody writes back.
        Ok((value, Some(Q::from_si(width.abs()))))
    } else {
        Err(UnitError::NegativeWidth { text: shortened(text), width, example: Q::EXAMPLE })
    }
}

/// Reads a list: "1 bar,2 bar,3 bar" or "1,2,3 bar", where numbers without a unit take that of the last item.
///
/// # Errors
/// If an item is empty or is not a quantity of the dimension.
pub fn parse_list<Q: Quantity>(text: &str) -> Result<Vec<Q>, UnitError> {
    let items = text.split(',').map(|item| Ok((item, split::<Q>(item)?))).collect::<Result<Vec<_>, _>>()?;
    let last_unit = items.last().map(|(_, (_, unit))| unit.clone()).unwrap_or_default();
    items
        .into_iter()
        .map(|(item, (number, unit))| {
            let unit = if unit.is_empty() { &last_unit } else { &unit };
            scaled(item, number, factor_in::<Q>(item, unit)?)
        })
        .collect()
}

/// Reads a range: "0 %..35 %" or "0..35 %", in the order written (a range may run downwards).
///
/// # Errors
/// If there is no `..` or an end is not a quantity of the dimension.
pub fn parse_range<Q: Quantity>(text: &str) -> Result<(Q, Q), UnitError> {
    let not_a_range =
        || UnitError::NotARange { text: shortened(text), unit: Q::SHOWN.0, example: Q::EXAMPLE };
    let (from, to) = text.split_once("..").ok_or_else(not_a_range)?;
    let (from_number, from_unit) = split::<Q>(from)?;
    let (to_number, to_unit) = split::<Q>(to)?;
    let from_unit = if from_unit.is_empty() { &to_unit } else { &from_unit };
    let start = scaled(from, from_number, factor_in::<Q>(from, from_unit)?)?;
    Ok((start, scaled(to, to_number, factor_in::<Q>(to, &to_unit)?)?))
}

/// Writes a quantity so that [`parse`] gives back exactly the same number: in the natural unit with as few digits as
/// that takes, else in SI.
#[must_use]
pub fn exact_text<Q: Quantity>(quantity: Q) -> String {
    exact_text_in(quantity, Q::SHOWN.0)
}

/// The same in another unit of the dimension; a unit that is not known gives SI.
pub(crate) fn exact_text_in<Q: Quantity>(quantity: Q, unit: &str) -> String {
    let si = quantity.si();
    let in_si = || format!("{si} {}", Q::UNITS.first().map_or("", |first| first.0)).trim_end().to_owned();
    let Some((unit, factor)) = find(Q::UNITS, |symbol| symbol == unit) else { return in_si() };
    let shown = in_unit(si, factor);
    let shortest = shortest(shown, |value| to_si(value, factor).to_bits() == si.to_bits());
    shortest.map_or_else(in_si, |value| format!("{value} {unit}"))
}

/// Splits "110 mm" into the number and the normalised unit, which may be empty.
fn split<Q: Quantity>(text: &str) -> Result<(f64, String), UnitError> {
    let body = text.trim().replace('\u{2212}', "-");
    if body.is_empty() {
        return Err(UnitError::Empty { quantity: Q::NAME, example: Q::EXAMPLE });
    }
    let (number, rest) = body.split_at(number_length(&body));
    let rest = rest.trim_start();
    let Ok(value) = number.parse::<f64>() else {
        return Err(if is_not_finite(&body) { not_finite::<Q>(text) } else { not_a_number::<Q>(text) });
    };
    match rest.chars().next() {
        Some(',') if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => Err(UnitError::DecimalComma {
            text: shortened(text),
            fixed: shortened(&body.replacen(',', ".", 1)),
        }),
        Some(c) if !(c.is_alphabetic() || matches!(c, '%' | '\u{2030}' | '\u{b0}' | '\u{b5}')) => {
            Err(not_a_number::<Q>(text))
        }
        _ => Ok((value, normalised(rest))),
    }
}

/// How many bytes at the beginning are a decimal number: sign, digits, point, exponent ("12e" has no exponent).
pub(crate) fn number_length(text: &str) -> usize {
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
pub(crate) fn is_not_finite(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']).split_whitespace().next().unwrap_or("");
    ["nan", "inf", "infinity", "\u{221e}"].iter().any(|other| word.eq_ignore_ascii_case(other))
}

/// One spelling for each unit: µ is u, ° is deg, ² is ^2, ‰ is permille, no blanks.
fn normalised(unit: &str) -> String {
    let mut out = String::with_capacity(unit.len());
    for c in unit.chars().filter(|c| !c.is_whitespace()) {
        match c {
            '\u{b5}' | '\u{3bc}' => out.push('u'),
            '\u{b0}' => out.push_str("deg"),
            '\u{b2}' => out.push_str("^2"),
            '\u{b3}' => out.push_str("^3"),
            '\u{2030}' => out.push_str("permille"),
            other => out.push(other),
        }
    }
    out
}

fn is_ratio_unit(unit: &str) -> bool {
    !unit.is_empty() && find(Ratio::UNITS, |symbol| symbol == unit).is_some()
}

fn find(units: Units, matches: impl Fn(&str) -> bool) -> Option<(&'static str, f64)> {
    units.iter().copied().find(|(symbol, _)| matches(symbol))
}

/// The factor of a normalised unit; `text` is the whole value, for the message.
fn factor_in<Q: Quantity>(text: &str, unit: &str) -> Result<f64, UnitError> {
    if let Some((_, factor)) = find(Q::UNITS, |symbol| symbol == unit) {
        return Ok(factor);
    }
    let text = shortened(text);
    let (quantity, example, known) = (Q::NAME, Q::EXAMPLE, Q::UNITS);
    if unit.is_empty() {
        return Err(UnitError::NoUnit { text, quantity, example, known });
    }
    let other = |matches: &dyn Fn(&str) -> bool| {
        DIMENSIONS.iter().find(|(_, units)| find(units, matches).is_some()).map(|(name, _)| *name)
    };
    if let Some(found) = other(&|symbol| symbol == unit) {
        return Err(UnitError::OtherDimension { text, found, quantity, example });
    }
    let suggestion = nearest_unit(unit, known);
    if suggestion.is_none()
        && let Some(found) = other(&|symbol| symbol.eq_ignore_ascii_case(unit))
    {
        return Err(UnitError::OtherDimension { text, found, quantity, example });
    }
    Err(UnitError::UnknownUnit { text, unit: shortened(unit), quantity, suggestion, example, known })
}

/// The unit that was probably meant: the same but for case, a word for it, or one slip of the finger away.
fn nearest_unit(unit: &str, known: Units) -> Option<&'static str> {
    let lower = unit.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    let word = WORDS.iter().find(|(word, _)| *word == lower || *word == singular).map(|(_, symbol)| *symbol);
    let slips = |symbol: &str| strsim::damerau_levenshtein(symbol, unit);
    find(known, |symbol| symbol.eq_ignore_ascii_case(unit))
        .or_else(|| word.and_then(|word| find(known, |symbol| symbol == word)))
        .or_else(|| find(known, |symbol| symbol.len() > 1 && symbol.eq_ignore_ascii_case(singular)))
        .or_else(|| find(known, |symbol| symbol.len() > 1 && unit.chars().count() > 1 && slips(symbol) == 1))
        .map(|(symbol, _)| symbol)
}

fn scaled<Q: Quantity>(text: &str, number: f64, factor: f64) -> Result<Q, UnitError> {
    let si = to_si(number, factor);
    if si.is_finite() { Ok(Q::from_si(si)) } else { Err(not_finite::<Q>(text)) }
}

fn not_finite<Q: Quantity>(text: &str) -> UnitError {
    UnitError::NotFinite { text: shortened(text), quantity: Q::NAME, example: Q::EXAMPLE }
}

fn not_a_number<Q: Quantity>(text: &str) -> UnitError {
    UnitError::NotANumber { text: shortened(text), quantity: Q::NAME, example: Q::EXAMPLE }
}

/// A quotation for a message: at most 40 characters, on one line, without control characters.
#[must_use]
pub fn shortened(text: &str) -> String {
    let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let trimmed = text.trim();
    let mut out: String = trimmed.chars().take(40).map(printable).collect();
    if trimmed.chars().nth(40).is_some() {
        out.push('\u{2026}');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn reads<Q: Quantity>(text: &str, si: f64) {
        let found = parse::<Q>(text).map(Quantity::si);
        assert_eq!(found, Ok(si), "{text}");
    }

    #[track_caller]
    fn refuses<Q: Quantity>(text: &str, parts: &[&str]) {
        let message = parse::<Q>(text).map(Quantity::si).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{text}: {message:?} does not say {part:?}");
        }
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
        fn check<Q: Quantity>(si: f64) {
            let text = exact_text(Q::from_si(si));
            let back = parse::<Q>(&text).map(|q| q.si().to_bits());
            assert_eq!(back, Ok(si.to_bits()), "{text}");
        }
        assert_eq!(exact_text(Length::mm(110.0)), "110 mm");
        assert_eq!(exact_text(Angle::deg(25.0)), "25 deg");
        let mut state = 7_u64;
        for _ in 0..2000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let si = f64::from_bits(
                (state & 0x800f_ffff_ffff_ffff) | ((state >> 3) & 0x3ff) << 52 | (0x200 << 52),
            );
            if si.is_finite() {
                check::<Length>(si);
                check::<Pressure>(si);
                check::<Angle>(si);
                check::<Ratio>(si);
                check::<Area>(si);
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
            "\u{b5}",
            "\u{b1}",
            "..",
            "bar",
            "%",
            "nan",
            "\u{0}",
            "\u{1f600}",
        ];
        let mut state = 1_usize;
        for _ in 0..20_000 {
            let mut text = String::new();
            for _ in 0..6 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                text.push_str(pieces[(state >> 33) % pieces.len()]);
            }
            let _ = (parse::<Length>(&text), parse_with_width::<Ratio>(&text), parse_list::<Force>(&text));
            let _ = parse_range::<Angle>(&text);
        }
    }
}
