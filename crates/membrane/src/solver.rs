//! Equilibria: Newton's method on one energy, from any start.
//!
//! ```text
//! find y with   d/dy [ W(y) - p V(y) - f.y ] = 0
//! ```
//!
//! At a prescribed pressure, or with a closed amount of gas, the energy is made smaller until it is least: where the stiffness isn't positive
//! (slack cloth, a flat start) it is raised by a multiple of the unit matrix (Levenberg), which vanishes again as the state improves. With
//! a prescribed volume the pressure is one more unknown, and what counts is the residual.
//!
//! Threads without stretch: an augmented Lagrangian. Each is as stiff as the structure's own scale asks for, and after each equilibrium its
//! tension is taken over, until its length is right.

use crate::assembly::{Assembly, Totals};
use crate::element::Vector;
use crate::error::MembraneError;
use crate::factor::{Factor, Inertia};
use crate::load::{Inflation, Load};
use crate::set::{Elements, Place};
use crate::structure::{Fitting, Structure};
use faer::Par;
use serde::Serialize;
use std::time::{Duration, Instant};

/// When an equilibrium is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Residual of each node over the mean of the forces that meet at one.
    pub residual: f64,
    /// Stretch of an inextensible thread.
    pub stretch: f64,
    /// Most iterations for one equilibrium.
    pub iterations: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { residual: 1e-10, stretch: 1e-11, iterations: 120 }
    }
}

/// An equilibrium. Whole structure: energies, forces and volumes count every copy of a sector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// The degrees of freedom.
    pub(crate) y: Vec<f64>,
    /// Gauge pressure, Pa.
    pub pressure: f64,
    /// Enclosed volume, m^3: between the membrane and the planes that close it.
    pub volume: f64,
    /// Stored energy, J.
    pub energy: f64,
    /// Place of each fitting along z from that in the mesh, m.
    pub fittings: Vec<f64>,
    /// Force on each fitting along z that holds it there, N: what the muscle pulls with.
    pub forces: Vec<f64>,
    /// Residual over the mean of the forces that meet at a node.
    pub residual: f64,
    /// Directions in which the energy falls: 0 in a stable equilibrium.
    pub unstable: usize,
    /// Iterations it took.
    pub iterations: usize,
}

/// How often the structure stands in the whole muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Copies {
    /// Round the z axis, side by side: their forces on a fitting add up.
    pub around: f64,
    /// Along it, one behind the other: 2 for half a muscle on its middle plane. Their lengths add up, and the force goes through all.
    pub along: f64,
}

impl Copies {
    /// The whole.
    pub const ONE: Self = Self { around: 1.0, along: 1.0 };

    fn all(self) -> f64 {
        self.around * self.along
    }
}

/// What has been spent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Effort {
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// In elements and their sums.
    pub assembling: Duration,
    /// In factors.
    pub factorising: Duration,
    /// In solving with them.
    pub solving: Duration,
}

/// Finds equilibria of a structure.
pub struct Solver {
    pub(crate) structure: Structure,
    pub(crate) copies: Copies,
    tolerance: Tolerance,
    assembly: Assembly,
    factor: Factor,
    matrix: Vec<f64>,
    shifted: Vec<f64>,
    totals: Totals,
    x: Vec<Vector>,
    pub(crate) penalty: f64,
    size: f64,
    effort: Effort,
}

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
    /// Whether the last step was made with the stiffness under a dead pressure.
    was_dead: bool,
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
/// Outer iterations of the augmented Lagrangian.
const HOLDS: usize = 40;
/// The stiffness of an inextensible thread over the forces that the pressure can make.
const STIFF: f64 = 3e2;

impl Solver {
    /// For a structure that stands for `copies` of itself: half a lobe of n over half the length for 2 n around and 2 along.
    ///
    /// # Errors
    /// [`MembraneError::Memory`].
    pub fn new(structure: Structure, copies: Copies, tolerance: Tolerance) -> Result<Self, MembraneError> {
        let sets = sets(&structure);
        let assembly = Assembly::new(&sets, &structure.dofs);
        // One thread for the factors: a second one brings little on a surface, and would change the last digits.
        let factor = Factor::new(assembly.columns.clone(), assembly.rows.clone(), Par::Seq)?;
        let matrix = vec![0.0; assembly.rows.len()];
        let size = structure.size();
        Ok(Self {
            shifted: matrix.clone(),
            matrix,
            factor,
            assembly,
            structure,
            copies,
            tolerance,
            totals: Totals::default(),
            x: Vec::new(),
            penalty: 1.0,
            size,
            effort: Effort::default(),
        })
    }

