//! Gas and walls at a time, and the exchange with the surroundings in a step.

use super::gas::R;
use super::mesh::{Instant, Mesh};

/// Gas and wall of the muscle, or of the pipe.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Chain {
    /// Mass of the gas, by cell \[kg\].
    pub mass: Vec<f64>,
    /// Temperature of the gas \[K\].
    pub gas: Vec<f64>,
    /// Wall temperature \[K\].
    pub wall: Vec<f64>,
    /// Mass flow through the faces, towards the end of the muscle \[kg/s\]; one face more than cells, none
    /// without cells.
    pub flow: Vec<f64>,
}

impl Chain {
    fn uniform(volumes: impl Iterator<Item = f64>, pressure: f64, gas: f64, wall: f64) -> Self {
        let mass: Vec<f64> = volumes.map(|volume| pressure * volume / (R * gas)).collect();
        let n = mass.len();
        Self { gas: vec![gas; n], wall: vec![wall; n], flow: vec![0.0; if n > 0 { n + 1 } else { 0 }], mass }
    }
}

/// Muscle and pipe at a time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct State {
    pub muscle: Chain,
    pub pipe: Chain,
}

impl State {
    /// Gas and walls at uniform temperatures \[K\].
    pub(super) fn uniform(mesh: &Mesh, now: Instant, gas: f64, wall: f64) -> Self {
        let volumes = (0..mesh.x.len()).map(|i| mesh.volume(i, now.section));
        Self {
            muscle: Chain::uniform(volumes, now.pressure, gas, wall),
            pipe: Chain::uniform(mesh.pipe_volume.iter().copied(), now.pressure, gas, wall),
        }
    }
}

/// Exchange with the surroundings in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Exchange {
    /// Air that entered through the inlet \[kg\].
    pub mass: f64,
    /// Its enthalpy, relative to 0 K \[J\].
    pub enthalpy: f64,
    /// Heat lost to the ambient \[J\].
    pub heat: f64,
    /// Work of the gas on the wall, P dV \[J\].
    pub work: f64,
}

/// Ambient and supply temperature \[K\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Outside {
    pub ambient: f64,
    pub supply: f64,
}
