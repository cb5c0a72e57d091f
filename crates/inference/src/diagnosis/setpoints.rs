//! The history as it was set, without the noise of its readings. Functions of pressure and contraction are
//! evaluated there.
//!
//! The noise of a reading is in the misfit too, as -dF/dp dp. A column that is a function of the same reading
//! correlates with it (errors in variables), above all where readings are dense or end, so that the noise of
//! a sensor looks like physics. A column at values that don't contain the row's own reading can't.

use bulge_model::Record;

use crate::comparison::levels::Levels;
use crate::median::{MAD_TO_SD, median};

/// Widest range of a level that counts as held, as a fraction of the largest pressure.
const KEPT: f64 = 0.04;
/// Neighbours on either side of a row.
const NEIGHBOURS: usize = 4;
/// A reading further from its neighbours than this many standard deviations is kept as it is, because the
/// path bends there.
const BEND: f64 = 4.0;

/// Least pressure that neighbours set, over the reading.
const LEAST: f64 = 0.1;

/// The record with pressures and contractions as set: the mean of a pressure level, or values interpolated
/// from the neighbours along a path.
pub(crate) fn setpoints(record: &Record) -> Record {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let pressures: Vec<f64> = record.moments().iter().map(|m| m.pressure).collect();
    let pressure: Vec<f64> = if is_kept(&pressures, &levels) {
        (0..record.len()).map(|row| levels.mean[levels.at(row)]).collect()
    } else {
        // Beside a step a parabola may lead below zero, where no model has a state.
        let sound = |(set, read): (f64, &f64)| if set > LEAST * read { set } else { *read };
        by_neighbours(record, &pressures).into_iter().zip(&pressures).map(sound).collect()
    };
    let contractions: Vec<f64> = record.moments().iter().map(|m| m.contraction).collect();
    record.clone().at(&pressure, &by_neighbours(record, &contractions))
}

/// Whether pressures were held at levels, rather than merely clustered.
fn is_kept(pressures: &[f64], levels: &Levels) -> bool {
    let largest = pressures.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; levels.len()];
    for (row, pressure) in pressures.iter().enumerate() {
        let [low, high] = &mut ranges[levels.at(row)];
        (*low, *high) = (low.min(*pressure), high.max(*pressure));
    }
    !levels.is_cut() && ranges.iter().all(|[low, high]| high - low <= KEPT * largest)
}

/// Each value from a parabola through its neighbours in the sweep, without the value itself.
fn by_neighbours(record: &Record, values: &[f64]) -> Vec<f64> {
    let mut found = values.to_vec();
    if !record.is_path() {
        return found;
    }
    for sweep in record.sweeps() {
        let own = &values[sweep.clone()];
        let noise = scatter(own);
        if noise <= 0.0 || noise.is_nan() {
            continue;
        }
        for i in 0..own.len() {
            let first = i.saturating_sub(NEIGHBOURS);
            let last = (i + NEIGHBOURS).min(own.len() - 1);
            let others = (first..=last).filter(|j| *j != i).map(|j| (j as f64 - i as f64, own[j]));
            if let Some(value) = parabola_at_zero(others)
                && (value - own[i]).abs() <= BEND * noise
            {
                found[sweep.start + i] = value;
            }
        }
    }
    found
}

/// Standard deviation about a smooth path, from second differences; the median is insensitive to reversals
/// and steps.
fn scatter(values: &[f64]) -> f64 {
    let mut bends: Vec<f64> = values.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    MAD_TO_SD * median(&mut bends) / 6.0_f64.sqrt()
}

/// Value at 0 of the least-squares parabola; none for fewer than five points.
fn parabola_at_zero(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let mut moments = [0.0; 5];
    let mut right = [0.0; 3];
    let mut count = 0;
    for (x, y) in points {
        count += 1;
        let mut power = 1.0;
        for (k, moment) in moments.iter_mut().enumerate() {
            *moment += power;
            if k < 3 {
                right[k] += power * y;
            }
            power *= x;
        }
    }
    if count < 5 {
        return None;
    }
    let matrix = nalgebra::Matrix3::from_fn(|i, j| moments[i + j]);
    let solution = matrix.cholesky()?.solve(&nalgebra::Vector3::from(right));
    Some(solution[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_numerics::Random;

    fn record(contraction: &[f64]) -> Record {
        let moments: Vec<Moment> = contraction
            .iter()
            .enumerate()
            .map(|(i, e)| Moment { direction: 1.0, begins: i == 0, ..Moment::at_rest(2e5, *e) })
            .collect();
        let n = moments.len();
        Record::from_moments(moments, vec![0.0; n], std::iter::once(0..n).collect()).unwrap()
    }

    #[test]
    fn a_parabola_stays_and_the_own_noise_goes() {
        let path: Vec<f64> = (0..400).map(|i| 1e-6 * f64::from(i * i)).collect();
        let mut random = Random::new(4, 0);
        let noise: Vec<f64> = path.iter().map(|_| 1e-4 * random.normal()).collect();
        let read: Vec<f64> = path.iter().zip(&noise).map(|(e, d)| e + d).collect();
        let exact = setpoints(&record(&path));
        for (moment, e) in exact.moments().iter().zip(&path) {
            assert!((moment.contraction - e).abs() < 1e-12);
        }
        let set = setpoints(&record(&read));
        let along: f64 =
            set.moments().iter().zip(&path).zip(&noise).map(|((m, e), d)| (m.contraction - e) * d).sum();
        let own: f64 = noise.iter().map(|d| d * d).sum();
        // The few readings beyond 4 sd of their neighbours keep their noise.
        assert!((along / own).abs() < 0.15, "{}", along / own);
    }

    #[test]
    fn a_pressure_beside_a_step_is_not_set_below_zero() {
        let mut random = Random::new(7, 0);
        let read = |i: u32| if i < 30 { 5e5 } else { 4e3 };
        // Steps all along make the scatter about a smooth path as large as they are.
        let moments: Vec<Moment> = (0..60)
            .map(|i| {
                let own = read(i) * (1.0 + 0.5 * f64::from(i % 2)) + 10.0 * random.normal();
                Moment { direction: 1.0, begins: i == 0, ..Moment::at_rest(own, 0.01 * f64::from(i)) }
            })
            .collect();
        let record = Record::from_moments(moments, vec![0.0; 60], std::iter::once(0..60).collect()).unwrap();
        let pressures: Vec<f64> = record.moments().iter().map(|moment| moment.pressure).collect();
        assert!(by_neighbours(&record, &pressures).iter().any(|set| *set < 0.0));
        assert!(setpoints(&record).moments().iter().all(|moment| moment.pressure > 0.0));
    }

    #[test]
    fn stairs_keep_their_edges() {
        let stairs: Vec<f64> = (0..100).map(|i| 0.02 * f64::from(i / 10)).collect();
        let set = setpoints(&record(&stairs));
        for (moment, e) in set.moments().iter().zip(&stairs) {
            assert!((moment.contraction - e).abs() < 1e-15);
        }
    }
}
