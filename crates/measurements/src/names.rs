//! Column names as people write them: `Kraft / N`, `P1 (kPa gauge)`, `t_s`.

use crate::dimension::Scale;
use crate::heading::Field;
use crate::unit::{Unit, unit};

/// Strength of a guess, from the weakest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Strength {
    /// Only the unit indicates it.
    UnitAlone,
    /// Name and unit indicate it, but it isn't a measured value: a set point, an error.
    Aside,
    /// The name indicates it, without a unit.
    NameAlone,
    /// Name and unit indicate it.
    NameAndUnit,
    /// The standard heading.
    Exact,
}

/// A possible meaning of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guess {
    pub(crate) field: Field,
    pub(crate) strength: Strength,
    /// None if no unit is written.
    pub(crate) unit: Option<Unit>,
    /// Whether its name says that it grows when the muscle lengthens.
    pub(crate) is_lengthening: bool,
}

/// Words of a name with their meanings; the flag requires that the name contains nothing else.
const WORDS: &[(&str, Field, bool)] = &[
    ("force_sd", Field::ForceSd, true),
    ("force_std", Field::ForceSd, true),
    ("sd_force", Field::ForceSd, true),
    ("pressure", Field::Pressure, false),
    ("press", Field::Pressure, false),
    ("druck", Field::Pressure, false),
    ("pression", Field::Pressure, false),
    ("presion", Field::Pressure, false),
    ("pressione", Field::Pressure, false),
    ("p", Field::Pressure, true),
    ("p_gauge", Field::Pressure, true),
    ("p_rel", Field::Pressure, true),
    ("p_meas", Field::Pressure, true),
    ("force", Field::Force, false),
    ("load", Field::Force, false),
    ("pull", Field::Force, false),
    ("loadcell", Field::Force, false),
    ("kraft", Field::Force, false),
    ("fuerza", Field::Force, false),
    ("forza", Field::Force, false),
    ("kracht", Field::Force, false),
    ("f", Field::Force, true),
    ("fz", Field::Force, true),
    ("f_meas", Field::Force, true),
    ("time", Field::Time, false),
    ("zeit", Field::Time, false),
    ("temps", Field::Time, false),
    ("tiempo", Field::Time, false),
    ("tempo", Field::Time, false),
    ("tijd", Field::Time, false),
    ("timestamp", Field::Time, false),
    ("zeitstempel", Field::Time, false),
    ("uhrzeit", Field::Time, false),
    ("horodatage", Field::Time, false),
    ("datetime", Field::Time, false),
    ("elapsed", Field::Time, false),
    ("x_value", Field::Time, true),
    ("t", Field::Time, true),
    ("t", Field::Temperature, true),
    ("length", Field::Length, false),
    ("laenge", Field::Length, false),
    ("longueur", Field::Length, false),
    ("longitud", Field::Length, false),
    ("lunghezza", Field::Length, false),
    ("l", Field::Length, true),
    ("contraction", Field::Contraction, false),
    ("kontraktion", Field::Contraction, false),
    ("verkuerzung", Field::Contraction, false),
    ("stauchung", Field::Contraction, false),
    ("shortening", Field::Contraction, false),
    ("strain", Field::Contraction, false),
    ("eps", Field::Contraction, true),
    ("epsilon", Field::Contraction, true),
    ("displacement", Field::Displacement, false),
    ("disp", Field::Displacement, false),
    ("stroke", Field::Displacement, false),
    ("travel", Field::Displacement, false),
    ("weg", Field::Displacement, false),
    ("hub", Field::Displacement, true),
    ("verschiebung", Field::Displacement, false),
    ("verkuerzung", Field::Displacement, false),
    ("stauchung", Field::Displacement, false),
    ("deplacement", Field::Displacement, false),
    ("desplazamiento", Field::Displacement, false),
    ("spostamento", Field::Displacement, false),
    ("position", Field::Displacement, false),
    ("pos", Field::Displacement, false),
    ("crosshead", Field::Displacement, false),
    ("lvdt", Field::Displacement, false),
    ("shortening", Field::Displacement, false),
    ("extension", Field::Displacement, false),
    ("elongation", Field::Displacement, false),
    ("x", Field::Displacement, true),
    ("temperature", Field::Temperature, false),
    ("temperatur", Field::Temperature, false),
    ("temp", Field::Temperature, false),
    ("diameter", Field::Diameter, false),
    ("durchmesser", Field::Diameter, false),
    ("d", Field::Diameter, true),
    ("volume", Field::Volume, false),
    ("volumen", Field::Volume, false),
    ("v", Field::Volume, true),
    ("sweep", Field::Sweep, true),
    ("run", Field::Sweep, true),
    ("run_id", Field::Sweep, true),
    ("run_no", Field::Sweep, true),
    ("specimen", Field::Specimen, true),
    ("muscle", Field::Specimen, true),
    ("muscle_id", Field::Specimen, true),
    ("cycle", Field::Cycle, true),
    ("cycle_no", Field::Cycle, true),
    ("zyklus", Field::Cycle, true),
    ("direction", Field::Direction, true),
    ("richtung", Field::Direction, true),
];

