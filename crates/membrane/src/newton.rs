//! Newton's method: steps, their globalisation, and convergence.

use crate::error::MembraneError;
use crate::factor::Inertia;
use crate::load::{Inflation, Load};
use crate::solver::Solver;
use bulge_numerics::vector::dot;
use std::time::Instant;

/// A step of Newton's method.
struct Step {
    by: Vec<f64>,
    pressure: f64,
    /// Inner product of gradient and step.
    slope: f64,
}

/// Regularisation of the descent.
#[derive(Debug, Clone, Copy, Default)]
struct Guard {
    /// Multiple of the unit matrix that is added to the stiffness.
    shift: f64,
    /// Whether the last step used the stiffness without the pressure's contribution (a dead pressure); the
    /// next flag is for the current step.
    was_dead: bool,
    is_dead: bool,
}

/// The current iterate.
struct Now {
    gradient: Vec<f64>,
    potential: f64,
    /// Residual relative to the allowed one.
    ratio: f64,
    /// Residual relative to the scale of the forces.
    residual: f64,
}

/// Most trial lengths along one direction.
const HALVINGS: usize = 5;
/// Most trials of one iteration with increasing shift.
const SHIFTS: usize = 30;
/// First shift of a stiffness that isn't positive definite, relative to its mean diagonal.
const LEAST_SHIFT: f64 = 1e-6;
/// Largest shift with which an iteration begins, relative to the mean diagonal and to the residual.
const MOST_SHIFT: f64 = 1e-3;
/// Largest displacement of a node in one solution, relative to the size of the structure; beyond, the
/// iteration diverges.
const FARTHEST: f64 = 3.0;

/// Response of the pressure to a change of the volume.
#[derive(Debug, Clone, Copy)]
enum Closure {
    Pressure,
    Gas { slope: f64 },
    Volume { excess: f64 },
}

impl Solver {
    /// W - p V, or W plus the energy of the gas, less the work of the forces on the fittings.
    fn potential(&self, load: &Load, y: &[f64], energy: f64, volume: f64) -> f64 {
        let inside = match load.inflation {
            Inflation::Pressure(p) => -p * volume,
            Inflation::Gas(gas) => gas.energy(volume * self.copies.all()) / self.copies.all(),
            Inflation::Volume(_) => 0.0,
        };
        energy + inside - self.outside(load).iter().map(|(dof, force)| force * y[*dof]).sum::<f64>()
    }

    /// Gradient and residual after the last [`Self::work`].
    fn now(&self, load: &Load, y: &[f64], pressure: f64) -> Now {
        let free = self.structure.dofs.free;
        let mut gradient: Vec<f64> =
            (0..free).map(|i| self.totals.force[i] - pressure * self.totals.sweep[i]).collect();
        for (dof, force) in self.outside(load) {
            gradient[dof] -= force;
        }
        // Forces are differences of lengths times stiffness, which bounds their rounding errors.
        let rounding = 32.0 * f64::EPSILON * self.size;
        let (mut ratio, mut residual) = (0.0_f64, 0.0_f64);
        for (i, g) in gradient.iter().enumerate() {
            let diagonal = self.matrix[self.assembly.diagonal[i]].abs();
            let allowed = self.tolerance.residual * self.totals.scale + rounding * diagonal;
            // The comparison also catches NaN.
            let own = g.abs() / allowed.max(f64::MIN_POSITIVE);
            ratio = if own.is_nan() { f64::INFINITY } else { ratio.max(own) };
            residual = residual.max(g.abs());
        }
        let residual = residual / self.totals.scale.max(f64::MIN_POSITIVE);
        let potential = self.potential(load, y, self.totals.energy, self.totals.volume);
        Now { gradient, potential, ratio, residual }
    }

    pub(crate) fn mean_diagonal(&self) -> f64 {
        let sum: f64 = self.assembly.diagonal.iter().map(|at| self.matrix[*at].abs()).sum();
        sum / self.assembly.diagonal.len() as f64
    }

    fn factorise(&mut self, shift: f64) -> Inertia {
        let clock = Instant::now();
        self.effort.factorisations += 1;
        let inertia = if shift == 0.0 {
            self.factor.factorise(&self.matrix)
        } else {
            self.shifted.copy_from_slice(&self.matrix);
            for at in &self.assembly.diagonal {
                self.shifted[*at] += shift;
            }
            self.factor.factorise(&self.shifted)
        };
        self.effort.factorising += clock.elapsed();
        inertia
    }

    fn backsolve(&mut self, right: &mut [f64]) {
        let clock = Instant::now();
        self.factor.solve(right);
        self.effort.solving += clock.elapsed();
    }

