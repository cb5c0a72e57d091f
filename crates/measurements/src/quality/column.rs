//! A column of readings with its resolution.

use crate::resolution::Resolution;
use std::collections::HashSet;
use std::ops::Range;

/// Readings are noisy if two of one state are equal with less than this probability: that of noise with a
/// standard deviation of two quantisation steps, 1/(4 sqrt(pi)).
const EQUAL: f64 = 0.141;
/// Noise below this fraction of a quantisation step is mostly that of rounding, and says nothing of what is
/// equal.
const SEEN: f64 = 0.7;
/// Noise below this fraction of the range comes from arithmetic, not from measuring.
const LEAST: f64 = 1e-7;
/// Fraction of neighbouring fourth differences with opposite signs from which a channel is noisy. White noise
/// has 1/2 + asin(4/5)/pi = 80 %, a smooth curve hardly any.
const TURNS: f64 = 0.65;

/// Force, motion or pressure of all rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column<'a> {
    pub(super) name: &'static str,
    pub(super) values: &'a [f64],
    pub(super) resolution: Resolution,
    /// Probability that two readings of one state are equal: step/(2 sqrt(pi) noise) for normal noise, 1 if
    /// what changes is no white noise.
    equal: f64,
}

impl<'a> Column<'a> {
    pub(super) fn new(
        name: &'static str,
        values: &'a [f64],
        resolution: Resolution,
        sweeps: &[Range<usize>],
    ) -> Self {
        let is_white = resolution.noise > (LEAST * resolution.range).max(SEEN * resolution.step)
            && turns(values, sweeps) > TURNS;
        let equal = resolution.step / (2.0 * std::f64::consts::PI.sqrt() * resolution.noise);
        Self { name, values, resolution, equal: if is_white { equal.min(1.0) } else { 1.0 } }
    }

    /// Whether the readings have white noise above their resolution, so that they differ in a state at rest.
    pub(super) fn is_noisy(&self) -> bool {
        self.equal < EQUAL
    }

    /// How many rows of these columns are equal in a state at rest as seldom as one noisy reading; infinite if
    /// nothing scatters.
    pub(super) fn rows_for_one<'c>(columns: impl IntoIterator<Item = &'c Self>) -> f64
    where
        'a: 'c,
    {
        let equal: f64 = columns.into_iter().map(|column| column.equal).product();
        if equal < 1.0 { (EQUAL.ln() / equal.ln()).max(1.0) } else { f64::INFINITY }
    }

    /// Whether values on no grid come back in most rows, as set points such as 1.00, 1.33 and 1.67 do.
    pub(super) fn are_set_points(&self) -> bool {
        let different: HashSet<u64> = self.values.iter().map(|value| value.to_bits()).collect();
        self.resolution.step <= 0.0 && 2 * different.len() < self.values.len()
    }

    /// Readings closer than this are the same but for rounding.
    pub(super) fn rounding(&self) -> f64 {
        LEAST * self.resolution.range
    }
}

/// Fraction of neighbouring fourth differences within sweeps that have opposite signs.
fn turns(values: &[f64], sweeps: &[Range<usize>]) -> f64 {
    let (mut opposite, mut pairs) = (0_usize, 0_usize);
    for sweep in sweeps {
        let fourth = |w: &[f64]| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
        let bends: Vec<f64> = values[sweep.clone()].windows(5).map(fourth).collect();
        for pair in bends.windows(2).filter(|pair| pair[0] != 0.0 && pair[1] != 0.0) {
            pairs += 1;
            opposite += usize::from((pair[0] > 0.0) != (pair[1] > 0.0));
        }
    }
    opposite as f64 / pairs.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Noise;

    #[test]
    fn white_noise_is_told_from_motion_and_from_steps() {
        let mut noise = Noise::new(3);
        let whole = 0..4000;
        let sweeps = std::slice::from_ref(&whole);
        let is_noisy =
            |values: &[f64]| Column::new("force", values, Resolution::of(values, sweeps), sweeps).is_noisy();
        let white: Vec<f64> = (0..4000).map(|_| noise.normal()).collect();
        // The share of a long record: 1/2 + asin(4/5)/pi.
        assert!((turns(&white, sweeps) - 0.795).abs() < 0.02, "{}", turns(&white, sweeps));
        let curve: Vec<f64> = (0..4000).map(|i| 100.0 * (f64::from(i) * 0.01).sin()).collect();
        let noisy: Vec<f64> = curve.iter().zip(&white).map(|(curve, white)| curve + white).collect();
        assert!(is_noisy(&white) && is_noisy(&noisy) && !is_noisy(&curve));
        let coarse: Vec<f64> = noisy.iter().map(|value| (value / 2.0).round() * 2.0).collect();
        assert!(!is_noisy(&coarse));
        // Noise of half a step: it says nothing. Of one step: one column says nothing, two together do.
        let column = Column::new("force", &coarse, Resolution::of(&coarse, sweeps), sweeps);
        let found = (0..3998).filter(|i| (white[*i].round() - white[i + 2].round()).abs() < 0.5).count();
        let step =
            Column::new("force", &white, Resolution { step: 1.0, ..Resolution::of(&white, sweeps) }, sweeps);
        assert!((found as f64 / 3998.0 / step.equal - 1.0).abs() < 0.1, "{found} {}", step.equal);
        let rows = [&[column][..], &[step], &[step; 2]].map(Column::rows_for_one);
        assert!(rows[0].is_infinite() && rows[1] > 1.0 && rows[2] <= 1.0, "{rows:?}");
        let set: Vec<f64> = (0..4000).map(|i| [1.0, 1.33, 1.67, 2.0, 2.33, 1.67][i % 6]).collect();
        let set = Column::new("pressure", &set, Resolution::of(&set, sweeps), sweeps);
        let free = Column::new("force", &noisy, Resolution::of(&noisy, sweeps), sweeps);
        assert!(set.are_set_points() && !free.are_set_points() && !column.are_set_points());
        let quiet = Column::new("force", &curve, Resolution::of(&curve, sweeps), sweeps);
        assert!(Column::rows_for_one(&[quiet]).is_infinite());
    }
}
