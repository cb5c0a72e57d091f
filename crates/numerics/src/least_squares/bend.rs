//! Bends a step along a curved valley after the straight step has failed.
//!
//! Uses the geodesic acceleration of M. K. Transtrum, J. P. Sethna (arXiv:1201.5885), with the second
//! derivative from the residuals of the failed step. It costs one evaluation of the Jacobian, and only after
//! a failed step.

use super::linear::{decrease, turned};
use super::residuals::Residuals;
use super::search::{LEAST_DAMPING, Search, Trial};
use super::step::damped;
use crate::vector::norm;

/// Longest bend relative to the step (the paper's value). If it is longer, the second derivative doesn't
/// describe the residuals.
const LONGEST: f64 = 0.75;
/// Fraction of the predicted decrease that a bent step must achieve.
const ENOUGH: f64 = 0.1;
/// Growth of the trust region after a bent step that achieves at least three quarters of the predicted
/// decrease.
const GROWTH: f64 = 1.5;

impl<P: Residuals> Search<'_, P> {
    /// Bends a failed trial with these residuals, and moves there if that is good.
    ///
    /// With `c = r(theta + p) - r - J p`, half the second derivative along `p`, the bend `a` minimises the damped `|J a + c|^2`
    /// within the bounds.
    pub(super) fn bend(&mut self, trial: &Trial, residuals: &[f64]) -> bool {
        let (scale, damping) =
            if trial.full { (&self.linear.norms, LEAST_DAMPING) } else { (&self.scale, self.damping) };
        self.linearisations += 1;
        let Ok(turned) = turned(self.problem, &self.theta, residuals) else { return false };
        let step: Vec<f64> = trial.theta.iter().zip(&self.theta).map(|(to, from)| to - from).collect();
        let linear = self.linear.r.times(&step);
        let c: Vec<f64> = (0..step.len()).map(|i| turned[i] - self.linear.q[i] - linear[i]).collect();
        let (a, c) = self.scaled_by(scale, &c);
        let bend = damped(&a, &c, damping, &self.limits(scale, &trial.theta));
        // Both lengths are in the scale of the trust region.
        let stretch = |j: usize| if scale[j] > 0.0 { bend.z[j] * (self.scale[j] / scale[j]) } else { 0.0 };
        if norm(&(0..step.len()).map(stretch).collect::<Vec<_>>()) > LONGEST * trial.length {
            return false;
        }
        let Some(bent) = self.at(self.point(&trial.theta, &bend, scale)) else { return false };
        let ratio = decrease(&self.residuals, &bent.residuals) / trial.predicted;
        if ratio < ENOUGH || !self.stay(bent) {
            return false;
        }
        self.radius = if ratio >= 0.75 { GROWTH * trial.length } else { trial.length };
        true
    }
}
