//! One cycle of charging and discharging, and its balances.

use super::gas::{GAMMA, R};
use super::mesh::{Conductances, Instant, Mesh};
use super::state::{Chain, Outside, State};
use super::step::{Step, Stepper};
use super::{HeatError, HeatProblem, HeatProfile};

/// Molar gas constant \[J/(mol K)\], exact in the SI.
const MOLAR: f64 = 8.314_462_618;

/// Means and maxima over a cycle, for the cells of the muscle or of the pipe.
#[derive(Debug, Clone, Default)]
pub(super) struct Figures {
    pub wall_mean: Vec<f64>,
    pub wall_max: Vec<f64>,
    gas_mean: Vec<f64>,
    gas_max: Vec<f64>,
    ageing: Vec<f64>,
}

impl Figures {
    fn new(n: usize) -> Self {
        let zero = vec![0.0; n];
        Self {
            wall_mean: zero.clone(),
            wall_max: zero.clone(),
            gas_mean: zero.clone(),
            gas_max: zero.clone(),
            ageing: zero,
        }
    }

    fn add(&mut self, chain: &Chain, weight: f64, ageing: impl Fn(f64) -> f64) {
        for (i, (gas, wall)) in chain.gas.iter().zip(&chain.wall).enumerate() {
            self.wall_mean[i] += weight * wall;
            self.gas_mean[i] += weight * gas;
            self.ageing[i] += weight * ageing(*wall);
            self.wall_max[i] = self.wall_max[i].max(*wall);
            self.gas_max[i] = self.gas_max[i].max(*gas);
        }
    }

    /// Converts the figures into the public profile.
    pub(super) fn profile(self, x: &[f64]) -> HeatProfile {
        HeatProfile {
            x_m: x[..self.wall_mean.len()].to_vec(),
            wall_mean_k: self.wall_mean,
            wall_max_k: self.wall_max,
            gas_mean_k: self.gas_mean,
            gas_max_k: self.gas_max,
            ageing_factor: self.ageing,
        }
    }
}

/// Totals of a cycle.
#[derive(Debug, Clone, Default)]
pub(super) struct Tally {
    pub muscle: Figures,
    pub pipe: Figures,
    /// For each cell of the muscle's and of the pipe's wall: the mean conductance to the gas times the
    /// period, divided by the capacity.
    pub exchange: [Vec<f64>; 2],
    pub mass: f64,
    pub enthalpy: f64,
    pub heat: f64,
    pub work: f64,
    pub peak_mach: f64,
}

/// Runs cycles of one problem.
#[derive(Debug)]
pub(super) struct Runner<'a> {
    pub problem: &'a HeatProblem,
    pub mesh: Mesh,
    pub state: State,
    /// Cycles computed.
    pub cycles: usize,
    stepper: Stepper,
    conductances: Conductances,
}

impl<'a> Runner<'a> {
    /// Starts with everything at the ambient temperature.
    pub(super) fn new(problem: &'a HeatProblem) -> Self {
        let mesh = Mesh::new(problem);
        let ambient = problem.surroundings.ambient_k;
        let state = State::uniform(&mesh, problem.instant(0.0), ambient, ambient);
        Self {
            problem,
            mesh,
            state,
            cycles: 0,
            stepper: Stepper::default(),
            conductances: Conductances::default(),
        }
    }

