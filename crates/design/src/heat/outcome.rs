//! What the heat model answers, or why it doesn't.

use serde::Serialize;

/// Temperatures along the muscle, or along its pipe, in a cycle of the periodic state. Lists by cell.
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
    /// Along the muscle.
    pub muscle: HeatProfile,
    /// Along the pipe; without pipe its lists are empty.
    pub pipe: HeatProfile,
    /// Mean wall temperature of the last cell, above the ambient \[K\].
    pub end_rise_k: f64,
    /// The same of the first cell \[K\].
    pub inlet_rise_k: f64,
    /// Largest mean wall temperature above the ambient \[K\].
    pub hottest_rise_k: f64,
    /// Where \[m\].
    pub hottest_x_m: f64,
    /// Time until the wall there has made 90 % of its rise \[s\]; 0 if it doesn't rise.
    pub time_to_90_s: f64,
    /// Ageing of the rubber at its worst place relative to that at the ambient temperature: a ratio of rates, not a life.
    pub ageing_factor: f64,
    /// Heat to the ambient in a cycle \[J\].
    pub heat_out_j: f64,
    /// Enthalpy in less enthalpy out through the inlet in a cycle \[J\]: the work that the supply puts in.
    pub enthalpy_in_j: f64,
    /// Work P dV of the gas on the wall in a cycle \[J\]; 0 as the section follows the pressure.
    pub wall_work_j: f64,
    /// Air in less air out in a cycle \[kg\].
    pub mass_in_kg: f64,
    /// Largest Mach number in the pipe or port.
    pub peak_mach: f64,
    /// Cycles computed, those of the transient included.
    pub cycles: usize,
    /// Estimated distance from the periodic state \[K\].
    pub residual_k: f64,
}

/// Why there is no temperature.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeatError {
    /// A number out of range.
    #[error("{what} is {value}; it must be {range}")]
    Invalid {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// The pressure can't rise as asked.
    #[error(
        "the air would enter or leave at Mach {mach:.2}, where the pipe or port chokes and the pressure can't follow; take a wider pipe or port, or a longer ramp"
    )]
    Choked {
        /// Largest Mach number.
        mach: f64,
    },
    /// A time step has no solution.
    #[error(
        "the step of the gas at {time_s} s in the cycle doesn't converge with {steps} steps in a cycle; take more"
    )]
    Step {
        /// Time in the cycle \[s\].
        time_s: f64,
        /// Steps in a cycle.
        steps: usize,
    },
    /// No periodic state within the cycles allowed.
    #[error(
        "not periodic after {cycles} cycles: about {residual_k:.2e} K are missing; allow more cycles, or a larger tolerance"
    )]
    NotPeriodic {
        /// Cycles computed.
        cycles: usize,
        /// Estimated distance \[K\].
        residual_k: f64,
    },
}
