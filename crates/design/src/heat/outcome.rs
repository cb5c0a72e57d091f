//! Results and errors of the heat model.

use bulge_muscles::Fault;
use serde::Serialize;

use crate::question::is;

/// Temperatures along the muscle or along its pipe over a cycle of the periodic state, by cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeatProfile {
    /// Centres of the cells, from the inlet \[m\].
    pub x_m: Vec<f64>,
    /// Mean wall temperature \[K\].
    pub wall_mean_k: Vec<f64>,
    /// Largest wall temperature \[K\].
    pub wall_max_k: Vec<f64>,
    /// Mean gas temperature \[K\].
    pub gas_mean_k: Vec<f64>,
    /// Largest gas temperature \[K\].
    pub gas_max_k: Vec<f64>,
    /// Mean of the Arrhenius factor of the wall, relative to ageing at the ambient temperature.
    pub ageing_factor: Vec<f64>,
}

/// The periodic steady state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeatSolution {
    /// Temperatures along the muscle.
    pub muscle: HeatProfile,
    /// Temperatures along the pipe; the lists are empty without a pipe.
    pub pipe: HeatProfile,
    /// Mean wall temperature of the last cell, above the ambient \[K\].
    pub end_rise_k: f64,
    /// Mean wall temperature of the first cell, above the ambient \[K\].
    pub inlet_rise_k: f64,
    /// Largest mean wall temperature above the ambient \[K\].
    pub hottest_rise_k: f64,
    /// Position of that largest temperature \[m\].
    pub hottest_x_m: f64,
    /// Time until the wall at that position has reached 90 % of its rise \[s\]; 0 if it doesn't rise.
    pub time_to_90_s: f64,
    /// Ageing of the rubber at its hottest place relative to ageing at the ambient temperature: a ratio of
    /// rates, not a service life.
    pub ageing_factor: f64,
    /// Heat to the ambient in a cycle \[J\].
    pub heat_out_j: f64,
    /// Enthalpy in minus enthalpy out through the inlet in a cycle \[J\]: the work done by the supply.
    pub enthalpy_in_j: f64,
    /// Work P dV of the gas on the wall in a cycle \[J\]; 0, since the section follows the pressure.
    pub wall_work_j: f64,
    /// Air in minus air out in a cycle \[kg\].
    pub mass_in_kg: f64,
    /// Largest Mach number in the pipe or port.
    pub peak_mach: f64,
    /// Cycles computed, including those of the transient.
    pub cycles: usize,
    /// Estimated distance from the periodic state \[K\].
    pub residual_k: f64,
}

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeatError {
    /// A number out of range.
    #[error("{}; it must be {range}", is(what, *value))]
    Invalid {
        /// The number, with its SI unit in brackets.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Its required range.
        range: &'static str,
    },
    /// The inlet chokes, so the pressure can't follow.
    #[error(
        "the air would enter or leave at Mach {mach:.2}, where the pipe or port chokes and the pressure can't follow; take a wider pipe or port, or a longer ramp"
    )]
    Choked {
        /// Largest Mach number.
        mach: f64,
    },
    /// A time step doesn't converge, or there is no periodic state within the cycles allowed.
    #[error("{0}")]
    NotConverged(String),
}

impl HeatError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub const fn fault(&self) -> Fault {
        match self {
            Self::Invalid { .. } => Fault::Input,
            Self::Choked { .. } => Fault::NoSolution,
            Self::NotConverged(_) => Fault::NotConverged,
        }
    }

    /// No periodic state within the cycles allowed: about so many kelvin are missing.
    pub(super) fn not_periodic(cycles: usize, residual_k: f64) -> Self {
        Self::NotConverged(format!(
            "not periodic after {cycles} cycles: about {residual_k:.2e} K are missing; allow more cycles, or a larger tolerance"
        ))
    }
}
