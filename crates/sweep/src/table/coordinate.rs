//! The map from the unit coordinates of a table back to a point, and the choice of the poles.
//!
//! ```text
//! v = q/Q,   q = s/(s + c),   s = x - low or its root;     c infinite: q = s
//! ```
//! A pole c below the width of the axis concentrates points at the lower end, where a boundary layer may be
//! thin. The pole is chosen by the outputs along lines through the domain: their Chebyshev coefficients must
//! fall fast, or their splines have small errors, depending on the form of the table.

use bulge_table::Form;
use rayon::prelude::*;

use super::certificate::FLOOR;
use super::field::{Field, FieldAxis, NoValue};
use super::polynomial::{basis, cosines, gauss_points};

/// Poles that are tried, relative to the width of the axis in s.
const POLES: [f64; 15] =
    [f64::INFINITY, 4.0, 2.5, 1.6, 1.0, 0.63, 0.4, 0.25, 0.16, 0.1, 0.063, 0.04, 0.025, 0.016, 0.01];
/// Rounds over all axes.
const ROUNDS: usize = 2;
/// Points of a line.
const POINTS: usize = 28;
/// The coefficients from this one on form the tail by which a pole is judged for polynomials.
const TAIL: usize = 10;
/// Cells of the spline by which a pole is judged for splines.
const CELLS: usize = 16;
/// Points in each of these cells.
const IN_A_CELL: usize = 3;

/// The coordinate of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) low: f64,
    /// Pole in units of s.
    pub(crate) pole: f64,
    pub(crate) is_root: bool,
}

impl Coordinate {
    /// q at a point.
    pub(crate) fn q(&self, x: f64) -> f64 {
        let s = if self.is_root { (x - self.low).max(0.0).sqrt() } else { x - self.low };
        if self.pole.is_infinite() { s } else { s / (s + self.pole) }
    }

    /// The point whose q is the fraction v of q(`high`).
    pub(crate) fn point(&self, v: f64, high: f64) -> f64 {
        self.of_q(v * self.q(high))
    }

    /// The point with the given q.
    pub(crate) fn of_q(&self, q: f64) -> f64 {
        let s = if self.pole.is_infinite() { q } else { self.pole * q / (1.0 - q) };
        self.low + if self.is_root { s * s } else { s }
    }
}

/// The coordinates of all axes of a field.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinates {
    /// Coordinate of each axis. For a fitted axis 0 it holds where all other axes are at their lower ends.
    pub(crate) axes: Vec<Coordinate>,
    /// Growth of the logarithm of the pole of a fitted axis 0 with the coordinates of the other axes.
    pub(crate) tilt: Vec<f64>,
}

impl Coordinates {
    /// The coordinate of axis 0 at unit coordinates of the other axes.
    pub(crate) fn first(&self, others: &[f64]) -> Coordinate {
        let growth: f64 = self.tilt.iter().zip(others).map(|(tilt, v)| tilt * v).sum();
        Coordinate { pole: self.axes[0].pole * growth.exp(), ..self.axes[0] }
    }

    /// The unit coordinates of values of axis 1 and the following ones.
    pub(crate) fn units(&self, highs: &[f64], others: &[f64]) -> Vec<f64> {
        let one =
            |((x, coordinate), high): ((&f64, &Coordinate), &f64)| coordinate.q(*x) / coordinate.q(*high);
        others.iter().zip(&self.axes[1..]).zip(&highs[1..]).map(one).collect()
    }
}

/// The coordinates of all axes of a field, with the best poles.
pub(crate) fn coordinates(field: &dyn Field, form: Form) -> Result<Coordinates, NoValue> {
    let is_root = field.outputs().iter().any(|output| output.is_singular);
    let axes = field.axes();
    let one = |(i, axis): (usize, &FieldAxis)| Coordinate {
        low: axis.low,
        pole: f64::INFINITY,
        is_root: is_root && i == 0,
    };
    let mut chosen =
        Coordinates { axes: axes.iter().enumerate().map(one).collect(), tilt: vec![0.0; axes.len() - 1] };
    let ends = [0.02, 0.5, 0.98];
    // The best pole of one axis depends slightly on the other axes.
    for _ in 0..ROUNDS {
        for axis in (1..axes.len()).rev() {
            let lines = lines(axes.len(), axis, &[&ends; 4]);
            chosen.axes[axis].pole = best_pole(field, &chosen, axis, &lines, form)?;
        }
        first_axis(field, &mut chosen, &ends, form)?;
    }
    Ok(chosen)
}

