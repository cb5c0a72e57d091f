//! Lack of fit by near replicates (Christensen 1989): rows of different strokes in about the same state
//! measure about the same force. A misfit that they have in common repeats, whatever its shape, and isn't
//! noise.
//!
//! ```text
//! e = P K^-1/2 (y - F),    T = e' W e = sum over cells of ((sum of e)^2 - sum over strokes of (sum of its e)^2)/rows of the cell
//! I = T f/(e' e),          f = rows - numbers                                                               (Moran 1950; Cliff and Ord 1981)
//! ```
//! W couples rows of one cell that belong to different strokes, and no row with itself, so that I depends
//! neither on the size of the noise nor on its tails. Cells are parts of the range of contraction (of
//! pressure, at held length) in three widths, each also shifted by half a cell; they contain rows of one
//! level and direction, of one level, or of one direction. Each of these eighteen statistics is compared with
//! a Pearson type III distribution of the same first three moments. Their p-values are combined by the Cauchy
//! combination test (Liu and Xie 2020), which holds for any dependence between them.

use bulge_model::Record;
use nalgebra::DMatrix;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Gamma, Normal};
use std::collections::BTreeMap;

use crate::diagnosis::setpoints::setpoints;
use crate::diagnosis::strokes::{Point, Stroke, strokes};
use bulge_numerics::vector::dot;

/// Numbers of cells over the range.
const CELLS: [f64; 3] = [5.0, 16.0, 50.0];
/// Shifts of the cells, as fractions of a cell.
const MOVED: [f64; 2] = [0.0, 0.5];
/// Fraction of the range next to a turn that is left out: rows of both directions are close in time there,
/// and their noise may be correlated.
const TURN: f64 = 0.06;
/// Least tr W^2; below, there are too few near replicates.
const ENOUGH: f64 = 20.0;
/// Skewness below which the normal distribution is used.
const EVEN: f64 = 1e-3;

/// What near replicates have in common.
#[derive(Clone, Copy)]
enum Alike {
    /// Level and direction.
    Both,
    Level,
    Direction,
}

/// Rows of one state, grouped by stroke.
type Cell = Vec<Vec<usize>>;

/// p-value of the common misfit of near replicates; none if there are too few of them.
///
/// `left` is the whitened misfit orthogonal to `tangents`, which are orthonormal. Both have rows for priors
/// after those of the record.
pub(crate) fn lack_of_fit(record: &Record, left: &[f64], tangents: &[Vec<f64>]) -> Option<f64> {
    // Use the set points: readings with the same error would otherwise share a cell, and at the ends of the
    // range that looks like physics.
    let strokes = strokes(&setpoints(record));
    let rows = left.len();
    let columns = DMatrix::from_fn(rows, tangents.len(), |row, column| tangents[column][row]);
    let mut kinds = Vec::new();
    for alike in [Alike::Both, Alike::Level, Alike::Direction] {
        for count in CELLS {
            kinds.extend(MOVED.map(|moved| (alike, count, moved)));
        }
    }
    let of = |(alike, count, moved): (Alike, f64, f64)| {
        chance(&cells(&strokes, alike, count, moved), left, &columns)
    };
    let chances: Vec<f64> = kinds.into_par_iter().filter_map(of).collect();
    combined(&chances)
}

/// Cells with rows of at least two strokes.
fn cells(strokes: &[Stroke], alike: Alike, count: f64, moved: f64) -> Vec<Cell> {
    let mut found: BTreeMap<_, Cell> = BTreeMap::new();
    for stroke in strokes {
        let state = stroke.state;
        let level = matches!(alike, Alike::Both | Alike::Level).then_some(state.level);
        let direction = matches!(alike, Alike::Both | Alike::Direction).then_some(state.is_up);
        let place = |place: f64| {
            #[expect(clippy::cast_possible_truncation, reason = "fewer cells than rows, or far away")]
            let cell = (place * count + moved).floor() as i64;
            cell
        };
        let points = match alike {
            Alike::Level => inner(&stroke.points),
            Alike::Both | Alike::Direction => &stroke.points[..],
        };
        for part in points.chunk_by(|a, b| place(a.place) == place(b.place)) {
            let key = (state.specimen, state.is_held, level, direction, place(part[0].place));
            found.entry(key).or_default().push(part.iter().map(|point| point.row).collect());
        }
    }
    found.into_values().filter(|cell| cell.len() > 1).collect()
}

