//! Load paths: from one load to another, with adaptive steps.

use crate::error::MembraneError;
use crate::load::{Inflation, Load};
use crate::solver::Solver;
use crate::state::State;

/// Smallest step relative to the whole path; for a large increase of pressure, relative to the pressure
/// reached.
const SMALLEST: f64 = 1.0 / 1024.0;
/// Most factorisations for one path, unless twice the iterations allowed for one equilibrium are more.
const BUDGET: usize = 6000;
/// Most volumes that are tried to detect a maximum of the pressure; then the first of these steps relative to
/// the volume.
const VOLUMES: usize = 60;
const FIRST_VOLUME: f64 = 0.01;
/// A pressure for meshes that have no scale of their own, Pa.
const ATMOSPHERE: f64 = 1e5;
/// Most iterations for a step of a path, because a shorter step is cheaper than a long search.
const PATIENCE: usize = 80;
/// Largest extrapolation relative to the step before it.
const REACH: f64 = 2.0;

impl Solver {
    /// The equilibrium under `load`, reached from the equilibrium `from` under `before` in as few steps as
    /// possible. Both loads must prescribe the same kinds of quantities. `seen` is called with each
    /// equilibrium on the way and its fraction of the path.
    ///
    /// # Errors
    /// [`MembraneError::LimitPoint`] if the pressure decreases before it reaches the prescribed one;
    /// [`MembraneError::NotConverged`] and the other errors of [`Self::solve`].
    pub fn follow(
        &mut self,
        before: &Load,
        from: &State,
        load: &Load,
        seen: impl FnMut(f64, &State),
    ) -> Result<State, MembraneError> {
        self.follow_on(before, (None, from), load, seen)
    }

    /// The same, continued from an older equilibrium, if there is one, whose load was as far from `before` on the other
    /// side as `load` is.
    pub(crate) fn follow_on(
        &mut self,
        before: &Load,
        (older, from): (Option<&State>, &State),
        load: &Load,
        mut seen: impl FnMut(f64, &State),
    ) -> Result<State, MembraneError> {
        let patience = self.tolerance.iterations;
        let budget = BUDGET.max(2 * patience);
        self.deadline = self.effort.factorisations + budget;
        let found = match self.steps(before, (older, from), load, &mut seen) {
            // A flat or slack mesh has no volume at first, so it is filled under pressure before the volume
            // is prescribed.
            Err(_) if matches!(load.inflation, Inflation::Volume(_)) && from.iterations == 0 => {
                self.deadline = self.effort.factorisations + budget;
                self.inflated(before, from, load).and_then(|first| {
                    let begun = Load {
                        inflation: Inflation::Volume(first.volume),
                        fittings: before.fittings.clone(),
                    };
                    self.steps(&begun, (None, &first), load, &mut seen)
                })
            }
            found => found,
        };
        self.tolerance.iterations = patience;
        self.deadline = usize::MAX;
        found
    }

    /// The equilibrium that is reached from `start` at once, within the effort of a path.
    pub(crate) fn attempt(&mut self, load: &Load, start: &State) -> Result<State, MembraneError> {
        self.deadline = self.effort.factorisations + BUDGET.max(2 * self.tolerance.iterations);
        let found = self.solve(load, start);
        self.deadline = usize::MAX;
        found
    }

    fn steps(
        &mut self,
        before: &Load,
        (older, from): (Option<&State>, &State),
        load: &Load,
        seen: &mut impl FnMut(f64, &State),
    ) -> Result<State, MembraneError> {
        let (mut done, mut step) = (0.0, 1.0_f64);
        let mut last = from.clone();
        let mut older = older.map(|state| (-1.0, state.clone()));
        let mut said = None;
        // The first state may be far from a mesh at rest, but states on a path are close to each other.
        let patience = self.tolerance.iterations;
        if from.iterations > 0 {
            self.tolerance.iterations = patience.min(PATIENCE);
        }
        loop {
            let next = (done + step).min(1.0);
            let between = before.towards(load, next);
            let start = match &older {
                Some((at, state)) if next - done <= REACH * (done - at) => {
                    extrapolated(state, &last, (next - done) / (done - at))
                }
                _ => self.stretched(&last, &between),
            };
            let solved = self.solve(&between, &start).or_else(|error| {
                // If the extrapolation fails, the last state itself may still work as a start.
                if older.is_some() { self.solve(&between, &last) } else { Err(error) }
            });
            match solved {
                Ok(state) => {
                    seen(next, &state);
                    if next >= 1.0 {
                        return Ok(state);
                    }
                    self.tolerance.iterations = patience.min(PATIENCE);
                    older = Some((done, std::mem::replace(&mut last, state)));
                    done = next;
                    step *= 1.5;
                }
                Err(error) => {
                    step *= 0.5;
                    let is_late = self.effort.factorisations >= self.deadline;
                    // An attempt that was cut off isn't informative, so report the error before it.
                    let error = if is_late { said.unwrap_or(error) } else { error };
                    if is_late || step < smallest(before, &last, load) {
                        self.tolerance.iterations = patience.min(PATIENCE);
                        return self.beyond(before, last, load, done, seen).unwrap_or(Err(error));
                    }
                    said = Some(error);
                }
            }
        }
    }

