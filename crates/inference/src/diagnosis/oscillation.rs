//! Detects an oscillation of a valve, a supply or an amplifier as a line in the spectrum of a model's
//! residuals. A law of slow noise would absorb its power but leave the line.
//!
//! ```text
//! P(f) = |sum over rows of e exp(2 pi i f t)|^2/(sum of e^2)                                      (Lomb 1976; Scargle 1982)
//! chance = 1 - (1 - exp(-P/L))^M,    L the level of the spectrum around f, M frequencies
//! ```
//! e are the whitened residuals orthogonal to the model's tangents. Under noise, P/L has an exponential
//! distribution, whatever the distribution of single readings and the colour of the noise: L is the median
//! level of neighbouring frequencies.

use bulge_model::Record;

use crate::diagnosis::decision_rule::RULE;
use crate::median::median;

/// Frequencies per natural spacing of the record, 1/duration.
const FINER: usize = 2;
/// A line with fewer periods in the record counts as drift.
const DRIFT: usize = 3;
/// Neighbouring frequencies on either side for the level of the spectrum. The larger level counts, because
/// slow noise is stronger at low frequencies.
const NEIGHBOURS: [usize; 2] = [150, 60];
/// Largest ratio of the true level to that of its neighbours where the noise is slow: readings that an
/// amplifier averages have a spectrum of humps, which no exponential correlation whitens.
const HUMPS: f64 = 2.0;
/// Fewest rows for a spectrum.
const FEWEST: usize = 60;