/// The points of a stroke away from its turns.
fn inner(points: &[Point]) -> &[Point] {
    let (Some(low), Some(high)) = (points.first(), points.last()) else { return points };
    let first = points.partition_point(|point| point.place < low.place + TURN);
    let last = points.partition_point(|point| point.place <= high.place - TURN);
    &points[first..last.max(first)]
}

/// W times a column.
fn coupled(cells: &[Cell], column: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; column.len()];
    for cell in cells {
        let sums: Vec<f64> = cell.iter().map(|rows| rows.iter().map(|row| column[*row]).sum()).collect();
        let (all, count) = (sums.iter().sum::<f64>(), cell.iter().map(Vec::len).sum::<usize>() as f64);
        for (rows, own) in cell.iter().zip(&sums) {
            for row in rows {
                product[*row] = (all - own) / count;
            }
        }
    }
    product
}

/// Traces of the square and the third power of W.
fn traces(cells: &[Cell]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for cell in cells {
        let power = |k: i32| cell.iter().map(|rows| (rows.len() as f64).powi(k)).sum::<f64>();
        let [one, two, three] = [1, 2, 3].map(power);
        sums[0] += (one * one - two) / (one * one);
        sums[1] += (one.powi(3) - 3.0 * one * two + 2.0 * three) / one.powi(3);
    }
    sums
}

/// Traces of P W, of its square and of its third power; `columns` is Q.
fn traces_outside(cells: &[Cell], columns: &DMatrix<f64>) -> [f64; 3] {
    let [two, three] = traces(cells);
    let image = |of: &DMatrix<f64>| {
        let images = of.column_iter().flat_map(|column| coupled(cells, column.as_slice())).collect();
        DMatrix::from_vec(of.nrows(), of.ncols(), images)
    };
    let once = image(columns);
    let twice = image(&once);
    // Q' W^k Q.
    let (a, b, c) = (columns.tr_mul(&once), once.tr_mul(&once), once.tr_mul(&twice));
    [
        -a.trace(),
        two - 2.0 * b.trace() + a.dot(&a),
        three - 3.0 * c.trace() + 3.0 * a.dot(&b) - (&a * &a).dot(&a),
    ]
}

/// Mean, second and third moment of I from those traces: the moments of e' W e under normal noise over those
/// of e' e, because I is independent of e' e.
fn moments([one, two, three]: [f64; 3], freedom: f64) -> [f64; 3] {
    let (k2, k3) = (2.0 * two, 8.0 * three);
    let second = (k2 + one * one) * freedom / (freedom + 2.0);
    let third = (k3 + 3.0 * one * k2 + one.powi(3)) * freedom * freedom / ((freedom + 2.0) * (freedom + 4.0));
    [one, second, third]
}

/// p-value of the statistic of these cells.
fn chance(cells: &[Cell], left: &[f64], columns: &DMatrix<f64>) -> Option<f64> {
    let freedom = (left.len() - columns.ncols()) as f64;
    if traces(cells)[0] < ENOUGH || freedom < 1.0 {
        return None;
    }
    let [mean, second, third] = moments(traces_outside(cells, columns), freedom);
    let sd = (second - mean * mean).max(0.0).sqrt();
    let skewness = (third - 3.0 * mean * sd * sd - mean.powi(3)) / sd.powi(3);
    let found = dot(left, &coupled(cells, left)) * freedom / dot(left, left);
    beyond((found - mean) / sd, skewness)
}

/// Upper tail probability of a variable of mean 0 and variance 1 with a given skewness (Pearson type III).
fn beyond(value: f64, skewness: f64) -> Option<f64> {
    if !(value.is_finite() && skewness.is_finite()) {
        return None;
    }
    if skewness < EVEN {
        return Some(Normal::standard().sf(value));
    }
    let shape = 4.0 / (skewness * skewness);
    Gamma::new(shape, 1.0).ok().map(|gamma| gamma.sf((shape + value * shape.sqrt()).max(0.0)))
}

