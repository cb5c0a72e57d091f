//! Linearity of a curve of resistance over contraction.

use serde::Serialize;

/// Change of the resistance, relative to R0, below which it counts as none.
const NOTHING: f64 = 1e-9;

/// Straight lines through a curve, and its deviation from them.
///
/// ```text
/// best fit    least squares over the points of the curve, all of one weight
/// terminal    through the first and the last point
/// departure   max |R - line|/(R_max - R_min) * 100 %         over the points of the curve
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Linearity {
    /// Slope of the best fit \[ohm per contraction of 1\].
    pub slope_ohm: f64,
    /// Resistance of the best fit at the contraction 0 \[ohm\].
    pub intercept_ohm: f64,
    /// Slope of the best fit over R0 \[-\]: the mean gauge factor.
    pub mean_sensitivity: f64,
    /// R_max - R_min \[ohm\].
    pub full_scale_ohm: f64,
    /// Largest departure from the best fit \[% of full scale\].
    pub best_fit_percent: f64,
    /// Contraction at this departure.
    pub best_fit_at: f64,
    /// Largest departure from the line through both ends \[% of full scale\].
    pub terminal_percent: f64,
    /// Contraction at this departure.
    pub terminal_at: f64,
}

impl Linearity {
    /// Linearity of resistances \[ohm\] at contractions, with the resistance R0 in the reference. `None` if
    /// there are fewer than two points, if all contractions are the same, if a number isn't finite, or if the
    /// resistance changes by less than 1e-9 R0.
    #[must_use]
    pub fn of(contractions: &[f64], resistances_ohm: &[f64], reference_ohm: f64) -> Option<Self> {
        let count = contractions.len();
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if count < 2 || resistances_ohm.len() != count || !finite(contractions) || !finite(resistances_ohm) {
            return None;
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count as f64;
        let (e_mean, r_mean) = (mean(contractions), mean(resistances_ohm));
        let pairs = || contractions.iter().zip(resistances_ohm).map(|(e, r)| (*e, *r));
        let spread: f64 = pairs().map(|(e, _)| (e - e_mean).powi(2)).sum();
        let high = resistances_ohm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = resistances_ohm.iter().copied().fold(f64::INFINITY, f64::min);
        let full_scale_ohm = high - low;
        let [first, last] = [0, count - 1].map(|i| (contractions[i], resistances_ohm[i]));
        let feels = full_scale_ohm >= NOTHING * reference_ohm && full_scale_ohm > 0.0;
        if !feels || spread <= 0.0 || last.0 - first.0 == 0.0 {
            return None;
        }
        let slope_ohm = pairs().map(|(e, r)| (e - e_mean) * (r - r_mean)).sum::<f64>() / spread;
        let chord = (last.1 - first.1) / (last.0 - first.0);
        let departure = |line: &dyn Fn(f64) -> f64| {
            let each = pairs().map(|(e, r)| ((r - line(e)).abs(), e));
            let (largest, at) =
                each.fold((0.0, first.0), |best, now| if now.0 > best.0 { now } else { best });
            (100.0 * largest / full_scale_ohm, at)
        };
        let (best_fit_percent, best_fit_at) = departure(&|e| r_mean + slope_ohm * (e - e_mean));
        let (terminal_percent, terminal_at) = departure(&|e| first.1 + chord * (e - first.0));
        Some(Self {
            slope_ohm,
            intercept_ohm: r_mean - slope_ohm * e_mean,
            mean_sensitivity: slope_ohm / reference_ohm,
            full_scale_ohm,
            best_fit_percent,
            best_fit_at,
            terminal_percent,
            terminal_at,
        })
    }
}
