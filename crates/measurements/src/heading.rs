//! The columns that measurements have: names, dimensions, and how a heading such as `length [mm]` is read.

use crate::cell;
use crate::dimension::{Scale, Time};
use crate::error::{CellError, MeasurementError};
use crate::quote::quoted;
use bulge_muscles::units::UnitError;
use bulge_muscles::{Force, Length, Pressure, Ratio, Volume};

/// A column of measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Field {
    Pressure,
    Contraction,
    Length,
    Force,
    Time,
    Sweep,
    Specimen,
    Cycle,
    Direction,
    Temperature,
    Diameter,
    Volume,
    ForceSd,
}

impl Field {
    pub(crate) const ALL: [Self; 13] = [
        Self::Pressure,
        Self::Contraction,
        Self::Length,
        Self::Force,
        Self::Time,
        Self::Sweep,
        Self::Specimen,
        Self::Cycle,
        Self::Direction,
        Self::Temperature,
        Self::Diameter,
        Self::Volume,
        Self::ForceSd,
    ];

    /// The heading as it should be, with a common unit.
    pub(crate) const fn example(self) -> &'static str {
        match self {
            Self::Pressure => "pressure [bar]",
            Self::Contraction => "contraction [%]",
            Self::Length => "length [mm]",
            Self::Force => "force [N]",
            Self::Time => "time [s]",
            Self::Sweep => "sweep",
            Self::Specimen => "specimen",
            Self::Cycle => "cycle",
            Self::Direction => "direction",
            Self::Temperature => "temperature [degC]",
            Self::Diameter => "diameter [mm]",
            Self::Volume => "volume [ml]",
            Self::ForceSd => "force_sd [N]",
        }
    }

    /// The name alone.
    pub(crate) fn name(self) -> &'static str {
        self.example().split(' ').next().unwrap_or_default()
    }

    /// The scale of a unit; none for labels and counts.
    fn scale(self, unit: &str) -> Option<Result<Scale, UnitError>> {
        Some(match self {
            Self::Pressure => Scale::of::<Pressure>(unit),
            Self::Contraction => Scale::of::<Ratio>(unit),
            Self::Length | Self::Diameter => Scale::of::<Length>(unit),
            Self::Force | Self::ForceSd => Scale::of::<Force>(unit),
            Self::Time => Scale::of::<Time>(unit),
            Self::Temperature => Scale::of_temperature(unit),
            Self::Volume => Scale::of::<Volume>(unit),
            Self::Sweep | Self::Specimen | Self::Cycle | Self::Direction => return None,
        })
    }
}

/// One heading, understood.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    pub(crate) field: Field,
    pub(crate) scale: Scale,
    /// As it is written.
    pub(crate) text: String,
}

impl Heading {
    /// A field with a unit gets its number in the unit of the heading.
    pub(crate) fn with_cure(&self, text: &str, problem: CellError) -> CellError {
        let CellError::UnitInside { text: shown, .. } = problem else { return problem };
        let in_si = |(number, unit)| Some(self.field.scale(unit)?.ok()?.si(number));
        let number = cell::with_unit(text).and_then(in_si).map(|si| self.scale.number(si));
        // Seven digits are enough for a cure, and hide the rounding of the factors.
        let rounded = number.and_then(|number| format!("{number:.6e}").parse::<f64>().ok());
        CellError::UnitInside { text: shown, fixed: rounded.map(|number| number.to_string()) }
    }
}

/// All headings, for messages.
pub(crate) fn known() -> String {
    Field::ALL.map(Field::example).join(", ")
}

