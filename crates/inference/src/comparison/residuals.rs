//! Distribution of the error: by each variable, on maps, along curves.

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::{Bin, Breakdown, Curve, CurvePoint, ResidualMap};
use crate::comparison::levels::sweep_of;
use crate::comparison::loops::branches;
use crate::vector::{minus, range};

/// Bins of a continuous variable.
const BINS: usize = 10;
/// Contraction columns of a map.
const COLUMNS: usize = 20;
/// Most points of a curve; the next constant is for the scatter plot.
const MOST_POINTS: usize = 400;
const MOST_SCATTER: usize = 2000;
/// Most sweeps that are shown one by one.
const MOST_SWEEPS: usize = 60;

/// Errors of one prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Errors {
    pub(crate) rmse: f64,
    pub(crate) bias: f64,
    pub(crate) largest: f64,
    pub(crate) r_squared: f64,
}

impl Analysis<'_> {
    /// Measured less model force of all rows \[N\].
    pub(crate) fn residuals(&self, climbed: &Climbed) -> Vec<f64> {
        minus(self.record.force(), &climbed.force)
    }
}

/// Errors over all rows that count and have a state. If none has one, the error is the measured force, since
/// the model then predicts none.
pub(crate) fn summary(analysis: &Analysis<'_>, force: &Vec<f64>) -> Errors {
    let measured = analysis.record.force();
    let has_any = analysis.with_state(&[force]).next().is_some();
    let counted = || analysis.rows().filter(|row| !has_any || force[*row].is_finite());
    let n = counted().count().max(1) as f64;
    let mean = counted().map(|row| measured[row]).sum::<f64>() / n;
    let mut sums = [0.0; 3];
    let mut largest: f64 = 0.0;
    for row in counted() {
        let error = measured[row] - if has_any { force[row] } else { 0.0 };
        sums[0] += error;
        sums[1] += error * error;
        sums[2] += (measured[row] - mean).powi(2);
        largest = largest.max(error.abs());
    }
    // A single point has no variance to explain.
    let r_squared = if sums[2] > 0.0 { 1.0 - sums[1] / sums[2] } else { 0.0 };
    Errors { rmse: (sums[1] / n).sqrt(), bias: sums[0] / n, largest, r_squared }
}

/// A variable divided into groups: name and unit, group of each row, label and middle of each group.
struct Groups<'a> {
    variable: &'static str,
    unit: &'static str,
    of: Box<dyn Fn(usize) -> usize + 'a>,
    labels: Vec<(String, f64)>,
}

/// A breakdown by every variable that varies.
pub(crate) fn breakdowns(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<Breakdown> {
    let record = &analysis.record;
    let moments = record.moments();
    let mut found: Vec<Breakdown> = Vec::new();
    let mut add = |groups: Groups<'_>| found.push(broken_down(analysis, forces, groups));
    let levels = &analysis.levels;
    add(Groups {
        variable: "pressure",
        unit: "bar",
        of: Box::new(|row| levels.at(row)),
        labels: levels.mean.iter().map(|p| (format!("{:.2}", p / 1e5), p / 1e5)).collect(),
    });
    even(analysis, "contraction", "%", &|row| 100.0 * moments[row].contraction)
        .into_iter()
        .for_each(&mut add);
    if record.is_path() {
        let of = |row: usize| {
            let branch = moments[row].branch();
            if branch > 0.0 {
                0
            } else if branch < 0.0 {
                2
            } else {
                1
            }
        };
        let [there, back] = branches(&analysis.data);
        let labels = [(there, 1.0), ("at rest", 0.0), (back, -1.0)];
        let labels = labels.into_iter().map(|(label, at)| (label.to_owned(), at)).collect();
        add(Groups { variable: "direction", unit: "", of: Box::new(of), labels });
    }
    if record.has_time() {
        even(analysis, "rate", "%/s", &|row| 100.0 * moments[row].rate).into_iter().for_each(&mut add);
        even(analysis, "time", "s", &|row| moments[row].clock).into_iter().for_each(&mut add);
    }
    if record.sweeps().len() <= MOST_SWEEPS {
        let labels = analysis.data.sweeps().iter().enumerate().map(|(i, s)| (s.name.clone(), (i + 1) as f64));
        let of = |row| sweep_of(record.sweeps(), row);
        add(Groups { variable: "sweep", unit: "", of: Box::new(of), labels: labels.collect() });
    }
    let names = record.specimens();
    add(Groups {
        variable: "specimen",
        unit: "",
        of: Box::new(|row| moments[row].specimen as usize),
        labels: names.iter().enumerate().map(|(i, name)| (name.clone(), (i + 1) as f64)).collect(),
    });
    if moments.iter().any(|m| m.temperature != 0.0) {
        even(analysis, "temperature", "K", &|row| moments[row].temperature).into_iter().for_each(&mut add);
    }
    found.retain(|breakdown| breakdown.bins.len() > 1);
    found
}

/// Bins of equal width; none if the variable doesn't vary.
fn even<'a>(
    analysis: &Analysis<'_>,
    variable: &'static str,
    unit: &'static str,
    value: &'a dyn Fn(usize) -> f64,
) -> Option<Groups<'a>> {
    let [low, high] = range(analysis.rows().map(value));
    if high.is_nan() || high <= low {
        return None;
    }
    let of = Box::new(move |row| bin(value(row), low, high, BINS));
    let width = (high - low) / BINS as f64;
    let label = |i: usize| {
        let start = low + i as f64 * width;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 6")]
        let digits = (-width.log10().floor()).clamp(0.0, 6.0) as usize;
        (format!("{start:.digits$} to {:.digits$}", start + width), start + 0.5 * width)
    };
    Some(Groups { variable, unit, of, labels: (0..BINS).map(label).collect() })
}

