//! The results of a fit for a muscle's numbers: their uncertainties and their correlations.
//!
//! ```toml
//! [fitted]
//! error = "4.1 N"          # RMS error of the rows that the muscle was fitted to
//! rows = 238               # of them, those that count as independent
//!
//! [[fitted.numbers]]
//! effect = "coulomb-friction"
//! number = "force"
//! value = "14 N +- 0.3 N"  # one standard deviation
//! correlations = [0.12]    # with the numbers before it
//! ```

use serde::Serialize;

use crate::file_error::FileError;
use crate::learnt::LearntValue;
use crate::muscle::Muscle;
use crate::quantity::Force;
use crate::settings::{Keys, Setting, Settings};
use crate::units::{self, Quantity, exact_text};

/// Keys of the table and of one of its numbers.
const KEYS: Keys = &[("error", "error = \"4 N\""), ("rows", "rows = 238"), ("numbers", "[[fitted.numbers]]")];
const NUMBER: Keys = &[
    ("effect", "effect = \"coulomb-friction\""),
    ("number", "number = \"force\""),
    ("value", "value = \"14 N +- 0.3 N\""),
    ("correlations", "correlations = [0.12, -0.3]"),
];

/// The results of a fit for numbers of a muscle. Other commands take the numbers as known.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FittedNumbers {
    /// RMS error of the rows to which the muscle was fitted \[N\].
    pub error_n: f64,
    /// Number of these rows that count as independent.
    pub rows: u64,
    /// The numbers.
    pub numbers: Vec<FittedNumber>,
}

/// A number that was fitted, with its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedNumber {
    /// The effect.
    pub effect: String,
    /// Its key in the effect's table, its value and its standard deviation as width.
    pub value: LearntValue,
    /// Correlations with the numbers before it, in their order.
    pub correlations: Vec<f64>,
}

impl FittedNumbers {
    /// Standard deviation of a number \[SI\].
    #[must_use]
    pub fn sd(&self, place: usize) -> f64 {
        self.numbers.get(place).and_then(|number| number.value.width).unwrap_or(0.0)
    }

    /// Correlation of two numbers.
    #[must_use]
    pub fn correlation(&self, one: usize, other: usize) -> f64 {
        let (first, last) = (one.min(other), one.max(other));
        if first == last {
            return 1.0;
        }
        self.numbers.get(last).and_then(|number| number.correlations.get(first)).copied().unwrap_or(0.0)
    }

    /// The numbers to be kept, with their correlations.
    #[must_use]
    pub fn keeping(&self, keep: impl Fn(&FittedNumber) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.numbers.len()).filter(|place| keep(&self.numbers[*place])).collect();
        let number = |(after, place): (usize, &usize)| FittedNumber {
            correlations: kept[..after].iter().map(|before| self.correlation(*before, *place)).collect(),
            ..self.numbers[*place].clone()
        };
        Self { numbers: kept.iter().enumerate().map(number).collect(), ..*self }
    }
}

impl Muscle {
    /// The same muscle with the results of a fit of its numbers; without results if they hold no numbers.
    #[must_use]
    pub fn with_fitted(mut self, fitted: FittedNumbers) -> Self {
        self.fitted = Some(fitted).filter(|fitted| !fitted.numbers.is_empty());
        self
    }

    /// The results of a fit of its numbers.
    #[must_use]
    pub fn fitted(&self) -> Option<&FittedNumbers> {
        self.fitted.as_ref()
    }
}

/// The lines of the file.
pub(crate) fn lines(fitted: &FittedNumbers) -> Vec<String> {
    let mut lines = vec![
        "\n[fitted]".to_owned(),
        format!("error = \"{}\"", exact_text(Force::from_si(fitted.error_n))),
        format!("rows = {}", fitted.rows),
    ];
    for number in &fitted.numbers {
        lines.extend([
            "\n[[fitted.numbers]]".to_owned(),
            format!("effect = \"{}\"", number.effect),
            format!("number = \"{}\"", number.value.key),
            format!("value = {}", number.value.text()),
        ]);
        if !number.correlations.is_empty() {
            let all: Vec<String> = number.correlations.iter().map(|r| format!("{r:?}")).collect();
            lines.push(format!("correlations = [{}]", all.join(", ")));
        }
    }
    lines
}

/// The table `[fitted]` of a file.
pub(crate) fn fitted_in(root: &Settings<'_>) -> Result<Option<FittedNumbers>, FileError> {
    let Some(table) = root.table("fitted", "`[fitted]`", KEYS)? else { return Ok(None) };
    table.check_keys()?;
    let error = table.parsed("error", units::parse::<Force>)?.ok_or_else(|| table.missing("error"))?;
    if error.si() < 0.0 {
        let what = "`error` is an RMS error, which can't be negative";
        return Err(table.error(
            table.value_span("error"),
            what,
            format!("write such as `{}`", table.example("error")),
        ));
    }
    let rows = table.count("rows")?.ok_or_else(|| table.missing("rows"))?;
    let mut numbers = Vec::new();
    for one in table.tables("numbers", "`[[fitted.numbers]]`", NUMBER)?.unwrap_or_default() {
        one.check_keys()?;
        numbers.push(number_in(&one, numbers.len())?);
    }
    Ok(Some(FittedNumbers { error_n: error.si(), rows, numbers }))
}

