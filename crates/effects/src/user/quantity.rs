//! Values of a parameter: numbers with a unit of its dimension that are consistent with each other.

use bulge_muscles::settings::{Setting, Settings};
use bulge_muscles::units::{self, Any};
use bulge_muscles::{Dimension, FileError};

/// A parameter's table and its unit.
pub(crate) struct Quantity<'a> {
    pub(crate) table: Settings<'a>,
    pub(crate) unit: String,
    pub(crate) dimension: Dimension,
}

impl Quantity<'_> {
    /// Low, typical and high value, in this order.
    pub(crate) fn bounded(&self) -> Result<(f64, f64, f64), FileError> {
        let [low, high, typical] = ["low", "high", "typical"].map(|key| self.required(key));
        let (low, high, typical) = (low?, high?, typical?);
        if low >= high {
            let (low, high) = (self.shown(low), self.shown(high));
            let what = format!("`low` is {low}, but must be less than `high`, {high}");
            let instead = "write the smallest possible value as `low` and the largest as `high`\n\
                           a value that is known can stand in the formula as a number";
            return Err(self.table.error(self.table.value_span("low"), what, instead));
        }
        if !(low..=high).contains(&typical) {
            let what = format!(
                "`typical` is {}, outside of its bounds {}",
                self.shown(typical),
                self.range(low, high)
            );
            let place = self.table.value_span("typical");
            return Err(self.table.error(place, what, "write a value between `low` and `high`"));
        }
        Ok((low, typical, high))
    }

    /// Mean (within the bounds) and standard deviation, if they are stated.
    pub(crate) fn prior(&self, low: f64, high: f64) -> Result<Option<(f64, f64)>, FileError> {
        let Some(value) = self.table.get("prior") else { return Ok(None) };
        let (mean, width) = units::any_with_width(self.value_text("prior", value)?)
            .map_err(|error| self.refused("prior", value, error.to_string()))?;
        self.check("prior", value, &mean)?;
        let Some(width) = width.filter(|width| *width > 0.0) else {
            let instead = format!("write `{}`, or leave it out", self.example("prior"));
            let what = "`prior` has no standard deviation greater than 0";
            return Err(self.table.error(value.span(), what, instead));
        };
        if !(low..=high).contains(&mean.si) {
            let (mean, bounds) = (self.shown(mean.si), self.range(low, high));
            let what = format!("the mean of `prior` is {mean}, outside of its bounds {bounds}");
            return Err(self.table.error(value.span(), what, "write a mean between `low` and `high`"));
        }
        Ok(Some((mean.si, width)))
    }

    /// An SI value as it would be written in the file.
    fn shown(&self, si: f64) -> String {
        units::exact_any_text(si, &self.unit)
    }

    fn range(&self, low: f64, high: f64) -> String {
        format!("{} to {}", self.shown(low), self.shown(high))
    }

    fn example(&self, key: &str) -> String {
        let number = if self.is_plain() { "0.5".to_owned() } else { format!("\"50 {}\"", self.unit) };
        match key {
            "prior" if self.is_plain() => "prior = \"0.5 +- 0.1\"".to_owned(),
            "prior" => format!("prior = \"50 {0} +- 10 {0}\"", self.unit),
            _ => format!("{key} = {number}"),
        }
    }

    /// Whether a bare number counts as a value in this unit.
    fn is_plain(&self) -> bool {
        self.dimension.is_none() && matches!(self.unit.as_str(), "1" | "-" | "rad" | "decade")
    }

    fn required(&self, key: &str) -> Result<f64, FileError> {
        let value = self.table.get(key).ok_or_else(|| {
            let what = format!("{} needs `{key}`, which is missing", self.table.title());
            self.table.error(self.table.key_span(key), what, format!("add `{}`", self.example(key)))
        })?;
        let found = units::any(self.value_text(key, value)?)
            .map_err(|error| self.refused(key, value, error.to_string()))?;
        self.check(key, value, &found)?;
        Ok(found.si)
    }

    fn value_text<'v>(&self, key: &str, value: Setting<'v>) -> Result<&'v str, FileError> {
        value.number().ok_or_else(|| {
            let what = format!("`{key}` is {}, but must be a number with its unit", value.type_name());
            self.refused(key, value, what)
        })
    }

    fn refused(&self, key: &str, value: Setting<'_>, what: String) -> FileError {
        self.table.error(value.span(), what, format!("write `{}`", self.example(key)))
    }

    /// Checks the unit of a value against that of the parameter. A bare number isn't a value in per cent or
    /// degrees.
    fn check(&self, key: &str, value: Setting<'_>, found: &Any) -> Result<(), FileError> {
        let wanted = format!("a parameter in `{}` needs {}", self.unit, self.dimension.describe());
        let what = if found.dimension != self.dimension && found.unit.is_empty() {
            format!("`{key}` has no unit, but {wanted}")
        } else if found.dimension != self.dimension {
            format!("`{key}` is {}, but {wanted}", found.dimension.describe())
        } else if found.unit.is_empty() && !self.is_plain() {
            format!("`{key}` has no unit, but the parameter is in `{}`", self.unit)
        } else {
            return Ok(());
        };
        Err(self.refused(key, value, what))
    }
}
