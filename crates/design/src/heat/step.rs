//! One time step: walls and gas are implicit, and mass and energy are conserved to rounding.

use super::gas::{CP, CV, R};
use super::mesh::{Conductances, Instant, Mesh};
use super::state::{Exchange, Outside, State};
use super::tridiagonal::Tridiagonal;

/// Change of a gas temperature \[K\] at which the iteration of a step ends. The remaining error doesn't
/// violate the energy balance: see [`Stepper::step`].
const TOLERANCE: f64 = 1e-8;
const ITERATIONS: usize = 60;

/// Inputs of a time step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step<'a> {
    pub mesh: &'a Mesh,
    pub conductances: &'a Conductances,
    pub outside: Outside,
    pub from: Instant,
    pub to: Instant,
    /// Duration \[s\].
    pub dt: f64,
}

impl Step<'_> {
    /// Rate \[W\] at which the gas in a volume stores energy and does work.
    fn stored(&self, before: f64, after: f64) -> f64 {
        let work = f64::midpoint(self.from.pressure, self.to.pressure) * (after - before);
        (CV / R * (self.to.pressure * after - self.from.pressure * before) + work) / self.dt
    }

    /// Net enthalpy inflow \[W\] of a cell of the muscle: stored energy and work minus the heat.
    fn intake(&self, state: &State, i: usize) -> f64 {
        let (mesh, c) = (self.mesh, self.conductances);
        let (muscle, pipe) = (&state.muscle, &state.pipe);
        let gas = muscle.gas[i];
        let mut heat = c.wall[i] * (muscle.wall[i] - gas);
        if i < mesh.pipe_cells {
            heat += c.pipe_outer[i] * (pipe.wall[i] - gas);
        }
        if i > 0 {
            heat += c.mixing[i] * (muscle.gas[i - 1] - gas);
        }
        if i + 1 < mesh.x.len() {
            heat += c.mixing[i + 1] * (muscle.gas[i + 1] - gas);
        }
        self.stored(mesh.volume(i, self.from.section), mesh.volume(i, self.to.section)) - heat
    }

    /// Net enthalpy inflow \[W\] of a cell of the pipe.
    fn pipe_intake(&self, state: &State, i: usize) -> f64 {
        let (volume, pipe) = (self.mesh.pipe_volume[i], &state.pipe);
        self.stored(volume, volume) - self.conductances.pipe_inner[i] * (pipe.wall[i] - pipe.gas[i])
    }

    /// Volume of a cell of the muscle or of the pipe at the end of the step.
    fn volume(&self, in_pipe: bool, i: usize) -> f64 {
        if in_pipe { self.mesh.pipe_volume[i] } else { self.mesh.volume(i, self.to.section) }
    }

    /// Volume of a cell, mean of start and end of the step.
    fn middle_volume(&self, in_pipe: bool, i: usize) -> f64 {
        if in_pipe {
            self.mesh.pipe_volume[i]
        } else {
            f64::midpoint(self.mesh.volume(i, self.from.section), self.mesh.volume(i, self.to.section))
        }
    }

    /// Work of the gas on the wall \[J\].
    fn work(&self) -> f64 {
        let swept = (0..self.mesh.x.len())
            .map(|i| self.mesh.volume(i, self.to.section) - self.mesh.volume(i, self.from.section));
        swept.sum::<f64>() * f64::midpoint(self.from.pressure, self.to.pressure)
    }
}

/// Takes steps and reuses its memory.
#[derive(Debug, Default)]
pub(super) struct Stepper {
    rows: Tridiagonal,
    old: State,
    next: Vec<f64>,
    /// Enthalpy flow through the faces \[W\], in the muscle and in the pipe.
    enthalpy: [Vec<f64>; 2],
    /// Enthalpy flow through the mouth of the pipe \[W\].
    mouth: f64,
}

/// The iteration of a step didn't converge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Diverged;

/// Values carried by the air that enters a chain of cells: at its first and last face, and from the mouth of
/// the pipe (with the cell there).
#[derive(Debug, Clone, Copy)]
struct Borders {
    first: f64,
    last: f64,
    mouth: Option<(usize, f64)>,
}

