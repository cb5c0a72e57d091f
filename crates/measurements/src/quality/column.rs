//! A column of readings with its resolution.

use crate::resolution::Resolution;
use std::ops::Range;

/// With noise of this many quantisation steps, neighbours differ: two normal readings are equal with a
/// probability of 1/(2 * 2 sqrt(pi)) = 14 %.
const STEPS: f64 = 2.0;
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
    /// Whether the readings have white noise above their resolution.
    pub(super) is_noisy: bool,
}

impl<'a> Column<'a> {
    pub(super) fn new(
        name: &'static str,
        values: &'a [f64],
        resolution: Resolution,
        sweeps: &[Range<usize>],
    ) -> Self {
        let is_noisy = resolution.noise > STEPS * resolution.step
            && resolution.noise > LEAST * resolution.range
            && turns(values, sweeps) > TURNS;
        Self { name, values, resolution, is_noisy }
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
            |values: &[f64]| Column::new("force", values, Resolution::of(values, sweeps), sweeps).is_noisy;
        let white: Vec<f64> = (0..4000).map(|_| noise.normal()).collect();
        // The share of a long record: 1/2 + asin(4/5)/pi.
        assert!((turns(&white, sweeps) - 0.795).abs() < 0.02, "{}", turns(&white, sweeps));
        let curve: Vec<f64> = (0..4000).map(|i| 100.0 * (f64::from(i) * 0.01).sin()).collect();
        let noisy: Vec<f64> = curve.iter().zip(&white).map(|(curve, white)| curve + white).collect();
        assert!(is_noisy(&white) && is_noisy(&noisy) && !is_noisy(&curve));
        let coarse: Vec<f64> = noisy.iter().map(|value| (value / 2.0).round() * 2.0).collect();
        assert!(!is_noisy(&coarse));
    }
}
