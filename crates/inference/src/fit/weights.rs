//! Weights of the rows: noise of the force, and noise of pressure and contraction propagated to the force.

use bulge_model::{Prediction, Record};
use bulge_muscles::Muscle;
use bulge_muscles::Quantity;
use rayon::prelude::*;

use bulge_numerics::vector::dot;

/// Most lags over which autocorrelations are summed.
const MOST_LAGS: usize = 2000;

/// Standard deviations of single readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of the force \[N\].
    pub force_n: f64,
    /// Standard deviation of the pressure \[Pa\].
    pub pressure_pa: f64,
    /// Standard deviation of the contraction of the muscle as stated; it is larger for shorter specimens, see
    /// [`Record::shortness`].
    pub contraction: f64,
}

impl Noise {
    /// Noise of the force as given. The other two are those of the muscle's `[instruments]`, or 0.
    #[must_use]
    pub fn of(muscle: &Muscle, force_n: f64) -> Self {
        let instruments = muscle.instruments();
        Self {
            force_n,
            pressure_pa: instruments.pressure.map_or(0.0, |p| p.noise()),
            contraction: instruments.length.map_or(0.0, |l| l.noise()) / muscle.length().si(),
        }
    }

    /// Standard deviation of each row:
    ///
    /// ```text
    /// s_i^2 = sw^2 + (dF/dp)^2 sp^2 + (dF/deps)^2 se^2
    /// ```
    /// sw is the file's own `force_sd` if it has that column.
    #[must_use]
    pub fn of_rows(&self, record: &Record, prediction: &Prediction) -> Vec<f64> {
        let slope = |slopes: &[f64], row: usize| slopes.get(row).copied().unwrap_or(0.0);
        (0..record.len())
            .map(|row| {
                let force = record.force_sd().map_or(self.force_n, |sd| sd[row].max(1e-3 * self.force_n));
                let by_pressure = slope(&prediction.by_pressure, row) * self.pressure_pa;
                let by_contraction =
                    slope(&prediction.by_contraction, row) * self.contraction * record.shortness(row);
                (force * force + by_pressure * by_pressure + by_contraction * by_contraction).sqrt()
            })
            .collect()
    }
}

/// Effective number of independent rows. The residuals r of a sweep are correlated; the integrated
/// correlation time is that of all sweeps together.
///
/// ```text
/// n_eff = n/(1 + 2 sum rho_k),    the sum up to the first k at which rho_k + rho_(k+1) is not positive (Geyer 1992)
/// ```
#[must_use]
pub fn effective_rows(record: &Record, residuals: &[f64], used: &[bool]) -> f64 {
    let rows = used.iter().filter(|u| **u).count() as f64;
    if !record.is_path() || rows < 10.0 {
        return rows;
    }
    let sweeps: Vec<Vec<f64>> = record
        .sweeps()
        .iter()
        .map(|sweep| sweep.clone().filter(|row| used[*row]).map(|row| residuals[row]).collect())
        .collect();
    let total: f64 = sweeps.iter().flatten().map(|r| r * r).sum();
    if total <= 0.0 {
        return rows;
    }
    let longest = sweeps.iter().map(Vec::len).max().unwrap_or(0);
    let correlation = |lag: usize| -> f64 {
        sweeps.iter().filter_map(|s| Some(dot(s, s.get(lag..)?))).sum::<f64>() / total
    };
    let mut sum = 0.0;
    let mut lag = 1;
    let mut batch = 2;
    let most = longest.min(MOST_LAGS);
    'lags: while lag + 1 < most {
        let ahead: Vec<f64> = (lag..lag + batch).into_par_iter().map(correlation).collect();
        for pair in ahead.chunks_exact(2) {
            let pair = pair[0] + pair[1];
            if pair <= 0.0 || lag + 1 >= most {
                break 'lags;
            }
            sum += pair;
            lag += 2;
        }
        // Long correlations need many lags: compute more of them at once.
        batch = (2 * batch).min(64);
    }
    (rows / (1.0 + 2.0 * sum)).clamp(1.0, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;

    #[test]
    fn repeated_values_count_once() {
        // Every value is repeated eight times, so an eighth of the rows is independent, up to the estimate's
        // scatter.
        let rows = 4000;
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let values: Vec<f64> = (0..rows / 8).flat_map(|_| vec![random(); 8]).collect();
        let moments: Vec<Moment> = (0..rows)
            .map(|i| Moment { direction: 1.0, begins: i == 0, ..Moment::at_rest(1e5, 1e-4 * i as f64) })
            .collect();
        let record =
            Record::from_moments(moments, vec![0.0; rows], std::iter::once(0..rows).collect()).unwrap();
        let found = effective_rows(&record, &values, &vec![true; rows]);
        // Integrated correlation time of a block of 8: (1 + 2 sum (8-k)/8) = 8.
        assert!((found / (rows as f64 / 8.0) - 1.0).abs() < 0.25, "{found}");
        let white: Vec<f64> = (0..rows).map(|_| random()).collect();
        assert!(effective_rows(&record, &white, &vec![true; rows]) > 0.85 * rows as f64);
    }
}