/// Bin of a value; values outside go to the first or last bin.
pub(crate) fn bin(value: f64, low: f64, high: f64, bins: usize) -> usize {
    let part = if high > low { (value - low) / (high - low) } else { 0.0 };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of bins"
    )]
    let bin = (part * bins as f64).clamp(0.0, bins as f64 - 1.0) as usize;
    bin
}

fn broken_down(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2], groups: Groups<'_>) -> Breakdown {
    let measured = analysis.record.force();
    let mut sums = vec![(0_usize, [0.0; 2], [0.0; 2]); groups.labels.len()];
    for row in analysis.with_state(&forces) {
        let (rows, bias, square) = &mut sums[(groups.of)(row)];
        *rows += 1;
        for (i, force) in forces.iter().enumerate() {
            let error = measured[row] - force[row];
            bias[i] += error;
            square[i] += error * error;
        }
    }
    let with_rows = sums.into_iter().zip(groups.labels).filter(|((rows, _, _), _)| *rows > 0);
    let bins = with_rows.map(|((rows, bias, square), (label, at))| Bin {
        label,
        at,
        rows,
        bias_n: bias.map(|b| b / rows as f64),
        rmse_n: square.map(|s| (s / rows as f64).sqrt()),
    });
    Breakdown { variable: groups.variable, unit: groups.unit, bins: bins.collect() }
}

/// Mean residuals over pressure levels and contraction, for each direction that occurs.
pub(crate) fn maps(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<ResidualMap> {
    let moments = analysis.record.moments();
    let measured = analysis.record.force();
    let [low, high] = contractions(analysis);
    let levels = analysis.levels.len();
    let mut maps = Vec::new();
    let [there, back] = branches(&analysis.data);
    for (direction, sign) in [(there, 1.0), ("at rest", 0.0), (back, -1.0)] {
        let mut sums = vec![(0_usize, [0.0; 2]); levels * COLUMNS];
        let rows = analysis.with_state(&forces).filter(|row| moments[*row].branch().total_cmp(&sign).is_eq());
        let mut any = 0_usize;
        for row in rows {
            let cell = analysis.levels.at(row) * COLUMNS + bin(moments[row].contraction, low, high, COLUMNS);
            sums[cell].0 += 1;
            for (sum, force) in sums[cell].1.iter_mut().zip(forces) {
                *sum += measured[row] - force[row];
            }
            any += 1;
        }
        // Turning points alone don't make a map.
        if any <= analysis.record.len() / 100 {
            continue;
        }
        let mean = |i: usize| {
            sums.iter().map(|(rows, sum)| (*rows > 0).then(|| sum[i] / *rows as f64)).collect::<Vec<_>>()
        };
        let width = (high - low) / COLUMNS as f64;
        maps.push(ResidualMap {
            direction,
            pressure_pa: analysis.levels.mean.clone(),
            contraction: (0..COLUMNS).map(|i| low + (i as f64 + 0.5) * width).collect(),
            first_n: mean(0),
            last_n: mean(1),
        });
    }
    maps
}

/// Range of the contraction of the rows that count.
pub(crate) fn contractions(analysis: &Analysis<'_>) -> [f64; 2] {
    let moments = analysis.record.moments();
    let [low, high] = range(analysis.rows().map(|row| moments[row].contraction));
    if high > low { [low, high] } else { [low - 1e-3, high + 1e-3] }
}

/// Force against contraction for each pressure level and specimen.
pub(crate) fn curves(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<Curve> {
    let moments = analysis.record.moments();
    let measured = analysis.record.force();
    let mut curves = Vec::new();
    for (level, pressure_pa) in analysis.levels.mean.iter().enumerate() {
        for (specimen, name) in analysis.record.specimens().iter().enumerate() {
            let is_here = |row: &usize| {
                analysis.levels.at(*row) == level && moments[*row].specimen as usize == specimen
            };
            let mut rows: Vec<usize> = analysis.with_state(&forces).filter(is_here).collect();
            if rows.is_empty() {
                continue;
            }
            if !analysis.record.is_path() {
                rows.sort_by(|a, b| moments[*a].contraction.total_cmp(&moments[*b].contraction));
            }
            let stride = rows.len().div_ceil(MOST_POINTS).max(1);
            let point = |row: &usize| CurvePoint {
                pressure_pa: moments[*row].pressure,
                contraction: moments[*row].contraction,
                direction: moments[*row].branch(),
                measured_n: measured[*row],
                first_n: forces[0][*row],
                last_n: forces[1][*row],
            };
            let points = rows.iter().step_by(stride).map(point).collect();
            curves.push(Curve { pressure_pa: *pressure_pa, specimen: name.clone(), points });
        }
    }
    curves
}

/// Measured against predicted forces.
pub(crate) fn scatter(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<[f64; 3]> {
    let measured = analysis.record.force();
    let stride = analysis.with_state(&forces).count().div_ceil(MOST_SCATTER).max(1);
    analysis
        .with_state(&forces)
        .step_by(stride)
        .map(|row| [measured[row], forces[0][row], forces[1][row]])
        .collect()
}
