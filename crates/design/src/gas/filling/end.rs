//! The end of a filling: the last part before equal pressures, the energy balance, and the times to fractions
//! of the pressure.

use bulge_numerics::dop853::step;
use bulge_numerics::root::illinois;

use super::run::{Phase, Run, State, Track};
use super::{Energy, GasModel, History, Supply};
use crate::gas::{CP_AIR, GAMMA, GasError};

impl Run<'_> {
    /// Completes the filling in closed form from w = 1e-3 or less to equal pressures, and tells whether the
    /// time suffices.
    ///
    /// ```text
    /// x = sin(theta),   dtheta/dt = |k| dx/dm,   dx/dm = (1 - x)/|dm|
    /// ```
    pub(super) fn meet(&self, y: &mut State, phase: Phase, track: &mut Track) -> Result<bool, GasError> {
        let now = self.moment(y, phase)?;
        let entering = if phase.inward { self.supply_k } else { now.temperature };
        let with = |part: f64| {
            let z = match self.filling.gas {
                GasModel::Isothermal => y[0] + (part / y[1]).ln_1p(),
                GasModel::Adiabatic { .. } => {
                    y[0] + (GAMMA - 1.0) * CP_AIR * entering * part
                        / (now.pressure * now.inside.gas_volume_m3)
                }
            };
            [z, y[1] + part, y[2], y[3], y[4] + CP_AIR * entering * part]
        };
        let gap = |part: f64| {
            let there = self.moment(&with(part), phase)?;
            Ok::<_, GasError>((there.pressure / there.supply).ln())
        };
        // Over such a small part the gap is almost linear in the mass.
        let (mut last, mut part) = (0.0, -gap(0.0)? * y[1]);
        let mut before = gap(0.0)?;
        for _ in 0..8 {
            let here = gap(part)?;
            let next = part - here * (part - last) / (here - before);
            if !next.is_finite() || here.abs() < 1e-15 {
                break;
            }
            (last, before, part) = (part, here, next);
        }
        // The remaining angle pi/2 - theta, divided by dtheta/dt = |k| (1 - x)/|dm|.
        let opening = 1.0 - now.x;
        let time = if opening > 0.0 {
            (opening * (1.0 + now.x)).sqrt().atan2(now.x) * part.abs() / (now.choked.abs() * opening)
        } else {
            0.0
        };
        if y[2] + time > self.filling.longest_s {
            return Ok(false);
        }
        *y = with(part);
        y[2] += time;
        let mut end = self.sample(y, phase)?;
        // The pressures are equal, so the flow is exactly 0.
        end.flow_kg_per_s = 0.0;
        track.samples.push(end);
        Ok(true)
    }

    pub(super) fn history(
        &self,
        y: &State,
        track: &Track,
        settled: bool,
        steps: u32,
    ) -> Result<History, GasError> {
        let filling = self.filling;
        let first = filling.start_pressure_pa;
        let last = track.samples.last().map_or(first, |sample| sample.pressure_pa);
        // For a vessel, the final pressure is known only when it is reached.
        let (final_pressure_pa, known) = match filling.supply {
            Supply::Constant { pressure_pa, .. } => (pressure_pa, true),
            Supply::Vessel { .. } => (last, settled),
        };
        let time = |part: f64| {
            let target = first + part * (final_pressure_pa - first);
            if known { self.time_of(target, track) } else { Ok(None) }
        };
        let energy = match filling.gas {
            GasModel::Isothermal => None,
            GasModel::Adiabatic { .. } => Some(self.energy(y, track)?),
        };
        Ok(History {
            final_pressure_pa,
            time_90_s: time(0.9)?,
            time_99_s: time(0.99)?,
            settled,
            air_kg: y[1] - self.start_mass,
            energy,
            steps,
            samples: track.samples.clone(),
        })
    }

    fn energy(&self, y: &State, track: &Track) -> Result<Energy, GasError> {
        let chamber = &self.filling.chamber;
        let stored = |p: f64, volume: f64| (p + chamber.ambient_pa()) * volume / (GAMMA - 1.0);
        let start = chamber.at(self.filling.start_pressure_pa)?;
        let end = match track.pieces.last() {
            Some((_, phase, _)) => self.inside(y[0], phase.resting)?,
            None => start,
        };
        let internal_j =
            stored(end.pressure_pa, end.gas_volume_m3) - stored(start.pressure_pa, start.gas_volume_m3);
        let (heat_j, enthalpy_j) = (y[3], y[4]);
        Ok(Energy { enthalpy_j, heat_j, internal_j, work_j: enthalpy_j + heat_j - internal_j })
    }

    /// Time at which a gauge pressure is first passed.
    fn time_of(&self, target: f64, track: &Track) -> Result<Option<f64>, GasError> {
        let rounding = 1e-12 * (target + self.filling.chamber.ambient_pa());
        if track.samples.first().is_some_and(|sample| (sample.pressure_pa - target).abs() <= rounding) {
            return Ok(Some(0.0));
        }
        for (i, pair) in track.samples.windows(2).enumerate() {
            let [from, to] = [pair[0].pressure_pa - target, pair[1].pressure_pa - target];
            if from * to > 0.0 {
                continue;
            }
            let Some((before, phase, h)) = track.pieces.get(i) else {
                let part = if (from - to).abs() > 0.0 { from / (from - to) } else { 0.0 };
                return Ok(Some(pair[0].time_s + part * (pair[1].time_s - pair[0].time_s)));
            };
            let slope = self.rates(before, *phase)?;
            let at = |h: f64| step(&mut |y: &State| self.right_hand_side(y, *phase), before, &slope, h);
            let value = |h: f64| {
                self.inside(at(h)[0], phase.resting).map_or(f64::NAN, |inside| inside.pressure_pa - target)
            };
            return Ok(Some(at(illinois(value, 0.0, *h, 1e-14 * h))[2]));
        }
        Ok(None)
    }
}
