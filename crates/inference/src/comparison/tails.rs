//! Readings far from their neighbours: how far a reading may deviate, and how readings beyond are weighted
//! down.

use bulge_model::Record;
use std::sync::Arc;

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::levels::Levels;
use crate::median::{MAD_TO_SD, median};

/// Neighbours on each side of a row that determine its expected value.
const AROUND: usize = 5;
/// Largest deviation, in standard deviations of the neighbours (from the median absolute deviation); normal
/// noise exceeds it once in 16 000.
const BOUND: f64 = 4.0;
/// Standard deviations stated for two rows of one mean differ by no more than this factor.
const ALIKE: f64 = 1.5;
/// Most differences for estimating the noise; their median is accurate to a hundredth.
const MOST_DIFFERENCES: usize = 100_000;
/// A reading that is moved by less than this fraction of the noise keeps its weight.
const MOVED: f64 = 1e-3;

/// Stretches of rows with the same direction, specimen and pressure level.
pub(crate) fn ways<'r>(
    rows: &'r [usize],
    record: &'r Record,
    levels: &'r Levels,
) -> impl Iterator<Item = &'r [usize]> {
    let moments = record.moments();
    // Rows with a much larger standard deviation are kept apart, because they would affect their neighbours.
    let is_alike = move |a: usize, b: usize| {
        record.force_sd().is_none_or(|sd| sd[a].max(sd[b]) <= ALIKE * sd[a].min(sd[b]))
    };
    rows.chunk_by(move |a, b| {
        let [first, second] = [a, b].map(|row| &moments[*row]);
        first.specimen == second.specimen
            && first.branch().total_cmp(&second.branch()).is_eq()
            && first.cycle.floor().total_cmp(&second.cycle.floor()).is_eq()
            && (record.is_path() || levels.at(*a) == levels.at(*b))
            && is_alike(*a, *b)
    })
}

/// Residuals with outliers moved towards their neighbours (Huber's pseudo-values about Hampel's running
/// median). A residual outside the range of its two neighbours is moved to within 4 standard deviations of
/// the median of the five rows on either side, or to the nearer neighbour if that is farther. The standard
/// deviation is the larger one of that of these rows and that of all rows. Normal noise keeps its values
/// except once in 16 000 rows; a steady rise or fall, such as the transition after a reversal, always keeps
/// them.
pub(crate) fn bounded(residual: &[f64], stretches: &[Vec<usize>]) -> Vec<f64> {
    let mut bounded = residual.to_vec();
    for (row, value) in moved(residual, stretches) {
        bounded[row] = value;
    }
    bounded
}

/// The residuals that [`bounded`] moves, with their rows.
fn moved(residual: &[f64], stretches: &[Vec<usize>]) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    let least = white(residual, stretches);
    for rows in stretches {
        for place in 1..rows.len().saturating_sub(1) {
            let value = residual[rows[place]];
            let [before, after] = [residual[rows[place - 1]], residual[rows[place + 1]]];
            let (low, high) = (before.min(after), before.max(after));
            if value >= low && value <= high {
                continue;
            }
            let around = place.saturating_sub(AROUND)..(place + AROUND + 1).min(rows.len());
            let mut values: Vec<f64> = rows[around].iter().map(|row| residual[*row]).collect();
            let middle = median(&mut values);
            for value in &mut values {
                *value = (*value - middle).abs();
            }
            let most = BOUND * (MAD_TO_SD * median(&mut values)).max(least);
            let bounded = value.max(low.min(middle - most)).min(high.max(middle + most));
            if bounded.total_cmp(&value).is_ne() {
                found.push((rows[place], bounded));
            }
        }
    }
    found
}

