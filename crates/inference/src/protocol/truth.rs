//! What is hidden in synthetic measurements: effects with their parameters, errors of the sensors, and where
//! the muscle didn't pull.

use bulge_model::{Model, ModelParameter};
use bulge_muscles::units;
use serde::Serialize;

use crate::protocol::bench::Protocol;

/// What is hidden in synthetic measurements: the document `bulge.simulation/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// Name and version of the document.
    pub schema: &'static str,
    /// The muscle.
    pub muscle: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of rows.
    pub rows: usize,
    /// Number of sweeps; of specimens in a static map.
    pub sweeps: usize,
    /// The hidden effects.
    pub effects: Vec<HiddenEffect>,
    /// Zero and gain errors of the sensors.
    pub rig: RigReadings,
    /// Sweeps that ended early, or rows of a static map that were left out, because the muscle doesn't pull
    /// there.
    pub ended: Vec<Ended>,
    /// The protocol, with its noise.
    pub protocol: Protocol,
}

/// An effect with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HiddenEffect {
    /// Its name.
    pub effect: String,
    /// The family that it belongs to.
    pub family: String,
    /// Its parameters.
    pub numbers: Vec<HiddenNumber>,
}

/// A parameter of a hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HiddenNumber {
    /// Its key in a muscle file.
    pub key: String,
    /// Its value in the unit shown.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// The specimen, if each has its own parameter.
    pub specimen: Option<String>,
}

/// Errors of the sensors: reading = true (1 + gain) + zero. The gain of the length sensor acts on the
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RigReadings {
    /// Zero of the load cell \[N\].
    pub force_zero_n: f64,
    /// Gain error of the load cell.
    pub force_gain: f64,
    /// Zero of the pressure sensor \[Pa\].
    pub pressure_zero_pa: f64,
    /// Gain error of the pressure sensor.
    pub pressure_gain: f64,
    /// Zero of the length sensor \[m\].
    pub length_zero_m: f64,
    /// Gain error of the length sensor.
    pub length_gain: f64,
}

/// A range in which the muscle doesn't pull, or has no equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ended {
    /// Gauge pressure \[Pa\]; at held length the highest one.
    pub pressure_pa: f64,
    /// Range of contractions that was planned.
    pub planned: [f64; 2],
    /// Range of contractions in the data; none if nothing of the sweep is left.
    pub reached: Option<[f64; 2]>,
    /// At held length, the range of pressures in the data \[Pa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_reached_pa: Option<[f64; 2]>,
    /// Number of such sweeps, or of rows that were left out of a static map.
    pub count: usize,
}

/// The effects whose parameters are not fixed, with their values in `theta`.
pub(crate) fn hidden(model: &Model, theta: &[f64]) -> Vec<HiddenEffect> {
    let of = |name: &str| {
        let numbers = model.parameters().iter().zip(theta).filter(|(p, _)| p.effect == name);
        let number = |(p, value): (&ModelParameter, &f64)| HiddenNumber {
            key: p.key.clone(),
            // Twelve digits hide the rounding error of the unit conversion.
            value: units::rounded(value / p.factor, 12),
            unit: p.unit.clone(),
            specimen: p.specimen.clone(),
        };
        numbers.map(number).collect()
    };
    let shown = model.effects().iter().filter(|chosen| !chosen.fixed).map(|chosen| chosen.effect.card());
    shown
        .map(|card| HiddenEffect {
            effect: card.name.to_owned(),
            family: card.family.to_owned(),
            numbers: of(card.name),
        })
        .collect()
}
