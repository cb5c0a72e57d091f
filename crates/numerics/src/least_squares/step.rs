//! The step of one iteration: linear least squares in a box, damped so that the step stays in the trust region.
//!
//! In scaled steps `z`, `min |A z + b|^2 + lambda |z|^2` with `lower <= z <= upper` is solved exactly by an active set (P. B. Stark,
//! R. L. Parker, *Comput. Stat.* 10 (1995) 129); `lambda` comes from the secular equation `|z(lambda)| = radius` by the iteration of
//! J. J. Moré (*Lecture Notes in Mathematics* 630, Springer 1978, p. 105), which holds on the free variables.

use super::residuals::Side;
use super::triangle::Triangle;
use crate::vector::{dot, norm};

/// Allowed relative difference between the length of a damped step and the radius (Moré's value).
const RADIUS_SLACK: f64 = 0.1;
/// A multiplier below this fraction of `|A_j| |b|` counts as zero.
const MULTIPLIER: f64 = 16.0 * f64::EPSILON;

/// The box of scaled steps; it contains 0.
#[derive(Debug, Clone)]
pub(super) struct StepBox {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

/// A scaled step.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) z: Vec<f64>,
    /// The bound at which a variable is held.
    pub(super) held: Vec<Option<Side>>,
    /// Decrease of `|A z + b|^2` from `z = 0`; never negative.
    pub(super) predicted: f64,
    /// `|S^-T z|^2` on the free variables, `S` the triangle of `[A; sqrt(lambda)]`: `-|z| d|z|/d lambda`.
    slope: f64,
}

/// State of the active-set iteration: the variables, and the bounds that hold them.
struct ActiveSet<'a> {
    a: &'a Triangle,
    b: &'a [f64],
    damping: f64,
    limits: &'a StepBox,
    z: Vec<f64>,
    held: Vec<Option<Side>>,
    /// Variables that a bound holds again after their release, because of rounding.
    refused: Vec<bool>,
    slope: f64,
}

/// The step for a given damping `lambda > 0`.
pub(super) fn damped(a: &Triangle, b: &[f64], damping: f64, limits: &StepBox) -> Step {
    let n = a.size();
    let mut set = ActiveSet {
        a,
        b,
        damping,
        limits,
        z: vec![0.0; n],
        held: vec![None; n],
        refused: vec![false; n],
        slope: 0.0,
    };
    for (j, g) in a.transposed_times(b).into_iter().enumerate() {
        let (lower, upper) = (limits.lower[j], limits.upper[j]);
        if lower >= 0.0 && (g > 0.0 || upper <= 0.0) {
            set.held[j] = Some(Side::Lower);
        } else if upper <= 0.0 && g < 0.0 {
            set.held[j] = Some(Side::Upper);
        }
    }
    set.solve()
}