/// Words for values that aren't readings of the quantity itself.
const ASIDE: &[&str] = &[
    "set",
    "setpoint",
    "soll",
    "sollwert",
    "target",
    "command",
    "cmd",
    "ref",
    "reference",
    "desired",
    "demand",
    "supply",
    "tank",
    "ambient",
    "room",
    "atmospheric",
    "error",
    "std",
    "sd",
    "rate",
    "velocity",
    "raw",
    "max",
    "min",
    "mean",
    "predicted",
    "model",
    "filtered",
];

/// Beginnings of compound words of that kind: "Solldruck", "Versorgungsdruck".
const ASIDE_BEGINNINGS: &[&str] = &["soll", "versorgung", "umgebung"];

/// Words for a pressure above vacuum.
const ABSOLUTE: &[&str] = &["absolute", "abs", "absolut", "absolutdruck"];

/// Words for quantities that grow when the muscle lengthens.
const LENGTHENING: &[&str] = &["extension", "elongation"];

/// Longest name that is analysed, in characters.
const LONGEST: usize = 100;

/// The words that stand for a column.
pub(crate) fn words_for(field: Field) -> impl Iterator<Item = &'static str> {
    WORDS.iter().filter(move |(_, meant, _)| *meant == field).map(|(word, _, _)| *word)
}

/// Possible meanings of a column from its heading and its unit in a row of units, if there is one; best
/// first.
pub(crate) fn guesses(heading: &str, unit_beneath: Option<&str>) -> Vec<Guess> {
    let heading: String = heading.trim().chars().take(LONGEST).collect();
    let beneath =
        unit_beneath.map(|text| text.trim_matches(['[', ']', '(', ')', ' '])).filter(|u| !u.is_empty());
    let mut found: Vec<Guess> = Vec::new();
    let (splits, says_unit) = splits(&heading, beneath);
    for (name, text) in &splits {
        let words = words(name);
        for field in fields(&words) {
            let mut unit = text.as_deref().and_then(|text| unit(field, text));
            if let Some(unit) = unit.as_mut().filter(|_| field == Field::Pressure) {
                unit.is_absolute |= words.iter().any(|word| ABSOLUTE.contains(&word.as_str()));
            }
            let is_known = match text.as_deref() {
                // A name whose unit doesn't suit its quantity means something else.
                Some(text) => unit.is_some() || (field.is_label() && matches!(text, "-" | "1")),
                None => !says_unit || field.is_label(),
            };
            if is_known && found.iter().all(|guess| guess.field != field) {
                let is_word_aside = |word: &String| {
                    ASIDE.contains(&word.as_str())
                        || ASIDE_BEGINNINGS.iter().any(|start| word.starts_with(start))
                };
                let is_aside = words.iter().any(is_word_aside) && field != Field::ForceSd;
                let strength = match (&unit, is_aside) {
                    _ if is_exact(&heading, field, unit.as_ref()) => Strength::Exact,
                    (_, true) => Strength::Aside,
                    (None, false) => Strength::NameAlone,
                    (Some(_), false) => Strength::NameAndUnit,
                };
                let is_lengthening = words.iter().any(|word| LENGTHENING.contains(&word.as_str()));
                found.push(Guess { field, strength, unit, is_lengthening });
            }
        }
    }
    if found.is_empty() {
        let texts = splits.iter().filter_map(|(_, text)| text.as_deref());
        let alone = |(field, text): (Field, &str)| {
            let unit = unit(field, text)?;
            Some(Guess { field, strength: Strength::UnitAlone, unit: Some(unit), is_lengthening: false })
        };
        // A column in millimetres is more often a displacement; its values then decide.
        let fields = [Field::Pressure, Field::Force, Field::Displacement, Field::Time, Field::Temperature];
        // A single letter at the end of a name is hardly a unit.
        let texts = texts.filter(|text| says_unit || text.len() > 1);
        found.extend(texts.flat_map(|text| fields.map(|field| (field, text))).filter_map(alone).take(1));
    }
    found.sort_by_key(|guess| std::cmp::Reverse(guess.strength));
    found
}