impl Borders {
    fn at(&self, face: usize) -> f64 {
        if face == 0 { self.first } else { self.last }
    }
}

impl Stepper {
    /// Advances a state by one step. The temperatures of gas and walls are found by alternating implicit
    /// solves. The internal energy of the gas is cv P V/R whatever its temperatures: the heats found fix
    /// every enthalpy flow, so energy is conserved exactly. A last linear solve for 1/T moves the mass with
    /// exactly these flows.
    pub(super) fn step(&mut self, step: Step, state: &mut State) -> Result<Exchange, Diverged> {
        let Step { mesh, outside, dt, .. } = step;
        self.old.clone_from(state);
        // The iteration starts from adiabatic compression.
        let rise = (step.to.pressure / step.from.pressure).powf(1.0 - CV / CP);
        for gas in state.muscle.gas.iter_mut().chain(&mut state.pipe.gas) {
            *gas *= rise;
        }
        for iteration in 0.. {
            self.walls(step, state);
            self.enthalpies(step, state);
            let change = self.gas(step, state);
            if change < TOLERANCE {
                break;
            }
            if iteration == ITERATIONS || !change.is_finite() {
                return Err(Diverged);
            }
        }
        // Repeated with the final gas temperatures, from which the enthalpy flows must follow exactly.
        self.walls(step, state);
        self.enthalpies(step, state);
        self.advect(step, state);
        let inlet = if mesh.pipe_cells > 0 { &state.pipe } else { &state.muscle };
        let carried = if inlet.flow[0] > 0.0 { outside.supply } else { inlet.gas[0] };
        let lost = |(wall, outer): (&f64, &f64)| outer * (wall - outside.ambient) * dt;
        Ok(Exchange {
            mass: inlet.flow[0] * dt,
            enthalpy: inlet.flow[0] * dt * CP * carried,
            heat: state.muscle.wall.iter().zip(&mesh.wall_outer).map(lost).sum(),
            work: step.work(),
        })
    }

    /// Solves both walls for given gas temperatures by backward Euler.
    fn walls(&mut self, step: Step, state: &mut State) {
        let Step { mesh, conductances: c, outside, dt, .. } = step;
        let (rows, n) = (&mut self.rows, mesh.x.len());
        rows.reset(n);
        for i in 0..n {
            let store = mesh.wall_capacity[i] / dt;
            rows.diagonal[i] += store + c.wall[i] + mesh.wall_outer[i];
            rows.right[i] = store * self.old.muscle.wall[i]
                + c.wall[i] * state.muscle.gas[i]
                + mesh.wall_outer[i] * outside.ambient;
            if i > 0 {
                rows.couple(i, mesh.wall_axial[i]);
            }
        }
        rows.solve(&mut state.muscle.wall);
        rows.reset(mesh.pipe_cells);
        for i in 0..mesh.pipe_cells {
            let store = mesh.pipe_capacity[i] / dt;
            rows.diagonal[i] += store + c.pipe_inner[i] + c.pipe_outer[i];
            rows.right[i] = store * self.old.pipe.wall[i]
                + c.pipe_inner[i] * state.pipe.gas[i]
                + c.pipe_outer[i] * state.muscle.gas[i];
            if i > 0 {
                rows.couple(i, mesh.pipe_axial[i]);
            }
        }
        rows.solve(&mut state.pipe.wall);
    }

    /// Enthalpy flows from the energy balance of every cell, summed from the closed ends.
    fn enthalpies(&mut self, step: Step, state: &State) {
        let (n, np) = (step.mesh.x.len(), step.mesh.pipe_cells);
        let [along, inside] = &mut self.enthalpy;
        along.clear();
        along.resize(n + 1, 0.0);
        inside.clear();
        for i in 0..np {
            along[i + 1] = along[i] - step.intake(state, i);
        }
        let beyond = if np > 0 { np + 1 } else { 0 };
        for i in (beyond..n).rev() {
            along[i] = along[i + 1] + step.intake(state, i);
        }
        self.mouth = 0.0;
        if np > 0 {
            self.mouth = step.intake(state, np) + along[np + 1] - along[np];
            inside.resize(np + 1, self.mouth);
            for i in (0..np).rev() {
                inside[i] = inside[i + 1] + step.pipe_intake(state, i);
            }
        }
    }