/// Pole and tilt of axis 0: a boundary layer at its lower end may get thinner along another axis.
fn first_axis(field: &dyn Field, chosen: &mut Coordinates, ends: &[f64], form: Form) -> Result<(), NoValue> {
    let count = chosen.axes.len();
    let others = count - 1;
    chosen.tilt = vec![0.0; others];
    let best = |chosen: &Coordinates, sides: &[&[f64]; 4]| {
        best_pole(field, chosen, 0, &lines(count, 0, sides), form)
    };
    let middle = best(chosen, &[ends; 4])?;
    if field.axes()[0].high.is_some() {
        chosen.axes[0].pole = middle;
        return Ok(());
    }
    let mut tilt = vec![0.0; others];
    for (i, tilt) in tilt.iter_mut().enumerate() {
        let side = |end: usize| {
            let mut sides = [ends; 4];
            sides[i + 1] = &ends[end..=end];
            best(chosen, &sides)
        };
        *tilt = (side(2)? / side(0)?).ln() / (ends[2] - ends[0]);
    }
    // The best pole applies in the middle of the other axes; the stored one refers to their lower ends.
    chosen.axes[0].pole = middle * (-0.5 * tilt.iter().sum::<f64>()).exp();
    chosen.tilt = tilt;
    Ok(())
}

/// Unit coordinates of lines along an axis, one for each combination of `ends` of the other axes.
fn lines(axes: usize, along: usize, ends: &[&[f64]; 4]) -> Vec<Vec<f64>> {
    let mut lines = vec![vec![0.0; axes]];
    for axis in (0..axes).filter(|axis| *axis != along) {
        let with = |line: &Vec<f64>| {
            let mut line = line.clone();
            ends[axis]
                .iter()
                .map(move |end| {
                    line[axis] = *end;
                    line.clone()
                })
                .collect::<Vec<_>>()
        };
        lines = lines.iter().flat_map(with).collect();
    }
    lines
}

/// The pole with which a table meets the outputs along lines of an axis best.
fn best_pole(
    field: &dyn Field,
    chosen: &Coordinates,
    axis: usize,
    lines: &[Vec<f64>],
    form: Form,
) -> Result<f64, NoValue> {
    let width = width(field, chosen, axis)?;
    // A fitted edge is stored with its pole, which must be finite.
    let is_fitted = field.axes()[axis].high.is_none();
    let tried: Vec<(f64, f64)> = POLES
        .par_iter()
        .filter(|pole| pole.is_finite() || !is_fitted)
        .map(|pole| {
            let mut with = chosen.clone();
            with.axes[axis].pole = pole * width;
            Ok((worst_error(field, &with, axis, lines, form)?, pole * width))
        })
        .collect::<Result<_, NoValue>>()?;
    let best = tried.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.map_or(f64::INFINITY, |(_, pole)| *pole))
}

/// Length of an axis in s. For a fitted axis it is taken in the middle of the other axes.
fn width(field: &dyn Field, chosen: &Coordinates, axis: usize) -> Result<f64, NoValue> {
    let axes = field.axes();
    let high = if let Some(high) = axes[axis].high {
        high
    } else {
        let middle = |axis: &FieldAxis| 0.5 * (axis.low + axis.high.unwrap_or(axis.low));
        field.upper_end(&axes[1..].iter().map(middle).collect::<Vec<_>>())?
    };
    let length = high - axes[axis].low;
    Ok(if chosen.axes[axis].is_root { length.sqrt() } else { length })
}

/// The largest error of a table in any output along lines of an axis.
fn worst_error(
    field: &dyn Field,
    coordinates: &Coordinates,
    axis: usize,
    lines: &[Vec<f64>],
    form: Form,
) -> Result<f64, NoValue> {
    let mut worst = 0.0_f64;
    let points = gauss_points(POINTS);
    let cosines = cosines(POINTS, POINTS);
    let mut values = vec![0.0; field.outputs().len()];
    for line in lines {
        let mut unit = line.clone();
        let mut samples = vec![Vec::with_capacity(POINTS); values.len()];
        for t in &points {
            unit[axis] = *t;
            reduced(field, coordinates, &unit, &|others| field.upper_end(others), &mut values)?;
            for (sample, value) in samples.iter_mut().zip(&values) {
                sample.push(*value);
            }
        }
        for sample in samples {
            let row = |row: &[f64]| row.iter().zip(&sample).map(|(c, v)| c * v).sum();
            let coefficients: Vec<f64> = cosines.chunks_exact(POINTS).map(row).collect();
            worst = worst.max(match form {
                Form::Chebyshev => tail(&coefficients, &sample),
                Form::Spline => spline_error(&coefficients, &sample),
            });
        }
    }
    Ok(worst)
}