/// Reads all headings of a file and checks that they make a data set. `line` is that of the header.
pub(crate) fn read(file: &str, line: usize, names: &[&str]) -> Result<Vec<Heading>, MeasurementError> {
    let is_number = |name: &&&str| name.trim().replacen(',', ".", 1).parse::<f64>().is_ok();
    if let Some(number) = names.first().filter(is_number) {
        return Err(MeasurementError::NoHeader { file: file.to_owned(), line, text: quoted(number) });
    }
    let mut headings: Vec<Heading> = Vec::with_capacity(names.len());
    for (i, name) in names.iter().enumerate() {
        let heading = read_one(file, line, i + 1, name)?;
        if let Some(first) = headings.iter().position(|other| other.field == heading.field) {
            let (name, first, second) = (heading.field.name(), first + 1, i + 1);
            return Err(MeasurementError::TwiceTheColumn {
                file: file.to_owned(),
                line,
                name,
                first,
                second,
            });
        }
        headings.push(heading);
    }
    let has = |field| headings.iter().any(|heading| heading.field == field);
    let missing = |field: Field, name| MeasurementError::MissingColumn {
        file: file.to_owned(),
        line,
        name,
        example: field.example(),
        found: headings.iter().map(|heading| quoted(&heading.text)).collect::<Vec<_>>().join(", "),
    };
    if has(Field::Contraction) && has(Field::Length) {
        return Err(MeasurementError::BothMotions { file: file.to_owned(), line });
    }
    if !has(Field::Pressure) {
        return Err(missing(Field::Pressure, "pressure"));
    }
    if !has(Field::Contraction) && !has(Field::Length) {
        return Err(missing(Field::Length, "length` or `contraction"));
    }
    if !has(Field::Force) {
        return Err(missing(Field::Force, "force"));
    }
    Ok(headings)
}

fn read_one(file: &str, line: usize, place: usize, text: &str) -> Result<Heading, MeasurementError> {
    let text = text.trim();
    // What data frames call the column of their row numbers.
    if ["", "__index_level_0__", "Unnamed: 0"].contains(&text) {
        return Err(MeasurementError::NoName { file: file.to_owned(), line, place, known: known() });
    }
    let (name, unit) = match text.split_once('[') {
        Some((name, rest)) => (name.trim(), rest.strip_suffix(']').map(str::trim)),
        None => (text, Some("")),
    };
    let plain = name.to_lowercase().replace([' ', '-'], "_");
    let field = Field::ALL.into_iter().find(|field| field.name() == plain);
    let (Some(field), Some(unit)) = (field, unit.filter(|unit| !unit.contains(['[', ']']))) else {
        return Err(MeasurementError::UnknownColumn {
            file: file.to_owned(),
            line,
            place,
            name: quoted(text),
            nearest: nearest(text),
            known: known(),
        });
    };
    let scale = match field.scale(unit) {
        None if matches!(unit, "" | "-" | "1") => Scale::SI,
        None => {
            return Err(MeasurementError::NeedlessUnit {
                file: file.to_owned(),
                line,
                column: quoted(text),
                name: field.name(),
            });
        }
        Some(found) => found.map_err(|problem| MeasurementError::Unit {
            file: file.to_owned(),
            line,
            column: quoted(text),
            problem: Box::new(problem),
            example: field.example(),
        })?,
    };
    Ok(Heading { field, scale, text: quoted(text) })
}

