//! The hypothesis of an unknown effect: the misfit is smooth, but no effect of the catalogue has its shape.
//!
//! ```text
//! ln Z = ln mean over (A, J) of exp sum_j [-ln(1 + t_j)/2 + z_j^2 t_j/(1 + t_j)/2],    t_j = (A F exp(-j/J)/f_j)^2
//! ```
//! with z_j the coordinate of the misfit along the j-th smooth function, f_j the RMS of that function at one
//! standard deviation, F the largest force.

use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::linearised_model::LinearisedModel;
use crate::vector::rms;
use bulge_numerics::vector::dot;

/// Sizes A of a smooth misfit as fractions of the largest force.
const SIZES: [f64; 6] = [3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1];
/// Numbers of functions J over which it decays.
const FADES: [f64; 3] = [4.0, 12.0, 36.0];

/// Log evidence of an unknown smooth misfit of a model, relative to none.
pub(crate) fn smooth_evidence(linear: &LinearisedModel) -> f64 {
    let largest = linear.force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let found: Vec<(f64, f64)> =
        linear.smooth.iter().map(|d| (dot(&d.unit, &linear.z), rms(&d.values))).collect();
    evidence_of(&found, largest)
}

/// Log odds of such a misfit against none.
pub(crate) fn log_odds(linear: &LinearisedModel) -> f64 {
    RULE.something_else + smooth_evidence(linear)
}

/// Log evidence for functions with these coordinates and RMS values at one standard deviation, the smoothest
/// first.
fn evidence_of(found: &[(f64, f64)], largest: f64) -> f64 {
    let of = |size: f64, fade: f64| -> f64 {
        let term = |(j, (z, rms)): (usize, &(f64, f64))| {
            let t = (size * largest * (-(j as f64) / fade).exp() / rms.max(f64::MIN_POSITIVE)).powi(2);
            0.5 * (z * z * t / (1.0 + t) - t.ln_1p())
        };
        found.iter().enumerate().map(term).sum()
    };
    let all: Vec<f64> = SIZES.iter().flat_map(|size| FADES.map(|fade| of(*size, fade))).collect();
    let largest = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest + (all.iter().map(|value| (value - largest).exp()).sum::<f64>() / all.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_the_ratio_of_normal_densities() {
        // Each coordinate has the variance 1 + t with an unknown effect, and 1 without.
        let found = [(7.0, 0.4), (-3.0, 0.7), (0.5, 0.2)];
        let density = |z: f64, variance: f64| (-0.5 * z * z / variance).exp() / variance.sqrt();
        let mut sum = 0.0;
        for size in SIZES {
            for fade in FADES {
                let ratio = |(j, (z, rms)): (usize, &(f64, f64))| {
                    let t = (size * 300.0 * (-(j as f64) / fade).exp() / rms).powi(2);
                    density(*z, 1.0 + t) / density(*z, 1.0)
                };
                sum += found.iter().enumerate().map(ratio).product::<f64>();
            }
        }
        let expected = (sum / 18.0_f64).ln();
        assert!((evidence_of(&found, 300.0) - expected).abs() < 1e-9 * expected.abs());
    }
}
