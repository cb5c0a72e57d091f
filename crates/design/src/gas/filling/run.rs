//! The integration of a filling: phases, events between them, the end, and the times to fractions of the
//! pressure.

use std::cell::{Cell, RefCell};

use bulge_numerics::dop853::{Dop853, step};
use bulge_numerics::root::illinois;

use super::path::Path;
use super::{Filling, GasModel, History, Sample, Supply};
use crate::gas::chamber::{Inside, with_gas};
use crate::gas::{CP_AIR, GAMMA, GasError, R_AIR};

/// Local error of a step relative to the scales of the state.
const TOLERANCE: f64 = 1e-11;
/// Value of w^2 from which the rest is taken in closed form.
const END: f64 = 1e-6;
/// Relative temperature difference below which wall and gas count as equally warm.
const AS_WARM: f64 = 1e-6;
/// Most failed rates within a step; they suffice to shorten it ten times.
const MOST_FAILURES: u32 = 150;
/// Fraction of the time of the filling below which a step is too small.
const LEAST_STEP: f64 = 1e-7;
/// Most steps and events before an error is assumed.
const MOST_STEPS: usize = 2_000_000;

/// z = ln(P (V + Vd)^n), mass, time, heat from the wall, and incoming enthalpy.
pub(super) type State = [f64; 5];

/// Conditions that stay the same during a phase of the integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    flow: Flow,
    /// Whether the load is on the support.
    pub(super) resting: bool,
    /// Whether the flow is from the supply into the chamber.
    pub(super) inward: bool,
}

/// Regime of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Flow {
    Choked,
    Subsonic,
    /// Flow controlled by the heat. The integration variable is the time.
    Slow,
}

/// Event that ends a phase.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Choking,
    Contact,
    Met,
    AsWarm,
    Time,
}

/// A state in the quantities of the equations. Pressures are absolute.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) inside: Inside,
    pub(super) pressure: f64,
    pub(super) temperature: f64,
    pub(super) supply: f64,
    pub(super) x: f64,
    /// Choked flow with its sign.
    pub(super) choked: f64,
}

pub(super) struct Run<'a> {
    pub(super) filling: &'a Filling<'a>,
    path: Path<'a>,
    exponent: f64,
    pub(super) supply_k: f64,
    pub(super) start_mass: f64,
    /// Scales of mass, time and energy.
    scales: State,
    /// Last gauge pressure, from which the next search starts.
    near: Cell<f64>,
    reason: RefCell<Option<String>>,
    failures: Cell<u32>,
}

pub(super) struct Track {
    pub(super) samples: Vec<Sample>,
    /// Start, phase and step of each piece between samples.
    pub(super) pieces: Vec<(State, Phase, f64)>,
}

