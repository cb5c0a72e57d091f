//! Equilibria: Newton's method on one energy, from any start.
//!
//! ```text
//! find y with   d/dy [ W(y) - p V(y) - f.y ] = 0
//! ```
//!
//! At a prescribed pressure, or with a closed amount of gas, the energy is minimised. If the stiffness isn't
//! positive definite (slack cloth, a flat start), a multiple of the unit matrix is added (Levenberg), which
//! vanishes again as the state improves. With a prescribed volume the pressure is one more unknown, and the
//! residual is minimised instead.
//!
//! Inextensible threads are treated by an augmented Lagrangian. Their penalty stiffness follows from the
//! structure's own scale; after each equilibrium their tension is transferred to the multiplier, until their
//! length is right.

use crate::assembly::{Assembly, Totals};
use crate::element::Vector;
use crate::error::MembraneError;
use crate::factor::{Factor, zeros};
use crate::load::{Inflation, Load};
use crate::set::Place;
use crate::state::{Copies, Effort, State, Tolerance};
use crate::structure::{Fitting, Group, Structure};
use faer::Par;
use std::time::Instant;

/// Finds equilibria of a structure.
pub struct Solver {
    pub(crate) structure: Structure,
    pub(crate) copies: Copies,
    pub(crate) tolerance: Tolerance,
    pub(crate) assembly: Assembly,
    pub(crate) factor: Factor,
    pub(crate) matrix: Vec<f64>,
    pub(crate) shifted: Vec<f64>,
    pub(crate) totals: Totals,
    pub(crate) x: Vec<Vector>,
    pub(crate) penalty: f64,
    pub(crate) size: f64,
    pub(crate) effort: Effort,
    /// Number of factorisations after which a search is given up.
    pub(crate) deadline: usize,
}

/// Most outer iterations of the augmented Lagrangian.
const HOLDS: usize = 40;
/// Stiffness of an inextensible thread relative to the forces that the pressure can cause.
const STIFF: f64 = 3e2;

impl Solver {
    /// A solver for a structure that represents `copies` of itself: half a lobe of n over half the length has
    /// 2 n copies around and 2 along.
    ///
    /// # Errors
    /// [`MembraneError::Memory`].
    pub fn new(structure: Structure, copies: Copies, tolerance: Tolerance) -> Result<Self, MembraneError> {
        let sets = structure.sets();
        let assembly = Assembly::new(&sets, &structure.dofs)?;
        // The factorisation uses one thread: a second one gains little on a surface, and would change the
        // last digits.
        let factor = Factor::new(assembly.columns.clone(), assembly.rows.clone(), Par::Seq)?;
        let [matrix, shifted] = [0, 1].map(|_| zeros(assembly.rows.len(), structure.dofs.free));
        let (matrix, shifted) = (matrix?, shifted?);
        let size = structure.size();
        let mut solver = Self {
            shifted,
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
            deadline: usize::MAX,
        };
        solver.stiffen_contacts();
        Ok(solver)
    }

    /// Gives contacts the stiffness that a node of the mesh has at rest.
    fn stiffen_contacts(&mut self) {
        if self.structure.contacts.elements.is_empty() {
            return;
        }
        let start = self.structure.start.clone();
        self.work(&start, 0.0);
        let node = self.mean_diagonal();
        for contact in &mut self.structure.contacts.elements {
            contact.stiffened(node);
        }
    }

    /// The computational effort so far.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// The structure.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Number of entries of the stiffness and of its factors.
    #[must_use]
    pub fn sizes(&self) -> (usize, usize) {
        (self.matrix.len(), self.factor.size())
    }

