//! Units as people write them above a column: `N`, `sec`, `kPa gauge`, `\u{b0}C`, `psig`.

use crate::dimension::Scale;
use crate::heading::Field;
use bulge_muscles::units::UnitError;

/// A recognised unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    pub(crate) scale: Scale,
    /// Its name in messages.
    pub(crate) name: String,
    /// Whether it is an absolute pressure.
    pub(crate) is_absolute: bool,
}

/// Other spellings of units, in lower case without blanks.
const WORDS: &[(&str, &str)] = &[
    ("pascal", "Pa"),
    ("kilopascal", "kPa"),
    ("megapascal", "MPa"),
    ("n/mm^2", "MPa"),
    ("n/mm2", "MPa"),
    ("n/m^2", "Pa"),
    ("n/m2", "Pa"),
    ("bars", "bar"),
    ("millibar", "mbar"),
    ("lbf/in^2", "psi"),
    ("lb/in2", "psi"),
    ("newton", "N"),
    ("newtons", "N"),
    ("kilonewton", "kN"),
    ("lb", "lbf"),
    ("lbs", "lbf"),
    ("kg", "kgf"),
    ("kp", "kgf"),
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("meter", "m"),
    ("metre", "m"),
    ("micron", "um"),
    ("inches", "in"),
    ("\"", "in"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("sek", "s"),
    ("sekunden", "s"),
    ("msec", "ms"),
    ("millisec", "ms"),
    ("milliseconds", "ms"),
    ("minutes", "min"),
    ("hr", "h"),
    ("hours", "h"),
    ("celsius", "degC"),
    ("\u{2103}", "degC"),
    ("\u{ba}c", "degC"),
    ("kelvin", "K"),
    ("percent", "%"),
    ("pct", "%"),
    ("prozent", "%"),
    ("mm/mm", ""),
    ("m/m", ""),
    ("cc", "ml"),
    ("ccm", "ml"),
    ("cm3", "ml"),
    ("cm^3", "ml"),
    ("m3", "m^3"),
];

/// Pressures and forces without a symbol of their own, in lower case, with their size in SI.
const FACTORS: &[(&str, Field, f64)] = &[
    // The technical atmosphere is one kilogram-force per square centimetre.
    ("kgf/cm2", Field::Pressure, 98_066.5),
    ("kgf/cm^2", Field::Pressure, 98_066.5),
    ("kg/cm2", Field::Pressure, 98_066.5),
    ("kg/cm^2", Field::Pressure, 98_066.5),
    ("atm", Field::Pressure, 101_325.0),
    // The conventional millimetre of mercury.
    ("mmhg", Field::Pressure, 133.322_387_415),
    ("torr", Field::Pressure, 101_325.0 / 760.0),
    ("dan", Field::Force, 10.0),
];

/// Additions to a unit of pressure: above ambient here, above vacuum in the next constant.
const GAUGE: [&str; 9] = ["gauge", "gage", "relative", "rel.", "rel", "(g)", "\u{fc}", "ueber", "diff"];
const ABSOLUTE: [&str; 4] = ["absolute", "abs.", "abs", "(a)"];

/// Parses the unit of a column; none if the column has no unit or this isn't one.
pub(crate) fn unit(field: Field, text: &str) -> Option<Unit> {
    let text = text.trim();
    if text.len() > 40 {
        return None;
    }
    if let Some(found) = named(field, text) {
        return Some(Unit { is_absolute: false, ..found });
    }
    if field != Field::Pressure {
        return None;
    }
    let lower = text.to_lowercase();
    for (words, is_absolute) in [(&GAUGE[..], false), (&ABSOLUTE[..], true)] {
        let plain = words.iter().find_map(|word| lower.find(word).map(|at| (at, word.len())));
        if let Some(found) = plain.and_then(|(at, length)| {
            // Changing the case alters the length of few characters, none of which occur in units.
            let rest = format!("{}{}", text.get(..at)?, text.get(at + length..)?);
            named(field, rest.trim_matches([' ', ',', '-', '_']))
        }) {
            return Some(Unit { is_absolute, ..found });
        }
    }
    // psig, barg, kPaA.
    for (ending, is_absolute) in [(['g', 'G'], false), (['a', 'A'], true)] {
        if let Some(found) = text.strip_suffix(ending).and_then(|rest| named(field, rest)) {
            return Some(Unit { is_absolute, ..found });
        }
    }
    None
}

/// A unit by its symbol in any case, or by another spelling.
fn named(field: Field, text: &str) -> Option<Unit> {
    let scale = |symbol: &str| field.scale(symbol).and_then(Result::ok);
    let of = |symbol: &str| Some(Unit { scale: scale(symbol)?, name: symbol.to_owned(), is_absolute: false });
    if text.is_empty() {
        return None;
    }
    if let Some(found) = of(text) {
        return Some(found);
    }
    let lower = text.to_lowercase().replace(char::is_whitespace, "");
    let lower = lower.replace('\u{b2}', "^2").replace('\u{b3}', "^3");
    let factor = FACTORS.iter().find(|(word, owner, _)| *owner == field && *word == lower);
    if let Some((_, _, factor)) = factor {
        return Some(Unit { scale: Scale::by(*factor), name: text.to_owned(), is_absolute: false });
    }
    if field == Field::Temperature && ["f", "\u{b0}f", "degf", "fahrenheit"].contains(&lower.as_str()) {
        return Some(Unit { scale: Scale::FAHRENHEIT, name: "degF".to_owned(), is_absolute: false });
    }
    let word = WORDS.iter().find(|(word, _)| *word == lower).and_then(|(_, symbol)| of(symbol));
    word.or_else(|| field.symbols().filter(|symbol| symbol.to_lowercase() == lower).find_map(of))
}

/// The problem with an invalid unit.
pub(crate) fn problem(field: Field, text: &str) -> Option<UnitError> {
    field.scale(text)?.err()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn reads(field: Field, text: &str, one: f64) {
        let found = unit(field, text).unwrap_or_else(|| panic!("{text} is not read"));
        let si = found.scale.si(1.0);
        assert!((si - one).abs() <= 1e-12 * one.abs(), "{text}: {si}");
        assert!(!found.is_absolute, "{text}");
    }

    #[test]
    fn units_as_people_write_them() {
        for text in ["s", "S", "sec", "Sek", "seconds", " s "] {
            reads(Field::Time, text, 1.0);
        }
        for text in
            ["kPa", "KPA", "kpa", "kPa gauge", "kPa (g)", "kPag", "kPa rel", "gauge kPa", "kPa, gauge"]
        {
            reads(Field::Pressure, text, 1e3);
        }
        reads(Field::Pressure, "N/mm\u{b2}", 1e6);
        reads(Field::Pressure, "psig", 6_894.757_293_168_361);
        reads(Field::Pressure, "bar\u{fc}", 1e5);
        reads(Field::Pressure, "MPA", 1e6);
        reads(Field::Pressure, "kgf/cm^2", 98_066.5);
        reads(Field::Force, "Newton", 1.0);
        reads(Field::Force, "lbs", 4.448_221_615_260_5);
        reads(Field::Force, "daN", 10.0);
        reads(Field::Length, "MM", 1e-3);
        reads(Field::Temperature, "\u{b0}C", 274.15);
        reads(Field::Temperature, "degF", 459.67 / 1.8 + 1.0 / 1.8);
        reads(Field::Contraction, "pct", 0.01);
        for (text, is_absolute) in
            [("bara", true), ("psia", true), ("kPa abs", true), ("bar(a)", true), ("bar", false)]
        {
            assert_eq!(unit(Field::Pressure, text).map(|unit| unit.is_absolute), Some(is_absolute), "{text}");
        }
        for (field, text) in
            [(Field::Force, "bar"), (Field::Pressure, "x"), (Field::Time, ""), (Field::Sweep, "s")]
        {
            assert_eq!(unit(field, text), None, "{text}");
        }
    }
}
