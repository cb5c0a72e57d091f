//! The errors of a table: measured against the solver at points off the grid, and bounded by subdivision.
//!
//! ```text
//! error of the value       |y - y*|/max(|y*|, floor)                           floor = 0.001 max |y| u^k, over the root of the part of the way to the upper end if k = 1
//! error of the gradient    |dy/dx_i - dy*/dx_i|/max(|dy*/dx_i|, max(|y*|, floor)/width_i)    the largest of all i
//! ```
//! A point that lies outside the table by no more than the error of its fitted end is left out.
//!
//! The points are those of the additive recurrence of the generalised golden ratio (M. Roberts 2018): x_k =
//! frac(k (g^-1, g^-2, ...)) with g^(d+1) = g + 1. Every second point is uniform in the axes themselves. The
//! others are uniform in the coordinates of the table, in which boundary layers are as wide as the rest.

use bulge_table::format::MOST_AXES;
use bulge_table::{Certificate, Table};
use rayon::prelude::*;
use std::sync::LazyLock;

use super::coordinate::{Coordinate, Coordinates, point_of};
use super::domain::Domain;
use super::field::NoValue;

/// Values below this fraction of the largest value are compared with that fraction.
pub(crate) const FLOOR: f64 = 1e-3;
/// Points of one task. The number is fixed, so that sums don't depend on the number of threads.
const TASK: u64 = 1024;
/// Fractions keep this distance from the ends.
const INSIDE: f64 = 1e-9;

/// Errors of all outputs at one point, or summed over many.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    value: f64,
    gradient: f64,
    value_squares: f64,
    gradient_squares: f64,
}

impl Errors {
    fn and(&self, other: &Self) -> Self {
        Self {
            value: self.value.max(other.value),
            gradient: self.gradient.max(other.gradient),
            value_squares: self.value_squares + other.value_squares,
            gradient_squares: self.gradient_squares + other.gradient_squares,
        }
    }
}

/// Increments of the sequence in 1 to 4 dimensions.
static STEPS: LazyLock<[Vec<f64>; MOST_AXES]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let axes = i + 1;
        // The fixed point of g = (1 + g)^(1/(d + 1)).
        let g = (0..64).fold(1.5_f64, |g, _| (1.0 + g).powf(1.0 / (axes as f64 + 1.0)));
        (1..=axes).map(|power| g.powf(-(power as f64))).collect()
    })
});

/// The k-th point of the low-discrepancy sequence in 1 to 4 dimensions.
pub(crate) fn golden(k: u64, axes: usize) -> Vec<f64> {
    let inside = |step: &f64| INSIDE + (1.0 - 2.0 * INSIDE) * (0.5 + k as f64 * step).fract();
    STEPS[axes.clamp(1, MOST_AXES) - 1].iter().map(inside).collect()
}

/// The k-th check point of a domain.
pub(crate) fn check_point(domain: &Domain<'_>, k: u64) -> Result<Vec<f64>, NoValue> {
    let unit = golden(k, domain.highs.len());
    if k.is_multiple_of(2) {
        return domain.point(&unit);
    }
    let linear = |c: &Coordinate| Coordinate { low: c.low, pole: f64::INFINITY, is_root: false };
    let plain = Coordinates { axes: domain.coordinates.axes.iter().map(linear).collect(), tilt: Vec::new() };
    point_of(domain.field.axes(), &plain, &unit, &|others| Ok(domain.upper_end(others)))
}

/// Measures a table at `count` points, beginning with number `first`.
pub(crate) fn measured(
    domain: &Domain<'_>,
    table: &Table<'_>,
    scales: &[f64],
    (first, count): (u64, u64),
) -> Result<Vec<Certificate>, NoValue> {
    let outputs = scales.len();
    let tasks: Vec<u64> = (0..count.div_ceil(TASK)).collect();
    let partial: Vec<Vec<Errors>> = tasks
        .par_iter()
        .map(|task| {
            let mut sums = vec![Errors::default(); outputs];
            for k in task * TASK..(task * TASK + TASK).min(count) {
                let point = check_point(domain, first + k)?;
                for (sum, errors) in sums.iter_mut().zip(errors_at(domain, table, scales, &point)?) {
                    *sum = sum.and(&errors);
                }
            }
            Ok(sums)
        })
        .collect::<Result<_, NoValue>>()?;
    let total = |o: usize| partial.iter().fold(Errors::default(), |sum, part| sum.and(&part[o]));
    let n = count as f64;
    Ok((0..outputs)
        .map(|o| {
            let errors = total(o);
            Certificate {
                value_max: errors.value,
                value_rms: (errors.value_squares / n).sqrt(),
                gradient_max: errors.gradient,
                gradient_rms: (errors.gradient_squares / n).sqrt(),
                bound: 0.0,
                scale: scales[o],
            }
        })
        .collect())
}

fn errors_at(
    domain: &Domain<'_>,
    table: &Table<'_>,
    scales: &[f64],
    point: &[f64],
) -> Result<Vec<Errors>, NoValue> {
    let field = domain.field;
    let (axes, outputs) = (point.len(), scales.len());
    let mut values = vec![0.0; outputs];
    let mut gradients = vec![0.0; outputs * axes];
    field.gradients(point, &mut values, &mut gradients)?;
    let high = domain.upper_end(&point[1..]);
    let width = |i: usize| {
        let axis = &field.axes()[i];
        axis.high.unwrap_or(high) - axis.low
    };
    let (mut found, mut slopes) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    if table.sample(point, &mut found, &mut slopes).is_none() {
        // Within the error of the edge, a point may lie outside the table.
        let at_edge = (high - point[0]).abs() <= 1e-6 * width(0);
        let outside = NoValue(format!("the table has no value at {point:?}"));
        return if at_edge { Ok(vec![Errors::default(); outputs]) } else { Err(outside) };
    }
    (0..outputs)
        .map(|o| {
            let part = ((point[0] - field.axes()[0].low) / width(0)).max(f64::MIN_POSITIVE);
            let floor = FLOOR * scales[o] / if field.outputs()[o].is_singular { part.sqrt() } else { 1.0 };
            let error = (found[o] - values[o]).abs() / values[o].abs().max(floor);
            let exact = &gradients[o * axes..(o + 1) * axes];
            let steep = (0..axes)
                .map(|i| {
                    let size = exact[i].abs().max(values[o].abs().max(floor) / width(i));
                    (slopes[o * axes + i] - exact[i]).abs() / size
                })
                .fold(0.0, f64::max);
            if error.is_nan() || steep.is_nan() {
                return Err(NoValue(format!("the error at {point:?} is not a number")));
            }
            Ok(Errors {
                value: error,
                gradient: steep,
                value_squares: error * error,
                gradient_squares: steep * steep,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_points_fill_evenly() {
        for axes in 1..=4 {
            let count = 4096_u32;
            let mut cells = vec![0_u32; 4_usize.pow(u32::try_from(axes).unwrap())];
            for k in 0..u64::from(count) {
                let mut cell = 0;
                for x in golden(k, axes) {
                    assert!(x > 0.0 && x < 1.0);
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
                    let place = (4.0 * x) as usize;
                    cell = 4 * cell + place;
                }
                cells[cell] += 1;
            }
            let mean = f64::from(count) / cells.len() as f64;
            let worst = cells.iter().map(|n| (f64::from(*n) - mean).abs()).fold(0.0, f64::max);
            // Independent points would deviate by 3 sqrt(mean).
            assert!(worst < 1.2 * mean.sqrt() + 1.0, "{axes}: {worst} of {mean}");
        }
    }
}
