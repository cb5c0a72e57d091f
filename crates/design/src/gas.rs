//! The air in a muscle: enclosed, or flowing through a valve, and its consumption in a stroke.
//!
//! The gas is dry air, taken as ideal. Pressures `p` are gauge pressures; `P = p + p0` are absolute ones.
//!
//! ```text
//! P (V + Vd) = m R T          R = 287.05 J/(kg K),  gamma = 1.4,  cp = gamma R/(gamma - 1),  cv = R/(gamma - 1)
//! ```
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | p, P, p0 | gauge, absolute and ambient pressure (101325 Pa unless stated) | Pa |
//! | V | volume of the muscle that holds the gas, `Response::volume_m3` (circular sections) | m^3 |
//! | Vd | dead volume of fittings and tubes, >= 0 | m^3 |
//! | m, T | mass and temperature of the gas in V + Vd | kg, K |
//! | e, l, F | contraction, length, pull | 1, m, N |
//!
//! There are two volumes. The gas fills `volume_m3`. Its work on the fibres is p dV of `volume_polygon_m3`,
//! the volume between flat cloth, because F dl = -p dV holds with that volume. Both are the same for braids
//! and for continuous fibres. Between n fibres the second is a = (n/2 pi) sin(2 pi/n) times the first (0.9959
//! for n = 40), so the fraction 1 - a of the work of the gas doesn't reach the load.
//!
//! - [`ClosedMuscle`]: the valve is shut and P (V + Vd)^n = const. It gives pressure, force, and the
//!   contraction under a force.
//! - [`StiffnessSplit`]: the contributions of the geometry and of the enclosed gas to dF/dl.
//! - [`Orifice`]: the flow of a valve according to ISO 6358.
//! - [`Filling`]: filling and venting over time, against a [`Load`].
//! - [`Stroke`]: air, energy and efficiency of a cycle.
//!
//! Neglected: humidity, real gas (below 10 bar its compressibility factor differs from 1 by less than 0.5 %),
//! waves in tubes, and inertia of the load.

mod chamber;
mod closed;
mod cycle;
mod filling;
mod muscle;
mod orifice;
mod question;
mod stiffness;
mod surroundings;

pub use chamber::{Chamber, Inside, LEAST_PRESSURE_PA, Load};
pub use closed::{ClosedMuscle, ClosedState};
pub use cycle::{CycleResult, Lift, Stroke};
pub use filling::{Energy, Filling, GasModel, History, Sample, Supply};
pub use orifice::{Orifice, REFERENCE_DENSITY, REFERENCE_TEMPERATURE_K};
pub use question::{
    FillAnswer, FillQuestion, Moves, ShutAnswer, ShutQuestion, ShutState, StrokeAnswer, StrokeQuestion, Valve,
};
pub use stiffness::StiffnessSplit;
pub(crate) use {
    closed::ShutGas,
    muscle::{failed, pulling, taut},
    surroundings::Surroundings,
};

use bulge_model::MuscleWithEffectsError;
use bulge_muscles::{Fault, Pressure};

use crate::question::is;

/// Specific gas constant of dry air \[J/(kg K)\].
pub const R_AIR: f64 = 287.05;
/// Ratio of the specific heats of air.
pub const GAMMA: f64 = bulge_fibre::ADIABATIC;
/// Specific heat of air at constant pressure \[J/(kg K)\].
pub const CP_AIR: f64 = GAMMA * R_AIR / (GAMMA - 1.0);
/// Specific heat of air at constant volume \[J/(kg K)\].
pub const CV_AIR: f64 = R_AIR / (GAMMA - 1.0);
/// Ambient temperature unless stated \[K\].
pub const AMBIENT_TEMPERATURE_K: f64 = 293.15;

/// Why a computation of the air in a muscle fails.
#[derive(Debug, thiserror::Error)]
pub enum GasError {
    /// An impossible number.
    #[error("{}: {instead}", is(what, *value))]
    Number {
        /// Name of the number, with its SI unit in brackets.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Advice on a valid value.
        instead: &'static str,
    },
    /// The muscle has no equilibrium at this pressure.
    #[error("at the gauge pressure {}: {error}", Pressure::pa(*pressure_pa))]
    Muscle {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
        /// The cause.
        error: Box<MuscleWithEffectsError>,
    },
    /// Pull and load are equal at no contraction, or no pressure satisfies the law of the enclosed gas.
    #[error("{0}")]
    NoBalance(String),
    /// The integration over time stopped.
    #[error("the filling stopped after {time_s} s at the gauge pressure {}: {reason}", Pressure::pa(*pressure_pa))]
    Stopped {
        /// Time \[s\].
        time_s: f64,
        /// Gauge pressure there \[Pa\].
        pressure_pa: f64,
        /// The cause.
        reason: String,
    },
}

impl GasError {
    /// The kind of the error: wrong input, no solution, or an integration that stopped.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Number { .. } => Fault::Input,
            Self::Stopped { .. } => Fault::NotConverged,
            Self::Muscle { error, .. } => error.fault(),
            Self::NoBalance(_) => Fault::NoSolution,
        }
    }

    /// An impossible number.
    const fn number(what: &'static str, value: f64, instead: &'static str) -> Self {
        Self::Number { what, value, instead }
    }
}

/// Checks that a number is finite and at least `low`.
fn at_least(what: &'static str, value: f64, low: f64, instead: &'static str) -> Result<f64, GasError> {
    if value.is_finite() && value >= low { Ok(value) } else { Err(GasError::number(what, value, instead)) }
}

/// Checks that a number is finite and above 0.
fn positive(what: &'static str, value: f64) -> Result<f64, GasError> {
    let instead = "give a finite number above 0";
    if value > 0.0 {
        at_least(what, value, 0.0, instead)
    } else {
        Err(GasError::number(what, value, instead))
    }
}

/// Checks that a number is finite.
fn finite(what: &'static str, value: f64) -> Result<f64, GasError> {
    at_least(what, value, f64::MIN, "give a finite number")
}

/// Muscles for the tests of the submodules.
#[cfg(test)]
mod examples {
    use bulge_effects::{Catalogue, known};
    use bulge_model::MuscleWithEffects;
    use bulge_muscles::from_toml;

    pub(super) fn muscle(lines: &str) -> MuscleWithEffects {
        let muscle = from_toml(&format!("name = \"x\"\n{lines}\n"), "m.toml").unwrap();
        MuscleWithEffects::new(&muscle, &known(&muscle, &Catalogue::builtin()).unwrap()).unwrap()
    }

    /// Continuous inextensible fibres: F dl = -p dV holds with the volume that the gas fills.
    pub(super) fn pleated() -> MuscleWithEffects {
        muscle("kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = \"continuous\"")
    }

    /// Forty inextensible fibres.
    pub(super) fn forty() -> MuscleWithEffects {
        muscle("kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40")
    }

    /// Fibres so soft that the volume depends on the pressure.
    pub(super) fn soft() -> MuscleWithEffects {
        muscle(
            "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"2 kN\" }",
        )
    }

    /// The textbook braid.
    pub(super) fn braid() -> MuscleWithEffects {
        muscle(
            "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"",
        )
    }

    /// A clamped braid with an effect that changes its shape and one that adds force.
    pub(super) fn learnt() -> MuscleWithEffects {
        muscle(
            "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n\n[effects.fibre-length]\nexcess = \"1 %\"\n[effects.hoop-elasticity]\nstiffness = \"500 N/m\"",
        )
    }
}
