//! Pure error between cycles: residuals that repeat from cycle to cycle are not noise, whatever a smooth
//! model makes of them.
//!
//! ```text
//! d = r_i - (1 - w) r_j - w r_(j+1),    s^2 = mean of d^2/(1 + (1 - w)^2 + w^2)
//! ```
//! r_i is a residual of one cycle; r_j and r_(j+1) are its neighbours in contraction in another cycle of the
//! same specimen, pressure level and direction. At held length they are neighbours in pressure at the same
//! length. Under a noise law, s^2 is the white noise plus the part of the correlated noise that has decayed
//! since the other cycle. Cycles may also differ by physics (creep, softening), so the pure error bounds the
//! noise from above, never from below:
//!
//! ```text
//! sigma^2 <= s^2 f/chi^2(f; 5 %),    f = 2 m/(k - 1)
//! ```
//! m is the number of independent pairs and k the kurtosis of the noise, 3 if it is normal. With tails as
//! heavy as Student's t of 3 degrees, k is ten and more, and s^2 of few pairs is mostly too small. In the same
//! way, repeated sweeps at one level bound the offsets, by half the mean square of their mean differences: an
//! offset that recurs at a pressure is a function of the pressure.

use bulge_model::Record;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;

use crate::diagnosis::strokes::{Stroke, strokes};
use crate::noise::law::{CorrelationTime, NoiseLaw};
use crate::noise::offset_belief::rms;
use crate::noise::whitening::moment_of;

/// Neighbours further apart than this fraction of the range are not interpolated.
const NEAR: f64 = 0.1;
/// Fewest pairs for an estimate.
const ENOUGH: usize = 20;
/// Fewest pairs between strokes of different sweeps. Fewer pairs share their neighbours, and subtracting
/// their mean would remove noise as well.
const FEWEST: usize = 6;
/// Fewest pairs of sweeps that bound the offsets.
const PAIRS: usize = 3;
/// Probability that the true variance is larger than its bound.
const LARGER: f64 = 0.05;
/// A law whose variance exceeds the bound by less than this fraction is kept.
const CLEAR: f64 = 0.2;
/// A correlated part beyond this multiple of the pure error repeats and is not noise.
const REPEATS: f64 = 1.5;

/// Scatter of residuals between cycles.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BetweenCycles {
    /// Variance of one residual \[N^2\].
    pub(crate) variance: f64,
    /// Time lag between the residuals of each pair \[s\], or in rows without time.
    lags: Vec<f64>,
    /// Number of independent pairs: those with the next stroke.
    independent: f64,
    /// Total duration of all sweeps \[s\], or in rows without time.
    span: f64,
    /// Mean difference of each pair of sweeps at the same level \[N\].
    offsets: Vec<f64>,
}

/// Differences between two sweeps: their sum and their number.
type Offsets = BTreeMap<[usize; 2], (f64, f64)>;

impl BetweenCycles {
    /// The scatter of residuals \[N\], one for each row of a record; none if no cycle is repeated.
    pub(crate) fn of(record: &Record, residual: &[f64]) -> Option<Self> {
        if !record.is_path() {
            return None;
        }
        let at = moment_of(record, seconds(record));
        let (mut sum, mut lags, mut offsets, mut independent) = (0.0, Vec::new(), Offsets::new(), 0.0);
        // The first cycle of a sweep is left out if there are enough others, because its history differs from
        // theirs.
        let mut alike: BTreeMap<_, Vec<Stroke>> = BTreeMap::new();
        for stroke in strokes(record).into_iter().filter(|stroke| !stroke.is_first) {
            alike.entry(stroke.state).or_default().push(stroke);
        }
        for strokes in alike.into_values() {
            let half = strokes.len() / 2;
            for (place, stroke) in strokes.iter().enumerate() {
                // Compare with the next stroke, and with one that is far in time.
                let next = strokes.get(place + 1);
                let before = lags.len();
                sum +=
                    next.map_or(0.0, |next| compared(stroke, next, residual, &at, (&mut lags, &mut offsets)));
                independent += (lags.len() - before) as f64;
                let far = strokes.get(place + half.max(2));
                sum += far.map_or(0.0, |far| compared(stroke, far, residual, &at, (&mut lags, &mut offsets)));
            }
        }
        let of_sweep =
            |rows: &std::ops::Range<usize>| (at(rows.end.saturating_sub(1)) - at(rows.start)).max(0.0);
        let span = record.sweeps().iter().map(of_sweep).sum();
        let offsets = offsets.into_values().map(|(sum, count)| sum / count).collect();
        (lags.len() >= ENOUGH && sum > 0.0).then(|| Self {
            variance: sum / lags.len() as f64,
            lags,
            independent,
            span,
            offsets,
        })
    }

