//! Cells along the muscle and its pipe: volumes, capacities, conductances of the walls.

use super::HeatProblem;
use super::gas::{CP, Convection, Jet, Passage, R};
use super::state::State;
use std::f64::consts::PI;

/// Wall of a tube of 1 m length; its temperature is that at mid-thickness.
#[derive(Debug, Clone, Copy)]
struct Shell {
    inner: f64,
    outer: f64,
    /// Resistances from the inner and the outer surface to the middle \[m K/W\].
    to_middle: [f64; 2],
    section: f64,
}

impl Shell {
    fn new(diameter: f64, thickness: f64, conductivity: f64) -> Self {
        let (inner, outer) = (0.5 * diameter, 0.5 * diameter + thickness);
        let middle = f64::midpoint(inner, outer);
        let resistance = |a: f64, b: f64| (b / a).ln() / (2.0 * PI * conductivity);
        Self {
            inner,
            outer,
            to_middle: [resistance(inner, middle), resistance(middle, outer)],
            section: PI * (outer * outer - inner * inner),
        }
    }

    /// Conductance \[W/(m K)\] from the air inside to mid-thickness, with a film coefficient `transfer`.
    fn inside(&self, transfer: f64) -> f64 {
        let film = transfer * 2.0 * PI * self.inner;
        film / (1.0 + film * self.to_middle[0])
    }

    /// Conductance \[W/(m K)\] from the air outside to mid-thickness.
    fn outside(&self, transfer: f64) -> f64 {
        let film = transfer * 2.0 * PI * self.outer;
        film / (1.0 + film * self.to_middle[1])
    }
}

/// Conductances of one time step \[W/K\].
#[derive(Debug, Clone, Default)]
pub(super) struct Conductances {
    /// Gas of the muscle to its wall, by cell.
    pub wall: Vec<f64>,
    /// Gas in the pipe to the pipe's wall, by cell of the pipe.
    pub pipe_inner: Vec<f64>,
    /// Gas of the muscle to the pipe's wall, by cell of the pipe.
    pub pipe_outer: Vec<f64>,
    /// Axial mixing between cells i-1 and i of the muscle; the first is 0.
    pub mixing: Vec<f64>,
}

/// Pressure and section at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instant {
    /// Absolute pressure \[Pa\].
    pub pressure: f64,
    /// Section of the muscle relative to the section at rest.
    pub section: f64,
}

/// The mesh: cells along the muscle and the pipe.
#[derive(Debug, Clone)]
pub(super) struct Mesh {
    /// Centres \[m\].
    pub x: Vec<f64>,
    /// Lengths \[m\].
    pub dx: Vec<f64>,
    /// Number of cells that the pipe passes; 0 without a pipe.
    pub pipe_cells: usize,
    /// Heat capacity of the muscle's wall \[J/K\].
    pub wall_capacity: Vec<f64>,
    /// Conductance from the muscle's wall to the ambient \[W/K\].
    pub wall_outer: Vec<f64>,
    /// Axial conductance of the muscle's wall between cells i-1 and i \[W/K\].
    pub wall_axial: Vec<f64>,
    /// Heat capacity of the pipe's wall \[J/K\].
    pub pipe_capacity: Vec<f64>,
    /// Axial conductance of the pipe's wall between cells i-1 and i \[W/K\].
    pub pipe_axial: Vec<f64>,
    /// Volume inside the pipe, by cell \[m3\].
    pub pipe_volume: Vec<f64>,
    /// Section through which air enters \[m2\]: that of the pipe or of the port.
    pub nozzle_section: f64,
    section: f64,
    pipe_outer_section: f64,
    diameter: f64,
    nozzle_diameter: f64,
    wall: Shell,
    pipe: Option<Shell>,
}

impl Mesh {
    pub(super) fn new(problem: &HeatProblem) -> Self {
        let (tube, n) = (&problem.tube, problem.numerics.cells);
        let (length, mouth) = (tube.length_m, problem.pipe.map_or(0.0, |pipe| pipe.length_m));
        let pipe_cells = problem.pipe.map_or(0, |_| nearest(n as f64 * mouth / length).clamp(1, n - 1));
        // The mouth of the pipe lies on a face, so cells before and behind it differ in length.
        let before = if pipe_cells > 0 { mouth / pipe_cells as f64 } else { 0.0 };
        let beyond = (length - mouth) / (n - pipe_cells) as f64;
        let dx: Vec<f64> = (0..n).map(|i| if i < pipe_cells { before } else { beyond }).collect();
        let x = (0..n)
            .map(|i| {
                let at = |from: usize, step: f64| ((i - from) as f64 + 0.5) * step;
                if i < pipe_cells { at(0, before) } else { mouth + at(pipe_cells, beyond) }
            })
            .collect();
        let wall = Shell::new(tube.inner_diameter_m, tube.wall_thickness_m, tube.wall_conductivity_w_per_m_k);
        let pipe = problem
            .pipe
            .map(|p| (p, Shell::new(p.inner_diameter_m, p.wall_thickness_m, p.conductivity_w_per_m_k)));
        let bore = problem.pipe.map_or(tube.port_diameter_m, |pipe| pipe.inner_diameter_m);
        let nozzle_section = 0.25 * PI * bore * bore;
        let along = |cells: usize, k_section: f64| -> Vec<f64> {
            (0..cells)
                .map(|i| if i == 0 { 0.0 } else { k_section / f64::midpoint(dx[i - 1], dx[i]) })
                .collect()
        };
        let outer = wall.outside(problem.surroundings.outer_transfer_w_per_m2_k);
        let by_length = |cells: usize, value: f64| dx[..cells].iter().map(|dx| dx * value).collect();
        Self {
            wall_capacity: by_length(n, wall.section * tube.wall_heat_capacity_j_per_m3_k),
            wall_outer: by_length(n, outer),
            wall_axial: along(n, wall.section * tube.wall_conductivity_w_per_m_k),
            pipe_capacity: by_length(
                pipe_cells,
                pipe.map_or(0.0, |(p, shell)| shell.section * p.heat_capacity_j_per_m3_k),
            ),
            pipe_axial: along(
                pipe_cells,
                pipe.map_or(0.0, |(p, shell)| shell.section * p.conductivity_w_per_m_k),
            ),
            pipe_volume: by_length(pipe_cells, nozzle_section),
            nozzle_section,
            section: 0.25 * PI * tube.inner_diameter_m * tube.inner_diameter_m,
            pipe_outer_section: pipe.map_or(0.0, |(_, shell)| PI * shell.outer * shell.outer),
            diameter: tube.inner_diameter_m,
            nozzle_diameter: bore,
            wall,
            pipe: pipe.map(|(_, shell)| shell),
            pipe_cells,
            x,
            dx,
        }
    }

