//! The noise floor: the scatter that no model of pressure, contraction and direction can explain.

use bulge_measurements::PureError;
use bulge_model::Record;
use bulge_muscles::Muscle;
use bulge_numerics::least_squares::{Bounds, Options, Residuals, minimise};
use std::convert::Infallible;
use std::f64::consts::SQRT_2;
use std::ops::Range;

use crate::chebyshev::chebyshev;
use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::NoiseFloor;
use crate::comparison::levels::sweep_of;
use crate::vector::range;

/// Degrees of freedom from which the scatter of repeats is used.
const ENOUGH: f64 = 8.0;
/// Most rows for fitting the smooth surface; they give the scatter to one per cent.
const MOST_ROWS: usize = 5_000;
/// Most readings for the resolution of a sensor and for the scatter of neighbours; their median is accurate
/// to half a per cent.
const MOST_READINGS: usize = 100_000;
/// The remaining fraction of the sum of squares, below which the predicted decrease may be dominated by
/// rounding.
const LEFT: f64 = 1e-9;

impl Analysis<'_> {
    /// The error that no model can go below, estimated from the residuals of a rung.
    pub(crate) fn noise_floor(&self, climbed: &Climbed) -> Option<NoiseFloor> {
        let (measured, force) = (self.record.force(), &climbed.force);
        let counts = |row: usize| self.used.mask[row] && force[row].is_finite();
        let residual = |row: usize| measured[row] - force[row];
        noise_floor(self.pure_error.as_ref(), &self.record, &counts, &residual, self.muscle)
    }
}

/// Estimated from repeats; otherwise from the residuals of a smooth surface through the residuals of the rows
/// that count; otherwise taken from the data sheet.
pub(crate) fn noise_floor(
    repeats: Option<&PureError>,
    record: &Record,
    counts: &dyn Fn(usize) -> bool,
    residual: &dyn Fn(usize) -> f64,
    muscle: &Muscle,
) -> Option<NoiseFloor> {
    if let Some(error) = repeats.filter(|error| error.degrees_of_freedom >= ENOUGH && error.sd_n > 0.0) {
        return Some(NoiseFloor {
            sd_n: error.sd_n,
            source: "repeats",
            says: format!(
                "scatter of repeated rows about their means, {:.0} degrees of freedom",
                error.degrees_of_freedom
            ),
        });
    }
    if let Some((sd_n, columns)) = saturated(record, counts, residual) {
        // The quantisation error of the readings is a lower bound.
        let sd_n = sd_n.max(step(record.force()) / 12.0_f64.sqrt());
        return Some(NoiseFloor {
            sd_n,
            source: "saturated",
            says: format!(
                "what a smooth surface of {columns} numbers in pressure, contraction and direction leaves of the residuals: an estimate, \
                 without noise that changes slowly along a sweep"
            ),
        });
    }
    let sd_n = muscle.instruments().force.map_or(0.0, |force| force.noise());
    (sd_n > 0.0).then(|| NoiseFloor {
        sd_n,
        source: "instruments",
        says: "noise of the load cell as the muscle file states it".to_owned(),
    })
}

/// The resolution of the force readings: the least difference between them, if most of them occur several
/// times; otherwise 0.
fn step(force: &[f64]) -> f64 {
    let mut levels: Vec<f64> = force.iter().copied().step_by(every(force.len())).collect();
    let readings = levels.len();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    if 3 * levels.len() > readings {
        return 0.0;
    }
    // A single level shows no resolution.
    levels.windows(2).map(|pair| pair[1] - pair[0]).reduce(f64::min).unwrap_or(0.0)
}

/// Stride with which at most `MOST_READINGS` readings are taken.
pub(crate) fn every(readings: usize) -> usize {
    readings.div_ceil(MOST_READINGS).max(1)
}

/// Chebyshev polynomials in pressure and contraction, even and odd in direction.
struct Surface {
    columns: usize,
    rows: Vec<f64>,
    values: Vec<f64>,
}

impl Residuals for Surface {
    type Error = Infallible;
    fn rows(&self) -> usize {
        self.values.len()
    }
    fn parameters(&self) -> usize {
        self.columns
    }
    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) -> Result<(), Infallible> {
        let k = self.columns;
        let part = &self.rows[rows.start * k..rows.end * k];
        for ((residual, row), value) in residuals.iter_mut().zip(part.chunks_exact(k)).zip(&self.values[rows])
        {
            *residual = row.iter().zip(theta).map(|(x, t)| x * t).sum::<f64>() - value;
        }
        if let Some(jacobian) = jacobian {
            jacobian.copy_from_slice(part);
        }
        Ok(())
    }
}