    /// Whether pipe or muscle is solved first: what leaves the mouth must be known before the cells it
    /// enters.
    fn order(&self, state: &State) -> impl Iterator<Item = bool> + use<> {
        let order = if self.mouth > 0.0 { [true, false] } else { [false, true] };
        let has_pipe = !state.pipe.gas.is_empty();
        order.into_iter().filter(move |in_pipe| has_pipe || !in_pipe)
    }

    /// Solves for the gas temperatures with given walls and flows; returns the largest change \[K\].
    /// ```text
    /// cp M_old (T - T_old)/dt = V dP/dt + sum_in m' cp (T_up - T) + sum U (T_wall - T) + mixing
    /// ```
    /// This is the energy balance minus cp T times the mass balance.
    fn gas(&mut self, step: Step, state: &mut State) -> f64 {
        let mut change = 0.0_f64;
        for in_pipe in self.order(state) {
            self.gas_rows(step, state, in_pipe);
            self.gas_flows(state, step.outside.supply, in_pipe);
            let now = if in_pipe { &mut state.pipe } else { &mut state.muscle };
            self.next.resize(now.gas.len(), 0.0);
            self.rows.solve(&mut self.next);
            for (gas, next) in now.gas.iter_mut().zip(&self.next) {
                // `max` would drop a NaN.
                let moved = (next - *gas).abs();
                change = if moved.is_finite() && *next > 0.0 { change.max(moved) } else { f64::INFINITY };
                *gas = *next;
            }
        }
        change
    }

    /// Adds the stored energy and the heat of each cell to the equations.
    fn gas_rows(&mut self, step: Step, state: &State, in_pipe: bool) {
        let (c, np) = (step.conductances, step.mesh.pipe_cells);
        let old = if in_pipe { &self.old.pipe } else { &self.old.muscle };
        let now = if in_pipe { &state.pipe } else { &state.muscle };
        let (n, pressing) = (now.gas.len(), (step.to.pressure - step.from.pressure) / step.dt);
        let rows = &mut self.rows;
        rows.reset(n);
        for i in 0..n {
            let store = CP * old.mass[i] / step.dt;
            rows.diagonal[i] += store;
            rows.right[i] += store * old.gas[i] + step.middle_volume(in_pipe, i) * pressing;
            // After this pass the wall will follow a fraction of the gas's change; anticipating that makes
            // few passes suffice.
            let mut heat = |conductance: f64, wall: f64, total: f64| {
                let kept = conductance * (1.0 - conductance / total);
                rows.diagonal[i] += kept;
                rows.right[i] += conductance * (wall - now.gas[i]) + kept * now.gas[i];
            };
            let pipe_total =
                |i: usize| step.mesh.pipe_capacity[i] / step.dt + c.pipe_inner[i] + c.pipe_outer[i];
            if in_pipe {
                heat(c.pipe_inner[i], now.wall[i], pipe_total(i));
            } else {
                let total = step.mesh.wall_capacity[i] / step.dt + c.wall[i] + step.mesh.wall_outer[i];
                heat(c.wall[i], now.wall[i], total);
                if i < np {
                    heat(c.pipe_outer[i], state.pipe.wall[i], pipe_total(i));
                }
            }
            if !in_pipe && i > 0 {
                rows.couple(i, c.mixing[i]);
            }
        }
    }