/// The heading that was probably meant: known words within the text, else few slips of the finger.
fn nearest(text: &str) -> Option<String> {
    /// Words that people write for a column.
    const WORDS: &[(&str, Field)] = &[
        ("force_sd", Field::ForceSd),
        ("displacement", Field::Length),
        ("position", Field::Length),
        ("stroke", Field::Length),
        ("strain", Field::Contraction),
        ("load", Field::Force),
        ("run", Field::Sweep),
        ("sample", Field::Specimen),
        ("muscle", Field::Specimen),
    ];
    let lower: String = text.to_lowercase().chars().take(100).collect();
    let word: String = lower.chars().take_while(|c| c.is_alphabetic() || *c == '_').collect();
    let close = |name: &str| strsim::damerau_levenshtein(name, &word);
    let symbol = match word.as_str() {
        "p" => Some(Field::Pressure),
        "l" | "x" => Some(Field::Length),
        "f" => Some(Field::Force),
        "t" => Some(Field::Time),
        "e" | "eps" | "epsilon" => Some(Field::Contraction),
        _ => None,
    };
    let slip = Field::ALL.into_iter().min_by_key(|field| close(field.name()));
    let slip = slip.filter(|field| close(field.name()) * 3 <= word.chars().count());
    let inside = || Field::ALL.into_iter().rev().find(|field| lower.contains(field.name()));
    let synonym = || WORDS.iter().find(|(name, _)| lower.contains(name)).map(|(_, field)| *field);
    // An absolute pressure is not made right by another name.
    if lower.contains("abs") {
        return None;
    }
    symbol.or(slip).or_else(inside).or_else(synonym).map(|field| field.example().to_owned())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "products of whole numbers are exact")]

    use super::*;

    #[track_caller]
    fn refuses(names: &[&str], parts: &[&str]) {
        let error = read("d.csv", 3, names).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.line(), Some(3));
        for part in parts.iter().chain(&["d.csv:3"]) {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[test]
    fn names_and_units_in_any_order() {
        let names = [" Force [kN] ", "Force SD [N]", "time[min]", "contraction", "sweep", "pressure [psi]"];
        let headings = read("d.csv", 1, &names).unwrap();
        let fields: Vec<_> = headings.iter().map(|heading| heading.field).collect();
        let expected =
            [Field::Force, Field::ForceSd, Field::Time, Field::Contraction, Field::Sweep, Field::Pressure];
        assert_eq!(fields, expected);
        assert_eq!([0, 2].map(|i: usize| headings[i].scale.si(2.0)), [2000.0, 120.0]);
    }

    #[test]
    fn wrong_headers_name_place_and_cure() {
        let rest = ["contraction [%]", "force [N]"];
        let with = |first| [first, rest[0], rest[1]];
        refuses(
            &with("presure [bar]"),
            &["column 1", "`presure [bar]`", "write `pressure [bar]`", "force_sd [N]"],
        );
        refuses(&with("pressure (bar)"), &["write `pressure [bar]`"]);
        refuses(&with("pressure_bar"), &["write `pressure [bar]`"]);
        refuses(&with("pressure [bar"), &["write `pressure [bar]`"]);
        let absolute = read("d.csv", 3, &with("absolute pressure [bar]")).unwrap_err().to_string();
        assert!(!absolute.contains("if that is meant"), "{absolute}");
        refuses(&with("qqq"), &["`qqq`", "known are pressure [bar]"]);
        for nameless in ["", " ", "__index_level_0__", "Unnamed: 0"] {
            refuses(&with(nameless), &["column 1 has no name", "`index=False`", "known are pressure [bar]"]);
        }
        refuses(&with("p [bar]"), &["column 1", "`p [bar]`", "write `pressure [bar]`"]);
        refuses(
            &with("pressure [bar] [bar]"),
            &["`pressure [bar] [bar]`, which is not known", "write `pressure [bar]`"],
        );
        refuses(&with("pressure [bar g]"), &["unknown unit", "did you mean `bar`?", "(known: Pa,"]);
        refuses(&with("1,5"), &["`1,5` is a number", "header"]);
        refuses(&with("pressure"), &["`pressure` has no unit (known: ", "`pressure [bar]`", "kPa"]);
        refuses(
            &with("pressure [mm]"),
            &["a unit of length where one of pressure is needed", "`pressure [bar]`"],
        );
        refuses(&with("pressure [Bar]"), &["did you mean `bar`"]);
        refuses(&with("sweep [s]"), &["no unit", "write `sweep`"]);
        refuses(&with("0.5"), &["`0.5` is a number", "header"]);
        refuses(&["pressure [bar]", "force [N]"], &["no column `length` or `contraction`", "`length [mm]`"]);
        refuses(&["pressure [bar]", "length [mm]"], &["no column `force`", "found: pressure [bar]"]);
        refuses(&rest, &["no column `pressure`"]);
        refuses(&["pressure [bar]", rest[0], rest[1], "force [kN]"], &["columns 3 and 4", "`force`"]);
        refuses(&["pressure [bar]", rest[0], rest[1], "length [mm]"], &["leave out"]);
        refuses(&with("displacement [mm]"), &["write `length [mm]`"]);
    }
}