/// Combines the p-values of dependent tests into one.
fn combined(chances: &[f64]) -> Option<f64> {
    use std::f64::consts::PI;
    let bounded = chances.iter().map(|p| p.clamp(1e-15, 1.0 - 1e-9));
    let sum: f64 = bounded.map(|p| ((0.5 - p) * PI).tan()).sum();
    (!chances.is_empty()).then(|| (chances.len() as f64).atan2(sum) / PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_numerics::Random;
    use bulge_numerics::vector::{add, norm};

    /// Four cycles at each of three pressures.
    fn record() -> Record {
        let moments: Vec<Moment> = (0..960)
            .map(|i| {
                let x = f64::from(i % 80) / 80.0;
                Moment {
                    direction: if x < 0.5 { 1.0 } else { -1.0 },
                    cycle: f64::from(i % 320) / 80.0,
                    clock: f64::from(i),
                    begins: i % 320 == 0,
                    ..Moment::at_rest(1e5 * f64::from(1 + i / 320), 0.2 * (1.0 - (2.0 * x - 1.0).abs()))
                }
            })
            .collect();
        let sweeps = (0..3).map(|i| 320 * i..320 * (i + 1)).collect();
        Record::from_moments(moments, vec![0.0; 960], sweeps).unwrap()
    }

    /// Orthonormal tangents from polynomials in contraction and pressure, and a column orthogonal to them.
    fn tangents(record: &Record) -> Vec<Vec<f64>> {
        let mut units: Vec<Vec<f64>> = Vec::new();
        for k in 0..6 {
            let of = |m: &Moment| (m.contraction - 0.1).powi(k % 3) * (m.pressure / 1e5).powi(k / 3);
            let mut column: Vec<f64> = record.moments().iter().map(of).collect();
            without(&mut column, &units);
            let length = norm(&column);
            units.push(column.iter().map(|v| v / length).collect());
        }
        units
    }

    fn without(column: &mut [f64], units: &[Vec<f64>]) {
        for _ in 0..2 {
            for unit in units {
                let part = dot(unit, column);
                add(column, -part, unit);
            }
        }
    }

    fn misfit(record: &Record, units: &[Vec<f64>], seed: u64, of: impl Fn(&Moment, f64) -> f64) -> Vec<f64> {
        let mut random = Random::new(seed, 0);
        let mut e: Vec<f64> = record.moments().iter().map(|m| of(m, random.normal())).collect();
        without(&mut e, units);
        e
    }

    #[test]
    fn traces_are_those_of_whole_matrices() {
        // Three cells of 2 to 4 strokes, and two single rows.
        let cells: Vec<Cell> = vec![
            vec![vec![0, 1], vec![2]],
            vec![vec![3], vec![4, 5], vec![6, 7, 8]],
            vec![vec![9], vec![10], vec![11], vec![12]],
        ];
        let n = 15;
        let unit = |place: usize| (0..n).map(|row| f64::from(row == place)).collect::<Vec<f64>>();
        let w = DMatrix::from_vec(n, n, (0..n).flat_map(|place| coupled(&cells, &unit(place))).collect());
        assert!((&w - w.transpose()).norm() < 1e-15 && w.trace().abs() < 1e-15);
        assert!((w[(0, 2)] - 1.0 / 3.0).abs() < 1e-15 && (w[(3, 8)] - 1.0 / 6.0).abs() < 1e-15);
        assert!((w[(9, 12)] - 0.25).abs() < 1e-15 && w[(6, 7)].abs() < 1e-15);
        let mut random = Random::new(2, 0);
        let q = DMatrix::from_fn(n, 3, |_, _| random.normal()).qr().q();
        let pw = (DMatrix::identity(n, n) - &q * q.transpose()) * w;
        let expected = [pw.trace(), (&pw * &pw).trace(), (&pw * &pw * &pw).trace()];
        for (found, expected) in traces_outside(&cells, &q).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn a_ratio_that_is_always_one_has_no_other_moments() {
        // With P itself in place of W, I equals the number of degrees of freedom for any noise.
        for freedom in [1.0, 4.0, 300.0_f64] {
            let found = moments([freedom; 3], freedom);
            for (power, found) in (1..).zip(found) {
                assert!((found / freedom.powi(power) - 1.0).abs() < 1e-12, "{power}: {found}");
            }
        }
        // A gamma distribution with shape 4 has skewness 1; P(x > 4 + 2 u) has a closed form.
        let x = 4.0 + 2.0 * 1.5_f64;
        let closed = (-x).exp() * (1.0 + x + x * x / 2.0 + x.powi(3) / 6.0);
        assert!((beyond(1.5, 1.0).unwrap() - closed).abs() < 1e-12);
        assert!((beyond(1.644_853_626_951_472_2, 0.0).unwrap() - 0.05).abs() < 1e-9);
        // The combination of equal p-values is that p-value.
        assert!((combined(&[0.02; 7]).unwrap() - 0.02).abs() < 1e-12);
    }

    #[test]
    fn moments_are_those_of_many_draws() {
        let record = record();
        let units = tangents(&record);
        let cells = cells(&strokes(&record), Alike::Both, 16.0, 0.0);
        let columns = DMatrix::from_fn(960, units.len(), |row, column| units[column][row]);
        // p-values under the null hypothesis are uniform, in the tail too.
        let draws = 4000;
        let chances: Vec<f64> = (0..draws)
            .into_par_iter()
            .filter_map(|seed| chance(&cells, &misfit(&record, &units, seed, |_, noise| noise), &columns))
            .collect();
        for level in [0.5, 0.1, 0.01] {
            let below = chances.iter().filter(|p| **p < level).count() as f64 / draws as f64;
            let sd = (level * (1.0 - level) / draws as f64).sqrt();
            assert!((below - level).abs() < 3.0 * sd, "{level}: {below}");
        }
    }

    #[test]
    fn chance_alarms_seldom_whatever_the_size_and_the_tails_of_the_noise() {
        let record = record();
        let units = tangents(&record);
        let rate = |of: &(dyn Fn(f64) -> f64 + Sync)| {
            let alarms = (0..600).into_par_iter().filter(|seed| {
                let e = misfit(&record, &units, 5000 + seed, |_, noise| of(noise));
                lack_of_fit(&record, &e, &units).unwrap() < 0.02
            });
            alarms.count()
        };
        // 12 expected; the Cauchy combination is exact in the far tail only.
        let found = [rate(&|noise| 3.0 * noise), rate(&|noise| noise * noise.abs())];
        assert!(found.iter().all(|count| (3..=26).contains(count)), "{found:?}");
    }

    #[test]
    fn what_repeats_is_seen_whatever_its_shape() {
        let record = record();
        let units = tangents(&record);
        // 8 sigma in total, 0.26 per row: a ripple that no smooth function follows, an event of the return
        // stroke, a step.
        let shapes: [fn(&Moment) -> f64; 3] = [
            |m| (260.0 * m.contraction).sin(),
            |m| f64::from(m.direction < 0.0) * (-((m.contraction - 0.06) / 0.004).powi(2)).exp(),
            |m| f64::from(m.contraction > 0.137) - f64::from(m.contraction > 0.12),
        ];
        for (number, shape) in shapes.iter().enumerate() {
            let size = record.moments().iter().map(|m| shape(m).powi(2)).sum::<f64>().sqrt();
            let seen = (0..20).filter(|seed| {
                let e = misfit(&record, &units, 100 + seed, |m, noise| noise + 9.0 * shape(m) / size);
                lack_of_fit(&record, &e, &units).unwrap() < 0.005
            });
            let seen = seen.count();
            assert!(seen >= 17, "shape {number}: {seen}");
        }
    }

    #[test]
    fn without_strokes_that_repeat_nothing_is_said() {
        let record = record();
        let first = record.moments()[..40].to_vec();
        let alone = Record::from_moments(first, vec![0.0; 40], std::iter::once(0..40).collect()).unwrap();
        assert_eq!(lack_of_fit(&alone, &[1.0; 40], &[]), None);
    }
}