    /// Limits the offsets of a law to the differences between sweeps at the same level; larger sizes are
    /// excluded.
    fn bounds_offsets(&self, mut law: NoiseLaw) -> NoiseLaw {
        let pairs = self.offsets.len();
        if pairs < PAIRS || law.offset_n <= 0.0 {
            return law;
        }
        let square = self.offsets.iter().map(|d| 0.5 * d * d).sum::<f64>() / pairs as f64;
        let most = largest(square, pairs as f64).sqrt();
        if law.offset_beliefs.iter().all(|belief| belief.sd_n <= most) && law.offset_n <= most {
            return law;
        }
        law.offset_beliefs.retain(|belief| belief.sd_n <= most);
        let left: f64 = law.offset_beliefs.iter().map(|belief| belief.weight).sum();
        for belief in &mut law.offset_beliefs {
            belief.weight /= left.max(f64::MIN_POSITIVE);
        }
        let believed = rms(&law.offset_beliefs);
        let larger = law.offset_n > most;
        law.offset_n = if left > 0.0 { believed } else { most }.min(law.offset_n);
        if larger {
            law.says = format!(
                "{}; {pairs} sweeps that were run again are off by at most {most:.3} N: offsets that recur are no noise",
                law.says
            );
        }
        law
    }

    /// Limits the noise of a law to the differences between cycles; variance beyond that is misfit that
    /// repeats.
    ///
    /// `inputs` is the mean variance from noise of the inputs, which the scatter contains as well \[N^2\];
    /// `kurtosis` is that of the noise.
    pub(crate) fn bounds(&self, law: NoiseLaw, inputs: f64, kurtosis: f64) -> NoiseLaw {
        let mut law = self.bounds_offsets(law);
        let time = law.time.map_or(1.0, CorrelationTime::value);
        let decayed = |lag: &f64| -(-lag / time).exp_m1();
        let part = self.lags.iter().map(decayed).sum::<f64>() / self.lags.len() as f64;
        let [white, correlated] = [law.white_n, law.correlated_n].map(|sd| sd * sd);
        let expected = white + inputs + correlated * part;
        // Pairs within a correlation time are not independent.
        let slow = if correlated > white { self.span / (2.0 * time) } else { f64::INFINITY };
        let pairs = slow.clamp(1.0, self.independent.max(1.0));
        let most = largest(self.variance, 2.0 * pairs / (kurtosis.max(3.0) - 1.0));
        if expected <= most * (1.0 + CLEAR) {
            return law;
        }
        let left = (most - inputs).max(0.01 * most);
        // The white part is known from neighbours; variance beyond the pure error repeats.
        let white = white.min(left);
        let rest = (left - white) / part.max(0.1);
        let refused = correlated > REPEATS * REPEATS * most;
        law.white_n = white.sqrt();
        law.correlated_n = correlated.min(rest).sqrt();
        if law.correlated_n <= 0.0 {
            law.time = None;
        }
        let what = if refused {
            "its correlated part repeats from cycle to cycle, and is no noise"
        } else {
            "a part of it repeats"
        };
        law.says = format!(
            "{}; cycles differ by at most {:.3} N ({} pairs): {what}",
            law.says,
            most.sqrt(),
            self.lags.len()
        );
        law
    }
}

/// Upper bound of a variance from an estimate with so many degrees of freedom.
fn largest(variance: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::INFINITY, |chi| variance * freedom / chi.inverse_cdf(LARGER))
}

/// The unit of the lags.
fn seconds(record: &Record) -> Option<CorrelationTime> {
    record.has_time().then_some(CorrelationTime::Seconds(1.0))
}

