//! The one table of units, their spellings, and the unit that was probably meant.

use crate::dimension::Dimension;
use crate::quantity::{Angle, Area, Force, Length, LineStiffness, Pressure, Ratio, Time, Volume};
use crate::units::Quantity;

/// Symbols, each with its size in SI units.
pub(crate) type Units = &'static [(&'static str, f64)];

/// Every unit by what it measures: the quantities of this crate, then those without a type of their own.
pub(crate) const TABLE: &[(&str, Units, Dimension)] = &[
    of::<Length>(),
    of::<Pressure>(),
    of::<Force>(),
    of::<Angle>(),
    of::<Area>(),
    of::<Volume>(),
    of::<LineStiffness>(),
    of::<Ratio>(),
    of::<Time>(),
    ("temperature", &[("K", 1.0)], Dimension::TEMPERATURE),
    ("mass", &[("kg", 1.0), ("g", 1e-3)], Dimension::MASS),
    ("energy", &[("J", 1.0)], Dimension::ENERGY),
    ("rate", &[("Hz", 1.0)], Dimension::RATE),
    // A decade of time: the argument of a decimal logarithm.
    ("ratio", &[("decade", 1.0)], Dimension::NONE),
];

/// Units in words. They are not accepted (there would be no end of them) but recognised.
const WORDS: &[(&str, &str)] = &[
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
    ("second", "s"),
    ("sec", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("kelvin", "K"),
    ("gram", "g"),
    ("kilogram", "kg"),
    ("joule", "J"),
    ("hertz", "Hz"),
];

const fn of<Q: Quantity>() -> (&'static str, Units, Dimension) {
    (Q::NAME, Q::UNITS, Q::DIMENSION)
}

/// The quantity that a symbol measures, such as "length".
pub(crate) fn measured(matches: impl Fn(&str) -> bool) -> Option<&'static str> {
    TABLE.iter().find(|(_, units, _)| units.iter().any(|(symbol, _)| matches(symbol))).map(|(name, ..)| *name)
}

/// Every symbol that may stand in a unit.
pub(crate) fn symbols() -> impl Iterator<Item = (&'static str, f64, Dimension)> + Clone {
    let each =
        TABLE.iter().flat_map(|(_, units, dimension)| units.iter().map(|(s, size)| (*s, *size, *dimension)));
    // "mm^2" is mm to a power; "" is no symbol.
    each.filter(|(symbol, ..)| !symbol.is_empty() && !symbol.contains(['^', '/']))
}

/// One spelling for each unit: µ is u, ° is deg, ‰ is permille, ·, × and ⋅ are `*`, ⁻² is ^-2; single blanks.
pub(crate) fn normalised(text: &str) -> String {
    let text = text.trim();
    let mut out = String::with_capacity(text.len());
    let mut is_raised = false;
    for c in text.chars() {
        if let Some(raised) = raised(c) {
            out.extend((!is_raised).then_some('^').into_iter().chain([raised]));
            is_raised = true;
            continue;
        }
        is_raised = false;
        match c {
            '\u{b5}' | '\u{3bc}' => out.push('u'),
            '\u{b0}' => out.push_str("deg"),
            '\u{2030}' => out.push_str("permille"),
            '\u{b7}' | '\u{d7}' | '\u{22c5}' => out.push('*'),
            '\u{2212}' => out.push('-'),
            c if c.is_whitespace() => out.extend((!out.ends_with(' ')).then_some(' ')),
            other => out.push(other),
        }
    }
    out
}

/// A raised digit or sign as a plain one.
fn raised(c: char) -> Option<char> {
    const RAISED: &str = "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}\u{207b}";
    RAISED.chars().zip("0123456789-".chars()).find(|(from, _)| *from == c).map(|(_, to)| to)
}

/// The known symbol that was probably meant: the same except for case, a word for it, or one slip of the
/// finger away.
pub(crate) fn nearest(
    unit: &str,
    known: &(impl Iterator<Item = &'static str> + Clone),
) -> Option<&'static str> {
    let lower = unit.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    let word = WORDS.iter().find(|(word, _)| *word == lower || *word == singular).map(|(_, symbol)| *symbol);
    let slips = |symbol: &str| strsim::damerau_levenshtein(symbol, unit);
    let is_long = unit.chars().count() > 1;
    let find = |matches: &dyn Fn(&str) -> bool| known.clone().find(|symbol| matches(symbol));
    find(&|symbol| symbol.eq_ignore_ascii_case(unit))
        .or_else(|| find(&|symbol| word == Some(symbol)))
        .or_else(|| find(&|symbol| symbol.len() > 1 && symbol.eq_ignore_ascii_case(singular)))
        .or_else(|| find(&|symbol| symbol.len() > 1 && is_long && slips(symbol) == 1))
}
