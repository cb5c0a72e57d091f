//! Fitted parameters as rows of a table, with remarks on each.

use bulge_inference::{Comparison, Fitted};
use serde::Serialize;

use crate::comparison::number::{level, three};
use crate::comparison::wording::last_fit;
use crate::interval::with_interval;

/// One row.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    label: String,
    about: String,
    value: String,
    also: String,
    interval: String,
    plausible: String,
    /// Remarks that are warnings.
    alerts: Vec<String>,
    /// Remarks that aren't.
    notes: Vec<String>,
}

/// All fitted parameters of the last rung.
pub(super) fn rows(comparison: &Comparison) -> Vec<Row> {
    last_fit(comparison).map(|fit| fit.parameters.iter().map(row).collect()).unwrap_or_default()
}

fn row(parameter: &Fitted) -> Row {
    let mut alerts = Vec::new();
    match (parameter.plausible, parameter.nuisance) {
        (true, _) => {}
        (false, true) => alerts.push("beyond its data sheet: it makes up for something else".to_owned()),
        (false, false) => alerts.push("implausible: a wrong cure".to_owned()),
    }
    if let Some(end) = parameter.at_bound {
        alerts.push(format!("at the {end} bound"));
    }
    if !parameter.determined {
        alerts.push("not determined by these data".to_owned());
    }
    let mut notes = Vec::new();
    if parameter.nuisance && parameter.plausible {
        notes.push("nuisance, within its stated width".to_owned());
    }
    if parameter.interval == "profile" {
        notes.push("interval by profile".to_owned());
    }
    let also = parameter.also.as_ref().filter(|(_, value, _)| value.is_finite());
    let [low, high] = parameter.plausible_range;
    Row {
        label: label(parameter),
        about: parameter.about.clone(),
        value: value(parameter),
        also: also
            .map(|(name, value, unit)| with_unit(&format!("{name} {}", three(*value)), unit))
            .unwrap_or_default(),
        interval: interval(parameter),
        plausible: match (low.is_finite(), high.is_finite()) {
            (true, true) => format!("{} to {}", level(low), level(high)),
            (true, false) => format!("from {}", level(low)),
            (false, true) => format!("up to {}", level(high)),
            (false, false) => "any".to_owned(),
        },
        alerts,
        notes,
    }
}

/// `effect: name`, with the specimen if each specimen has its own value.
pub(super) fn label(parameter: &Fitted) -> String {
    match &parameter.specimen {
        Some(specimen) => format!("{}: {} ({specimen})", parameter.effect, parameter.name),
        None => format!("{}: {}", parameter.effect, parameter.name),
    }
}

/// The value with its unit.
pub(super) fn value(parameter: &Fitted) -> String {
    with_unit(&shown(parameter)[0], &parameter.unit)
}

fn with_unit(value: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { value.to_owned() } else { format!("{value} {unit}") }
}

/// Value and ends of the interval, with enough decimals to show the interval.
fn shown(parameter: &Fitted) -> [String; 3] {
    let ends = [parameter.low, parameter.high];
    match with_interval(parameter.value, ends) {
        Some(shown) => shown.map(|text| text.replace('-', "−")),
        None => [parameter.value, parameter.low, parameter.high].map(three),
    }
}

/// The interval in brackets.
pub(super) fn interval(parameter: &Fitted) -> String {
    let [_, low, high] = shown(parameter);
    match (parameter.low.is_finite(), parameter.high.is_finite()) {
        (false, false) => "[unbounded]".to_owned(),
        _ => format!("[{low} to {high}]"),
    }
}