    /// Free section of a cell \[m2\].
    fn free_section(&self, i: usize, swollen: f64) -> f64 {
        self.section * swollen - if i < self.pipe_cells { self.pipe_outer_section } else { 0.0 }
    }

    /// Volume of the muscle's gas in a cell \[m3\].
    pub(super) fn volume(&self, i: usize, swollen: f64) -> f64 {
        self.dx[i] * self.free_section(i, swollen)
    }

    /// Speed \[m/s\] of a flow \[kg/s\] through the pipe or the port.
    pub(super) fn nozzle_speed(&self, flow: f64, temperature: f64, pressure: f64) -> f64 {
        flow * R * temperature / (pressure * self.nozzle_section)
    }

    /// Conductances from the closures, for the flow of a state.
    pub(super) fn conductances(
        &self,
        problem: &HeatProblem,
        state: &State,
        now: Instant,
        out: &mut Conductances,
    ) {
        let (n, closures) = (self.x.len(), &problem.closures);
        for (list, cells) in [
            (&mut out.wall, n),
            (&mut out.mixing, n),
            (&mut out.pipe_inner, self.pipe_cells),
            (&mut out.pipe_outer, self.pipe_cells),
        ] {
            list.clear();
            list.resize(cells, 0.0);
        }
        let jet = self.jet(problem, state, now);
        // rho D A of the previous cell.
        let mut before = 0.0;
        for i in 0..n {
            let (t, section) = (state.muscle.gas[i], self.free_section(i, now.section));
            let density = now.pressure / (R * t);
            let through = f64::midpoint(state.muscle.flow[i].abs(), state.muscle.flow[i + 1].abs());
            let along = through / (density * section);
            let speed = along.hypot(jet.stirring(self.x[i], self.diameter, closures));
            let gap = match &self.pipe {
                Some(pipe) if i < self.pipe_cells => self.diameter - 2.0 * pipe.outer,
                _ => self.diameter,
            };
            let passage = Passage { hydraulic: gap, speed, density, gas: t, wall: state.muscle.wall[i] };
            let Convection { transfer, diffusivity } = passage.convection(closures);
            out.wall[i] = self.dx[i] * self.wall.inside(transfer);
            let here = density * diffusivity * section;
            if i > 0 {
                out.mixing[i] = CP * f64::midpoint(before, here) / f64::midpoint(self.dx[i - 1], self.dx[i]);
            }
            before = here;
            if let (Some(pipe), true) = (&self.pipe, i < self.pipe_cells) {
                out.pipe_outer[i] = self.dx[i] * pipe.outside(transfer);
                let t = state.pipe.gas[i];
                let flow = f64::midpoint(state.pipe.flow[i].abs(), state.pipe.flow[i + 1].abs());
                let passage = Passage {
                    hydraulic: 2.0 * pipe.inner,
                    speed: self.nozzle_speed(flow, t, now.pressure),
                    density: now.pressure / (R * t),
                    gas: t,
                    wall: state.pipe.wall[i],
                };
                out.pipe_inner[i] = self.dx[i] * pipe.inside(passage.convection(closures).transfer);
            }
        }
    }

    fn jet(&self, problem: &HeatProblem, state: &State, now: Instant) -> Jet {
        let (flow, temperature) = match (state.pipe.flow.last(), state.pipe.gas.last()) {
            (Some(flow), Some(gas)) => (*flow, *gas),
            _ => (state.muscle.flow[0], problem.surroundings.supply_k),
        };
        Jet {
            position: problem.pipe.map_or(0.0, |pipe| pipe.length_m),
            speed: self.nozzle_speed(flow.max(0.0), temperature, now.pressure),
            contraction: self.nozzle_diameter / self.diameter,
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and the number of cells"
)]
fn nearest(value: f64) -> usize {
    value.round() as usize
}