fn largest(sample: &[f64]) -> f64 {
    sample.iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()))
}

/// Sum of the magnitudes of the coefficients from [`TAIL`] on, relative to the largest sample.
fn tail(coefficients: &[f64], sample: &[f64]) -> f64 {
    coefficients[TAIL..].iter().map(|c| c.abs()).sum::<f64>() / largest(sample)
}

/// Error of a cubic Hermite spline of [`CELLS`] cells, relative to the value, or to the floor for small
/// values.
fn spline_error(coefficients: &[f64], sample: &[f64]) -> f64 {
    let floor = FLOOR * largest(sample);
    let at = |u: f64| {
        let [values, slopes] = basis(u, coefficients.len());
        let sum = |of: &[f64]| of.iter().zip(coefficients).map(|(t, c)| t * c).sum::<f64>();
        [sum(&values), sum(&slopes) / CELLS as f64]
    };
    let nodes: Vec<[f64; 2]> = (0..=CELLS).map(|k| at(k as f64 / CELLS as f64)).collect();
    let mut worst = 0.0_f64;
    for (cell, ends) in nodes.windows(2).enumerate() {
        for k in 1..=IN_A_CELL {
            let t = k as f64 / (IN_A_CELL + 1) as f64;
            let [exact, _] = at((cell as f64 + t) / CELLS as f64);
            let knots = [ends[0][0], ends[0][1], ends[1][0], ends[1][1]];
            let spline: f64 = hermite(t).iter().zip(knots).map(|(h, v)| h * v).sum();
            worst = worst.max((spline - exact).abs() / exact.abs().max(floor));
        }
    }
    worst
}

/// The cubic Hermite basis on a cell: value and slope at its start, value and slope at its end.
pub(crate) fn hermite(t: f64) -> [f64; 4] {
    let r = 1.0 - t;
    [(1.0 + 2.0 * t) * r * r, t * r * r, t * t * (3.0 - 2.0 * t), -t * t * r]
}

/// The point at unit coordinates; `end` gives the upper end of axis 0.
pub(crate) fn point_of(
    axes: &[FieldAxis],
    coordinates: &Coordinates,
    unit: &[f64],
    end: &dyn Fn(&[f64]) -> Result<f64, NoValue>,
) -> Result<Vec<f64>, NoValue> {
    let mut point = vec![0.0; axes.len()];
    for i in (0..axes.len()).rev() {
        let high = match axes[i].high {
            Some(high) => high,
            None => end(&point[1..])?,
        };
        let coordinate = if i == 0 { coordinates.first(&unit[1..]) } else { coordinates.axes[i] };
        point[i] = coordinate.point(unit[i], high);
    }
    Ok(point)
}

/// The reduced outputs g = y u^k/(1 - u)^j at unit coordinates inside (0, 1).
pub(crate) fn reduced(
    field: &dyn Field,
    coordinates: &Coordinates,
    unit: &[f64],
    end: &dyn Fn(&[f64]) -> Result<f64, NoValue>,
    values: &mut [f64],
) -> Result<(), NoValue> {
    let point = point_of(field.axes(), coordinates, unit, end)?;
    field.values(&point, values)?;
    for (value, output) in values.iter_mut().zip(field.outputs()) {
        if output.is_singular {
            *value *= unit[0];
        }
        if output.vanishes {
            *value /= 1.0 - unit[0];
        }
        if !value.is_finite() {
            return Err(NoValue(format!("`{}` is not finite at {point:?}", output.name)));
        }
    }
    Ok(())
}

/// The four cubic B-splines of a cell at its local coordinate t in \[0, 1\].
pub(crate) fn b_splines(t: f64) -> [f64; 4] {
    let r = 1.0 - t;
    [
        r * r * r / 6.0,
        2.0 / 3.0 - t * t * (1.0 - 0.5 * t),
        2.0 / 3.0 - r * r * (1.0 - 0.5 * r),
        t * t * t / 6.0,
    ]
}