    /// Adds the flows to the equations. The enthalpy flow m' cp T divided by T of the last pass gives m' cp.
    fn gas_flows(&mut self, state: &State, supply: f64, in_pipe: bool) {
        let borders = borders(in_pipe, state, supply, |gas| gas);
        let now = if in_pipe { &state.pipe.gas } else { &state.muscle.gas };
        let rows = &mut self.rows;
        for (face, flow) in self.enthalpy[usize::from(in_pipe)].iter().enumerate() {
            let (up, down) = upwind(face, *flow, now.len());
            let Some(down) = down else { continue };
            let heat = flow.abs() / up.map_or(borders.at(face), |i| now[i]);
            rows.diagonal[down] += heat;
            match up {
                None => rows.right[down] += flow.abs(),
                Some(up) if up < down => rows.low[down] -= heat,
                Some(_) => rows.high[down] -= heat,
            }
        }
        if let Some((cell, carried)) = borders.mouth
            && self.mouth > 0.0
        {
            rows.diagonal[cell] += self.mouth / carried;
            rows.right[cell] += self.mouth;
        }
    }

    /// Moves the mass with the enthalpy flows H. With y = 1/T, M = P V y/R and m' = H y_up/cp:
    /// ```text
    /// (P V/R + dt sum_out H/cp) y - dt sum_in H/cp y_up = M_old
    /// ```
    fn advect(&mut self, step: Step, state: &mut State) {
        for in_pipe in self.order(state) {
            let borders = borders(in_pipe, state, step.outside.supply, f64::recip);
            self.advect_rows(step, in_pipe, borders);
            let now = if in_pipe { &mut state.pipe } else { &mut state.muscle };
            let n = now.gas.len();
            self.next.resize(n, 0.0);
            self.rows.solve(&mut self.next);
            for (face, flow) in self.enthalpy[usize::from(in_pipe)].iter().enumerate() {
                let carried = upwind(face, *flow, n).0.map_or(borders.at(face), |i| self.next[i]);
                now.flow[face] = flow / CP * carried;
            }
            for (i, y) in self.next.iter().enumerate() {
                now.gas[i] = y.recip();
                now.mass[i] = step.to.pressure * step.volume(in_pipe, i) / R * y;
            }
        }
    }

    fn advect_rows(&mut self, step: Step, in_pipe: bool, borders: Borders) {
        let old = if in_pipe { &self.old.pipe } else { &self.old.muscle };
        let (n, rows) = (old.gas.len(), &mut self.rows);
        rows.reset(n);
        for i in 0..n {
            rows.diagonal[i] += step.to.pressure * step.volume(in_pipe, i) / R;
            rows.right[i] += old.mass[i];
        }
        for (face, flow) in self.enthalpy[usize::from(in_pipe)].iter().enumerate() {
            let (up, down) = upwind(face, *flow, n);
            let moved = step.dt * flow.abs() / CP;
            if let Some(up) = up {
                rows.diagonal[up] += moved;
            }
            match (up, down) {
                (None, Some(down)) => rows.right[down] += moved * borders.at(face),
                (Some(up), Some(down)) if up < down => rows.low[down] -= moved,
                (Some(_), Some(down)) => rows.high[down] -= moved,
                (_, None) => {}
            }
        }
        if let Some((cell, carried)) = borders.mouth {
            let moved = step.dt * self.mouth / CP;
            rows.right[cell] += moved.max(0.0) * carried;
            rows.diagonal[cell] += (-moved).max(0.0);
        }
    }
}

/// Values of the air that enters a chain; `of` maps a temperature to the value carried.
fn borders(in_pipe: bool, state: &State, supply: f64, of: impl Fn(f64) -> f64) -> Borders {
    let (np, first) = (state.pipe.gas.len(), of(supply));
    if in_pipe {
        Borders { first, last: of(state.muscle.gas[np]), mouth: None }
    } else {
        // Nothing passes the last face of the muscle.
        Borders { first, last: first, mouth: state.pipe.gas.last().map(|gas| (np, of(*gas))) }
    }
}

/// Cells upstream and downstream of a face between n cells.
fn upwind(face: usize, flow: f64, n: usize) -> (Option<usize>, Option<usize>) {
    let (left, right) = (face.checked_sub(1), (face < n).then_some(face));
    if flow > 0.0 { (left, right) } else { (right, left) }
}