    /// What has been spent so far.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// The structure.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Numbers in the stiffness and in its factors.
    #[must_use]
    pub fn sizes(&self) -> (usize, usize) {
        (self.matrix.len(), self.factor.size())
    }

    /// The mesh as it is, without load: where to start from. No equilibrium by itself.
    #[must_use]
    pub fn at_rest(&mut self) -> State {
        let y = self.structure.start.clone();
        let [energy, volume] = self.measure(&y);
        State {
            pressure: 0.0,
            volume: volume * self.copies.all(),
            energy: energy * self.copies.all(),
            fittings: vec![0.0; self.structure.fittings.len()],
            forces: vec![0.0; self.structure.fittings.len()],
            residual: 0.0,
            unstable: 0,
            iterations: 0,
            y,
        }
    }

    /// The equilibrium under `load` that is reached from `start`.
    ///
    /// # Errors
    /// [`MembraneError::NotConverged`]; the state that failed is not kept.
    pub fn solve(&mut self, load: &Load, start: &State) -> Result<State, MembraneError> {
        let mut y = start.y.clone();
        for (i, kind) in self.structure.fittings.iter().enumerate() {
            if *kind == Fitting::Placed {
                y[self.structure.dofs.fittings[i] as usize] = load.fittings[i];
            }
        }
        let mut pressure = start.pressure;
        self.choose_penalty(load, start);
        let first = self.effort.iterations;
        let mut worst = f64::INFINITY;
        for _ in 0..HOLDS {
            let (residual, unstable) = match load.inflation {
                Inflation::Volume(volume) => {
                    self.with_volume(load, volume / self.copies.all(), &mut y, &mut pressure)?
                }
                Inflation::Pressure(_) | Inflation::Gas(_) => self.downhill(load, &mut y, &mut pressure)?,
            };
            let iterations = self.effort.iterations - first;
            let state = self.state(&y, pressure, residual, unstable, iterations);
            let before = worst;
            worst = self.hold(&y);
            // At the round-off of the lengths it gets no better.
            if worst <= self.tolerance.stretch || (worst < 1e-9 && worst > 0.3 * before) {
                return Ok(state);
            }
            if worst > 0.2 * before {
                self.penalty *= 5.0;
            }
        }
        Err(MembraneError::NotConverged {
            iterations: self.effort.iterations - first,
            residual: worst,
            asked: self.tolerance.stretch,
        })
    }

    /// From the loads: forces of p V^(2/3) shall stretch a thread by 1/STIFF in the first round.
    fn choose_penalty(&mut self, load: &Load, start: &State) {
        let pressure = match load.inflation {
            Inflation::Pressure(p) => p,
            Inflation::Gas(gas) => gas.pressure(start.volume.max(1e-3 * self.size.powi(3))).0,
            Inflation::Volume(_) => start.pressure,
        };
        let area = (self.size * self.size).min(4.0 * start.volume.abs().powf(2.0 / 3.0).max(1e-3 * self.size.powi(2)));
        let threads = self.structure.threads();
        let force = pressure.abs() * area + load.fittings_force(&self.structure.fittings);
        self.penalty = STIFF * force.max(f64::MIN_POSITIVE) / self.copies.around / threads.max(1.0);
    }

    fn measure(&mut self, y: &[f64]) -> [f64; 2] {
        let clock = Instant::now();
        self.structure.dofs.places(y, &mut self.x);
        let sets = sets(&self.structure);
        let measured = self.assembly.measure(&sets, &self.structure.dofs, &self.x, self.penalty);
        self.effort.assembling += clock.elapsed();
        measured
    }

    fn work(&mut self, y: &[f64], pressure: f64) {
        let clock = Instant::now();
        self.structure.dofs.places(y, &mut self.x);
        let sets = sets(&self.structure);
        self.assembly.work(
            &sets,
            &self.structure.dofs,
            &self.x,
            self.penalty,
            pressure,
            &mut self.totals,
            &mut self.matrix,
        );
        self.effort.assembling += clock.elapsed();
    }

    /// Takes the tensions of inextensible threads over.
    fn hold(&mut self, y: &[f64]) -> f64 {
        self.structure.dofs.places(y, &mut self.x);
        let mut worst = 0.0_f64;
        for (_, group) in &mut self.structure.groups {
            let place =
                Place { x: &self.x, dofs: &self.structure.dofs.nodes, penalty: self.penalty, pressure: 0.0 };
            worst = worst.max(group.elements_mut().hold(place));
        }
        worst
    }

