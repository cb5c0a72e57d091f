//! Reads the name of a muscle, such as "DMSP-20-200N-RM-RM": family, size, length.

/// A word or a number in a name.
#[derive(Debug, Clone, PartialEq)]
enum Part {
    Word(String),
    Number(f64),
}

/// The words (in lower case) and numbers of a name, in order.
fn parts(name: &str) -> Vec<Part> {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let mut runs: Vec<String> = Vec::new();
    let mut last = None;
    for c in name.chars().flat_map(char::to_lowercase) {
        let sort = (c.is_alphanumeric() || c == '.').then(|| is_number(c));
        match (sort, runs.last_mut()) {
            (Some(_), Some(run)) if sort == last => run.push(c),
            (Some(_), _) => runs.push(c.to_string()),
            (None, _) => {}
        }
        last = sort;
    }
    let part = |run: String| match run.parse() {
        // "nan" and "inf" count as words.
        Ok(number) if run.starts_with(is_number) => Part::Number(number),
        _ => Part::Word(run),
    };
    runs.into_iter().map(part).collect()
}

/// The numbers that follow a word.
fn numbers_after(parts: &[Part], word: &Part) -> Option<Vec<f64>> {
    let place = parts.iter().position(|part| part == word)?;
    let number = |part: &Part| if let Part::Number(number) = part { Some(*number) } else { None };
    Some(parts[place + 1..].iter().filter_map(number).collect())
}

/// The distance of a muscle from a type such as "DMSP-20-200": the difference of their second numbers (the
/// lengths).
///
/// None if the family (the type's first word) or its first number (the diameter, or the generation) differs
/// or is missing. A muscle without a length is at an infinite distance, which still counts as one.
pub(super) fn distance(muscle: &str, type_name: &str) -> Option<f64> {
    let wanted = parts(type_name);
    let family = wanted.first()?;
    let (wanted, found) = (numbers_after(&wanted, family)?, numbers_after(&parts(muscle), family)?);
    // Numbers as written are either equal or not, so no tolerance is needed.
    if wanted.first()?.to_bits() != found.first()?.to_bits() {
        return None;
    }
    match (wanted.get(1), found.get(1)) {
        (Some(wanted), Some(found)) => Some((wanted - found).abs()),
        _ => Some(f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_all_spellings() {
        for name in ["dmsp-20-200", "DMSP-20-200N-RM-RM", "Festo DMSP20-200N", "my 2nd dmsp 20, 200 mm"] {
            assert_eq!(distance(name, "DMSP-20-200"), Some(0.0), "{name}");
        }
        assert_eq!(distance("DMSP-20-300", "DMSP-20-400"), Some(100.0));
        assert_eq!(distance("DMSP-20", "DMSP-20-400"), Some(f64::INFINITY));
        assert_eq!(distance("ppam-2-r11.5", "PPAM-2-R16"), Some(4.5));
    }

    #[test]
    fn another_muscle_is_not_near() {
        for name in
            ["DMSP-10-200", "MAS-20-200", "ppam-2-r16", "dmsp", "dmsp-nan-200", "", "..", "20-200 dmsp"]
        {
            assert_eq!(distance(name, "DMSP-20-200"), None, "{name}");
        }
        assert_eq!(distance("ppam-1", "PPAM-2-R16"), None);
    }
}
