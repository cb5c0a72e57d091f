//! Detects a jump within a sweep: a clamp that slipped, a cell that was knocked, an amplifier that changed
//! its range. A law of slow noise would take it for noise.
//!
//! ```text
//! z(k) = <s, e>/|s|,    s = K^-1/2 (1 from row k to the end of its sweep) outside of the model's numbers,    e the whitened misfit outside of them
//! chance = 1 - (1 - erfc(|z|/(L sqrt 2)))^M,    L the level of all M of them by their median, at least 1
//! ```
//! z is the likelihood-ratio statistic of one jump in the estimated coloured noise (Page 1955; Basseville and
//! Nikiforov 1993).

use bulge_model::Record;
use bulge_numerics::vector::dot;
use rayon::prelude::*;
use statrs::function::erf::erfc;

use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::space::Space;
use crate::median::robust_sd;
use crate::noise::whitening::Whitening;

/// Rows next to the ends of a sweep and to its turns, where a jump can't be distinguished from end effects.
const EDGE: usize = 5;
/// Fewest rows for estimating the level.
const FEWEST: usize = 60;
/// Most positions that are tried, because each requires whitening a column.
const MOST: usize = 1500;
/// Fraction of a jump's square that must remain outside the model's tangents.
const OWN: f64 = 0.1;

/// A jump in the residuals of a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jump {
    /// First row after the jump.
    pub(crate) row: usize,
    /// Its size \[N\].
    pub(crate) newtons: f64,
}

/// The clearest jump, if it is significant. `left` is the whitened misfit, row by row.
pub(crate) fn jump(record: &Record, whitening: &Whitening, space: &Space, left: &[f64]) -> Option<Jump> {
    let places = places(record);
    if !record.is_path() || places.len() < FEWEST || whitening.rows() != record.len() {
        return None;
    }
    let tried: Vec<(Jump, f64)> =
        places.par_iter().map(|(row, end)| score(whitening, space, left, (*row, *end))).collect();
    let sizes: Vec<f64> = tried.iter().map(|(_, z)| *z).collect();
    let level = robust_sd(&sizes).max(1.0);
    let (found, z) = tried.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (chance(z / level, sizes.len()) < RULE.jump).then_some(found)
}

/// Probability that the largest of `places` normal variables exceeds z in absolute value.
fn chance(z: f64, places: usize) -> f64 {
    let single = erfc(z.abs() / std::f64::consts::SQRT_2);
    -(places as f64 * (-single).ln_1p()).exp_m1()
}

/// Rows at which a jump could be detected, with the end of their sweep.
fn places(record: &Record) -> Vec<(usize, usize)> {
    let moments = record.moments();
    let is_smooth = |row: usize| {
        let around = &moments[row - EDGE..row + EDGE];
        around.iter().all(|m| m.direction.total_cmp(&around[0].direction).is_eq())
    };
    let mut places = Vec::new();
    for sweep in record.sweeps() {
        let inner = sweep.start + EDGE..(sweep.end + 1).saturating_sub(EDGE).max(sweep.start + EDGE);
        places.extend(
            inner.filter(|row| row + EDGE <= sweep.end && is_smooth(*row)).map(|row| (row, sweep.end)),
        );
    }
    let stride = places.len().div_ceil(MOST).max(1);
    places.into_iter().step_by(stride).collect()
}

