//! Noise of the inputs if no data sheet states it, estimated from the scatter of the rows: it is larger where
//! the force is steeper.
//!
//! ```text
//! s_i^2 = w (1 + k (dF/dx_i)^2 / mean),    x the contraction or the pressure;   w and k by maximum likelihood on the residuals of a saturated model
//! ```
//! Along a path, the scatter is taken from neighbouring residuals, (r_i - r_(i-1))^2/2, which slow noise
//! hardly changes. The likelihood ratio against k = 0 is divided by the factors by which heavy tails,
//! (kurtosis - 1)/2, and shared neighbours, 3/2, inflate it. If rows are means of many readings, the scatter
//! of the readings themselves is used, without any model.

use std::ops::Range;

use bulge_numerics::vector::dot;

/// Ratios k on the grid: least, largest and number, evenly spaced on a logarithmic scale.
const RATIOS: (f64, f64, u32) = (0.02, 200.0, 60);
/// Likelihood ratio from which the scatter depends on the slope: p = 0.001 (chi-squared, one degree of
/// freedom).
const CLEAR: f64 = 10.83;
/// Parts of a stated noise on the grid: least and number, evenly spaced on a logarithmic scale up to 1; and none of it.
const PARTS: (f64, u32) = (0.003, 20);
/// Range of the other noise in which its best variance is sought, over the mean square; and steps of that search, which end
/// within a thousandth.
const OTHER: [f64; 2] = [1e-4, 10.0];
const SECTIONS: usize = 20;
/// Fewest rows for an estimate.
const FEWEST: usize = 60;
/// Neighbouring differences share a row, which inflates the variance of sums of their squares by this factor.
const SHARED: f64 = 1.5;

/// Sum of squares about the mean of some readings \[N^2\], with its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scatter {
    pub(crate) sum: f64,
    pub(crate) freedom: f64,
}

/// Variance of each row from noise of an input \[N^2\]; none if the scatter doesn't depend on the slopes.
///
/// - `residual`: measured less predicted force \[N\], `sweeps` of rows in the order of measurement (none in a
///   static map),
/// - `design`: orthonormal columns of a saturated model,
/// - `slopes`: derivative of the force by each of the inputs,
/// - `counts`: number of readings that each row is the mean of,
/// - `within`: scatter of the readings of each row about their mean. It contains no misfit, and replaces the
///   residuals if most rows have it.
pub(crate) fn input_noise(
    residual: &[f64],
    sweeps: &[Range<usize>],
    design: &[Vec<f64>],
    slopes: [&[f64]; 2],
    counts: &[f64],
    within: &[Option<Scatter>],
) -> Option<Vec<f64>> {
    if residual.len() < FEWEST {
        return None;
    }
    if 2 * within.iter().flatten().count() > residual.len() {
        return of_readings(slopes, counts, within);
    }
    let rows = left(residual, design);
    let neighbours = |values: &[f64], of: fn(f64, f64) -> f64| -> Vec<f64> {
        let of_sweep = |sweep: &Range<usize>| {
            values[sweep.clone()].windows(2).map(|w| of(w[0], w[1])).collect::<Vec<_>>()
        };
        sweeps.iter().flat_map(of_sweep).collect()
    };
    let is_path = !sweeps.is_empty();
    let squares: Vec<f64> = if is_path {
        neighbours(&rows, |a, b| 0.5 * (a - b) * (a - b))
    } else {
        rows.iter().map(|r| r * r).collect()
    };
    let fits = slopes.map(|slope| {
        let shape: Vec<f64> = slope.iter().zip(counts).map(|(s, count)| s * s / count).collect();
        let mean = shape.iter().sum::<f64>() / shape.len() as f64;
        let shape: Vec<f64> = shape.iter().map(|s| s / mean).collect();
        if !shape.iter().all(|s| s.is_finite()) {
            return None;
        }
        let of_squares = if is_path { neighbours(&shape, |a, b| 0.5 * (a + b)) } else { shape.clone() };
        let (clear, variance) = fitted(&squares, &of_squares, &vec![1.0; squares.len()])?;
        let clear = if is_path { clear / SHARED } else { clear };
        Some((clear, shape.iter().map(|s| variance * s).collect::<Vec<f64>>()))
    });
    clearest(fits)
}

