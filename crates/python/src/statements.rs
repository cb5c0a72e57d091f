//! What a caller states beside data, muscle and effects: rows to leave out, numbers held, bounded or tied.

use bulge_inference::{Options, Statements};
use bulge_measurements::Data;
use bulge_muscles::Muscle;
use pyo3::prelude::*;

use crate::error::{OrRaise, input};

/// A value of a number: in SI, or text with its unit.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) enum Value {
    Number(f64),
    Text(String),
}

/// Both bounds of a number, one by one or as text such as "5..20 N".
#[derive(Debug, Clone, FromPyObject)]
pub(crate) enum Bounds {
    Text(String),
    Pair(Value, Value),
}

/// What is stated: the lines of rows to leave out; numbers by name, held at a value, between two values, with the value of another.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) struct Said(Option<String>, Vec<(String, Value)>, Vec<(String, Bounds)>, Vec<(String, String)>);

impl Said {
    /// The options with what is stated; `muscle` is the one that is fitted.
    pub(crate) fn apply(
        &self,
        py: Python<'_>,
        options: Options,
        data: &Data,
        muscle: &Muscle,
    ) -> PyResult<Options> {
        let Self(exclude, hold, bound, tie) = self;
        let options = match exclude {
            Some(lines) => options.excluding(lines, data).or_raise()?,
            None => options,
        };
        let text = |about: &str, name: &str, value: &Value| -> PyResult<String> {
            Ok(match value {
                Value::Text(text) => text.clone(),
                Value::Number(value) => {
                    let unit = options.si_unit_of(name, muscle);
                    let unit = unit.map_err(|what| input(format!("{about}: {what}")))?;
                    if unit == "1" { value.to_string() } else { format!("{value} {unit}") }
                }
            })
        };
        let held = |(name, value): &(String, Value)| Ok(format!("{name}={}", text("hold", name, value)?));
        let bounded = |(name, bounds): &(String, Bounds)| match bounds {
            Bounds::Text(range) => Ok(format!("{name}={range}")),
            Bounds::Pair(low, high) => {
                let [low, high] = [text("bound", name, low)?, text("bound", name, high)?];
                Ok(format!("{name}={low}..{high}"))
            }
        };
        let statements = Statements {
            hold: hold.iter().map(held).collect::<PyResult<_>>()?,
            bound: bound.iter().map(bounded).collect::<PyResult<_>>()?,
            tie: tie.iter().map(|(name, other)| format!("{name}={other}")).collect(),
        };
        py.detach(|| options.stating(&statements, data, muscle)).or_raise()
    }
}
