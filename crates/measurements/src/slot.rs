//! A column while it is read: takes fields as text or as numbers, and becomes one of the columns of the data set.

use crate::cell;
use crate::columns::{Columns, Labels, Trace};
use crate::error::CellError;
use crate::heading::{Field, Heading};
use crate::quote::quoted;

/// What a column holds.
#[derive(Debug)]
enum Values {
    Numbers(Vec<f64>),
    Counts(Vec<i64>),
    Directions(Vec<i8>),
    Labels(Labels),
}

/// A column while it is read.
#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) heading: Heading,
    values: Values,
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
        Self { heading, values }
    }

    /// The next field, as text without blanks around it.
    pub(crate) fn push_text(&mut self, text: &str) -> Result<(), CellError> {
        match &mut self.values {
            Values::Numbers(values) => {
                let number = cell::number(text).map_err(|problem| self.heading.with_cure(text, problem))?;
                values.push(cell::measurable(self.heading.scale.si(number), || quoted(text))?);
            }
            Values::Counts(values) => values.push(cell::whole(text)?),
            Values::Directions(values) => values.push(cell::direction(text)?),
            Values::Labels(_) if text.is_empty() => return Err(CellError::Empty),
            Values::Labels(labels) => labels.push(text),
        }
        Ok(())
    }

    /// The next field, as a number.
    pub(crate) fn push_number(&mut self, number: f64) -> Result<(), CellError> {
        match &mut self.values {
            Values::Numbers(values) => {
                let value = self.heading.scale.si(number);
                values.push(cell::measurable(value, || number.to_string())?);
            }
            Values::Counts(values) => values.push(cell::whole_of(number, &number.to_string())?),
            Values::Directions(values) => values.push(
                cell::sign(number).ok_or_else(|| CellError::NotADirection { text: number.to_string() })?,
            ),
            Values::Labels(labels) => labels.push(&number.to_string()),
        }
        Ok(())
    }
}

/// The columns of a file. The headings have been checked: pressure, force and one motion are among them.
pub(crate) fn columns(slots: Vec<Slot>) -> Columns {
    let mut found = Columns::new(Vec::new(), Trace::Contraction(Vec::new()), Vec::new());
    for slot in slots {
        match (slot.heading.field, slot.values) {
            (Field::Pressure, Values::Numbers(values)) => found.pressure_pa = values,
            (Field::Contraction, Values::Numbers(values)) => found.motion = Trace::Contraction(values),
            (Field::Length, Values::Numbers(values)) => found.motion = Trace::Length(values),
            (Field::Force, Values::Numbers(values)) => found.force_n = values,
            (Field::Time, Values::Numbers(values)) => found.time_s = Some(values),
            (Field::Temperature, Values::Numbers(values)) => found.temperature_k = Some(values),
            (Field::Diameter, Values::Numbers(values)) => found.diameter_m = Some(values),
            (Field::Volume, Values::Numbers(values)) => found.volume_m3 = Some(values),
            (Field::ForceSd, Values::Numbers(values)) => found.force_sd_n = Some(values),
            (_, Values::Counts(values)) => found.cycle = Some(values),
            (_, Values::Directions(values)) => found.direction = Some(values),
            (Field::Sweep, Values::Labels(labels)) => found.sweep = Some(labels),
            (_, Values::Labels(labels)) => found.specimen = Some(labels),
            // Only labels and counts are no numbers: `Slot::new`.
            (_, Values::Numbers(_)) => {}
        }
    }
    found
}