/// Sum of squared differences between two strokes, in variances of one residual. Appends the lags and the
/// difference between the sweeps to their lists.
fn compared(
    one: &Stroke,
    other: &Stroke,
    residual: &[f64],
    at: &dyn Fn(usize) -> f64,
    (lags, offsets): (&mut Vec<f64>, &mut Offsets),
) -> f64 {
    let mut found: Vec<(f64, f64, f64)> = Vec::with_capacity(one.points.len());
    for point in &one.points {
        let after = other.points.partition_point(|p| p.place < point.place);
        let (Some(a), Some(b)) =
            (after.checked_sub(1).and_then(|i| other.points.get(i)), other.points.get(after))
        else {
            continue;
        };
        let width = b.place - a.place;
        if width <= 0.0 || width > NEAR {
            continue;
        }
        let w = (point.place - a.place) / width;
        let difference = residual[point.row] - (1.0 - w) * residual[a.row] - w * residual[b.row];
        found.push((difference, 1.0 + (1.0 - w).powi(2) + w * w, (at(point.row) - at(a.row)).abs()));
    }
    let mut scale = 1.0;
    if one.sweep != other.sweep && found.len() >= FEWEST {
        // Sweeps may differ by an offset.
        let mean = found.iter().map(|f| f.0).sum::<f64>() / found.len() as f64;
        let differs = offsets.entry([one.sweep.min(other.sweep), one.sweep.max(other.sweep)]).or_default();
        let side = if one.sweep < other.sweep { 1.0 } else { -1.0 };
        *differs = (differs.0 + side * mean, differs.1 + 1.0);
        for pair in &mut found {
            pair.0 -= mean;
        }
        // The subtracted mean takes one degree of freedom.
        scale = found.len() as f64 / (found.len() as f64 - 1.0);
    } else if one.sweep != other.sweep {
        return 0.0;
    }
    lags.extend(found.iter().map(|f| f.2));
    scale * found.iter().map(|f| f.0 * f.0 / f.1).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::law::NoiseSource;
    use bulge_effects::Moment;
    use bulge_numerics::Random;

    /// Cycles of 80 rows in one sweep, with steps of 2 s.
    fn record(cycles: usize) -> Record {
        let moments: Vec<Moment> = (0..80 * cycles)
            .map(|i| {
                let x = (i % 80) as f64 / 80.0;
                Moment {
                    direction: if x < 0.5 { 1.0 } else { -1.0 },
                    cycle: i as f64 / 80.0,
                    clock: 2.0 * i as f64,
                    time: 2.0 * i as f64,
                    begins: i == 0,
                    ..Moment::at_rest(2e5, 0.2 * (1.0 - (2.0 * x - 1.0).abs()))
                }
            })
            .collect();
        let n = moments.len();
        Record::from_moments(moments, vec![0.0; n], std::iter::once(0..n).collect()).unwrap()
    }

    /// Cycles of a pressure that rests for five readings on each of nine levels and is read with noise, of which the
    /// misfit holds -3 N/kPa: neighbours by reading would have the same noise, and differ by that of the force alone.
    #[test]
    fn noise_of_the_reading_that_orders_the_rows_of_a_rest_counts() {
        let mut random = Random::new(8, 0);
        let (mut moments, mut residual) = (Vec::new(), Vec::new());
        for cycle in 0..20 {
            for place in 0..18 {
                let (level, up) = if place < 9 { (place, 1.0) } else { (17 - place, -1.0) };
                for _ in 0..5 {
                    let noise = 250.0 * random.normal();
                    let clock = moments.len() as f64;
                    moments.push(Moment {
                        pressure_direction: up,
                        cycle: f64::from(cycle),
                        clock,
                        time: clock,
                        begins: moments.is_empty(),
                        ..Moment::at_rest(1e5 + 5e4 * f64::from(level) + noise, 0.1)
                    });
                    residual.push(-3e-3 * noise + 0.3 * random.normal());
                }
            }
        }
        let n = moments.len();
        let record = Record::from_moments(moments, vec![0.0; n], std::iter::once(0..n).collect()).unwrap();
        let found = BetweenCycles::of(&record, &residual).unwrap().variance;
        let ratio = (found / (0.75_f64.powi(2) + 0.09)).sqrt();
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn a_ripple_that_repeats_is_no_noise_and_the_noise_stays_what_it_is() {
        for cycles in [2, 4, 12] {
            let record = record(cycles);
            let mut random = Random::new(3, cycles as u64);
            let residual: Vec<f64> = record
                .moments()
                .iter()
                .map(|m| 20.0 * (150.0 * m.contraction).sin() * m.direction + 1.5 * random.normal())
                .collect();
            let found = BetweenCycles::of(&record, &residual).unwrap();
            let ratio = (found.variance / 2.25).sqrt();
            assert!((ratio - 1.0).abs() < 0.2, "{cycles} cycles: {ratio}");
            let rippled = NoiseLaw {
                correlated_n: 14.0,
                time: Some(CorrelationTime::Seconds(30.0)),
                ..NoiseLaw::white(1.4, NoiseSource::Saturated, 100.0, String::new())
            };
            let law = found.bounds(rippled, 0.0, 3.0);
            let total = law.white_n.hypot(law.correlated_n);
            // The upper bound of a variance from five correlation times, for two cycles: four times the estimate.
            assert!((1.2..3.4).contains(&total), "{cycles} cycles: {total}");
        }
        assert!(BetweenCycles::of(&record(1), &[0.0; 80]).is_none());
    }

    /// Sweeps of a loop at six pressures, run twice, with an offset by pressure or by sweep.
    #[test]
    fn offsets_that_recur_at_a_pressure_are_no_noise_and_others_stay() {
        let moments: Vec<Moment> = (0..12 * 80)
            .map(|i| {
                let (x, sweep) = (f64::from(i % 80) / 80.0, i / 80);
                Moment {
                    direction: if x < 0.5 { 1.0 } else { -1.0 },
                    clock: 2.0 * f64::from(i),
                    time: 2.0 * f64::from(i % 80),
                    begins: i % 80 == 0,
                    ..Moment::at_rest(1e5 * f64::from(1 + sweep % 6), 0.2 * (1.0 - (2.0 * x - 1.0).abs()))
                }
            })
            .collect();
        let sweeps = (0..12).map(|i| 80 * i..80 * (i + 1)).collect();
        let record = Record::from_moments(moments, vec![0.0; 960], sweeps).unwrap();
        let mut random = Random::new(4, 0);
        let sizes: Vec<f64> = (0..12).map(|_| 5.0 * random.normal()).collect();
        let law = |by: &dyn Fn(usize) -> f64| {
            let mut random = Random::new(5, 0);
            let residual: Vec<f64> = (0..960).map(|row| by(row / 80) + 1.5 * random.normal()).collect();
            let found = BetweenCycles::of(&record, &residual).unwrap();
            let law = NoiseLaw {
                offset_n: 5.0,
                ..NoiseLaw::white(1.5, NoiseSource::Saturated, 500.0, String::new())
            };
            found.bounds(law, 0.0, 3.0)
        };
        let recurring = law(&|sweep| sizes[sweep % 6]);
        assert!(recurring.offset_n < 0.6, "{}", recurring.offset_n);
        assert!((law(&|sweep| sizes[sweep]).offset_n - 5.0).abs() < 1e-12);
    }

    #[test]
    fn at_held_length_cycles_are_compared_at_equal_pressures() {
        let moments: Vec<Moment> = record(4)
            .moments()
            .iter()
            .map(|m| Moment {
                pressure: 1e5 + 2.5e6 * m.contraction,
                contraction: 0.1,
                pressure_direction: m.direction,
                direction: 0.0,
                ..*m
            })
            .collect();
        let n = moments.len();
        let record = Record::from_moments(moments, vec![0.0; n], std::iter::once(0..n).collect()).unwrap();
        let mut random = Random::new(3, 1);
        let ripple = |m: &Moment| 20.0 * (m.pressure / 2e4).sin() * m.pressure_direction;
        let residual: Vec<f64> = record.moments().iter().map(|m| ripple(m) + 1.5 * random.normal()).collect();
        let ratio = (BetweenCycles::of(&record, &residual).unwrap().variance / 2.25).sqrt();
        assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
    }

    #[test]
    fn strokes_of_few_rows_say_nothing_about_noise() {
        // Set points of three rows each, close enough for comparisons: the mean of three differences with
        // common neighbours would remove most of the noise.
        let moments: Vec<Moment> = (0..600)
            .map(|i| Moment {
                direction: 1.0,
                clock: f64::from(i),
                time: f64::from(i % 3),
                begins: i % 3 == 0,
                ..Moment::at_rest(2e5, 0.05 + 0.002 * f64::from(i % 3) + 0.04 * f64::from((i / 3) % 2))
            })
            .collect();
        let sweeps = (0..200).map(|i| 3 * i..3 * i + 3).collect();
        let record = Record::from_moments(moments, vec![0.0; 600], sweeps).unwrap();
        let mut random = Random::new(9, 1);
        let residual: Vec<f64> = (0..600).map(|_| random.normal()).collect();
        assert_eq!(BetweenCycles::of(&record, &residual), None);
    }

    /// Noise with the tails of Student's t of 3 degrees and variance 1, which three cycles of one pressure show.
    #[test]
    fn tails_make_the_scatter_between_few_cycles_a_poor_bound() {
        let record = record(3);
        let truth = NoiseLaw::white(1.0, NoiseSource::Saturated, 200.0, String::new());
        let lowered = |kurtosis: f64| {
            let of = |seed: &u64| {
                let mut random = Random::new(*seed, 5);
                let mut t = || {
                    let normal = random.normal();
                    let square: f64 = (0..3).map(|_| random.normal().powi(2)).sum();
                    normal / square.sqrt()
                };
                let noise: Vec<f64> = (0..240).map(|_| t()).collect();
                let found = BetweenCycles::of(&record, &noise).unwrap();
                let law = found.bounds(truth.clone(), 0.0, kurtosis);
                // Pairs with the next stroke only.
                assert!(found.independent > 0.0 && found.independent <= found.lags.len() as f64);
                let most = largest(found.variance, 2.0 * found.independent / (kurtosis - 1.0));
                let expected = if most * 1.2 < 1.0 { most.sqrt() } else { 1.0 };
                assert!((law.white_n - expected).abs() < 1e-12, "{} {expected}", law.white_n);
                law.white_n < 1.0
            };
            (0..400).filter(of).count()
        };
        let [normal, heavy] = [3.0, 20.0].map(lowered);
        assert!(normal > 40 && heavy < 20, "{normal} {heavy}");
    }

    /// 100 degrees of freedom, of which the 5 % quantile is 77.93.
    #[test]
    fn the_largest_variance_is_that_of_chi_squared() {
        assert!((largest(2.0, 100.0) - 200.0 / 77.929_465).abs() < 1e-6);
        // Left by two columns: 1, -1 and 3 in standard deviations of sqrt(1 + 3) N.
        let columns = [vec![0.0, 0.0, 0.0, 1.0], vec![0.0; 4]];
        let law = NoiseLaw::white(1.0, NoiseSource::Saturated, 3.0, String::new());
        let found = super::super::noise::kurtosis(&[2.0, -2.0, 6.0, 9.0], &columns, &[3.0; 4], &law);
        assert!((found - 4.0 * 83.0 / 121.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn noise_that_is_slow_stays_in_the_law() {
        // The correlation time is 400 s and a cycle takes 160 s, so the cycles differ by a part of the noise
        // only.
        let truth = NoiseLaw {
            correlated_n: 3.0,
            time: Some(CorrelationTime::Seconds(400.0)),
            ..NoiseLaw::white(0.5, NoiseSource::Saturated, 100.0, String::new())
        };
        let record = record(30);
        let mut sum = 0.0;
        for seed in 0..20 {
            let noise = truth.simulate(&record, &vec![true; record.len()], &[], seed);
            let found = BetweenCycles::of(&record, &noise).unwrap();
            let law = found.bounds(truth.clone(), 0.0, 3.0);
            sum += law.correlated_n / 20.0;
        }
        assert!(sum > 2.5, "{sum}");
    }
}