    /// The step from the current factors, and the number of negative eigenvalues of the matrix behind it.
    ///
    /// A closed amount of gas adds c v v' to the stiffness, with v = dV/dy and c = -dp/dV (Sherman and
    /// Morrison). A prescribed volume is the limit of infinite c, in which dp becomes an unknown.
    fn step(&mut self, gradient: &[f64], closure: Closure, negative: usize) -> (Step, usize) {
        let mut by: Vec<f64> = gradient.iter().map(|g| -g).collect();
        self.backsolve(&mut by);
        let (mut pressure, mut negative) = (0.0, negative);
        if !matches!(closure, Closure::Pressure) {
            let free = by.len();
            let v = self.totals.sweep[..free].to_vec();
            let mut w = v.clone();
            self.backsolve(&mut w);
            let (vs, vw) = (dot(&v, &by), dot(&v, &w));
            let bordered = match closure {
                Closure::Volume { excess } => {
                    pressure = (-excess - vs) / vw;
                    vw
                }
                Closure::Gas { slope } => {
                    pressure = -slope * vs / (1.0 + slope * vw);
                    1.0 + slope * vw
                }
                Closure::Pressure => 1.0,
            };
            // The gas removes one negative eigenvalue.
            if bordered < 0.0 {
                negative = negative.saturating_sub(1);
            }
            for (by, w) in by.iter_mut().zip(&w) {
                *by += pressure * w;
            }
        }
        let slope = dot(gradient, &by);
        (Step { by, pressure, slope }, negative)
    }

    /// Minimises the potential.
    pub(crate) fn downhill(
        &mut self,
        load: &Load,
        y: &mut [f64],
        pressure: &mut f64,
    ) -> Result<(f64, usize), MembraneError> {
        let mut guard = Guard::default();
        let begun = self.effort.iterations;
        let mut last = f64::INFINITY;
        let first = y.to_vec();
        for iteration in 0..self.tolerance.iterations {
            // The iteration diverges: beyond a limit point there is no equilibrium.
            let farthest = y.iter().zip(&first).fold(0.0_f64, |a, (y, first)| a.max((y - first).abs()));
            if farthest > FARTHEST * self.size || self.effort.factorisations >= self.deadline {
                break;
            }
            let (p, closure) = match load.inflation {
                Inflation::Gas(gas) => {
                    let [_, volume] = self.measure(y);
                    let (p, slope) = gas.pressure(volume * self.copies.all());
                    (p, Closure::Gas { slope: -slope * self.copies.all() })
                }
                Inflation::Pressure(p) => (p, Closure::Pressure),
                Inflation::Volume(_) => (*pressure, Closure::Pressure),
            };
            *pressure = p;
            // Far from equilibrium, most attempts with the full stiffness fail. After a failure it is only
            // tried in every third iteration.
            guard.is_dead = guard.was_dead && last > 0.03 && !(self.effort.iterations + 1).is_multiple_of(3);
            self.work(y, if guard.is_dead { 0.0 } else { p });
            let now = self.now(load, y, p);
            last = now.residual;
            if now.ratio <= 1.0 {
                if guard.is_dead {
                    self.work(y, p);
                }
                let inertia = self.factorise(0.0);
                if let Inertia::Negative(negative) = inertia {
                    let (_, negative) = self.step(&now.gradient, closure, negative);
                    if negative == 0 || iteration > 0 {
                        return Ok((now.residual, negative));
                    }
                } else if iteration > 0 {
                    return Ok((now.residual, 0));
                }
            }
            self.effort.iterations += 1;
            if !self.improve(load, &now, closure, &mut guard, y) {
                // An equilibrium is a minimum already, for example a mesh at rest without load.
                if now.ratio <= 1.0 {
                    return Ok((now.residual, 0));
                }
                break;
            }
        }
        Err(self.not_converged(begun, last))
    }

    /// No equilibrium since a number of iterations; `residual` is the last one.
    fn not_converged(&self, begun: usize, residual: f64) -> MembraneError {
        let iterations = self.effort.iterations - begun;
        MembraneError::NotConverged { iterations, residual, asked: self.tolerance.residual }
    }