    /// If the pressure can't be raised any more, increases the volume to see whether the pressure has a
    /// maximum. `None` if that can't be decided.
    fn beyond(
        &mut self,
        before: &Load,
        last: State,
        load: &Load,
        done: f64,
        seen: &mut impl FnMut(f64, &State),
    ) -> Option<Result<State, MembraneError>> {
        let Inflation::Pressure(asked) = load.inflation else { return None };
        // Nothing is known without an equilibrium before, or if an end moved as well.
        if asked <= last.pressure || last.iterations == 0 || before.fittings != load.fittings {
            return None;
        }
        let mut best = last;
        let mut step = FIRST_VOLUME * best.volume;
        for _ in 0..VOLUMES {
            let volume = best.volume + step;
            let wider = Load { inflation: Inflation::Volume(volume), fittings: load.fittings.clone() };
            match self.solve(&wider, &best) {
                Ok(state) if state.pressure <= best.pressure => {
                    seen(done, &best);
                    let (last, volume) = (best.pressure, best.volume);
                    return Some(Err(MembraneError::LimitPoint { pressure: asked, last, volume }));
                }
                Ok(state) => {
                    best = state;
                    step *= 1.3;
                    if best.pressure >= asked {
                        return Some(self.solve(load, &best));
                    }
                }
                Err(_) => step *= 0.3,
            }
            if step < 1e-6 * best.volume || self.effort.factorisations >= self.deadline {
                break;
            }
        }
        None
    }

    /// A mesh at rest under a pressure that brings it near the prescribed volume.
    fn inflated(&mut self, before: &Load, rest: &State, load: &Load) -> Result<State, MembraneError> {
        let Inflation::Volume(volume) = load.inflation else { return Ok(rest.clone()) };
        let under = |p: f64| Load { inflation: Inflation::Pressure(p), fittings: before.fittings.clone() };
        self.work(&rest.y, 0.0);
        let breath = 1e-3 * self.mean_diagonal() / self.size;
        // Inextensible threads have no stiffness of their own, and their shape is independent of the
        // pressure.
        let mut pressure = if breath > 1e-200 { breath } else { ATMOSPHERE };
        let mut state = self.solve(&under(pressure), rest)?;
        // A bag fills at low pressure, so reduce it.
        for _ in 0..VOLUMES {
            if state.volume <= volume {
                break;
            }
            pressure *= 0.1;
            let Ok(less) = self.solve(&under(pressure), &state) else { break };
            if less.volume > 0.999 * state.volume {
                break;
            }
            state = less;
        }
        for _ in 0..VOLUMES {
            if state.volume >= volume {
                break;
            }
            pressure *= 2.0;
            let Ok(more) = self.solve(&under(pressure), &state) else { break };
            if more.volume > volume && (more.volume - volume) > (volume - state.volume) {
                break;
            }
            state = more;
        }
        Ok(state)
    }

    /// A state whose nodes have followed the fittings along z in proportion: the start for new positions of
    /// the fittings.
    fn stretched(&self, state: &State, load: &Load) -> State {
        let structure = &self.structure;
        let mut start = state.clone();
        let dofs = &structure.dofs;
        let mut ends: Vec<(f64, f64)> = Vec::new();
        for (fitting, kind) in structure.fittings.iter().enumerate() {
            if *kind != crate::structure::Fitting::Placed {
                continue;
            }
            let dof = dofs.fittings[fitting];
            let Some(node) = dofs.nodes.iter().position(|node| node.dof[0] == dof) else { continue };
            let before = state.y[dof as usize];
            ends.push((structure.places[node][2] + before, load.fittings[fitting] - before));
        }
        // Nodes held on a plane orthogonal to z count as an end that doesn't move.
        let still = dofs.nodes.iter().find(|node| {
            node.axis.iter().zip(node.dof).all(|(axis, dof)| dof == crate::dofs::NONE || axis[2] == 0.0)
        });
        if let (1, Some(node)) = (ends.len(), still) {
            ends.push((node.base[2], 0.0));
        }
        let [(z0, d0), (z1, d1)] = ends[..] else { return start };
        if (z1 - z0).abs() <= 1e-12 * self.structure.size() || (d0 == 0.0 && d1 == 0.0) {
            return start;
        }
        let mut x = Vec::new();
        dofs.places(&state.y, &mut x);
        for (node, place) in dofs.nodes.iter().zip(&x) {
            let by = d0 + (d1 - d0) * (place[2] - z0) / (z1 - z0);
            for (dof, axis) in node.dof.iter().zip(&node.axis) {
                if *dof != crate::dofs::NONE && (*dof as usize) < dofs.free && axis[2].abs() > 0.99 {
                    start.y[*dof as usize] += by * axis[2];
                }
            }
        }
        start
    }
}

impl Load {
    /// The load at a fraction of the way to another one.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| if share >= 1.0 { b } else { a + share * (b - a) };
        let inflation = match (self.inflation, other.inflation) {
            (Inflation::Pressure(a), Inflation::Pressure(b)) => Inflation::Pressure(mix(a, b)),
            (Inflation::Volume(a), Inflation::Volume(b)) => Inflation::Volume(mix(a, b)),
            (Inflation::Gas(a), Inflation::Gas(mut b)) => {
                b.constant = mix(a.constant, b.constant);
                Inflation::Gas(b)
            }
            (_, b) => b,
        };
        let fittings = self.fittings.iter().zip(&other.fittings).map(|(a, b)| mix(*a, *b)).collect();
        Self { inflation, fittings }
    }
}

/// Extrapolates from two states by `ratio` of the step between them.
fn extrapolated(older: &State, last: &State, ratio: f64) -> State {
    let mut start = last.clone();
    for (y, older) in start.y.iter_mut().zip(&older.y) {
        *y += ratio * (*y - older);
    }
    start.pressure += ratio * (last.pressure - older.pressure);
    start
}

/// The smallest step that is tried.
fn smallest(before: &Load, last: &State, load: &Load) -> f64 {
    match (before.inflation, load.inflation) {
        (Inflation::Pressure(a), Inflation::Pressure(b)) if last.iterations > 0 && b > a => {
            SMALLEST.min(SMALLEST * last.pressure / (b - a))
        }
        _ => SMALLEST,
    }
}