/// Whether a heading has the standard form: the name, and its unit in square brackets.
fn is_exact(heading: &str, field: Field, unit: Option<&Unit>) -> bool {
    let (name, inside) = match heading.split_once('[') {
        Some((name, rest)) => (name.trim(), rest.strip_suffix(']').map(str::trim)),
        None => (heading, Some("")),
    };
    let plain = name.to_lowercase().replace([' ', '-'], "_");
    let Some(inside) = inside.filter(|_| plain == field.name()) else { return false };
    match field.scale(inside) {
        None => matches!(inside, "" | "-" | "1"),
        Some(scale) => scale.is_ok() && unit.is_none_or(|unit| !unit.is_absolute),
    }
}

type Split = (String, Option<String>);

/// A heading as name and unit in all possible ways, and whether it certainly has a unit.
fn splits(heading: &str, beneath: Option<&str>) -> (Vec<Split>, bool) {
    if let Some(unit) = beneath {
        let plain = without_brackets(heading).map_or(heading.to_owned(), |(name, _)| name);
        return (vec![(plain, Some(unit.to_owned()))], true);
    }
    if let Some((name, unit)) = without_brackets(heading) {
        let says_unit = !unit.is_empty() && unit != "-" && unit != "1";
        return (vec![(name, Some(unit).filter(|unit| !unit.is_empty()))], says_unit);
    }
    let mut found = Vec::new();
    if let Some((name, unit)) = heading.split_once('/') {
        found.push((name.to_owned(), Some(unit.trim().to_owned())));
    }
    for word in [" in ", " en "] {
        if let Some((name, unit)) = heading.rsplit_once(word) {
            found.push((name.to_owned(), Some(unit.trim().to_owned())));
        }
    }
    let says_unit = !found.is_empty();
    if let Some((name, unit)) = heading.rsplit_once(['_', ' ', '.', ',', ':', '-', '|'])
        && !name.is_empty()
    {
        found.push((name.to_owned(), Some(unit.trim().to_owned())));
    }
    found.push((heading.to_owned(), None));
    (found, says_unit)
}