/// The part of the stated variances of the inputs that the scatter of the rows agrees with: 1 unless it contradicts them (p =
/// 0.001). Data sheets state what isn't exceeded. Where that is much more than there is, rows on steep stretches seem to
/// scatter too little, the others too much, and what isn't there would be found in them.
///
/// ```text
/// s_i^2 = w + part v_i,    v_i as stated;   w and part <= 1 by maximum likelihood
/// ```
/// Arguments are those of [`input_noise`]; `stated` are variances of the rows \[N^2\]. More than is stated isn't
/// tried: what is missing in the model scatters as well.
pub(crate) fn part_of_stated(
    residual: &[f64],
    sweeps: &[Range<usize>],
    design: &[Vec<f64>],
    stated: &[f64],
    counts: &[f64],
    within: &[Option<Scatter>],
) -> f64 {
    if residual.len() < FEWEST {
        return 1.0;
    }
    // A mean square, its degrees of freedom, and the stated variance in it.
    let shown: Vec<[f64; 3]> = if 2 * within.iter().flatten().count() > residual.len() {
        let known = within.iter().enumerate().filter_map(|(row, one)| Some((row, (*one)?)));
        known.map(|(row, one)| [one.sum / one.freedom, one.freedom, stated[row] * counts[row]]).collect()
    } else {
        // Along a path a rate or a step holds the noise of the length, and a model with such columns would follow it.
        let pair = |row: usize| {
            [0.5 * (residual[row] - residual[row + 1]).powi(2), 1.0, 0.5 * (stated[row] + stated[row + 1])]
        };
        if sweeps.is_empty() {
            left(residual, design).iter().zip(stated).map(|(left, own)| [left * left, 1.0, *own]).collect()
        } else {
            sweeps.iter().flat_map(|sweep| (sweep.start..sweep.end.saturating_sub(1)).map(pair)).collect()
        }
    };
    let shared = if sweeps.is_empty() { 1.0 } else { SHARED };
    let (least, count) = PARTS;
    let parts = (0..count).map(|i| least.powf(1.0 - f64::from(i) / f64::from(count - 1)));
    let found = std::iter::once(0.0).chain(parts).map(|part| (part, with_part(&shown, part)));
    let Some((part, (deviance, other))) = found.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { return 1.0 };
    let spread = shown
        .iter()
        .map(|[square, freedom, own]| 0.5 * freedom * (square / (other + part * own) - 1.0).powi(2));
    let tails = (spread.sum::<f64>() / shown.len() as f64).max(1.0);
    if (with_part(&shown, 1.0).0 - deviance) / tails / shared > CLEAR { part } else { 1.0 }
}

/// The least deviance with a part of the stated variances, and the other variance there, by golden sections of its
/// logarithm.
fn with_part(shown: &[[f64; 3]], part: f64) -> (f64, f64) {
    let mean = shown.iter().map(|[square, ..]| square).sum::<f64>() / shown.len() as f64;
    let at = |log: f64| {
        let other = log.exp();
        let of = |[square, freedom, own]: &[f64; 3]| {
            let variance = (other + part * own).max(f64::MIN_POSITIVE);
            freedom * (variance.ln() + square / variance)
        };
        (shown.iter().map(of).sum::<f64>(), other)
    };
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut low, mut high] = OTHER.map(|part| (part * mean).max(f64::MIN_POSITIVE).ln());
    for _ in 0..SECTIONS {
        let step = golden * (high - low);
        if at(high - step).0 < at(low + step).0 { high = low + step } else { low = high - step }
    }
    at(0.5 * (low + high))
}

