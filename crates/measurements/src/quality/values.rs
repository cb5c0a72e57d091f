//! Values that no muscle has, most often a wrong unit or sign.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::Motion;
use std::f64::consts::PI;

/// Less than a vacuum, as gauge pressure with some error of the zero \[Pa\].
const VACUUM: f64 = -1.05e5;
/// More than any muscle holds \[Pa\].
const BURST: f64 = 1e8;
/// More than any muscle pulls \[N\].
const FORCE: f64 = 1e6;
/// More than p pi r^2 is ever multiplied by.
const FORCE_OF_AREA: f64 = 1e3;
/// Contractions that a muscle can have, compressed and overstretched.
const CONTRACTION: [f64; 2] = [-1.0, 0.6];
/// Temperatures at which muscles are tested \[K\].
const TEMPERATURE: [f64; 2] = [150.0, 500.0];

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let data = gate.data;
    let impossible = |values: &[f64], what: &str, unit: &str, is_wrong: &dyn Fn(usize, f64) -> bool, instead| {
        let rows: Vec<usize> =
            values.iter().enumerate().filter(|(row, v)| is_wrong(*row, **v)).map(|(row, _)| row).collect();
        let says = |count| {
            let worst = rows.iter().map(|row| values[*row]).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            format!("{} {what}, such as {:.6}{unit}", rows_in_words(count), worst.unwrap_or(0.0))
        };
        gate.finding_if_any(FindingKind::ImpossibleValue, Severity::Error, &rows, says, instead)
    };
    let contraction = match data.motion() {
        Motion::Contraction(_) => Some(data.contraction(1.0)),
        Motion::Length(_) => gate.options.l0_m.filter(|l0| *l0 > 0.0).map(|l0| data.contraction(l0)),
    };
    let length = match data.motion() {
        Motion::Length(values) => Some(values),
        Motion::Contraction(_) => None,
    };
    let area = gate.options.radius_m.map(|radius| PI * radius * radius);
    let pressure = data.pressure();
    let is_absurd = |row: usize, force: f64| {
        let limit = area.map(|area| FORCE_OF_AREA * area * pressure[row].abs().max(1e5));
        force.abs() > limit.map_or(FORCE, |limit| limit.min(FORCE))
    };
    let positive = "remove the rows, or check unit and sign: it must be greater than 0";
    let mut found = vec![
        impossible(
            pressure,
            "have a gauge pressure below a vacuum",
            " Pa",
            &|_, p| p < VACUUM,
            "check the unit, and that the pressure is gauge pressure",
        ),
        impossible(
            pressure,
            "have a pressure above 1000 bar",
            " Pa",
            &|_, p| p > BURST,
            "check the unit of the pressure in the header",
        ),
        impossible(
            contraction.as_deref().unwrap_or_default(),
            "have a contraction outside -1 to 0.6",
            "",
            &|_, c| !(CONTRACTION[0]..=CONTRACTION[1]).contains(&c),
            "write `contraction [%]` if it is in per cent; for lengths, check the unit and the muscle's own length",
        ),
        impossible(length.unwrap_or_default(), "have a length of 0 or less", " m", &|_, l| l <= 0.0, positive),
        impossible(
            data.force(),
            "have a force beyond any muscle of this size",
            " N",
            &is_absurd,
            "check the unit of the force in the header",
        ),
        impossible(
            data.temperature().unwrap_or_default(),
            "have a temperature outside 150 K to 500 K",
            " K",
            &|_, t| !(TEMPERATURE[0]..=TEMPERATURE[1]).contains(&t),
            "check the unit of the temperature: `temperature [degC]` or `temperature [K]`",
        ),
    ];
    for (values, what, unit) in [
        (data.diameter(), "have a diameter of 0 or less", " m"),
        (data.volume(), "have a volume of 0 or less", " m^3"),
        (data.force_sd(), "have a standard deviation of the force of 0 or less", " N"),
    ] {
        found.push(impossible(values.unwrap_or_default(), what, unit, &|_, v| v <= 0.0, positive));
    }
    found.into_iter().flatten().collect()
}
