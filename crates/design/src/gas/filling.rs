//! Filling and venting over time: a supply, an orifice, and a muscle on a load (or a rigid vessel).
//!
//! ```text
//! dm/dt = m'(P_supply, P)                              orifice after ISO 6358, positive into the chamber
//! isothermal   P (V + Vd) = m R T,  T constant
//! adiabatic    dU = cp T_in dm - P dV + hA (Tw - T) dt,   U = m cv T
//!              dz/dt = (gamma - 1)(cp T_in m' + hA (Tw - T))/(P (V + Vd)),   z = ln(P (V + Vd)^gamma)
//! F(p, e) = load(e)                                    quasi-static; on a support e stays until F exceeds the load
//! ```
//! T_in is the temperature of the side that the air comes from. The state is z and m; P, V and e follow from z by one root, so that neither
//! balance needs a derivative of V, and with m' = 0 the law is that of [`ClosedMuscle`](super::ClosedMuscle). V is the volume that holds the gas.
//!
//! **The end.** m' has an infinite slope where the pressures meet, which they do after a finite time. Instead of the time t the integration variable is s with
//! dt = w ds, w = sqrt(1 - x^2), x = (ratio - b)/(1 - b): in s everything is regular (dm/ds = k w^2 = k (1 - x^2)). At w = 1e-3 (the pressures differ by
//! 5e-7 (1 - b)) the rest is taken in closed form: x = sin(theta), dtheta/dt constant but for terms of w^2. Nothing is smoothed. Where heat flows, the
//! pressures never quite meet and the flow follows the heat: from w = 1e-3 on the ratio of the pressures stays, and the flow is the one that keeps it.
//!
//! Steps end where the flow ceases to be choked and where the load leaves its support or comes back: between, all is smooth, and DOP853 keeps its order.
//!
//! The states of a muscle on its load are functions of the pressure alone. They are interpolated from equilibria to 1e-10, where that many agree.
//!
//! Left out: kinetic energy, heat conduction in the tube, inertia of the load, a supply vessel that changes its temperature (it keeps it).

mod end;
mod path;
mod run;

use serde::Serialize;

use super::chamber::Chamber;
use super::orifice::Orifice;
use super::{AMBIENT_TEMPERATURE_K, GasError, at_least, positive};

/// Where the air comes from, or goes to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Supply {
    /// At a constant gauge pressure: a compressor with a regulator, or the ambient.
    Constant {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
        /// Temperature \[K\].
        temperature_k: f64,
    },
    /// A vessel of this volume, whose pressure falls with what leaves it and whose temperature stays.
    Vessel {
        /// Gauge pressure at the start \[Pa\].
        pressure_pa: f64,
        /// Temperature \[K\].
        temperature_k: f64,
        /// Volume \[m^3\].
        volume_m3: f64,
    },
}

impl Supply {
    /// The ambient at 293.15 K: what a muscle is vented to.
    #[must_use]
    pub const fn ambient() -> Self {
        Self::Constant { pressure_pa: 0.0, temperature_k: AMBIENT_TEMPERATURE_K }
    }
}

/// What becomes of the temperature of the gas in the chamber.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum GasModel {
    /// It stays: slow changes.
    Isothermal,
    /// The balance of energy, with the walls taking part by hA (Tw - T).
    Adiabatic {
        /// Heat transfer coefficient times the wall's area \[W/K\] >= 0; 0 for no heat.
        heat_transfer_w_per_k: f64,
        /// Temperature of the wall \[K\].
        wall_temperature_k: f64,
    },
}

impl GasModel {
    /// No heat through the walls.
    #[must_use]
    pub const fn adiabatic() -> Self {
        Self::Adiabatic { heat_transfer_w_per_k: 0.0, wall_temperature_k: AMBIENT_TEMPERATURE_K }
    }
}

/// A chamber to be filled, or vented.
#[derive(Debug, Clone, Copy)]
pub struct Filling<'a> {
    /// What is filled: a muscle on its load, or a vessel.
    pub chamber: Chamber<'a>,
    /// What the air flows through.
    pub orifice: Orifice,
    /// Where it comes from, or goes to.
    pub supply: Supply,
    /// Isothermal, or with a balance of energy.
    pub gas: GasModel,
    /// Gauge pressure in the chamber at the start \[Pa\]; of a muscle >= 0.
    pub start_pressure_pa: f64,
    /// Temperature in the chamber at the start \[K\].
    pub start_temperature_k: f64,
    /// The longest time to compute \[s\].
    pub longest_s: f64,
    /// Samples at least, spread evenly over ln P (V + Vd)^n.
    pub samples: usize,
}

