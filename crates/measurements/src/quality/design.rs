//! Sufficiency and variation of the data: rows, pressures, contractions, temperature.

use super::{Finding, FindingKind, Gate, Severity};
use crate::resolution::bounds;

/// Fewer rows hardly make a characteristic.
const FEW_ROWS: usize = 8;
/// Pressures within this fraction of the largest form one level.
const LEVEL: f64 = 0.05;
/// A contraction with a smaller change is constant.
const TRAVEL: f64 = 2e-3;
/// A change of temperature worth a note \[K\].
const KELVIN: f64 = 2.0;
/// Correlation with temperature from which the two can't be separated.
const CORRELATION: f64 = 0.95;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let data = gate.data;
    let whole = |kind, severity, says, instead| gate.finding(kind, severity, &[], says, instead);
    let mut found = Vec::new();
    let rows = data.len();
    if rows < FEW_ROWS {
        let says = if rows == 1 {
            "there is one row: a single reading shows no dependence on anything".to_owned()
        } else {
            format!("there are only {rows} rows")
        };
        let instead = "measure at least 8 states; several dozen at three pressures tell effects apart";
        found.push(whole(FindingKind::TooFewRows, Severity::Warning, says, instead));
    }
    let motion = gate.motion_resolution();
    if rows > 1 && gate.pressure.range == 0.0 && gate.force.range == 0.0 && motion.range == 0.0 {
        let says = format!("all {rows} rows have the same pressure, {} and force", gate.motion_name());
        let instead = "check whether the recording or the export stood still";
        found.push(whole(FindingKind::AllRowsIdentical, Severity::Error, says, instead));
        return found;
    }
    let varies = gate.pressure.range > LEVEL * gate.largest_pressure;
    if !varies && rows > 1 {
        let says = if gate.pressure.range > 0.0 {
            format!("all pressures lie within {:.3} bar", 1e-5 * gate.pressure.range)
        } else {
            "all rows have the same pressure".to_owned()
        };
        let instead = "measure at least three pressures: what acts on the pressure can't be seen at one";
        found.push(whole(FindingKind::OnePressureLevel, Severity::Note, says, instead));
    }
    if motion.range <= TRAVEL * data.structure.scale && rows > 1 {
        let severity = if varies { Severity::Note } else { Severity::Warning };
        let name = gate.motion_name();
        let says = format!("the {name} changes by no more than {}", gate.with_unit(name, motion.range));
        let instead = "measure over the working range of the contraction as well";
        found.push(whole(FindingKind::ContractionConstant, severity, says, instead));
    }
    found.extend(temperature(gate));
    found
}

fn temperature(gate: &Gate) -> Option<Finding> {
    let temperature = gate.data.temperature()?;
    let (low, high) = bounds(temperature);
    if high - low < KELVIN {
        return None;
    }
    let rivals = [("pressure", gate.data.pressure()), (gate.motion_name(), gate.motion)];
    let confounded = rivals.iter().find(|(_, values)| correlation(temperature, values).abs() > CORRELATION);
    let change = format!("the temperature changes by {:.1} K", high - low);
    let (severity, says, instead) = match confounded {
        Some((name, values)) => (
            Severity::Warning,
            format!(
                "{change} together with the {name} (correlation {:.3})",
                correlation(temperature, values)
            ),
            "repeat part of the test at another temperature: as it is, the effect of the temperature can't be told from that of the other",
        ),
        None => (Severity::Note, change, "include the effect of the temperature when comparing"),
    };
    Some(gate.finding(FindingKind::TemperatureChanges, severity, &[], says, instead))
}

/// Pearson's correlation; 0 if one of them is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(x, y)| f(x - ma, y - mb)).sum::<f64>();
    let (aa, bb, ab) = (sum(&|x, _| x * x), sum(&|_, y| y * y), sum(&|x, y| x * y));
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}
