//! Inputs of the heat model: muscle, pipe, pressure, surroundings, closures, numerics.

use super::mesh::Instant;
use serde::Serialize;

/// The muscle as a tube.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tube {
    /// Length L \[m\].
    pub length_m: f64,
    /// Inner diameter D \[m\].
    pub inner_diameter_m: f64,
    /// Thickness of the wall \[m\].
    pub wall_thickness_m: f64,
    /// Conductivity of the wall \[W/(m K)\]; rubber 0.13 to 0.25.
    pub wall_conductivity_w_per_m_k: f64,
    /// Volumetric heat capacity of the wall \[J/(m3 K)\]; rubber 1.7e6 to 2.2e6.
    pub wall_heat_capacity_j_per_m3_k: f64,
    /// Diameter of the port through which the muscle is charged without a pipe \[m\], at most D.
    pub port_diameter_m: f64,
    /// Increase of the section from the low to the high pressure, as a fraction of the section at the low
    /// one; 0 is isometric. It is linear in the pressure.
    pub swelling: f64,
}

impl Default for Tube {
    fn default() -> Self {
        Self {
            length_m: 0.25,
            inner_diameter_m: 0.02,
            wall_thickness_m: 0.0015,
            wall_conductivity_w_per_m_k: 0.16,
            wall_heat_capacity_j_per_m3_k: 2.0e6,
            port_diameter_m: 0.006,
            swelling: 0.0,
        }
    }
}

/// A pipe from the inlet into the muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pipe {
    /// Length Lp \[m\], less than that of the muscle.
    pub length_m: f64,
    /// Inner diameter d \[m\].
    pub inner_diameter_m: f64,
    /// Thickness of its wall \[m\].
    pub wall_thickness_m: f64,
    /// Thermal conductivity of its wall \[W/(m K)\].
    pub conductivity_w_per_m_k: f64,
    /// Volumetric heat capacity of its wall \[J/(m3 K)\].
    pub heat_capacity_j_per_m3_k: f64,
}

impl Pipe {
    /// A nylon pipe of given length and inner diameter \[m\]: 0.25 W/(m K) (S3), 1.9e6 J/(m3 K), wall 0.75
    /// mm.
    #[must_use]
    pub const fn nylon(length_m: f64, inner_diameter_m: f64) -> Self {
        Self {
            length_m,
            inner_diameter_m,
            wall_thickness_m: 0.75e-3,
            conductivity_w_per_m_k: 0.25,
            heat_capacity_j_per_m3_k: 1.9e6,
        }
    }
}

/// The pressure cycle of charging and discharging.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drive {
    /// Gauge pressure when discharged \[Pa\], >= 0.
    pub low_pa: f64,
    /// Gauge pressure when charged \[Pa\], at least the low one.
    pub high_pa: f64,
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Fraction of the period from the start of charging to the start of discharging.
    pub duty: f64,
    /// Duration of charging, and of discharging \[s\].
    pub ramp_s: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self { low_pa: 0.0, high_pa: 5e5, period_s: 1.0, duty: 0.5, ramp_s: 0.2 }
    }
}

/// Surroundings of the muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Surroundings {
    /// Temperature of the ambient \[K\].
    pub ambient_k: f64,
    /// Temperature of the air that is charged \[K\].
    pub supply_k: f64,
    /// Pressure of the ambient \[Pa\].
    pub pressure_pa: f64,
    /// Outer heat transfer coefficient including radiation \[W/(m2 K)\]; still air 5 to 15.
    pub outer_transfer_w_per_m2_k: f64,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self { ambient_k: 293.15, supply_k: 293.15, pressure_pa: 101_325.0, outer_transfer_w_per_m2_k: 10.0 }
    }
}

/// Constants of the closures. They are assumptions, described in the module.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Closures {
    /// Smallest Nusselt number, for conduction in gas at rest; 3.66 to 5.78.
    pub nusselt_floor: f64,
    /// Coefficient c_n of natural convection; 0.3 to 0.7, or 0 for none.
    pub natural_convection: f64,
    /// Factor of every Nusselt number; 1, or 0 for adiabatic walls.
    pub nusselt_factor: f64,
    /// Coefficient c_m of axial mixing in turbulent flow; 0.05 to 1.
    pub mixing: f64,
    /// Strength c_j of the stirring by the jet; 0.3 to 2.
    pub jet_strength: f64,
    /// Distance in diameters D over which the stirring decays to 1/e ahead of the jet; 2 to 8.
    pub jet_reach: f64,
    /// The same distance behind the nozzle; 0.5 to 2.
    pub jet_back: f64,
}

impl Default for Closures {
    fn default() -> Self {
        Self {
            nusselt_floor: 5.78,
            natural_convection: 0.55,
            nusselt_factor: 1.0,
            mixing: 0.3,
            jet_strength: 1.0,
            jet_reach: 4.0,
            jet_back: 1.0,
        }
    }
}

/// Resolution, tolerance and limits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeatNumerics {
    /// Cells along the muscle, 4 to 2000.
    pub cells: usize,
    /// Time steps in a cycle, 20 to 100 000.
    pub steps_per_cycle: usize,
    /// Largest estimated distance of a temperature from its periodic value \[K\].
    pub tolerance_k: f64,
    /// Cycles after which the search fails.
    pub max_cycles: usize,
    /// Whether cycles are extrapolated; otherwise every cycle is computed.
    pub accelerate: bool,
}

impl Default for HeatNumerics {
    fn default() -> Self {
        Self { cells: 40, steps_per_cycle: 200, tolerance_k: 1e-4, max_cycles: 20_000, accelerate: true }
    }
}

/// A muscle under repeated charging and discharging.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeatProblem {
    /// The muscle.
    pub tube: Tube,
    /// The pipe in it, if any.
    pub pipe: Option<Pipe>,
    /// The pressure.
    pub drive: Drive,
    /// The ambient and the supply.
    pub surroundings: Surroundings,
    /// Constants of heat transfer and mixing.
    pub closures: Closures,
    /// Activation energy Ea of the rubber's ageing \[J/mol\]; 70e3 to 110e3.
    pub activation_energy_j_per_mol: f64,
    /// Cells, steps, tolerance.
    pub numerics: HeatNumerics,
}

impl Default for HeatProblem {
    fn default() -> Self {
        Self {
            tube: Tube::default(),
            pipe: None,
            drive: Drive::default(),
            surroundings: Surroundings::default(),
            closures: Closures::default(),
            activation_energy_j_per_mol: 85e3,
            numerics: HeatNumerics::default(),
        }
    }
}

impl HeatProblem {
    /// Pressure and section at a fraction of the period.
    pub(super) fn instant(&self, part: f64) -> Instant {
        let level = self.drive.level(part);
        Instant {
            pressure: self.surroundings.pressure_pa
                + self.drive.low_pa
                + (self.drive.high_pa - self.drive.low_pa) * level,
            section: 1.0 + self.tube.swelling * level,
        }
    }
}

impl Drive {
    /// Pressure level from 0 (low) to 1 (high) at a fraction of the period, with ramps 10 s^3 - 15 s^4 + 6
    /// s^5.
    fn level(&self, part: f64) -> f64 {
        let ramp = |since: f64| {
            let s = (since * self.period_s / self.ramp_s).clamp(0.0, 1.0);
            s * s * s * (10.0 + s * (6.0 * s - 15.0))
        };
        ramp(part) - ramp(part - self.duty)
    }
}
