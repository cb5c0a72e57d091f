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
