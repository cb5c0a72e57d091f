//! Newton's method: steps, how they are guarded, and when they have arrived.

use crate::error::MembraneError;
use crate::factor::Inertia;
use crate::load::{Inflation, Load};
use crate::solver::Solver;
use std::time::Instant;

/// A step of Newton's method.
struct Step {
    by: Vec<f64>,
    pressure: f64,
    /// Gradient times step.
    slope: f64,
}

/// How the way down is guarded.
#[derive(Debug, Clone, Copy, Default)]
struct Guard {
    /// Multiple of the unit matrix that is added to the stiffness.
    shift: f64,
    /// Whether the last step was made with the stiffness under a dead pressure, and whether this one begins with it.
    was_dead: bool,
    is_dead: bool,
}

/// What is known where the iteration stands.
struct Now {
    gradient: Vec<f64>,
    potential: f64,
    /// Residual over what is allowed.
    ratio: f64,
    /// Residual over the scale of the forces.
    residual: f64,
}

/// Trials of one direction.
const HALVINGS: usize = 5;
/// Trials of one iteration with more and more shift.
const SHIFTS: usize = 30;
/// The first shift of a stiffness that isn't positive, over its mean diagonal.
const LEAST_SHIFT: f64 = 1e-6;
/// How far a node goes in one solution, over the size of the structure: farther is a way without end.
const FARTHEST: f64 = 3.0;

/// What the pressure does as the volume changes.
#[derive(Debug, Clone, Copy)]
enum Closure {
    Pressure,
    Gas { slope: f64 },
    Volume { excess: f64 },
}

impl Solver {
    /// W - p V, or W and the gas, less the work of the fittings' forces.
    fn potential(&self, load: &Load, y: &[f64], energy: f64, volume: f64) -> f64 {
        let inside = match load.inflation {
            Inflation::Pressure(p) => -p * volume,
            Inflation::Gas(gas) => gas.energy(volume * self.copies.all()) / self.copies.all(),
            Inflation::Volume(_) => 0.0,
        };
        energy + inside - self.outside(load).iter().map(|(dof, force)| force * y[*dof]).sum::<f64>()
    }

    /// Gradient and residual at the last [`Self::work`].
    fn now(&self, load: &Load, y: &[f64], pressure: f64) -> Now {
        let free = self.structure.dofs.free;
        let mut gradient: Vec<f64> =
            (0..free).map(|i| self.totals.force[i] - pressure * self.totals.sweep[i]).collect();
        for (dof, force) in self.outside(load) {
            gradient[dof] -= force;
        }
        // Forces are differences of lengths times stiffness: what rounding leaves of them.
        let rounding = 32.0 * f64::EPSILON * self.size;
        let (mut ratio, mut residual) = (0.0_f64, 0.0_f64);
        for (i, g) in gradient.iter().enumerate() {
            let diagonal = self.matrix[self.assembly.diagonal[i]].abs();
            let allowed = self.tolerance.residual * self.totals.scale + rounding * diagonal;
            // Also true of NaN.
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

    /// The step from the factors that are there, and the number of negative eigenvalues of what it solves.
    ///
    /// Gas of a closed amount adds c v v' to the stiffness, with v = dV/dy and c = -dp/dV (Sherman and Morrison); a prescribed volume is
    /// the limit of an infinite c, in which dp becomes an unknown.
    fn step(&mut self, gradient: &[f64], closure: Closure, negative: usize) -> (Step, usize) {
        let mut by: Vec<f64> = gradient.iter().map(|g| -g).collect();
        self.backsolve(&mut by);
        let (mut pressure, mut negative) = (0.0, negative);
        if !matches!(closure, Closure::Pressure) {
            let free = by.len();
            let v = self.totals.sweep[..free].to_vec();
            let mut w = v.clone();
            self.backsolve(&mut w);
            let (vs, vw) = (inner(&v, &by), inner(&v, &w));
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
            // One negative eigenvalue is mended by the gas.
            if bordered < 0.0 {
                negative = negative.saturating_sub(1);
            }
            for (by, w) in by.iter_mut().zip(&w) {
                *by += pressure * w;
            }
        }
        let slope = inner(gradient, &by);
        (Step { by, pressure, slope }, negative)
    }

    /// The least potential.
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
            // Running away: beyond a limit point there is nothing to find.
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
            // Far from equilibrium most attempts with the whole stiffness are in vain: only every third is made after one that was.
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
                // Nothing lowers the energy of what is in equilibrium: a mesh at rest without load, for one.
                if now.ratio <= 1.0 {
                    return Ok((now.residual, 0));
                }
                break;
            }
        }
        Err(MembraneError::NotConverged {
            iterations: self.effort.iterations - begun,
            residual: last,
            asked: self.tolerance.residual,
        })
    }

    /// One accepted step; false if none is found.
    fn improve(
        &mut self,
        load: &Load,
        now: &Now,
        closure: Closure,
        guard: &mut Guard,
        y: &mut [f64],
    ) -> bool {
        let unit = self.mean_diagonal();
        // What rounding leaves of the potential.
        let floor = 1e-13 * (self.totals.energy.abs() + now.potential.abs());
        let mut trial = y.to_vec();
        let mut is_dead = guard.is_dead;
        for _ in 0..SHIFTS {
            let applied = if is_dead { guard.shift } else { 0.0 };
            let (step, negative) = match self.factorise(applied) {
                Inertia::Negative(negative) => self.step(&now.gradient, closure, negative),
                Inertia::Singular => (Step { by: Vec::new(), pressure: 0.0, slope: f64::NAN }, 1),
            };
            let longest = step.by.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if negative > 0 || !longest.is_finite() || step.slope > 0.0 || step.slope.is_nan() {
                if is_dead {
                    guard.shift = (4.0 * guard.shift).max(LEAST_SHIFT * unit);
                } else {
                    // As if the pressure kept its direction: what it adds to the stiffness is all that a slack cloth can't bear.
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
                    // A quadratic potential falls by slope/2.
                    let expected = length * (1.0 - 0.5 * length) * step.slope;
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

    /// Where the potential is lost in its rounding (small strains), a smaller residual is what counts. Leaves the assembly at y if it isn't.
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
                // Near round-off the residual can't fall any more.
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
        Err(MembraneError::NotConverged {
            iterations: self.effort.iterations - begun,
            residual: last,
            asked: self.tolerance.residual,
        })
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