    /// Takes one accepted step; false if none is found.
    fn improve(
        &mut self,
        load: &Load,
        now: &Now,
        closure: Closure,
        guard: &mut Guard,
        y: &mut [f64],
    ) -> bool {
        let unit = self.mean_diagonal();
        // Rounding error of the potential.
        let floor = 1e-13 * (self.totals.energy.abs() + now.potential.abs());
        let mut trial = y.to_vec();
        let mut is_dead = guard.is_dead;
        // It vanishes with the residual, so that the last steps are Newton's (Fan and Yuan 2005).
        guard.shift = guard.shift.min(MOST_SHIFT * now.residual * unit);
        for _ in 0..SHIFTS {
            let (step, negative) = match self.factorise(guard.shift) {
                Inertia::Negative(negative) => self.step(&now.gradient, closure, negative),
                Inertia::Singular => (Step { by: Vec::new(), pressure: 0.0, slope: f64::NAN }, 1),
            };
            let longest = step.by.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if negative > 0 || !longest.is_finite() || step.slope > 0.0 || step.slope.is_nan() {
                if is_dead {
                    guard.shift = (4.0 * guard.shift).max(LEAST_SHIFT * unit);
                } else {
                    // Drop the pressure's contribution, as if the pressure kept its direction: it is what
                    // makes the stiffness of a slack cloth indefinite.
                    is_dead = true;
                    self.work(y, 0.0);
                }
                continue;
            }
            let mut length = (0.2 * self.size / longest).min(1.0);
            for halving in 0..HALVINGS {
                for (trial, (y, by)) in trial.iter_mut().zip(y.iter().zip(&step.by)) {
                    *trial = y + length * by;
                }
                let [energy, volume] = self.measure(&trial);
                let fell = self.potential(load, &trial, energy, volume) - now.potential;
                let is_lower = fell <= 1e-4 * length * step.slope + floor;
                let is_first = halving == 0;
                if is_lower || (is_first && self.is_calmer(load, now, (y, &trial), step.slope, is_dead)) {
                    // What a quadratic potential does whose stiffness is that without the shift.
                    let bent = -step.slope - guard.shift * dot(&step.by, &step.by);
                    let expected = length * step.slope + 0.5 * length * length * bent;
                    let is_as_expected = (fell - expected).abs() < 0.3 * expected.abs() + floor;
                    if is_as_expected {
                        guard.shift *= if length < 1.0 { 0.5 } else { 0.1 };
                    }
                    if guard.shift < 1e-3 * LEAST_SHIFT * unit {
                        guard.shift = 0.0;
                    }
                    guard.was_dead = is_dead;
                    y.copy_from_slice(&trial);
                    return true;
                }
                length *= 0.4;
            }
            if is_dead {
                guard.shift = (4.0 * guard.shift).max(LEAST_SHIFT * unit);
            } else {
                is_dead = true;
                self.work(y, 0.0);
            }
        }
        false
    }

    /// Accepts a smaller residual instead if the change of the potential is below rounding (small strains).
    /// If not, leaves the assembly at y.
    fn is_calmer(
        &mut self,
        load: &Load,
        now: &Now,
        (y, trial): (&[f64], &[f64]),
        slope: f64,
        is_dead: bool,
    ) -> bool {
        let size = self.totals.energy.abs() + now.potential.abs();
        if slope.abs() > 1e-9 * size || matches!(load.inflation, Inflation::Volume(_)) {
            return false;
        }
        let pressure = |solver: &Self| match load.inflation {
            Inflation::Gas(gas) => gas.pressure(solver.totals.volume * solver.copies.all()).0,
            Inflation::Pressure(p) => p,
            Inflation::Volume(_) => 0.0,
        };
        self.work(trial, 0.0);
        let p = pressure(self);
        let next = self.now(load, trial, p);
        if next.residual < 0.9 * now.residual {
            return true;
        }
        self.work(y, 0.0);
        let p = pressure(self);
        if !is_dead {
            self.work(y, p);
        }
        false
    }

    /// Equilibrium at a prescribed volume.
    pub(crate) fn with_volume(
        &mut self,
        load: &Load,
        volume: f64,
        y: &mut [f64],
        pressure: &mut f64,
    ) -> Result<(f64, usize), MembraneError> {
        let begun = self.effort.iterations;
        let mut last = f64::INFINITY;
        let mut trial = y.to_vec();
        self.work(y, *pressure);
        let mut now = self.now(load, y, *pressure);
        for iteration in 0..self.tolerance.iterations {
            let excess = self.totals.volume - volume;
            last = now.residual.hypot(excess / volume);
            let Inertia::Negative(negative) = self.factorise(0.0) else {
                break;
            };
            let (step, negative) = self.step(&now.gradient, Closure::Volume { excess }, negative);
            if now.ratio <= 1.0 && excess.abs() <= 1e-12 * volume.abs() && iteration > 0 {
                return Ok((now.residual, negative));
            }
            self.effort.iterations += 1;
            let merit = |now: &Now, excess: f64| now.residual.hypot(excess / volume);
            let before = merit(&now, excess);
            let longest = step.by.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if !longest.is_finite() {
                break;
            }
            let mut length = (0.2 * self.size / longest).min(1.0);
            let mut is_better = false;
            for _ in 0..2 * HALVINGS {
                for (trial, (y, by)) in trial.iter_mut().zip(y.iter().zip(&step.by)) {
                    *trial = y + length * by;
                }
                let p = *pressure + length * step.pressure;
                self.work(&trial, p);
                let next = self.now(load, &trial, p);
                // Near round-off the residual can't decrease any more.
                let after = merit(&next, self.totals.volume - volume);
                if after < before * (1.0 - 0.1 * length)
                    || (after.is_finite() && after < 1e-11)
                    || next.ratio <= 1.0
                {
                    y.copy_from_slice(&trial);
                    *pressure = p;
                    now = next;
                    is_better = true;
                    break;
                }
                length *= 0.5;
            }
            if !is_better {
                break;
            }
        }
        Err(self.not_converged(begun, last))
    }
}