/// The period \[s\] of a significant oscillation; none without time, or if there is none. `left` is the
/// whitened misfit, row by row; `is_slow` says whether its noise is correlated.
pub(crate) fn oscillation(record: &Record, left: &[f64], is_slow: bool) -> Option<f64> {
    let clock: Vec<f64> = record.moments().iter().map(|m| m.clock).collect();
    let rows = clock.len();
    let mut steps: Vec<f64> = record.moments().iter().map(|m| m.since).filter(|since| *since > 0.0).collect();
    if !record.is_path() || !record.has_time() || rows < FEWEST || steps.is_empty() {
        return None;
    }
    let first = clock.iter().copied().fold(f64::INFINITY, f64::min);
    let whole = clock.iter().copied().fold(f64::NEG_INFINITY, f64::max) - first;
    let step = median(&mut steps);
    let unit = 1.0 / (FINER as f64 * whole);
    // Up to half the sampling frequency, with a limit proportional to the number of readings, because pauses
    // make the duration long.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of frequencies")]
    let last = ((0.5 / (step * unit)) as usize).min(FINER * 4 * rows);
    let begin = FINER * DRIFT;
    if last < begin + NEIGHBOURS[0] {
        return None;
    }
    let power = spectrum(&clock.iter().map(|t| t - first).collect::<Vec<_>>(), left, unit, begin..last);
    let level_among = |place: usize, neighbours: usize| {
        let around = place.saturating_sub(neighbours)..(place + neighbours + 1).min(power.len());
        // The line itself and its flanks don't belong to the level.
        let others = around.filter(|other| other.abs_diff(place) > FINER);
        // The median of an exponential distribution is ln 2 times its mean.
        median(&mut others.map(|other| power[other]).collect::<Vec<f64>>()) / std::f64::consts::LN_2
    };
    let level =
        |place: usize| NEIGHBOURS.map(|count| level_among(place, count)).into_iter().fold(0.0, f64::max);
    let (place, height) = (0..power.len())
        .map(|place| (place, power[place] / level(place).max(f64::MIN_POSITIVE)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let height = if is_slow { height / HUMPS } else { height };
    let chance = -(power.len() as f64 * (-(-height).exp()).ln_1p()).exp_m1();
    (chance < RULE.oscillation).then(|| 1.0 / (unit * (begin + place) as f64))
}

/// The spectrum at multiples of a frequency. Each row's phasor is rotated from one multiple to the next,
/// which saves sines and cosines.
fn spectrum(time: &[f64], left: &[f64], unit: f64, multiples: std::ops::Range<usize>) -> Vec<f64> {
    let turn = |t: &f64, multiple: f64| (std::f64::consts::TAU * unit * multiple * t).sin_cos();
    let mut phasors: Vec<(f64, f64)> = time.iter().map(|t| turn(t, multiples.start as f64)).collect();
    let turns: Vec<(f64, f64)> = time.iter().map(|t| turn(t, 1.0)).collect();
    let square: f64 = left.iter().take(time.len()).map(|e| e * e).sum();
    multiples
        .map(|_| {
            let (mut sine, mut cosine) = (0.0, 0.0);
            for ((phasor, turn), e) in phasors.iter_mut().zip(&turns).zip(left) {
                let (s, c) = *phasor;
                (sine, cosine) = (sine + s * e, cosine + c * e);
                *phasor = (s * turn.1 + c * turn.0, c * turn.1 - s * turn.0);
            }
            (sine * sine + cosine * cosine) / square
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_numerics::Random;

    /// Three sweeps of 300 rows at 0.2 s, a minute apart.
    fn record() -> Record {
        let moment = |i: u32| {
            let clock = 0.2 * f64::from(i) + 60.0 * f64::from(i / 300);
            let begins = i.is_multiple_of(300);
            let since = if begins { 0.0 } else { 0.2 };
            let contraction = 0.1 + 1e-4 * f64::from(i % 300);
            let time = 0.2 * f64::from(i % 300);
            Moment { direction: 1.0, clock, time, since, begins, ..Moment::at_rest(2e5, contraction) }
        };
        let sweeps = (0..3).map(|i| 300 * i..300 * (i + 1)).collect();
        Record::from_moments((0..900).map(moment).collect(), vec![0.0; 900], sweeps).unwrap()
    }

    /// White noise with an oscillation of a given size.
    fn left(record: &Record, size: f64, period: f64, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed, 0);
        let hum = |m: &Moment| size * (std::f64::consts::TAU * m.clock / period).sin();
        record.moments().iter().map(|m| hum(m) + random.normal()).collect()
    }

    #[test]
    fn a_hum_is_found_with_its_period() {
        let record = record();
        for period in [0.9, 2.3, 7.0] {
            // |e|^2/2 = 900 0.4^2/4: 36 times the level.
            let found = oscillation(&record, &left(&record, 0.4, period, 5), false).unwrap();
            assert!((found / period - 1.0).abs() < 0.01, "{found} {period}");
        }
    }

    /// Without times there is no frequency, and in few rows no line.
    #[test]
    fn rows_without_a_time_and_few_rows_have_none() {
        let still: Vec<Moment> = record().moments().iter().map(|m| Moment { since: 0.0, ..*m }).collect();
        let still = Record::from_moments(still, vec![0.0; 900], std::iter::once(0..900).collect()).unwrap();
        assert!(oscillation(&still, &left(&still, 4.0, 2.3, 5), false).is_none());
        let few = |rows: usize| {
            let moments = record().moments()[..rows].to_vec();
            let record =
                Record::from_moments(moments, vec![0.0; rows], std::iter::once(0..rows).collect()).unwrap();
            oscillation(&record, &left(&record, 9.0, 1.0, 5), false)
        };
        assert!(few(FEWEST - 1).is_none() && few(4 * FEWEST).is_some());
    }

    #[test]
    fn noise_has_no_line_more_often_than_it_may() {
        let record = record();
        let found =
            (0..300).filter(|seed| oscillation(&record, &left(&record, 0.0, 1.0, *seed), false).is_some());
        // One in five thousand may have a line.
        assert!(found.count() <= 2);
    }

    /// Means of eight readings, as a logger forms them, whitened as slow noise is: by 0.88 of the reading before.
    #[test]
    fn averaged_noise_has_no_line() {
        let moments = record().moments()[..300].to_vec();
        let record =
            Record::from_moments(moments, vec![0.0; 300], std::iter::once(0..300).collect()).unwrap();
        let averaged = |seed: u64| {
            let mut random = Random::new(seed, 1);
            let noise: Vec<f64> = (0..308).map(|_| random.normal()).collect();
            let means: Vec<f64> = noise.windows(8).map(|eight| eight.iter().sum()).collect();
            means.windows(2).map(|pair| pair[1] - 0.88 * pair[0]).collect::<Vec<f64>>()
        };
        let lines = |is_slow| {
            (0..400).filter(|seed| oscillation(&record, &averaged(*seed), is_slow).is_some()).count()
        };
        let found = [false, true].map(lines);
        assert!(found[0] > 20 && found[1] <= 4, "{found:?}");
    }

    #[test]
    fn the_spectrum_is_the_sum_over_the_rows() {
        let record = record();
        let (time, e): (Vec<f64>, _) =
            (record.moments().iter().map(|m| m.clock).collect(), left(&record, 0.4, 3.0, 2));
        let found = spectrum(&time, &e, 1e-3, 100..400);
        for (place, power) in found.iter().enumerate().step_by(37) {
            let angle = |t: &f64| std::f64::consts::TAU * 1e-3 * (100 + place) as f64 * t;
            let sine: f64 = time.iter().zip(&e).map(|(t, e)| angle(t).sin() * e).sum();
            let cosine: f64 = time.iter().zip(&e).map(|(t, e)| angle(t).cos() * e).sum();
            let square: f64 = e.iter().map(|e| e * e).sum();
            assert!((power - (sine * sine + cosine * cosine) / square).abs() < 1e-9 * (1.0 + power));
        }
    }
}