    /// Advances the state by one cycle.
    pub(super) fn cycle(&mut self) -> Result<Tally, HeatError> {
        let (problem, mesh, c) = (self.problem, &self.mesh, &mut self.conductances);
        let (ambient, supply) = (problem.surroundings.ambient_k, problem.surroundings.supply_k);
        let steps = problem.numerics.steps_per_cycle;
        let (weight, dt) = (1.0 / steps as f64, problem.drive.period_s / steps as f64);
        let temperature = problem.activation_energy_j_per_mol / MOLAR;
        let ageing = |wall: f64| (temperature * (ambient.recip() - wall.recip())).exp();
        let mut tally = Tally {
            muscle: Figures::new(mesh.x.len()),
            pipe: Figures::new(mesh.pipe_cells),
            exchange: [vec![0.0; mesh.x.len()], vec![0.0; mesh.pipe_cells]],
            ..Tally::default()
        };
        let mut from = problem.instant(0.0);
        for step in 1..=steps {
            let to = problem.instant(step as f64 * weight);
            mesh.conductances(problem, &self.state, from, c);
            let exchange = self
                .stepper
                .step(
                    Step { mesh, conductances: c, outside: Outside { ambient, supply }, from, to, dt },
                    &mut self.state,
                )
                .map_err(|_| {
                    let time_s = step as f64 * dt;
                    HeatError::NotConverged(format!(
                        "the step of the gas at {time_s} s in the cycle doesn't converge with {steps} steps in a cycle; take more"
                    ))
                })?;
            tally.muscle.add(&self.state.muscle, weight, ageing);
            tally.pipe.add(&self.state.pipe, weight, ageing);
            tally.mass += exchange.mass;
            tally.enthalpy += exchange.enthalpy;
            tally.heat += exchange.heat;
            tally.work += exchange.work;
            tally.add_exchange(mesh, c, dt);
            tally.peak_mach = tally.peak_mach.max(mach(mesh, &self.state, to, supply));
            from = to;
        }
        self.cycles += 1;
        if tally.peak_mach >= 1.0 {
            return Err(HeatError::Choked { mach: tally.peak_mach });
        }
        Ok(tally)
    }

    /// Temperatures of muscle gas, muscle wall, pipe gas, pipe wall.
    pub(super) fn temperatures(&self) -> Vec<f64> {
        let State { muscle, pipe } = &self.state;
        [&muscle.gas, &muscle.wall, &pipe.gas, &pipe.wall].into_iter().flatten().copied().collect()
    }

    /// Sets these temperatures at the start of a cycle.
    pub(super) fn set_temperatures(&mut self, values: &[f64]) {
        let (start, n) = (self.problem.instant(0.0), self.mesh.x.len());
        let State { muscle, pipe } = &mut self.state;
        let mut rest = values;
        for list in [&mut muscle.gas, &mut muscle.wall, &mut pipe.gas, &mut pipe.wall] {
            let (these, others) = rest.split_at(list.len());
            list.copy_from_slice(these);
            rest = others;
        }
        for i in 0..n {
            muscle.mass[i] = start.pressure * self.mesh.volume(i, start.section) / (R * muscle.gas[i]);
        }
        for (i, mass) in pipe.mass.iter_mut().enumerate() {
            *mass = start.pressure * self.mesh.pipe_volume[i] / (R * pipe.gas[i]);
        }
    }
}

impl Tally {
    fn add_exchange(&mut self, mesh: &Mesh, c: &Conductances, dt: f64) {
        for (i, sum) in self.exchange[0].iter_mut().enumerate() {
            *sum += dt * c.wall[i] / mesh.wall_capacity[i];
        }
        for (i, sum) in self.exchange[1].iter_mut().enumerate() {
            *sum += dt * (c.pipe_inner[i] + c.pipe_outer[i]) / mesh.pipe_capacity[i];
        }
    }
}

/// Largest Mach number at both ends of the pipe, or in the port.
pub(super) fn mach(mesh: &Mesh, state: &State, now: Instant, supply: f64) -> f64 {
    let chain = if mesh.pipe_cells > 0 { &state.pipe } else { &state.muscle };
    let at =
        |flow: f64, gas: f64| mesh.nozzle_speed(flow.abs(), gas, now.pressure) / (GAMMA * R * gas).sqrt();
    let first = chain.flow[0];
    let inlet = at(first, if first > 0.0 { supply } else { chain.gas[0] });
    match (state.pipe.flow.last(), state.pipe.gas.last()) {
        (Some(flow), Some(gas)) => inlet.max(at(*flow, *gas)),
        _ => inlet,
    }
}