/// The text outside and inside the brackets of a unit: the last brackets, or the only nonempty ones.
fn without_brackets(heading: &str) -> Option<(String, String)> {
    let pairs = [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')];
    let (start, end) = pairs.iter().find_map(|(open, close)| {
        let start = heading.find(*open)?;
        // Nested brackets belong to the unit: "bar(g)" in "[bar(g)]".
        let end = heading.rfind(*close).filter(|end| *end > start)?;
        Some((start, end))
    })?;
    let name = format!("{} {}", heading[..start].trim(), heading[end + 1..].trim());
    Some((name.trim().to_owned(), heading[start + 1..end].trim().to_owned()))
}

/// The words of a name in lower case, without accents and trailing digits.
pub(crate) fn words(name: &str) -> Vec<String> {
    let mut plain = String::with_capacity(name.len());
    for c in name.to_lowercase().chars() {
        match c {
            '\u{e4}' => plain.push_str("ae"),
            '\u{f6}' => plain.push_str("oe"),
            '\u{fc}' => plain.push_str("ue"),
            '\u{df}' => plain.push_str("ss"),
            '\u{e8}'..='\u{eb}' => plain.push('e'),
            '\u{f2}' | '\u{f3}' => plain.push('o'),
            '\u{3b5}' => plain.push_str("epsilon"),
            c if c.is_alphanumeric() => plain.push(c),
            _ => plain.push(' '),
        }
    }
    let without_number = |word: &str| word.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    plain.split(' ').map(without_number).filter(|word| !word.is_empty()).collect()
}

/// The meanings of the words of a name.
fn fields(words: &[String]) -> Vec<Field> {
    let whole = words.join("_");
    let of = |is_it: &dyn Fn(&str, bool) -> bool| -> Vec<Field> {
        let mut found: Vec<Field> = Vec::new();
        for (_, field, _) in WORDS.iter().filter(|(word, _, is_whole)| is_it(word, *is_whole)) {
            if !found.contains(field) {
                found.push(*field);
            }
        }
        found
    };
    let found = of(&|known, _| known == whole);
    if !found.is_empty() {
        return found;
    }
    // Compound words: "Innendruck", "Zugkraft".
    let is_in = |word: &str, known: &str| {
        word == known
            || (known.len() >= 5 && word.contains(known))
            || (known.len() >= 3 && word.ends_with(known))
    };
    let found = of(&|known, is_whole| !is_whole && words.iter().any(|word| is_in(word, known)));
    if !found.is_empty() {
        return found;
    }
    // "p rel", "F Zug": symbols with a qualifying word.
    let first = words.first().map_or("", String::as_str);
    let symbols = [("p", Field::Pressure), ("f", Field::Force), ("t", Field::Time)];
    let symbol = symbols.iter().find(|(symbol, _)| *symbol == first).map(|(_, field)| *field);
    symbol.or_else(|| slip(&whole)).into_iter().collect()
}

/// The name that is one or two typing errors away.
pub(crate) fn slip(word: &str) -> Option<Field> {
    let slips = |field: &Field| strsim::damerau_levenshtein(field.name(), word);
    let closest = Field::ALL.into_iter().min_by_key(slips)?;
    (slips(&closest) * 4 <= word.chars().count()).then_some(closest)
}

/// The unit that is assumed if none is written: seconds, newtons, and dimensionless numbers.
pub(crate) fn assumed(field: Field) -> Option<(Scale, &'static str)> {
    match field {
        Field::Time => Some((Scale::SI, "s")),
        Field::Force | Field::ForceSd => Some((Scale::SI, "N")),
        Field::Contraction => Some((Scale::SI, "1")),
        _ if field.is_label() => Some((Scale::SI, "")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn reads(heading: &str, expected: Option<(Field, &str)>) {
        let found = guesses(heading, None);
        let first = found
            .first()
            .map(|guess| (guess.field, guess.unit.as_ref().map_or("", |unit| unit.name.as_str())));
        assert_eq!(first, expected, "{heading}");
    }

    #[test]
    fn headings_as_people_write_them() {
        for (heading, field, unit) in [
            ("Time (s)", Field::Time, "s"),
            ("Force_N", Field::Force, "N"),
            ("Displacement/mm", Field::Displacement, "mm"),
            ("t_s", Field::Time, "s"),
            ("TIME [S]", Field::Time, "s"),
            ("time [sec]", Field::Time, "s"),
            ("P [kPa]", Field::Pressure, "kPa"),
            ("Pressure (kPa gauge)", Field::Pressure, "kPa"),
            ("Kraft / N", Field::Force, "N"),
            ("T [\u{b0}C]", Field::Temperature, "\u{b0}C"),
            ("Innendruck in bar", Field::Pressure, "bar"),
            ("L\u{e4}nge (mm)", Field::Length, "mm"),
            ("Weg_mm", Field::Displacement, "mm"),
            ("Dev1/ai0 (psi)", Field::Pressure, "psi"),
            ("Load cell [lbf]", Field::Force, "lbf"),
            ("P1 (bar(g))", Field::Pressure, "bar"),
            ("Shortening (mm)", Field::Displacement, "mm"),
            ("Shortening (%)", Field::Contraction, "%"),
            ("Volume cm^3", Field::Volume, "cm^3"),
            ("presure [bar]", Field::Pressure, "bar"),
            ("X_Value", Field::Time, ""),
            ("Run", Field::Sweep, ""),
            ("pressure", Field::Pressure, ""),
        ] {
            reads(heading, Some((field, unit)));
        }
        for heading in
            ["stiffness [N/m]", "end_slope [rad]", "residual [-]", "Comment", "Force rate [N/s]", "I [A]", ""]
        {
            reads(heading, None);
        }
        let beneath = guesses("Muskelkraft", Some("[N]"));
        assert_eq!((beneath[0].field, beneath[0].strength), (Field::Force, Strength::NameAndUnit));
        let set = guesses("Pressure setpoint [bar]", None);
        assert_eq!((set[0].field, set[0].strength), (Field::Pressure, Strength::Aside));
        assert!(guesses("Extension (mm)", None)[0].is_lengthening);
        assert_eq!(guesses("force [N]", None)[0].strength, Strength::Exact);
    }
}
