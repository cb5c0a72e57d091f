//! Resolution of a quantity: its quantisation step, its white noise and the range of its values.

use std::ops::Range;

/// Quantisation step, noise and range of a column.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Resolution {
    /// Distance between neighbouring levels; 0 if the values are on no grid.
    pub(crate) step: f64,
    /// Standard deviation of the white noise, from the differences of neighbouring rows within a sweep.
    pub(crate) noise: f64,
    /// Largest minus smallest value.
    pub(crate) range: f64,
}

/// Ratio of the standard deviation of a normal x to the median of |x|.
const MAD_TO_SD: f64 = 1.482_602_218_505_602;
/// Number of values for detecting a grid: a grid of all values is a grid of some.
const GRID_SAMPLE: usize = 1 << 15;

impl Resolution {
    /// Resolution of a column whose rows are covered by `sweeps`.
    pub(crate) fn of(values: &[f64], sweeps: &[Range<usize>]) -> Self {
        let (low, high) = bounds(values);
        let range = if values.is_empty() { 0.0 } else { high - low };
        Self { step: grid(values), noise: white_noise(values, sweeps), range }
    }

    /// Number of levels between the smallest and the largest value; none without a grid.
    pub(crate) fn levels(&self) -> Option<f64> {
        (self.step > 0.0).then(|| (self.range / self.step).round() + 1.0)
    }
}

/// Smallest and largest value.
pub(crate) fn bounds(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

/// The median, 0 without values; reorders the values.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The step of the grid on which all values lie (except one in 200, for two devices in one file); 0 if there
/// is none.
fn grid(values: &[f64]) -> f64 {
    let stride = values.len().div_ceil(GRID_SAMPLE).max(1);
    let mut levels: Vec<f64> = values.iter().step_by(stride).copied().collect();
    levels.sort_unstable_by(f64::total_cmp);
    let largest = levels.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    // Rounding of a decimal number in a double and in the unit conversion.
    let rounding = 8.0 * f64::EPSILON * largest;
    let gaps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > rounding).collect();
    let step = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    // One gap doesn't show a grid; a step near the rounding error can't be distinguished from it.
    if gaps.len() < 2 || step < 20.0 * rounding {
        return 0.0;
    }
    let multiples = |gap: f64| gap / step;
    let is_off =
        |gap: &&f64| (multiples(**gap) - multiples(**gap).round()).abs() > 0.02 + 2.0 * rounding / step;
    if 200 * gaps.iter().filter(is_off).count() > gaps.len() {
        return 0.0;
    }
    // The smallest gap has a rounding error. The sum of all gaps, divided by the number of steps in it,
    // hardly has one.
    let count: f64 = gaps.iter().map(|gap| multiples(*gap).round()).sum();
    gaps.iter().sum::<f64>() / count
}

/// Standard deviation of white noise from the differences of order 2, 3 and 4 between neighbouring rows.
///
/// Each order gives sd = 1.4826 median|difference| / |coefficients|, which is too large by what the motion
/// contributes to the differences. The smallest of the three is the most accurate.
fn white_noise(values: &[f64], sweeps: &[Range<usize>]) -> f64 {
    /// Coefficients of each order with their norm: sqrt(6), sqrt(20), sqrt(70).
    const ORDERS: [(&[f64], f64); 3] = [
        (&[1.0, -2.0, 1.0], 2.449_489_742_783_178),
        (&[1.0, -3.0, 3.0, -1.0], 4.472_135_954_999_58),
        (&[1.0, -4.0, 6.0, -4.0, 1.0], 8.366_600_265_340_756),
    ];
    let mut smallest = f64::INFINITY;
    let mut differences = Vec::with_capacity(values.len());
    for (coefficients, norm) in ORDERS {
        differences.clear();
        for sweep in sweeps {
            let windows = values.get(sweep.clone()).unwrap_or_default().windows(coefficients.len());
            differences
                .extend(windows.map(|w| w.iter().zip(coefficients).map(|(v, c)| v * c).sum::<f64>().abs()));
        }
        // Fewer differences don't give a reliable median.
        if differences.len() >= 5 {
            smallest = smallest.min(MAD_TO_SD * median(&mut differences) / norm);
        }
    }
    if smallest.is_finite() { smallest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "a median is one of the numbers")]

    use super::*;
    use crate::simulated::Noise;

    fn whole(values: &[f64]) -> Resolution {
        Resolution::of(values, std::slice::from_ref(&(0..values.len())))
    }

    #[test]
    fn noise_of_a_moving_signal() {
        let mut noise = Noise::new(1);
        let signal: Vec<f64> =
            (0..20_000).map(|i| (f64::from(i) * 0.02).sin() + 0.01 * noise.normal()).collect();
        let found = whole(&signal);
        assert!((found.noise / 0.01 - 1.0).abs() < 0.03, "{found:?}");
        assert_eq!(found.levels(), None);
        let quiet: Vec<f64> = (0..20_000).map(|i| (f64::from(i) * 0.02).sin()).collect();
        assert!(whole(&quiet).noise < 1e-6, "{:?}", whole(&quiet));
        let ramp: Vec<f64> = (0..100).map(|i| 0.25 * f64::from(i)).collect();
        assert!(whole(&ramp).noise < 1e-15);
    }

    #[test]
    fn steps_are_found_in_decimal_numbers() {
        let values: Vec<f64> = (0..500).map(|i| (f64::from(i) * 0.37).sin()).collect();
        let quantised: Vec<f64> = values.iter().map(|v| (v * 50.0).round() / 50.0 * 1e-3).collect();
        let found = whole(&quantised);
        assert!((found.step / 2e-5 - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found.levels(), Some(101.0));
        assert_eq!(whole(&values).levels(), None);
        // Set points without a common step.
        assert_eq!(whole(&[0.296, 0.282, 0.267, 0.250, 0.237, 0.222]).levels(), None);
    }

    #[test]
    fn few_or_equal_values() {
        assert_eq!(whole(&[]), Resolution::default());
        assert_eq!(whole(&[3.0]), Resolution::default());
        assert_eq!(whole(&[3.0; 100]), Resolution::default());
        assert_eq!([median(&mut [3.0, 1.0, 2.0]), median(&mut [])], [2.0, 0.0]);
    }
}