    /// Force on a degree of freedom from outside, of one copy.
    fn outside(&self, load: &Load) -> Vec<(usize, f64)> {
        let fittings = self.structure.fittings.iter().zip(&self.structure.dofs.fittings);
        fittings
            .zip(&load.fittings)
            .filter(|((kind, _), _)| **kind == Fitting::Loaded)
            .map(|((_, dof), force)| (*dof as usize, force / self.copies.around))
            .collect()
    }

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
        let mut gradient: Vec<f64> = (0..free)
            .map(|i| self.totals.force[i] - pressure * self.totals.sweep[i])
            .collect();
        for (dof, force) in self.outside(load) {
            gradient[dof] -= force;
        }
        // Forces are differences of lengths times stiffness: what rounding leaves of them.
        let rounding = 8.0 * f64::EPSILON * self.size;
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

    fn mean_diagonal(&self) -> f64 {
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
    fn downhill(
        &mut self,
        load: &Load,
        y: &mut Vec<f64>,
        pressure: &mut f64,
    ) -> Result<(f64, usize), MembraneError> {
        let mut guard = Guard::default();
        let mut last = f64::INFINITY;
        let first = y.clone();
        for iteration in 0..self.tolerance.iterations {
            // Running away: beyond a limit point there is nothing to find.
            let farthest = y.iter().zip(&first).fold(0.0_f64, |a, (y, first)| a.max((y - first).abs()));
            if farthest > FARTHEST * self.size {
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
            self.work(y, p);
            let now = self.now(load, y, p);
            last = now.residual;
            if now.ratio <= 1.0 {
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
                break;
            }
        }
        Err(MembraneError::NotConverged {
            iterations: self.tolerance.iterations,
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
        y: &mut Vec<f64>,
    ) -> bool {
        let unit = self.mean_diagonal();
        // What rounding leaves of the potential.
        let floor = 1e-13 * (self.totals.energy.abs() + now.potential.abs());
        let mut trial = y.clone();
        // Far from equilibrium most attempts with the whole stiffness are in vain: only every third is made after one that was.
        let mut is_dead = guard.was_dead && now.residual > 0.03 && self.effort.iterations % 3 != 0;
        if is_dead {
            self.work(y, 0.0);
        }
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
            for _ in 0..HALVINGS {
                for (trial, (y, by)) in trial.iter_mut().zip(y.iter().zip(&step.by)) {
                    *trial = y + length * by;
                }
                let [energy, volume] = self.measure(&trial);
                let fell = self.potential(load, &trial, energy, volume) - now.potential;
                if fell <= 1e-4 * length * step.slope + floor {
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

    /// Equilibrium at a prescribed volume.
    fn with_volume(
        &mut self,
        load: &Load,
        volume: f64,
        y: &mut Vec<f64>,
        pressure: &mut f64,
    ) -> Result<(f64, usize), MembraneError> {
        let mut last = f64::INFINITY;
        let mut trial = y.clone();
        self.work(y, *pressure);
        let mut now = self.now(load, y, *pressure);
        for iteration in 0..self.tolerance.iterations {
            let excess = self.totals.volume - volume;
            last = now.residual;
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
                if after < before * (1.0 - 0.1 * length) || (after.is_finite() && after < 1e-11) || next.ratio <= 1.0 {
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
            iterations: self.tolerance.iterations,
            residual: last,
            asked: self.tolerance.residual,
        })
    }

    /// The state at y, from a last assembly there.
    fn state(&mut self, y: &[f64], pressure: f64, residual: f64, unstable: usize, iterations: usize) -> State {
        self.work(y, pressure);
        let dofs = &self.structure.dofs.fittings;
        State {
            pressure,
            volume: self.totals.volume * self.copies.all(),
            energy: self.totals.energy * self.copies.all(),
            fittings: dofs.iter().map(|dof| y[*dof as usize]).collect(),
            forces: dofs
                .iter()
                .map(|dof| {
                    let dof = *dof as usize;
                    self.copies.around * (self.totals.force[dof] - pressure * self.totals.sweep[dof])
                })
                .collect(),
            residual,
            unstable,
            iterations,
            y: y.to_vec(),
        }
    }
}

/// What the pressure does as the volume changes.
#[derive(Debug, Clone, Copy)]
enum Closure {
    Pressure,
    Gas { slope: f64 },
    Volume { excess: f64 },
}

impl Load {
    /// The largest force on a fitting, N.
    fn fittings_force(&self, kinds: &[Fitting]) -> f64 {
        let loaded = self.fittings.iter().zip(kinds).filter(|(_, kind)| **kind == Fitting::Loaded);
        loaded.fold(0.0, |a, (force, _)| a.max(force.abs()))
    }
}

fn sets(structure: &Structure) -> Vec<&dyn Elements> {
    structure.groups.iter().map(|(_, group)| group.elements()).collect()
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