/// The same estimate from the scatter of the readings that each row is the mean of.
fn of_readings(slopes: [&[f64]; 2], counts: &[f64], within: &[Option<Scatter>]) -> Option<Vec<f64>> {
    let known: Vec<(usize, Scatter)> =
        within.iter().enumerate().filter_map(|(row, one)| Some((row, (*one)?))).collect();
    let squares: Vec<f64> = known.iter().map(|(_, one)| one.sum / one.freedom).collect();
    let freedom: Vec<f64> = known.iter().map(|(_, one)| one.freedom).collect();
    let fits = slopes.map(|slope| {
        let mean = slope.iter().map(|s| s * s).sum::<f64>() / slope.len() as f64;
        let shape: Vec<f64> = known.iter().map(|(row, _)| slope[*row] * slope[*row] / mean).collect();
        if !shape.iter().all(|s| s.is_finite()) {
            return None;
        }
        let (clear, variance) = fitted(&squares, &shape, &freedom)?;
        let of_means = slope.iter().zip(counts).map(|(s, count)| variance * s * s / mean / count);
        Some((clear, of_means.collect::<Vec<f64>>()))
    });
    clearest(fits)
}

/// The input with the largest likelihood ratio, if it is above the threshold.
fn clearest(fits: [Option<(f64, Vec<f64>)>; 2]) -> Option<Vec<f64>> {
    let best = fits.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > CLEAR).then_some(best.1)
}

/// Residuals orthogonal to the columns, each divided by the square root of 1 - its leverage.
fn left(residual: &[f64], design: &[Vec<f64>]) -> Vec<f64> {
    let mut left = residual.to_vec();
    let mut free = vec![1.0; left.len()];
    for column in design {
        let part = dot(column, residual);
        for ((value, free), c) in left.iter_mut().zip(&mut free).zip(column) {
            *value -= part * c;
            *free -= c * c;
        }
    }
    left.iter().zip(&free).map(|(value, free)| value / free.max(0.05).sqrt()).collect()
}