/// Standard deviation about a smooth surface, and the number of its columns; none if there are too few rows
/// for one.
fn saturated(
    record: &Record,
    counts: &dyn Fn(usize) -> bool,
    residual: &dyn Fn(usize) -> f64,
) -> Option<(f64, usize)> {
    let counting = || (0..record.len()).filter(|row| counts(*row));
    let step = counting().count().div_ceil(MOST_ROWS).max(1);
    let rows: Vec<usize> = counting().step_by(step).collect();
    let moments = record.moments();
    let distinct = |value: &dyn Fn(usize) -> f64| {
        let mut all: Vec<u64> = rows.iter().map(|row| value(*row).to_bits()).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    };
    let degree = |distinct: usize, most: usize| (distinct.saturating_sub(1)).min(most);
    let n = rows.len();
    let degrees_p = degree(distinct(&|row| moments[row].pressure), if n < 40 { 1 } else { 3 });
    let degrees_e = degree(
        distinct(&|row| moments[row].contraction),
        if n < 40 {
            2
        } else if n < 200 {
            4
        } else {
            7
        },
    );
    let parities = if record.is_path() { 2 } else { 1 };
    let offsets = if record.is_path() && record.sweeps().len() <= 20 { record.sweeps().len() - 1 } else { 0 };
    let columns = (degrees_p + 1) * (degrees_e + 1) * parities + offsets;
    if n < 2 * columns + 5 {
        return None;
    }
    let p = Scaled::of(rows.iter().map(|row| moments[*row].pressure));
    let e = Scaled::of(rows.iter().map(|row| moments[*row].contraction));
    let mut matrix = Vec::with_capacity(n * columns);
    let all = |x: f64, most: usize| (0..=most).map(|degree| chebyshev(degree, x)).collect::<Vec<f64>>();
    for row in &rows {
        let m = &moments[*row];
        let [along_p, along_e] = [all(p.at(m.pressure), degrees_p), all(e.at(m.contraction), degrees_e)];
        for parity in 0..parities {
            let sign = if parity == 0 { 1.0 } else { m.branch() };
            for x in &along_p {
                matrix.extend(along_e.iter().map(|y| sign * x * y));
            }
        }
        let own = sweep_of(record.sweeps(), *row);
        matrix.extend((1..=offsets).map(|sweep| if own == sweep { 1.0 } else { 0.0 }));
    }
    let values: Vec<f64> = rows.iter().map(|row| residual(*row)).collect();
    let surface = Surface { columns, rows: matrix, values };
    let fitted = |max_evaluations| {
        let options = Options { check_curvature: false, max_evaluations, ..Options::default() };
        let found = minimise(&surface, &vec![0.0; columns], &Bounds::none(columns), &options).ok()?;
        let part = 1.0 - found.certificate.relative_decrease;
        Some((found.cost * part, part, found.certificate.rank))
    };
    // The surface is linear in its coefficients, so the cost predicted by the first Gauss-Newton step is the
    // minimum.
    let (cost, _, rank) = fitted(1).filter(|(_, part, _)| *part > LEFT).or_else(|| fitted(2000))?;
    let freedom = n.checked_sub(rank).filter(|f| *f > 0)?;
    let smooth = (cost / freedom as f64).sqrt();
    // A surface that is too coarse leaves misfit that would count as noise; differences of neighbours along a
    // sweep don't.
    let local = neighbours(record, counts, residual).unwrap_or(f64::INFINITY);
    Some((smooth.min(local.max(0.5 * smooth)), columns)).filter(|(sd, _)| *sd > 0.0)
}

/// Standard deviation from second differences along the sweeps: `r_(i-1) - 2 r_i + r_(i+1)` has the variance
/// 6 sd^2.
fn neighbours(
    record: &Record,
    counts: &dyn Fn(usize) -> bool,
    residual: &dyn Fn(usize) -> f64,
) -> Option<f64> {
    if !record.is_path() {
        return None;
    }
    let mut deviations: Vec<f64> = Vec::new();
    for sweep in record.sweeps() {
        for i in (sweep.start + 1..sweep.end.saturating_sub(1)).step_by(every(record.len())) {
            if counts(i - 1) && counts(i) && counts(i + 1) {
                let d = residual(i - 1) - 2.0 * residual(i) + residual(i + 1);
                deviations.push(d.abs() / 6.0_f64.sqrt());
            }
        }
    }
    if deviations.len() < 20 {
        return None;
    }
    deviations.sort_by(f64::total_cmp);
    // The median of |x| of a normal variable x is 0.6745 sd; it is insensitive to reversals and spikes.
    Some(deviations[deviations.len() / 2] / (0.476_936_276_204_469_9 * SQRT_2))
}

/// Maps a range to -1 ..= 1.
struct Scaled {
    middle: f64,
    half: f64,
}

impl Scaled {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let [low, high] = range(values);
        Self { middle: 0.5 * (low + high), half: (0.5 * (high - low)).max(f64::MIN_POSITIVE) }
    }

    fn at(&self, value: f64) -> f64 {
        (value - self.middle) / self.half
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_muscles::preset;

    #[test]
    fn a_range_is_mapped_to_one_on_either_side() {
        let scaled = Scaled::of([3.0, 7.0, 4.0].into_iter());
        for (value, place) in [(3.0, -1.0), (5.0, 0.0), (7.0, 1.0)] {
            assert!((scaled.at(value) - place).abs() < 1e-15, "{value}");
        }
    }

    #[test]
    fn no_floor_is_finer_than_the_steps_of_the_force() {
        let moments: Vec<Moment> = (0..120)
            .map(|i| Moment::at_rest(f64::from(1 + i / 20) * 1e5, 0.01 * f64::from(i % 20)))
            .collect();
        let force: Vec<f64> = (0..120).map(|i| 40.0 * f64::from(20 - i % 20)).collect();
        let record = Record::from_moments(moments, force, std::iter::once(0..120).collect()).unwrap();
        // A model that matches the rounded readings to about a micronewton.
        let residuals: Vec<f64> = (0..120).map(|i| 1e-6 * f64::from(i * 37 % 11)).collect();
        let muscle = preset("ppam-2-r16").unwrap();
        let floor = noise_floor(None, &record, &|_| true, &|row| residuals[row], &muscle).unwrap();
        assert!((floor.sd_n - 40.0 / 12.0_f64.sqrt()).abs() < 1e-9, "{}", floor.sd_n);
    }
}
