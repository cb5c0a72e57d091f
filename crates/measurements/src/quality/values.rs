//! Impossible values, most often from a wrong unit or sign.

use super::quantisation::four;
use super::{Finding, FindingKind, Gate, QualityOptions, Severity, rows_in_words};
use crate::Trace;
use crate::data::Data;
use crate::resolution::bounds;
use std::f64::consts::PI;

/// Below a vacuum as gauge pressure, with some margin for the zero error \[Pa\].
const VACUUM: f64 = -1.05e5;
/// Above the pressure that any muscle holds, hydraulic ones included \[Pa\].
const BURST: f64 = 1.5e7;
/// Below the pressure of any test if all pressures are positive: bars labelled as pascals \[Pa\].
const HARDLY: f64 = 20.0;
/// Above the force of any muscle \[N\].
const FORCE: f64 = 1e6;
/// Above any ratio of the force to p pi r^2.
const FORCE_OF_AREA: f64 = 1e3;
/// Contractions that are possible for a muscle, from overstretched to fully contracted.
const CONTRACTION: [f64; 2] = [-1.0, 0.6];
/// Temperatures at which muscles are tested \[K\].
const TEMPERATURE: [f64; 2] = [150.0, 500.0];

/// Rows with an impossible value, in ascending order.
struct Impossible {
    rows: Vec<usize>,
    says: String,
    instead: &'static str,
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let found = readings(gate).into_iter().chain(others(gate));
    let finding = |Impossible { rows, says, instead }| {
        gate.finding(FindingKind::ImpossibleValue, Severity::Error, &rows, says, instead)
    };
    found.map(finding).collect()
}

/// Rows with an impossible pressure, motion or force, and what is.
pub(super) fn rows(gate: &Gate) -> impl Iterator<Item = (Vec<usize>, String)> {
    let told = |found: Impossible| {
        let why = format!("impossible: {}; {}", found.says, found.instead);
        (found.rows, why)
    };
    readings(gate).into_iter().filter(|found| !found.is_unit(gate.data.len(), |_| true)).map(told)
}

impl Impossible {
    /// Where half of `all` rows that count have an impossible reading it is the unit that is wrong, not the rows.
    fn is_unit(&self, all: usize, counts: impl Fn(usize) -> bool) -> bool {
        let wrong = self.rows.iter().filter(|row| counts(**row)).count();
        wrong > 0 && 2 * wrong >= all
    }
}

impl Data {
    /// The pressure or force that no muscle has and half of the rows that count or more have, and what to check; none if there is no
    /// such reading.
    #[must_use]
    pub fn impossible(&self, counts: impl Fn(usize) -> bool) -> Option<String> {
        if self.is_empty() {
            return None;
        }
        let options = QualityOptions::default();
        let gate = Gate::new(self, &options);
        let all = (0..self.len()).filter(|row| counts(*row)).count();
        let mut found = pressures(&gate).into_iter().chain(forces(&gate));
        let found = found.find(|found| found.is_unit(all, &counts))?;
        Some(format!("{}; {}", found.says, found.instead))
    }
}

fn readings(gate: &Gate) -> Vec<Impossible> {
    let mut found = pressures(gate);
    found.extend(motions(gate));
    found.extend(forces(gate));
    found
}

/// Rows with an impossible value; `what` comes after "3 rows with" and before the worst value and its unit.
fn impossible(
    values: &[f64],
    [what, unit]: [&str; 2],
    is_wrong: impl Fn(usize, f64) -> bool,
    instead: &'static str,
) -> Option<Impossible> {
    let rows: Vec<usize> =
        values.iter().enumerate().filter(|(row, v)| is_wrong(*row, **v)).map(|(row, _)| row).collect();
    let worst = rows.iter().map(|row| values[*row]).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let worst = four(if unit == "bar" { 1e-5 * worst } else { worst });
    let says = format!("{} with {what}, such as {worst} {unit}", rows_in_words(rows.len()));
    Some(Impossible { rows, says: says.trim_end().to_owned(), instead })
}

fn pressures(gate: &Gate) -> Vec<Impossible> {
    let values = gate.data.pressure();
    let below = impossible(
        values,
        ["a gauge pressure below a vacuum", "bar"],
        |_, p| p < VACUUM,
        "check the unit, and that the pressure is gauge pressure",
    );
    let above = impossible(
        values,
        ["a pressure above 150 bar", "bar"],
        |_, p| p > BURST,
        "check the unit of the pressure in the header",
    );
    let (low, high) = bounds(values);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    // Readings around zero belong to a vented muscle.
    let is_tiny = low >= 0.0 && high > 0.0 && high < HARDLY && mean > 0.25 * high;
    let tiny = impossible(
        values,
        ["a pressure below 20 Pa, though above 0", "Pa"],
        |_, p| is_tiny && p > 0.0,
        "check the unit of the pressure in the header",
    );
    below.into_iter().chain(above).chain(tiny).collect()
}

fn motions(gate: &Gate) -> Vec<Impossible> {
    let l0 = gate.options.l0_m.filter(|l0| *l0 > 0.0);
    let (contraction, length): (Vec<f64>, &[f64]) = match gate.data.motion() {
        Trace::Contraction(values) => (values.clone(), &[]),
        Trace::Length(values) => (l0.map_or_else(Vec::new, |l0| gate.data.contraction(l0)), values),
    };
    let outside = impossible(
        &contraction,
        ["a contraction outside -1 to 0.6", ""],
        |_, c| !(CONTRACTION[0]..=CONTRACTION[1]).contains(&c),
        "write `contraction [%]` if it is in per cent; for lengths, check the unit and the muscle's own length",
    );
    let gone = impossible(
        length,
        ["a length of 0 or less", "m"],
        |_, l| l <= 0.0,
        "check unit, sign and zero: the length is that between the fittings, not a displacement",
    );
    outside.into_iter().chain(gone).collect()
}

fn forces(gate: &Gate) -> Option<Impossible> {
    let pressure = gate.data.pressure();
    let area = gate.options.radius_m.map(|radius| PI * radius * radius);
    let is_absurd = |row: usize, force: f64| {
        let limit = area.map(|area| FORCE_OF_AREA * area * pressure[row].abs().max(1e5));
        force.abs() > limit.map_or(FORCE, |limit| limit.min(FORCE))
    };
    impossible(
        gate.data.force(),
        ["a force beyond any muscle of this size", "N"],
        is_absurd,
        "check the unit of the force in the header",
    )
}

fn others(gate: &Gate) -> Vec<Impossible> {
    let data = gate.data;
    let temperature = impossible(
        data.temperature().unwrap_or_default(),
        ["a temperature outside 150 K to 500 K", "K"],
        |_, t| !(TEMPERATURE[0]..=TEMPERATURE[1]).contains(&t),
        "check the unit of the temperature: `temperature [degC]` or `temperature [K]`",
    );
    let positive = [
        (data.columns().diameter_m.as_deref(), ["a diameter of 0 or less", "m"]),
        (data.columns().volume_m3.as_deref(), ["a volume of 0 or less", "m^3"]),
        (data.force_sd(), ["a standard deviation of the force of 0 or less", "N"]),
    ];
    let not_positive = positive.into_iter().filter_map(|(values, what)| {
        let instead = "remove the rows, or check unit and sign: it must be greater than 0";
        impossible(values.unwrap_or_default(), what, |_, v| v <= 0.0, instead)
    });
    temperature.into_iter().chain(not_positive).collect()
}
