//! Filling and venting over time, with a supply, an orifice, and a muscle on a load (or a rigid vessel).
//!
//! ```text
//! dm/dt = m'(P_supply, P)                              orifice after ISO 6358, positive into the chamber
//! isothermal   P (V + Vd) = m R T,  T constant
//! adiabatic    dU = cp T_in dm - P dV + hA (Tw - T) dt,   U = m cv T
//!              dz/dt = (gamma - 1)(cp T_in m' + hA (Tw - T))/(P (V + Vd)),   z = ln(P (V + Vd)^gamma)
//! F(p, e) = load(e)                                    quasi-static; on a support e stays until F exceeds the load
//! ```
//! T_in is the temperature of the side from which the air comes. The state consists of z and m. P, V and e
//! follow from z by finding one root, so that neither balance needs a derivative of V. With m' = 0 the law is
//! that of [`ClosedMuscle`](super::ClosedMuscle). V is the volume that the gas fills.
//!
//! **The end.** The pressures become equal after a finite time, and the slope of m' is infinite there. The
//! integration variable is therefore s instead of the time t, with dt = w ds, w = sqrt(1 - x^2) and x =
//! (ratio - b)/(1 - b). All functions of s are regular (dm/ds = k w^2 = k (1 - x^2)). At w = 1e-3, where the
//! pressures differ by 5e-7 (1 - b), the rest is taken in closed form: x = sin(theta), with dtheta/dt
//! constant except for terms of w^2. Nothing is smoothed. With heat flow the pressures never become quite
//! equal, and the flow follows the heat: from w = 1e-3 on, the ratio of the pressures is constant, and the
//! flow is the one that keeps it constant.
//!
//! Steps end where the flow ceases to be choked, and where the load leaves its support or returns to it.
//! Between these events all functions are smooth, and DOP853 keeps its order.
//!
//! The states of a muscle on its load depend only on the pressure. They are interpolated between equilibria
//! to 1e-10 where this accuracy is reached.
//!
//! Neglected: kinetic energy, heat conduction in the tube, inertia of the load, and changes of temperature in
//! a supply vessel.

mod end;
mod path;
mod run;

use serde::Serialize;

use super::chamber::Chamber;
use super::orifice::Orifice;
use super::{AMBIENT_TEMPERATURE_K, GasError, at_least, positive};

/// Source or sink of the air.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Supply {
    /// Constant gauge pressure: a compressor with a regulator, or the ambient.
    Constant {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
        /// Temperature \[K\].
        temperature_k: f64,
    },
    /// A vessel of constant temperature whose pressure falls as air leaves it.
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
    /// The ambient at 293.15 K, into which a muscle is vented.
    #[must_use]
    pub const fn ambient() -> Self {
        Self::Constant { pressure_pa: 0.0, temperature_k: AMBIENT_TEMPERATURE_K }
    }
}

/// Model for the temperature of the gas in the chamber.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum GasModel {
    /// Constant temperature, for slow changes.
    Isothermal,
    /// Energy balance with the heat hA (Tw - T) from the walls.
    Adiabatic {
        /// Heat transfer coefficient times the area of the wall \[W/K\] >= 0; 0 for no heat.
        heat_transfer_w_per_k: f64,
        /// Temperature of the wall \[K\].
        wall_temperature_k: f64,
    },
}

impl GasModel {
    /// Energy balance without heat from the walls.
    #[must_use]
    pub const fn adiabatic() -> Self {
        Self::Adiabatic { heat_transfer_w_per_k: 0.0, wall_temperature_k: AMBIENT_TEMPERATURE_K }
    }
}

/// Filling or venting of a chamber.
#[derive(Debug, Clone, Copy)]
pub struct Filling<'a> {
    /// The chamber: a muscle on its load, or a vessel.
    pub chamber: Chamber<'a>,
    /// Orifice through which the air flows.
    pub orifice: Orifice,
    /// Source or sink of the air.
    pub supply: Supply,
    /// Isothermal model, or energy balance.
    pub gas: GasModel,
    /// Gauge pressure in the chamber at the start \[Pa\]; >= 0 for a muscle.
    pub start_pressure_pa: f64,
    /// Temperature in the chamber at the start \[K\].
    pub start_temperature_k: f64,
    /// Longest computed time \[s\].
    pub longest_s: f64,
    /// Least number of samples, spread evenly over ln P (V + Vd)^n.
    pub samples: usize,
}

/// State at one time of a filling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Time \[s\].
    pub time_s: f64,
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction; 0 for a vessel.
    pub contraction: f64,
    /// Pull of the muscle \[N\], which is less than the load while that is on a support; 0 for a vessel.
    pub force_n: f64,
    /// Volume of the muscle or vessel \[m^3\], without the dead volume.
    pub volume_m3: f64,
    /// Mass of the gas including the dead volume \[kg\].
    pub mass_kg: f64,
    /// Temperature of the gas \[K\].
    pub temperature_k: f64,
    /// Flow into the chamber \[kg/s\].
    pub flow_kg_per_s: f64,
}

/// Energy balance of a filling from start to end: work = enthalpy + heat - internal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Energy {
    /// Enthalpy of the incoming air, integral of cp T_in dm \[J\]; negative for outgoing air.
    pub enthalpy_j: f64,
    /// Heat from the wall \[J\].
    pub heat_j: f64,
    /// Change of the internal energy \[J\].
    pub internal_j: f64,
    /// Work of the gas, integral of P dV \[J\]: on the load, on stretched parts, and on the atmosphere (p0
    /// dV).
    pub work_j: f64,
}

/// Time history of a filling.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct History {
    /// Samples from the start to the end.
    pub samples: Vec<Sample>,
    /// Final gauge pressure \[Pa\]: that of a constant supply, otherwise the last one.
    pub final_pressure_pa: f64,
    /// Time until 90 % of the change of pressure \[s\]. If the filling starts from the ambient, that is 90 %
    /// of the final gauge pressure. None if not reached.
    pub time_90_s: Option<f64>,
    /// Time until 99 % of the change of pressure \[s\].
    pub time_99_s: Option<f64>,
    /// Whether the flow has ended, and with heat also the difference of temperatures (to 1e-6 of the
    /// wall temperature).
    pub settled: bool,
    /// Mass of air that came in \[kg\]; negative if it flowed out.
    pub air_kg: f64,
    /// Energy balance; none for the isothermal model, in which the wall supplies any heat.
    pub energy: Option<Energy>,
    /// Number of integration steps.
    pub steps: u32,
}

impl Filling<'_> {
    /// Computes the time history.
    ///
    /// # Errors
    /// [`GasError::Number`] for impossible numbers, [`GasError::Stopped`] with the reason if the muscle no
    /// longer has an equilibrium, or the errors of [`Chamber::at`] at the start.
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
                return Err(GasError::number(what, p, absolute));
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
            return Err(GasError::number("the number of samples", self.samples as f64, "give 2 to 1000000"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