    /// The mesh as it is, without load: a start, but not an equilibrium by itself.
    #[must_use]
    pub fn at_rest(&mut self) -> State {
        let y = self.structure.start.clone();
        self.held().into_iter().for_each(|tension| *tension = 0.0);
        let held = vec![0.0; self.held().len()];
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
            penalty: self.penalty,
            held,
            y,
        }
    }

    /// A state with the nodes at `places`, as another mesh without inextensible threads has it.
    pub(crate) fn placed(&self, places: &[Vector], other: State) -> State {
        let y = self.structure.dofs.values(places, &other.fittings);
        State { y, held: Vec::new(), penalty: self.penalty, ..other }
    }

    fn held(&mut self) -> Vec<&mut f64> {
        self.structure.groups.iter_mut().flat_map(|(_, group)| group.elements_mut().held()).collect()
    }

    /// Sets the tensions of inextensible threads to those of a state.
    pub(crate) fn restore(&mut self, state: &State) {
        for (tension, held) in self.held().into_iter().zip(&state.held) {
            *tension = *held;
        }
        self.penalty = state.penalty;
    }

    /// The equilibrium under `load` that is reached from `start`.
    ///
    /// # Errors
    /// [`MembraneError::NotConverged`]; the failed state is not kept.
    pub fn solve(&mut self, load: &Load, start: &State) -> Result<State, MembraneError> {
        let mut y = start.y.clone();
        for (i, kind) in self.structure.fittings.iter().enumerate() {
            if *kind == Fitting::Placed {
                y[self.structure.dofs.fittings[i] as usize] = load.fittings[i];
            }
        }
        let mut pressure = start.pressure;
        self.restore(start);
        self.choose_penalty(load, start.pressure, start.volume);
        let first = self.effort.iterations;
        if matches!(load.inflation, Inflation::Volume(_)) && start.iterations == 0 {
            self.puff(load, &mut y, &mut pressure);
            let [_, volume] = self.measure(&y);
            self.choose_penalty(load, pressure, volume * self.copies.all());
        }
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
            // At the round-off of the lengths it can't improve any more.
            if worst <= self.tolerance.stretch || (worst < 1e-9 && worst > 0.3 * before) {
                return self.upright(&state).map(|()| state);
            }
            if worst > 0.2 * before {
                self.penalty *= 5.0;
            }
        }
        Err(MembraneError::Overstretched { stretch: worst, asked: self.tolerance.stretch })
    }

    /// Refuses an equilibrium that is inside out.
    fn upright(&self, state: &State) -> Result<(), MembraneError> {
        let collapsed = |what: &str| Err(MembraneError::Collapsed { what: what.to_owned() });
        if state.pressure > 0.0 && state.volume < 0.0 {
            return collapsed("it has turned inside out");
        }
        let left = |node: &u32| self.x[*node as usize][0] < -1e-9 * self.size;
        let crosses = self.structure.groups.iter().any(|(_, group)| match group {
            Group::Ring2(set) => set.nodes.as_flattened().iter().any(left),
            Group::Ring3(set) => set.nodes.as_flattened().iter().any(left),
            _ => false,
        });
        if crosses {
            return collapsed("it crosses its axis");
        }
        Ok(())
    }

    /// Applies a small pressure to a mesh at rest, so that a prescribed volume starts from a membrane under
    /// tension.
    fn puff(&mut self, load: &Load, y: &mut Vec<f64>, pressure: &mut f64) {
        self.work(y, 0.0);
        let mut breath = 1e-3 * self.mean_diagonal() / self.size;
        for _ in 0..4 {
            let small = Load { inflation: Inflation::Pressure(breath), fittings: load.fittings.clone() };
            let mut trial = y.clone();
            let mut p = breath;
            if self.downhill(&small, &mut trial, &mut p).is_ok() {
                (*y, *pressure) = (trial, breath);
                return;
            }
            breath *= 0.1;
        }
    }

    /// Chooses the penalty from the loads: forces of p V^(2/3) stretch a thread by 1/STIFF in the first
    /// round.
    fn choose_penalty(&mut self, load: &Load, pressure: f64, volume: f64) {
        let pressure = match load.inflation {
            Inflation::Pressure(p) => p,
            Inflation::Gas(gas) => gas.pressure(volume.max(1e-3 * self.size.powi(3))).0,
            Inflation::Volume(_) => pressure,
        };
        // A flat start has no volume yet.
        let (round, box_side) = (volume.abs().powf(2.0 / 3.0), self.size * self.size);
        let area = if round < 1e-3 * box_side { box_side } else { 4.0 * round };
        let threads = self.structure.threads();
        let force = pressure.abs() * area + load.fittings_force(&self.structure.fittings);
        self.penalty = STIFF * force.max(f64::MIN_POSITIVE) / self.copies.around / threads.max(1.0);
    }

    pub(crate) fn measure(&mut self, y: &[f64]) -> [f64; 2] {
        let clock = Instant::now();
        self.structure.dofs.places(y, &mut self.x);
        let sets = self.structure.sets();
        let place = place(&self.x, &self.structure, self.penalty, 0.0);
        let measured = self.assembly.measure(&sets, place);
        self.effort.assembling += clock.elapsed();
        measured
    }

    pub(crate) fn work(&mut self, y: &[f64], pressure: f64) {
        let clock = Instant::now();
        self.structure.dofs.places(y, &mut self.x);
        let sets = self.structure.sets();
        let place = place(&self.x, &self.structure, self.penalty, pressure);
        self.assembly.work(&sets, place, self.structure.dofs.free, &mut self.totals, &mut self.matrix);
        self.effort.assembling += clock.elapsed();
    }

    /// Transfers the tensions of inextensible threads to the multipliers.
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

    /// External forces on degrees of freedom, for one copy.
    pub(crate) fn outside(&self, load: &Load) -> Vec<(usize, f64)> {
        let fittings = self.structure.fittings.iter().zip(&self.structure.dofs.fittings);
        fittings
            .zip(&load.fittings)
            .filter(|((kind, _), _)| **kind == Fitting::Loaded)
            .map(|((_, dof), force)| (*dof as usize, force / self.copies.around))
            .collect()
    }

    /// The state at y; assembles there once more.
    fn state(
        &mut self,
        y: &[f64],
        pressure: f64,
        residual: f64,
        unstable: usize,
        iterations: usize,
    ) -> State {
        self.work(y, pressure);
        let held = self.held().into_iter().map(|tension| *tension).collect();
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
            penalty: self.penalty,
            held,
            y: y.to_vec(),
        }
    }
}

impl Load {
    /// The largest prescribed force on a fitting, N.
    fn fittings_force(&self, kinds: &[Fitting]) -> f64 {
        let loaded = self.fittings.iter().zip(kinds).filter(|(_, kind)| **kind == Fitting::Loaded);
        loaded.fold(0.0, |a, (force, _)| a.max(force.abs()))
    }
}

fn place<'a>(x: &'a [Vector], structure: &'a Structure, penalty: f64, pressure: f64) -> Place<'a> {
    Place { x, dofs: &structure.dofs.nodes, penalty, pressure }
}