pub(super) fn run(filling: &Filling<'_>) -> Result<History, GasError> {
    let chamber = &filling.chamber;
    let inside = chamber.at(filling.start_pressure_pa)?;
    let pressure = inside.pressure_pa + chamber.ambient_pa();
    let (exponent, enters) = match filling.gas {
        GasModel::Isothermal => (1.0, filling.start_temperature_k),
        GasModel::Adiabatic { .. } => (GAMMA, filling.start_temperature_k),
    };
    let z = pressure.ln() + exponent * inside.gas_volume_m3.ln();
    let mass = pressure * inside.gas_volume_m3 / (R_AIR * enters);
    let (Supply::Constant { pressure_pa, temperature_k } | Supply::Vessel { pressure_pa, temperature_k, .. }) =
        filling.supply;
    let supply = pressure_pa + chamber.ambient_pa();
    let most = mass.max(supply * inside.gas_volume_m3 / (R_AIR * temperature_k));
    let flow = filling.orifice.choked_flow(supply.max(pressure), temperature_k.max(enters));
    let energy = CP_AIR * most * temperature_k.max(enters);
    let run = Run {
        filling,
        path: Path::new(chamber, supply.max(pressure) - chamber.ambient_pa()),
        exponent,
        supply_k: temperature_k,
        start_mass: mass,
        scales: [1.0, most, most / flow, energy, energy],
        near: Cell::new(inside.pressure_pa),
        reason: RefCell::new(None),
        failures: Cell::new(0),
    };
    let resting = chamber.rests(filling.start_pressure_pa)?;
    let mut phase = Phase { flow: Flow::Subsonic, resting, inward: supply > pressure };
    let mut y = [z, mass, 0.0, 0.0, 0.0];
    let start = run.moment(&y, phase)?;
    phase.flow = if start.x < 0.0 { Flow::Choked } else { Flow::Subsonic };
    let mut track = Track { samples: vec![run.sample(&y, phase)?], pieces: Vec::new() };
    let span = ((supply / pressure).ln().abs() / filling.samples as f64).max(1e-9);
    let mut steps = 0;
    let mut settled = false;
    if supply.to_bits() != pressure.to_bits() {
        let mut end = (start.x * start.x > 1.0 - END && start.x > 0.0).then_some(Event::Met);
        if end.is_none() {
            end = Some(run.integrate(&mut y, &mut phase, &mut track, span, &mut steps)?);
        }
        // Without heat the rest has a closed form; with heat, the slow phase follows.
        if end == Some(Event::Met) && !run.has_heat() {
            settled = run.meet(&mut y, phase, &mut track)?;
        }
    }
    if !settled && run.has_heat() && y[2] < filling.longest_s {
        phase = Phase { flow: Flow::Slow, ..phase };
        settled = run.integrate(&mut y, &mut phase, &mut track, span, &mut steps)? == Event::AsWarm;
    } else if supply.to_bits() == pressure.to_bits() {
        settled = true;
    }
    run.history(&y, &track, settled, steps)
}

