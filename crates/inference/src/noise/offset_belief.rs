//! Posterior distribution of the size of the sweeps' offsets, because few sweeps don't determine a single
//! value.

use serde::Serialize;

use crate::noise::restricted_likelihood::RestrictedLikelihood;
use crate::noise::whitening::Components;

/// Standard deviations of the offsets on the grid, relative to that of the other noise.
const PARTS: [f64; 14] = [0.03, 0.05, 0.08, 0.12, 0.18, 0.26, 0.38, 0.55, 0.8, 1.2, 1.8, 2.7, 4.0, 8.0];
/// Range of relative sizes that are usual for rigs: equally probable a priori within it, less probable
/// outside.
const USUAL: (f64, f64) = (0.1, 1.3);
/// Prior probability that there are no offsets.
const NONE: f64 = 0.75;

/// One size of the offsets with its probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OffsetBelief {
    /// Standard deviation \[N\].
    pub sd_n: f64,
    /// Probability.
    pub weight: f64,
}

/// Posterior probabilities of the offsets' sizes: the restricted likelihood of each, with the other
/// components fixed, times its prior.
pub(crate) fn offset_beliefs(likelihood: &RestrictedLikelihood, others: &Components) -> Vec<OffsetBelief> {
    let other = others.white + others.correlated;
    let scale = other + likelihood.usual_input_variance();
    let usual = |part: f64| (part / USUAL.0).min(1.0) * (USUAL.1 / part).powi(4).min(1.0);
    let all: f64 = PARTS.iter().map(|part| usual(*part)).sum();
    let mut found: Vec<(f64, f64)> = Vec::with_capacity(PARTS.len() + 1);
    for part in std::iter::once(0.0).chain(PARTS) {
        let components = Components { offset: part * part * scale, ..*others };
        let Some(deviance) = likelihood.deviance(&components) else { continue };
        let prior = if part == 0.0 { NONE } else { (1.0 - NONE) * usual(part) / all };
        let sd = part * (scale * deviance.factor).sqrt();
        found.push((sd, prior.ln() - 0.5 * deviance.value));
    }
    let most = found.iter().map(|f| f.1).fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = found.iter().map(|f| (f.1 - most).exp()).sum();
    found.into_iter().map(|(sd_n, log)| OffsetBelief { sd_n, weight: (log - most).exp() / sum }).collect()
}

/// Root of the mean square.
pub(crate) fn rms(beliefs: &[OffsetBelief]) -> f64 {
    beliefs.iter().map(|b| b.weight * b.sd_n * b.sd_n).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::orthonormal::Basis;
    use crate::noise::whitening::Layout;
    use bulge_effects::Moment;
    use bulge_model::Record;

    /// Sweeps of ten rows with these offsets, and noise that alternates.
    fn likelihood(offsets: &[f64], known: f64) -> RestrictedLikelihood {
        let rows = 10 * offsets.len();
        let sweeps = (0..offsets.len()).map(|sweep| 10 * sweep..10 * sweep + 10).collect();
        let moments = (0..rows).map(|i| Moment::at_rest(2e5, 0.01 * i as f64)).collect();
        let values: Vec<f64> = (0..rows).map(|i| offsets[i / 10] + [1.1, -0.9, 0.4, -0.6][i % 4]).collect();
        let record = Record::from_moments(moments, values.clone(), sweeps).unwrap();
        let layout = Layout::new(&record, &vec![true; rows], &vec![known; rows], None).unwrap();
        RestrictedLikelihood::new(layout, &Basis { columns: Vec::new() }, &values).unwrap()
    }

    /// Likelihoods of blocks with a common offset, in closed form: det K = w^(m-1) (w + m o), and
    /// K^-1 = (1 - o 1 1' / (w + m o)) / w, with m = 10 rows in each.
    #[test]
    fn beliefs_are_priors_times_likelihoods() {
        let offsets = [0.9, -0.5, 0.2, -1.0, 0.7];
        for known in [0.0, 0.5] {
            let found = likelihood(&offsets, known);
            let others = Components { white: 1.3, correlated: 0.0, time: 1.0, offset: 0.0 };
            let beliefs = offset_beliefs(&found, &others);
            assert_eq!(beliefs.len(), 15);
            let (n, white) = (50.0, 1.3 + known);
            let values = |sweep: usize| {
                (10 * sweep..10 * sweep + 10).map(move |i| offsets[sweep] + [1.1, -0.9, 0.4, -0.6][i % 4])
            };
            let usual = |part: f64| (part / 0.1).min(1.0) * (1.3 / part).powi(4).min(1.0);
            let all: f64 = PARTS.iter().map(|part| usual(*part)).sum();
            let expected: Vec<(f64, f64)> = std::iter::once(0.0)
                .chain(PARTS)
                .map(|part| {
                    let offset = part * part * white;
                    let determinant = 5.0 * (9.0 * white.ln() + (white + 10.0 * offset).ln());
                    let square: f64 = (0..5)
                        .map(|sweep| {
                            let sum: f64 = values(sweep).sum();
                            let squares: f64 = values(sweep).map(|y| y * y).sum();
                            (squares - offset * sum * sum / (white + 10.0 * offset)) / white
                        })
                        .sum();
                    // Known variances fix the scale; else the best common factor counts.
                    let [factor, fit] =
                        if known > 0.0 { [1.0, square] } else { [square / n, n * (square / n).ln()] };
                    let prior = if part > 0.0 { 0.25 * usual(part) / all } else { 0.75 };
                    (part * (white * factor).sqrt(), prior * (-0.5 * (determinant + fit)).exp())
                })
                .collect();
            let sum: f64 = expected.iter().map(|e| e.1).sum();
            for (belief, (sd, weight)) in beliefs.iter().zip(&expected) {
                assert!((belief.sd_n - sd).abs() < 1e-12, "{belief:?} {sd}");
                assert!((belief.weight - weight / sum).abs() < 1e-10, "{belief:?} {}", weight / sum);
            }
        }
    }
}