fn number_in(table: &Settings<'_>, place: usize) -> Result<FittedNumber, FileError> {
    let [effect, number] = ["effect", "number"].map(|key| table.text(key)?.ok_or_else(|| table.missing(key)));
    let value = table.get("value").ok_or_else(|| table.missing("value"))?;
    let value = LearntValue { key: number?.to_owned(), ..table.learnt_value("value", value)? };
    if value.width.is_none() {
        let what = "a fitted number needs its standard deviation";
        return Err(table.error(
            table.value_span("value"),
            what,
            format!("write such as `{}`", table.example("value")),
        ));
    }
    let wrong = |setting: Option<Setting<'_>>| {
        let span = setting.map_or_else(|| table.value_span("correlations"), Setting::span);
        let what =
            format!("`correlations` are {place} numbers from -1 to 1, with the numbers before this one");
        table.error(span, what, "fit again, or take the table `[fitted]` out")
    };
    let correlations = match table.get("correlations") {
        None => Vec::new(),
        Some(list) => list.items().ok_or_else(|| wrong(Some(list)))?,
    };
    if correlations.len() != place {
        return Err(wrong(table.get("correlations")));
    }
    let one = |item: &Setting<'_>| {
        let number = item.number().and_then(|text| text.parse::<f64>().ok());
        number.filter(|r| (-1.0..=1.0).contains(r)).ok_or_else(|| wrong(Some(*item)))
    };
    let correlations = correlations.iter().map(one).collect::<Result<_, _>>()?;
    Ok(FittedNumber { effect: effect?.to_owned(), value, correlations })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dimension::Dimension;
    use crate::{from_toml, preset, to_toml};

    fn number(effect: &str, si: f64, correlations: &[f64]) -> FittedNumber {
        let value = LearntValue {
            key: "force".to_owned(),
            si,
            dimension: Dimension::FORCE,
            unit: "N".to_owned(),
            width: Some(0.3),
        };
        FittedNumber { effect: effect.to_owned(), value, correlations: correlations.to_vec() }
    }

    #[test]
    fn what_is_known_survives_a_file() {
        let numbers =
            vec![number("a", 14.0, &[]), number("b", 2.5, &[-0.25]), number("c", 1.0, &[0.5, 0.75])];
        let fitted = FittedNumbers { error_n: 4.125, rows: 238, numbers };
        let muscle = preset("ppam-2-r16").unwrap().with_fitted(fitted.clone());
        let back = from_toml(&to_toml(&muscle), "m.toml").unwrap();
        assert_eq!(back, muscle);
        let kept = fitted.keeping(|number| number.effect != "a");
        assert_eq!((kept.numbers.len(), kept.numbers[0].correlations.len()), (2, 0));
        assert!(
            (kept.correlation(1, 0) - 0.75).abs() < 1e-15 && (fitted.correlation(0, 2) - 0.5).abs() < 1e-15
        );
        assert!(preset("ppam-2-r16").unwrap().with_fitted(FittedNumbers::default()).fitted().is_none());
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        let base = to_toml(&preset("ppam-2-r16").unwrap());
        let one = "[[fitted.numbers]]\neffect = \"a\"\nnumber = \"force\"\n";
        let head = "[fitted]\nerror = \"4 N\"\nrows = 20\n";
        for (text, part) in [
            ("[fitted]\nrows = 20\n".to_owned(), "needs `error`"),
            ("[fitted]\nerror = \"-4 N\"\nrows = 20\n".to_owned(), "can't be negative"),
            (format!("{head}other = 3\n"), "unknown key `other`"),
            (format!("{head}{one}value = \"3 N\"\n"), "needs its standard deviation"),
            (format!("{head}{one}value = \"3 N +- 1 N\"\ncorrelations = [0.1]\n"), "are 0 numbers"),
            (format!("{head}{one}value = \"3 N +- 1 N\"\n{one}value = \"1 N +- 1 N\"\n"), "are 1 numbers"),
            (
                format!(
                    "{head}{one}value = \"3 N +- 1 N\"\n{one}value = \"1 N +- 1 N\"\ncorrelations = [2]\n"
                ),
                "from -1 to 1",
            ),
        ] {
            let message = from_toml(&format!("{base}\n{text}"), "m.toml").unwrap_err().to_string();
            assert!(
                message.starts_with("m.toml:") && message.contains(part),
                "{message:?} does not say {part:?}"
            );
        }
    }
}