impl Run<'_> {
    fn has_heat(&self) -> bool {
        matches!(self.filling.gas, GasModel::Adiabatic { heat_transfer_w_per_k, .. } if heat_transfer_w_per_k > 0.0)
    }

    /// Heat flow from the wall \[W\].
    fn heat(&self, temperature: f64) -> f64 {
        match self.filling.gas {
            GasModel::Isothermal => 0.0,
            GasModel::Adiabatic { heat_transfer_w_per_k, wall_temperature_k } => {
                heat_transfer_w_per_k * (wall_temperature_k - temperature)
            }
        }
    }

    /// Absolute pressure of the supply when the chamber holds the given mass.
    fn supply(&self, mass: f64) -> f64 {
        let ambient = self.filling.chamber.ambient_pa();
        match self.filling.supply {
            Supply::Constant { pressure_pa, .. } => pressure_pa + ambient,
            Supply::Vessel { pressure_pa, temperature_k, volume_m3 } => {
                pressure_pa + ambient - (mass - self.start_mass) * R_AIR * temperature_k / volume_m3
            }
        }
    }

    pub(super) fn inside(&self, z: f64, resting: bool) -> Result<Inside, GasError> {
        let found = with_gas(
            |p| self.path.inside(p, resting),
            self.filling.chamber.ambient_pa(),
            [z, self.exponent],
            self.near.get(),
        )?;
        self.near.set(found.pressure_pa);
        Ok(found)
    }

    pub(super) fn moment(&self, y: &State, phase: Phase) -> Result<Moment, GasError> {
        let inside = self.inside(y[0], phase.resting)?;
        let pressure = inside.pressure_pa + self.filling.chamber.ambient_pa();
        let temperature = match self.filling.gas {
            GasModel::Isothermal => self.filling.start_temperature_k,
            GasModel::Adiabatic { .. } => pressure * inside.gas_volume_m3 / (y[1] * R_AIR),
        };
        let supply = self.supply(y[1]);
        let orifice = &self.filling.orifice;
        let (ratio, choked) = if phase.inward {
            (pressure / supply, orifice.choked_flow(supply, self.supply_k))
        } else {
            (supply / pressure, -orifice.choked_flow(pressure, temperature))
        };
        Ok(Moment { inside, pressure, temperature, supply, x: orifice.opening(ratio), choked })
    }

    /// Derivatives with respect to s; in the slow phase, with respect to time.
    pub(super) fn rates(&self, y: &State, phase: Phase) -> Result<State, GasError> {
        let now = self.moment(y, phase)?;
        let heat = self.heat(now.temperature);
        let stored = now.pressure * now.inside.gas_volume_m3;
        let (mass, time, entering) = if phase.flow == Flow::Slow {
            let entering = if heat > 0.0 { now.temperature } else { self.supply_k };
            (self.flow_with_heat(&now, phase, heat, entering)?, 1.0, entering)
        } else {
            let w2 = if phase.flow == Flow::Choked { 1.0 } else { (1.0 - now.x) * (1.0 + now.x) };
            let entering = if phase.inward { self.supply_k } else { now.temperature };
            (now.choked * w2, w2.max(0.0).sqrt(), entering)
        };
        let enthalpy = CP_AIR * entering * mass;
        let z = match self.filling.gas {
            GasModel::Isothermal => mass / y[1],
            GasModel::Adiabatic { .. } => (GAMMA - 1.0) * (enthalpy + heat * time) / stored,
        };
        Ok([z, mass, time, heat * time, enthalpy])
    }

    /// Flow that keeps the ratio of the pressures constant while heat flows.
    ///
    /// ```text
    /// (gamma - 1)(cp T_in m' + Q)/(P V) = (1 + gamma dlnV/dlnP) dlnP/dt,     dlnP/dt = dlnPs/dt = -m' R Ts/(Vs Ps)
    /// ```
    fn flow_with_heat(&self, now: &Moment, phase: Phase, heat: f64, entering: f64) -> Result<f64, GasError> {
        let stored = now.pressure * now.inside.gas_volume_m3 / (GAMMA - 1.0);
        let mut per_flow = CP_AIR * entering / stored;
        if let Supply::Vessel { temperature_k, volume_m3, .. } = self.filling.supply {
            let h = 1e-4;
            let volume = |factor: f64| {
                let gauge = now.pressure * factor - self.filling.chamber.ambient_pa();
                Ok::<_, GasError>(self.path.inside(gauge, phase.resting)?.gas_volume_m3.ln())
            };
            let growth = (volume(1.0 + h)? - volume(1.0 - h)?) / (2.0 * h);
            per_flow += (1.0 + GAMMA * growth) * R_AIR * temperature_k / (volume_m3 * now.supply);
        }
        Ok(-heat / stored / per_flow)
    }

    pub(super) fn sample(&self, y: &State, phase: Phase) -> Result<Sample, GasError> {
        let now = self.moment(y, phase)?;
        let flow = if phase.flow == Flow::Slow {
            self.rates(y, phase)?[1]
        } else {
            let x = now.x.clamp(0.0, 1.0);
            now.choked * ((1.0 - x) * (1.0 + x)).sqrt()
        };
        Ok(Sample {
            time_s: y[2],
            pressure_pa: now.inside.pressure_pa,
            contraction: now.inside.contraction,
            force_n: now.inside.force_n,
            volume_m3: now.inside.volume_m3,
            mass_kg: y[1],
            temperature_k: now.temperature,
            flow_kg_per_s: flow,
        })
    }

    /// Rates for the integrator. They are NaN where there is no equilibrium, so that it shortens its step. If
    /// only the end of a step has none, this doesn't shorten the step. After some failures the rates are
    /// therefore numbers again, so that the step returns and the filling ends.
    pub(super) fn right_hand_side(&self, y: &State, phase: Phase) -> State {
        self.rates(y, phase).unwrap_or_else(|error| {
            *self.reason.borrow_mut() = Some(error.to_string());
            self.failures.set(self.failures.get() + 1);
            if self.failures.get() > MOST_FAILURES { [f64::MAX; 5] } else { [f64::NAN; 5] }
        })
    }

    /// Event function: negative before the event, positive after it.
    fn event(&self, event: Event, y: &State, phase: Phase) -> Result<f64, GasError> {
        let now = self.moment(y, phase)?;
        Ok(match event {
            Event::Choking if phase.flow == Flow::Choked => now.x,
            Event::Choking => -now.x - 1e-9,
            Event::Contact => {
                match (self.filling.chamber.load_on_support(), self.filling.chamber.support()) {
                    (Some(load), _) if phase.resting => now.inside.force_n - load,
                    (_, Some(support)) => support - now.inside.contraction - 1e-9,
                    (_, None) => -1.0,
                }
            }
            Event::Met => END - (1.0 - now.x) * (1.0 + now.x),
            Event::AsWarm => match self.filling.gas {
                GasModel::Isothermal => 1.0,
                GasModel::Adiabatic { wall_temperature_k, .. } => {
                    AS_WARM * wall_temperature_k - (now.temperature - wall_temperature_k).abs()
                }
            },
            Event::Time => y[2] - self.filling.longest_s,
        })
    }

    /// Integrates through the phases until the pressures are equal, wall and gas are equally warm, or the
    /// time is over.
    fn integrate(
        &self,
        y: &mut State,
        phase: &mut Phase,
        track: &mut Track,
        span: f64,
        steps: &mut u32,
    ) -> Result<Event, GasError> {
        let mut integrator = Dop853::new(1e-4 * self.scales[2], TOLERANCE);
        for _ in 0..MOST_STEPS {
            let now = *phase;
            let mut f = |y: &State| self.right_hand_side(y, now);
            let mut slope = f(y);
            let limit = if now.flow == Flow::Slow {
                (self.filling.longest_s - y[2]).min(self.filling.longest_s / self.filling.samples as f64)
            } else {
                span / slope[0].abs().max(span / self.filling.longest_s.max(self.scales[2]))
            };
            if now.flow == Flow::Slow && limit <= 0.0 {
                return Ok(Event::Time);
            }
            let before = *y;
            let scales = self.scales;
            *self.reason.borrow_mut() = None;
            self.failures.set(0);
            let taken = integrator.advance(&mut f, |_, _| scales, y, &mut slope, limit);
            let mut h = taken.map_err(|stalled| self.stopped(&before, now, &stalled.to_string()))?;
            *steps += 1;
            if self.failures.get() > MOST_FAILURES {
                return Err(self.stopped(&before, now, ""));
            }
            // A step is this small only because there are no equilibria beyond it.
            if h < LEAST_STEP * self.scales[2] && self.reason.borrow().is_some() {
                return Err(self.stopped(y, now, ""));
            }
            let first = self.first_event(&before, y, &mut h, now)?;
            track.pieces.push((before, now, h));
            track.samples.push(self.sample(y, now)?);
            match first {
                Some(Event::Choking) => {
                    phase.flow = if now.flow == Flow::Choked { Flow::Subsonic } else { Flow::Choked };
                }
                Some(Event::Contact) => phase.resting = !phase.resting,
                Some(end) => return Ok(end),
                None => {}
            }
        }
        Err(self.stopped(y, *phase, "too many steps: the orifice is far too large or too small for the time"))
    }

    /// The first event in a step. State and step are then reset to it.
    fn first_event(
        &self,
        before: &State,
        y: &mut State,
        h: &mut f64,
        phase: Phase,
    ) -> Result<Option<Event>, GasError> {
        let candidates: &[Event] = match phase.flow {
            Flow::Slow => &[Event::Contact, Event::AsWarm],
            Flow::Choked => &[Event::Choking, Event::Contact, Event::Time],
            Flow::Subsonic => &[Event::Choking, Event::Contact, Event::Met, Event::Time],
        };
        let mut f = |y: &State| self.right_hand_side(y, phase);
        let mut first = None;
        for event in candidates {
            // Each event shortens the step, so that only an earlier one can replace it.
            if self.event(*event, y, phase)? > 0.0 {
                let slope = f(before);
                let value = |part: f64| {
                    let there = step(&mut |y: &State| self.right_hand_side(y, phase), before, &slope, part);
                    self.event(*event, &there, phase).unwrap_or(f64::NAN)
                };
                *h = illinois(value, 0.0, *h, 1e-14 * *h);
                *y = step(&mut f, before, &slope, *h);
                first = Some(*event);
            }
        }
        Ok(first)
    }

    fn stopped(&self, y: &State, phase: Phase, otherwise: &str) -> GasError {
        let pressure_pa =
            self.inside(y[0], phase.resting).map_or(self.near.get(), |inside| inside.pressure_pa);
        let reason = self.reason.borrow_mut().take().unwrap_or_else(|| otherwise.to_owned());
        GasError::Stopped { time_s: y[2], pressure_pa, reason }
    }
}