/// Likelihood ratio at the best k, and the input variance where the shape is 1. `squares` are mean squares
/// with `freedom` degrees of freedom each.
fn fitted(squares: &[f64], shape: &[f64], freedom: &[f64]) -> Option<(f64, f64)> {
    let all: f64 = freedom.iter().sum();
    let rows = || squares.iter().zip(shape).zip(freedom);
    let of = |ratio: f64| {
        let scale = rows().map(|((r, s), f)| f * r / (1.0 + ratio * s)).sum::<f64>() / all;
        let logs: f64 = rows().map(|((_, s), f)| f * (1.0 + ratio * s).ln()).sum();
        (all * scale.ln() + logs, scale)
    };
    let (low, high, count) = RATIOS;
    let ratios = (0..count).map(|i| low * (high / low).powf(f64::from(i) / f64::from(count - 1)));
    let (ratio, (deviance, scale)) =
        ratios.map(|ratio| (ratio, of(ratio))).min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    // Expected value 1 for normal residuals, since a mean square of f degrees of freedom has the relative
    // variance 2/f.
    let spread = rows().map(|((r, s), f)| 0.5 * f * (r / (scale * (1.0 + ratio * s)) - 1.0).powi(2));
    let tails = (spread.sum::<f64>() / squares.len() as f64).max(1.0);
    Some(((of(0.0).0 - deviance) / tails, scale * ratio))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Random;

    fn steep(n: usize) -> Vec<f64> {
        (0..n).map(|i| 1.0 / (0.05 + i as f64 / n as f64)).collect()
    }

    fn scatter(n: usize, input: f64, tails: bool) -> Vec<f64> {
        let mut random = Random::new(4, 0);
        let slope = steep(n);
        (0..n)
            .map(|i| {
                // One in ten residuals is three times as large.
                let wide = if tails && random.uniform() < 0.1 { 3.0 } else { 1.0 };
                wide * random.normal() + input * slope[i] * random.normal()
            })
            .collect()
    }

    /// Columns as a saturated model has them: orthonormal and slowly varying.
    fn columns(n: usize) -> Vec<Vec<f64>> {
        let wave = |k: usize| -> Vec<f64> {
            let of = |i: usize| (std::f64::consts::PI * k as f64 * (i as f64 + 0.5) / n as f64).cos();
            (0..n).map(|i| of(i) * (2.0 / n as f64).sqrt()).collect()
        };
        (1..40).map(wave).collect()
    }

    #[test]
    fn scatter_that_grows_with_the_slope_is_found_with_its_size() {
        let n = 4000;
        // Means of four readings each.
        let (slope, flat, fours) = (steep(n), vec![1.0; n], vec![4.0; n]);
        for sweeps in [vec![], vec![0..n / 2, n / 2..n]] {
            let found =
                input_noise(&scatter(n, 0.4, false), &sweeps, &columns(n), [&flat, &slope], &fours, &[])
                    .unwrap();
            let sd = (found[n / 3] / (slope[n / 3] * slope[n / 3])).sqrt();
            assert!((0.37..0.43).contains(&sd), "{sd}");
            assert!((found[0] / found[n / 3] - (slope[0] / slope[n / 3]).powi(2)).abs() < 1e-9);
        }
    }

    #[test]
    fn scatter_that_is_the_same_everywhere_is_left_alone() {
        let n = 600;
        let (slope, flat, ones) = (steep(n), vec![1.0; n], vec![1.0; n]);
        for tails in [false, true] {
            let scatter = scatter(n, 0.0, tails);
            assert!(input_noise(&scatter, &[], &[], [&slope, &flat], &ones, &[]).is_none());
        }
        assert!(input_noise(&[1.0; 20], &[], &[], [&[1.0; 20], &[1.0; 20]], &[1.0; 20], &[]).is_none());
    }

    /// The readings of each row tell their scatter if more than half of the rows have several; the residuals of
    /// these rows show none.
    #[test]
    fn scatter_within_rows_counts_where_most_rows_have_it() {
        let n = 400;
        let (slope, flat, fours) = (steep(n), vec![1.0; n], vec![4.0; n]);
        let no_slope = scatter(n, 0.0, false);
        let noise = scatter(4 * n, 0.0, false);
        let found = |rows: usize| {
            let of_row = |row: usize| {
                let sd = 0.8 * slope[row];
                let own: Vec<f64> = noise[4 * row..4 * row + 4].iter().map(|x| sd * x).collect();
                let mean = own.iter().sum::<f64>() / 4.0;
                Scatter { sum: own.iter().map(|x| (x - mean).powi(2)).sum(), freedom: 3.0 }
            };
            let within: Vec<Option<Scatter>> =
                (0..n).map(|row| (row % n < rows).then(|| of_row(row))).collect();
            input_noise(&no_slope, &[], &columns(n), [&flat, &slope], &fours, &within)
        };
        assert!(found(n / 2).is_none());
        let most = found(n / 2 + 1).unwrap();
        assert!((0.7..0.9).contains(&(2.0 * (most[n / 3]).sqrt() / slope[n / 3])), "{}", most[n / 3]);
    }

    /// Data sheets that state four times the noise of an input are contradicted, by residuals and by readings of means; those
    /// that are right, or state too little, are taken as they are.
    #[test]
    fn noise_that_is_stated_too_large_is_taken_in_part() {
        let n = 2400;
        let (slope, ones) = (steep(n), vec![1.0; n]);
        for (real, stated, part) in [(0.4, 1.6, 0.0625), (0.0, 0.8, 0.0), (0.4, 0.4, 1.0), (0.4, 0.1, 1.0)] {
            let variances: Vec<f64> = slope.iter().map(|s| (stated * s).powi(2)).collect();
            for sweeps in [vec![], vec![0..n / 2, n / 2..n]] {
                let rows = scatter(n, real, false);
                let found = part_of_stated(&rows, &sweeps, &columns(n), &variances, &ones, &[]);
                assert!((found - part).abs() < 0.3 * part + 0.01, "{real} {stated}: {found}");
            }
            let mut random = Random::new(5, 0);
            let of_row = |s: &f64| {
                let own: Vec<f64> =
                    (0..8).map(|_| (1.0 + (real * s).powi(2)).sqrt() * random.normal()).collect();
                let mean = own.iter().sum::<f64>() / 8.0;
                Some(Scatter { sum: own.iter().map(|x| (x - mean).powi(2)).sum(), freedom: 7.0 })
            };
            let within: Vec<Option<Scatter>> = slope.iter().map(of_row).collect();
            let of_means: Vec<f64> = variances.iter().map(|v| v / 8.0).collect();
            let found = part_of_stated(&vec![0.0; n], &[], &[], &of_means, &vec![8.0; n], &within);
            assert!((found - part).abs() < 0.3 * part + 0.01, "{real} {stated}, readings: {found}");
        }
        assert!(part_of_stated(&[1.0; 20], &[], &[], &[9.0; 20], &[1.0; 20], &[]) >= 1.0);
    }

    #[test]
    fn few_rows_tell_no_input_noise() {
        let tell = |n: usize| {
            let slope: Vec<f64> = (0..n).map(|i| if i % 6 == 0 { 40.0 } else { 0.1 }).collect();
            let alternating: Vec<f64> =
                (0..n).map(|i| if i % 12 < 6 { slope[i] } else { -slope[i] }).collect();
            input_noise(&alternating, &[], &[], [&vec![0.0; n], &slope], &vec![1.0; n], &[]).is_some()
        };
        assert_eq!([20, FEWEST - 1, FEWEST, 240].map(tell), [false, false, true, true]);
    }

    #[test]
    fn slow_noise_is_no_noise_of_the_inputs() {
        let n = 2400;
        let (slope, flat, ones) = (steep(n), vec![1.0; n], vec![1.0; n]);
        let mut found = 0;
        for seed in 0..40 {
            let mut random = Random::new(seed, 1);
            let mut slow = 0.0;
            let noise: Vec<f64> = (0..n)
                .map(|_| {
                    // Slow noise of twice the white noise, correlated over 25 rows.
                    slow = 0.96 * slow + 2.0 * (1.0 - 0.96_f64.powi(2)).sqrt() * random.normal();
                    slow + random.normal()
                })
                .collect();
            let sweeps = [0..n / 2, n / 2..n];
            found +=
                u32::from(input_noise(&noise, &sweeps, &columns(n), [&slope, &flat], &ones, &[]).is_some());
        }
        assert!(found <= 1, "{found} of 40");
    }

    #[test]
    fn readings_of_means_say_it_whatever_the_means_are_off() {
        // 300 means of 20 readings, with a misfit of the means that is proportional to the slope.
        let (n, readings_of_each) = (300, 20);
        let count = f64::from(readings_of_each);
        let slope = steep(n);
        let (flat, counts) = (vec![1.0; n], vec![count; n]);
        for (input, is_found) in [(0.4, true), (0.0, false)] {
            let mut random = Random::new(9, 0);
            let within: Vec<Option<Scatter>> = slope
                .iter()
                .map(|s| {
                    let sd = (1.0 + (input * s).powi(2)).sqrt();
                    let readings: Vec<f64> = (0..readings_of_each).map(|_| sd * random.normal()).collect();
                    let mean = readings.iter().sum::<f64>() / count;
                    let sum = readings.iter().map(|r| (r - mean).powi(2)).sum();
                    Some(Scatter { sum, freedom: count - 1.0 })
                })
                .collect();
            let misfit: Vec<f64> = slope.iter().map(|s| 5.0 * s * random.normal()).collect();
            let sweeps = [0..n / 2, n / 2..n];
            let found = input_noise(&misfit, &sweeps, &columns(n), [&flat, &slope], &counts, &within);
            assert_eq!(found.is_some(), is_found);
            if let Some(found) = found {
                let sd = (found[n / 3] * count).sqrt() / slope[n / 3];
                assert!((0.37..0.43).contains(&sd), "{sd}");
            }
        }
    }
}