/// A moment of a filling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Time \[s\].
    pub time_s: f64,
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction; 0 for a vessel.
    pub contraction: f64,
    /// Pull of the muscle \[N\], less than the load on a support; 0 for a vessel.
    pub force_n: f64,
    /// Volume of the muscle or vessel \[m^3\], without the dead volume.
    pub volume_m3: f64,
    /// Mass of the gas, that in the dead volume included \[kg\].
    pub mass_kg: f64,
    /// Temperature of the gas \[K\].
    pub temperature_k: f64,
    /// Flow into the chamber \[kg/s\].
    pub flow_kg_per_s: f64,
}

/// What became of the energy, from the start to the end of a filling: work = enthalpy + heat - internal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Energy {
    /// Carried in by the air, integral of cp T_in dm \[J\]; negative when it flowed out.
    pub enthalpy_j: f64,
    /// Heat from the wall \[J\].
    pub heat_j: f64,
    /// Change of the internal energy \[J\].
    pub internal_j: f64,
    /// Work of the gas, integral of P dV: on the load, what stretches, and the atmosphere (p0 dV) \[J\].
    pub work_j: f64,
}

/// A filling over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct History {
    /// From the start to the end.
    pub samples: Vec<Sample>,
    /// Gauge pressure at which it ends \[Pa\]: that of a constant supply, else the last one.
    pub final_pressure_pa: f64,
    /// Time until 90 % of the change of pressure \[s\]; from the ambient that is 90 % of the final gauge pressure. None if not reached.
    pub time_90_s: Option<f64>,
    /// The same for 99 %.
    pub time_99_s: Option<f64>,
    /// Whether the flow has ended, and with heat the difference of temperatures too (1e-6 of it).
    pub settled: bool,
    /// Air that came in \[kg\], negative when it flowed out.
    pub air_kg: f64,
    /// Balance of energy; none when isothermal, where the wall gives whatever it takes.
    pub energy: Option<Energy>,
    /// Integration steps.
    pub steps: u32,
}

impl Filling<'_> {
    /// The time series.
    ///
    /// # Errors
    /// [`GasError::Number`] for numbers that can't be, [`GasError::Stopped`] where the muscle finds no equilibrium any more (with the reason), or the
    /// errors of [`Chamber::at`] at the start.
    pub fn run(&self) -> Result<History, GasError> {
        self.check()?;
        run::run(self)
    }

    fn check(&self) -> Result<(), GasError> {
        let ambient = self.chamber.ambient_pa();
        let absolute = "give one above minus the ambient pressure";
        let (Supply::Constant { pressure_pa, temperature_k }
        | Supply::Vessel { pressure_pa, temperature_k, .. }) = self.supply;
        for (what, p) in [
            ("the gauge pressure of the supply [Pa]", pressure_pa),
            ("the gauge pressure at the start [Pa]", self.start_pressure_pa),
        ] {
            if !(p.is_finite() && p > -ambient) {
                return Err(GasError::Number { what, value: p, instead: absolute });
            }
            if !self.chamber.is_vessel() {
                at_least(what, p, 0.0, "give one from 0 on: a muscle holds none below the ambient")?;
            }
        }
        positive("the temperature of the supply [K]", temperature_k)?;
        positive("the temperature at the start [K]", self.start_temperature_k)?;
        positive("the longest time [s]", self.longest_s)?;
        if let Supply::Vessel { volume_m3, .. } = self.supply {
            positive("the volume of the supply vessel [m^3]", volume_m3)?;
        }
        if let GasModel::Adiabatic { heat_transfer_w_per_k, wall_temperature_k } = self.gas {
            at_least(
                "the heat transfer [W/K]",
                heat_transfer_w_per_k,
                0.0,
                "give a finite number from 0 on",
            )?;
            positive("the temperature of the wall [K]", wall_temperature_k)?;
        }
        if !(2..=1_000_000).contains(&self.samples) {
            return Err(GasError::Number {
                what: "the number of samples",
                value: self.samples as f64,
                instead: "give 2 to 1000000",
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