impl ActiveSet<'_> {
    fn solve(mut self) -> Step {
        let tolerance: Vec<f64> =
            self.a.column_norms().iter().map(|c| MULTIPLIER * c * norm(self.b)).collect();
        let mut released = None;
        // Each round either ends or lowers the objective, up to rounding errors, which the limit guards
        // against.
        for _ in 0..4 * self.z.len() + 8 {
            self.minimise_free(released);
            let w = self.multipliers();
            let inward = |j: usize| match self.held[j] {
                Some(Side::Lower) => -w[j],
                Some(Side::Upper) => w[j],
                None => 0.0,
            };
            let candidate = (0..self.z.len())
                .filter(|j| self.limits.lower[*j] < self.limits.upper[*j] && !self.refused[*j])
                .filter(|j| inward(*j) > tolerance[*j])
                .max_by(|i, j| inward(*i).total_cmp(&inward(*j)));
            let Some(j) = candidate else { break };
            released = self.held[j].take().map(|side| (j, side));
        }
        // -2 b.Az - |Az|^2 with b eliminated by the multipliers: a sum of nonnegative terms.
        let w = self.multipliers();
        let az = self.a.times(&self.z);
        let predicted = dot(&az, &az) + 2.0 * (self.damping * dot(&self.z, &self.z) - dot(&self.z, &w));
        Step { z: self.z, held: self.held, predicted: predicted.max(0.0), slope: self.slope }
    }

    /// Half the gradient of the objective, exactly 0 for free variables.
    fn multipliers(&self) -> Vec<f64> {
        let mut rest = self.a.times(&self.z);
        rest.iter_mut().zip(self.b).for_each(|(r, b)| *r += b);
        let mut w = self.a.transposed_times(&rest);
        for (j, w) in w.iter_mut().enumerate() {
            *w = if self.held[j].is_some() { *w + self.damping * self.z[j] } else { 0.0 };
        }
        w
    }

    /// Moves to the minimum over the free variables, and holds those that reach a bound on the way.
    fn minimise_free(&mut self, released: Option<(usize, Side)>) {
        loop {
            let free: Vec<usize> = (0..self.z.len()).filter(|j| self.held[*j].is_none()).collect();
            let target = self.free_minimum(&free);
            // A released variable whose minimum lies outside again would cycle: it is held for good.
            if let Some((j, side)) = released
                && let Some(place) = free.iter().position(|f| *f == j)
            {
                let outward = match side {
                    Side::Lower => target[place] < self.limits.lower[j],
                    Side::Upper => target[place] > self.limits.upper[j],
                };
                if outward && self.is_at(j, side) {
                    self.held[j] = Some(side);
                    self.refused[j] = true;
                    continue;
                }
            }
            // Fraction of the way to its target at which a variable reaches its bound; infinite if it doesn't.
            let part = |j: usize, target: f64| {
                let [lower, upper] = [self.limits.lower[j], self.limits.upper[j]];
                if (lower..=upper).contains(&target) {
                    return f64::INFINITY;
                }
                ((target.clamp(lower, upper) - self.z[j]) / (target - self.z[j])).clamp(0.0, 1.0)
            };
            let parts: Vec<f64> = free.iter().zip(&target).map(|(j, t)| part(*j, *t)).collect();
            let least = parts.iter().copied().fold(f64::INFINITY, f64::min);
            if least.is_infinite() {
                for (j, t) in free.iter().zip(&target) {
                    self.z[*j] = *t;
                }
                return;
            }
            // All variables stop at the first bound on the way; those that reach it are held there.
            for (i, j) in free.iter().enumerate() {
                if parts[i] <= least {
                    let side = if target[i] < self.z[*j] { Side::Lower } else { Side::Upper };
                    self.z[*j] = match side {
                        Side::Lower => self.limits.lower[*j],
                        Side::Upper => self.limits.upper[*j],
                    };
                    self.held[*j] = Some(side);
                } else {
                    let z = self.z[*j] + least * (target[i] - self.z[*j]);
                    self.z[*j] = z.clamp(self.limits.lower[*j], self.limits.upper[*j]);
                }
            }
        }
    }

    fn is_at(&self, j: usize, side: Side) -> bool {
        match side {
            Side::Lower => self.z[j] <= self.limits.lower[j],
            Side::Upper => self.z[j] >= self.limits.upper[j],
        }
    }

    /// The minimum over the free variables without regard to their bounds, from the triangle of `[A_F, A_B
    /// z_B + b; sqrt(lambda), 0]`.
    fn free_minimum(&mut self, free: &[usize]) -> Vec<f64> {
        let (n, f) = (self.z.len(), free.len());
        let mut fixed = self.z.clone();
        for j in free {
            fixed[*j] = 0.0;
        }
        let rows = n + f;
        let mut columns = vec![0.0; rows * (f + 1)];
        for (c, j) in free.iter().enumerate() {
            columns[c * rows..=c * rows + j].copy_from_slice(self.a.column(*j));
            columns[c * rows + n + c] = self.damping.sqrt();
        }
        for (x, (az, b)) in columns[f * rows..].iter_mut().zip(self.a.times(&fixed).iter().zip(self.b)) {
            *x = -(az + b);
        }
        let s = Triangle::of_columns(&mut columns, rows, f + 1);
        let mut target = s.column(f)[..f].to_vec();
        s.solve(&mut target);
        let mut slope = target.clone();
        s.solve_transposed(&mut slope);
        self.slope = dot(&slope, &slope);
        target
    }
}

/// The step of length `radius` (within a tenth) and its damping; call only if the undamped step is longer. `guess` is the damping
/// of the last step.
pub(super) fn of_length(a: &Triangle, b: &[f64], radius: f64, guess: f64, limits: &StepBox) -> (Step, f64) {
    let gradient = a.transposed_times(b);
    let mut low = 0.0;
    // |z(lambda)| <= |A^T b|/lambda, because 0 is in the box.
    let mut high = norm(&gradient) / radius;
    let inside = |lambda: f64, low: f64, high: f64| {
        if lambda > low && lambda < high { lambda } else { (low * high).sqrt().max(1e-3 * high) }
    };
    let mut lambda = inside(guess, low, high);
    let mut step = damped(a, b, lambda, limits);
    for _ in 0..30 {
        let length = norm(&step.z);
        let excess = length - radius;
        if excess.abs() <= RADIUS_SLACK * radius {
            break;
        }
        if excess > 0.0 {
            low = lambda;
        } else {
            high = lambda;
        }
        let newton = lambda + excess / radius * (length * length / step.slope);
        lambda = inside(newton, low, high);
        step = damped(a, b, lambda, limits);
    }
    (step, lambda)
}