/// Standard deviation of the white part of the residuals, from second differences along the stretches.
fn white(residual: &[f64], stretches: &[Vec<usize>]) -> f64 {
    let all: usize = stretches.iter().map(Vec::len).sum();
    let every = all.div_ceil(MOST_DIFFERENCES).max(1);
    let windows = stretches.iter().flat_map(|rows| rows.windows(3)).step_by(every);
    let mut differences: Vec<f64> =
        windows.map(|w| (residual[w[0]] - 2.0 * residual[w[1]] + residual[w[2]]).abs()).collect();
    MAD_TO_SD * median(&mut differences) / 6.0_f64.sqrt()
}

/// Standard deviations of all rows \[N\], in which an outlier has the weight that it would have at the bound:
/// Huber's weights as variances, `s^2 (1 + m/(4 s))` for a reading that is moved by m. None if there are no
/// outliers. `sd_n` is the noise of rows for which the file states none.
fn sd_with_tails(
    record: &Record,
    levels: &Levels,
    used: &[bool],
    residuals: &[f64],
    sd_n: f64,
) -> Option<Vec<f64>> {
    if !record.is_path() {
        return None;
    }
    let mut far: Vec<(usize, f64)> = Vec::new();
    for sweep in record.sweeps() {
        let rows: Vec<usize> =
            sweep.clone().filter(|row| used[*row] && residuals[*row].is_finite()).collect();
        let stretches: Vec<Vec<usize>> = ways(&rows, record, levels).map(<[usize]>::to_vec).collect();
        let by = |(row, bounded): (usize, f64)| (row, (residuals[row] - bounded).abs());
        far.extend(moved(residuals, &stretches).into_iter().map(by).filter(|(_, by)| *by > MOVED * sd_n));
    }
    if far.is_empty() {
        return None;
    }
    let mut sd = record.force_sd().map_or_else(|| vec![sd_n; record.len()], <[f64]>::to_vec);
    for (row, by) in far {
        sd[row] *= (1.0 + by / (BOUND * sd_n)).sqrt();
    }
    Some(sd)
}

impl Analysis<'_> {
    /// From here on, limits the influence of readings in the tails of the noise on fits through their
    /// weights. Means of rows, which a diagnosis uses, have their own limit.
    pub(crate) fn bound_tails(&mut self, first: &Climbed) {
        let residuals = self.residuals(first);
        let sd = sd_with_tails(&self.record, &self.levels, &self.used.mask, &residuals, self.noise.force_n);
        if let Some(sd) = sd {
            self.record = Arc::new(Record::clone(&self.record).with_force_sd(sd));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_numerics::Random;

    #[test]
    fn a_reading_in_the_tails_pulls_no_more_than_at_the_bound() {
        let moments: Vec<Moment> = (0..400)
            .map(|i| Moment {
                direction: 1.0,
                begins: i == 0,
                clock: f64::from(i),
                ..Moment::at_rest(2e5, 5e-4 * f64::from(i))
            })
            .collect();
        let record =
            Record::from_moments(moments, vec![0.0; 400], std::iter::once(0..400).collect()).unwrap();
        let used = vec![true; 400];
        let levels = Levels::of(&record, &used);
        let mut random = Random::new(8, 0);
        let clean: Vec<f64> = (0..400).map(|i| 0.05 * f64::from(i) + 2.0 * random.normal()).collect();
        assert_eq!(sd_with_tails(&record, &levels, &used, &clean, 2.0), None);
        let pull = |off: f64| {
            let mut residuals = clean.clone();
            residuals[200] = 10.0 + off;
            let sd = sd_with_tails(&record, &levels, &used, &residuals, 2.0).unwrap();
            assert!(sd.iter().enumerate().all(|(row, sd)| (*sd - 2.0).abs() < 1e-12 || row == 200));
            off / (sd[200] * sd[200])
        };
        // At four standard deviations 8 N/(2 N)^2 = 2, and hardly more beyond.
        for off in [12.0, 40.0, 400.0, 4000.0] {
            assert!((1.0..2.6).contains(&pull(off)), "{off}: {}", pull(off));
        }
        assert!((pull(4000.0) / pull(400.0) - 1.0).abs() < 0.05);
    }
}