/// The jump at a row, with its size in standard deviations; none if the model's parameters could absorb it.
fn score(whitening: &Whitening, space: &Space, left: &[f64], (row, end): (usize, usize)) -> (Jump, f64) {
    let mut column = vec![0.0; whitening.rows()];
    column[row..end].fill(1.0);
    let mut white = whitening.whitened(column);
    // Rows for the priors of parameters follow those of the readings.
    white.resize(left.len(), 0.0);
    let outside = space.outside_of_left_out(&white);
    let square = dot(&outside, &outside);
    if square < OWN * dot(&white, &white) {
        return (Jump { row, newtons: 0.0 }, 0.0);
    }
    let along = dot(&outside, left);
    (Jump { row, newtons: along / square }, along / square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::law::{CorrelationTime, NoiseLaw, NoiseSource};
    use bulge_effects::Moment;
    use bulge_numerics::Random;

    /// Four strokes of 150 rows at 0.5 s.
    fn record() -> Record {
        let moment = |i: u32| {
            let begins = i.is_multiple_of(150);
            let direction = if (i / 150).is_multiple_of(2) { 1.0 } else { -1.0 };
            let clock = 0.5 * f64::from(i);
            Moment {
                direction,
                clock,
                since: if begins { 0.0 } else { 0.5 },
                begins,
                ..Moment::at_rest(2e5, 0.1)
            }
        };
        let sweeps = (0..4).map(|i| 150 * i..150 * (i + 1)).collect();
        Record::from_moments((0..600).map(moment).collect(), vec![0.0; 600], sweeps).unwrap()
    }

    /// The jump found in white noise of 1 N and slow noise of 2 N with a jump of a given size from row 200 to
    /// the end of the second stroke.
    fn found(record: &Record, size: f64, seed: u64) -> Option<Jump> {
        let mut law = NoiseLaw::white(1.0, NoiseSource::Saturated, 1e6, String::new());
        (law.correlated_n, law.time) = (2.0, Some(CorrelationTime::Seconds(20.0)));
        let whitening = Whitening::new(&law, record, &[true; 600], &[]).unwrap();
        let mut random = Random::new(seed, 0);
        // A Markov chain with the correlation time, restarted in each sweep.
        let (kept, mut slow) = ((-0.5_f64 / 20.0).exp(), 0.0);
        let mut noise = Vec::new();
        for moment in record.moments() {
            let scale = if moment.begins { 2.0 } else { 2.0 * (1.0 - kept * kept).sqrt() };
            slow = if moment.begins { 0.0 } else { kept * slow } + scale * random.normal();
            noise.push(slow + random.normal());
        }
        noise[200..300].iter_mut().for_each(|reading| *reading += size);
        let space = Space::without(&[whitening.whitened(vec![1.0; 600])]);
        let left = space.outside_of_left_out(&whitening.whitened(noise));
        jump(record, &whitening, &space, &left)
    }

    #[test]
    fn a_jump_is_found_beneath_slow_noise() {
        let record = record();
        for seed in 0..10 {
            let jump = found(&record, 9.0, seed).unwrap();
            assert!(jump.row.abs_diff(200) <= 1 && (jump.newtons - 9.0).abs() < 4.0, "{jump:?}");
        }
    }

    #[test]
    fn too_few_places_show_no_jump() {
        let record = record();
        let law = NoiseLaw::white(1.0, NoiseSource::Saturated, 1e6, String::new());
        // Of the rows of a sweep, 2 EDGE - 1 at its ends are no places.
        let whole = FEWEST / 3 + 2 * EDGE - 1;
        let found = |last: usize| {
            let rows = 2 * whole + last;
            let sweeps = vec![0..whole, whole..2 * whole, 2 * whole..rows];
            let moments = record.moments()[..rows].to_vec();
            let few = Record::from_moments(moments, vec![0.0; rows], sweeps).unwrap();
            let whitening = Whitening::new(&law, &few, &vec![true; rows], &[]).unwrap();
            let left: Vec<f64> = (0..rows).map(|row| if row < 2 * whole + 14 { 0.0 } else { 50.0 }).collect();
            jump(&few, &whitening, &Space::default(), &left)
        };
        let jump = found(whole).unwrap();
        assert!(jump.row == 2 * whole + 14 && (jump.newtons - 50.0).abs() < 1e-9, "{jump:?}");
        assert!(found(whole - 1).is_none());
    }

    #[test]
    fn the_largest_of_many_is_large_more_often() {
        // Two-sided probability beyond 5: 5.733e-7.
        assert!((chance(-5.0, 1) / 5.733_031e-7 - 1.0).abs() < 1e-6);
        assert!((chance(5.0, 100) / 5.732_868e-5 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn slow_noise_has_none_more_often_than_it_may() {
        let record = record();
        assert_eq!((0..200).filter(|seed| found(&record, 0.0, *seed).is_some()).count(), 0);
    }

    #[test]
    fn what_the_model_can_make_is_no_jump() {
        let record = record();
        let law = NoiseLaw::white(1.0, NoiseSource::Saturated, 1e6, String::new());
        let whitening = Whitening::new(&law, &record, &[true; 600], &[]).unwrap();
        let mut step = vec![0.0; 600];
        step[200..300].fill(1.0);
        let left = vec![1.0; 600];
        let space = Space::without(&[whitening.whitened(step)]);
        assert!(score(&whitening, &space, &left, (200, 300)).1.abs() < 1e-12);
        assert!(score(&whitening, &Space::default(), &left, (200, 300)).1 > 9.0);
    }
}
