//! A column during reading: takes fields as text or as numbers, and becomes one of the columns of the data
//! set.

use crate::cell::{self, Decimal};
use crate::cell_error::{CellError, OTHER_UNIT};
use crate::clock::{Clock, instant};
use crate::columns::{Columns, Labels, Trace};
use crate::heading::{Field, Heading};
use crate::quote::quoted;
use bulge_muscles::shown::{LONGEST_NAME, one_line};

/// Values of a column.
#[derive(Debug)]
enum Values {
    Numbers(Vec<f64>),
    Counts(Vec<i64>),
    Directions(Vec<i8>),
    Labels(Labels),
}

/// A column during reading.
#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) heading: Heading,
    values: Values,
    clock: Option<Clock>,
    /// Number of fields with a unit of their own.
    pub(crate) units_inside: usize,
}

impl Slot {
    /// An empty column with room for some rows.
    pub(crate) fn new(heading: Heading, rows: usize) -> Self {
        let values = match heading.field {
            Field::Sweep | Field::Specimen => Values::Labels(Labels::default()),
            Field::Cycle => Values::Counts(Vec::with_capacity(rows)),
            Field::Direction => Values::Directions(Vec::with_capacity(rows)),
            _ => Values::Numbers(Vec::with_capacity(rows)),
        };
        Self { heading, values, clock: None, units_inside: 0 }
    }

    /// Adds the next field as trimmed text. An unusable field leaves a gap: a value whose row must be
    /// dropped.
    pub(crate) fn push_text(&mut self, text: &str, decimal: Decimal) -> Result<(), CellError> {
        match &mut self.values {
            Values::Numbers(values) if decimal == Decimal::Point && self.clock.is_none() => {
                if let Ok(number) = text.parse::<f64>()
                    && let Ok(value) = cell::measurable(self.heading.scale.si(number), String::new)
                {
                    values.push(value);
                    return Ok(());
                }
            }
            Values::Labels(labels) if (1..=LONGEST_NAME).contains(&text.len()) => {
                labels.push(&one_line(text));
                return Ok(());
            }
            _ => {}
        }
        let found = self.push_unusual(text, decimal);
        if found.is_err() {
            self.push_gap();
        }
        found
    }

    /// Adds the next field if it isn't a plain number.
    #[cold]
    fn push_unusual(&mut self, text: &str, decimal: Decimal) -> Result<(), CellError> {
        match &mut self.values {
            Values::Numbers(values) => {
                let found = if self.heading.field == Field::Time {
                    in_time(text, decimal, &self.heading, &mut self.clock, values.is_empty())
                } else {
                    cell::written(text, decimal).map(|number| self.heading.scale.si(number))
                };
                let value = match found {
                    Err(problem) if problem.kind == OTHER_UNIT => {
                        self.units_inside += 1;
                        self.heading.with_unit_inside(text).ok_or(problem)?
                    }
                    found => found?,
                };
                values.push(cell::measurable(value, || quoted(text))?);
            }
            Values::Counts(values) => values.push(cell::whole(text, decimal)?),
            Values::Directions(values) => values.push(cell::direction(text)?),
            Values::Labels(_) if text.is_empty() => return Err(CellError::empty()),
            Values::Labels(_) => return Err(CellError::new("too long for a label", quoted(text))),
        }
        Ok(())
    }

    /// Adds the next field as a number.
    pub(crate) fn push_number(&mut self, number: f64) -> Result<(), CellError> {
        let found = self.try_number(number);
        if found.is_err() {
            self.push_gap();
        }
        found
    }

    fn try_number(&mut self, number: f64) -> Result<(), CellError> {
        match &mut self.values {
            Values::Numbers(values) => {
                let value = self.heading.scale.si(number);
                values.push(cell::measurable(value, || number.to_string())?);
            }
            Values::Counts(values) => values.push(cell::whole_of(number, &number.to_string())?),
            Values::Directions(values) => {
                values
                    .push(cell::sign(number).ok_or_else(|| CellError::not_a_direction(number.to_string()))?);
            }
            Values::Labels(labels) => labels.push(&number.to_string()),
        }
        Ok(())
    }

    /// Adds a value in place of a missing one; its row must be dropped.
    pub(crate) fn push_gap(&mut self) {
        match &mut self.values {
            Values::Numbers(values) => values.push(0.0),
            Values::Counts(values) => values.push(0),
            Values::Directions(values) => values.push(0),
            Values::Labels(labels) => labels.push(""),
        }
    }

    /// Its numbers; empty if it holds none.
    pub(crate) fn numbers(&self) -> &[f64] {
        if let Values::Numbers(values) = &self.values { values } else { &[] }
    }

    /// Changes its numbers, and turns it into another column.
    pub(crate) fn become_column(&mut self, field: Field, change: impl Fn(f64) -> f64) {
        self.heading.field = field;
        if let Values::Numbers(values) = &mut self.values {
            for value in values {
                *value = change(*value);
            }
        }
    }
}

/// A time in seconds, or on a clock; the first row decides which.
fn in_time(
    text: &str,
    decimal: Decimal,
    heading: &Heading,
    clock: &mut Option<Clock>,
    is_first: bool,
) -> Result<f64, CellError> {
    if let (Some(now), true) = (instant(text), clock.is_some() || is_first) {
        let since = clock.get_or_insert_default().since_start(now);
        return since.ok_or_else(|| CellError::new("a time of day among numbers", quoted(text)));
    }
    let number = cell::written(text, decimal)?;
    if clock.is_some() {
        return Err(CellError::new("no time of day", quoted(text)));
    }
    Ok(heading.scale.si(number))
}

/// Values without spare capacity.
fn fitted<T>(mut values: Vec<T>) -> Vec<T> {
    values.shrink_to_fit();
    values
}

/// The columns of a file. The headings have been checked to include pressure, force and one motion.
pub(crate) fn columns(slots: Vec<Slot>) -> Columns {
    let mut found = Columns::new(Vec::new(), Trace::Contraction(Vec::new()), Vec::new());
    for slot in slots {
        match (slot.heading.field, slot.values) {
            (Field::Pressure, Values::Numbers(values)) => found.pressure_pa = fitted(values),
            (Field::Contraction, Values::Numbers(values)) => {
                found.motion = Trace::Contraction(fitted(values));
            }
            (Field::Length | Field::Displacement, Values::Numbers(values)) => {
                found.motion = Trace::Length(fitted(values));
            }
            (Field::Force, Values::Numbers(values)) => found.force_n = fitted(values),
            (Field::Time, Values::Numbers(values)) => found.time_s = Some(fitted(values)),
            (Field::Temperature, Values::Numbers(values)) => found.temperature_k = Some(fitted(values)),
            (Field::Diameter, Values::Numbers(values)) => found.diameter_m = Some(fitted(values)),
            (Field::Volume, Values::Numbers(values)) => found.volume_m3 = Some(fitted(values)),
            (Field::ForceSd, Values::Numbers(values)) => found.force_sd_n = Some(fitted(values)),
            (_, Values::Counts(values)) => found.cycle = Some(fitted(values)),
            (_, Values::Directions(values)) => found.direction = Some(fitted(values)),
            (Field::Sweep, Values::Labels(labels)) => found.sweep = Some(labels),
            (_, Values::Labels(labels)) => found.specimen = Some(labels),
            // Only labels and counts are no numbers, see `Slot::new`.
            (_, Values::Numbers(_)) => {}
        }
    }
    // A file without forces, which the options allow.
    found.force_n.resize(found.pressure_pa.len(), 0.0);
    found
}
