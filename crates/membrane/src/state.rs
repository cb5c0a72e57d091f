//! An equilibrium, how good it must be, and what it took.

use serde::Serialize;
use std::time::Duration;

/// When an equilibrium is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Residual of each node over the mean of the forces that meet at one.
    pub residual: f64,
    /// Stretch of an inextensible thread.
    pub stretch: f64,
    /// Most iterations for one equilibrium. Some tens do for most; slack cloth that is blown up from a flat mesh folds and unfolds on its way, the more
    /// often the finer the mesh: a square airbag of 28800 triangles takes 350.
    pub iterations: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { residual: 1e-10, stretch: 1e-11, iterations: 2000 }
    }
}

/// An equilibrium. Whole structure: energies, forces and volumes count every copy of a sector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// The degrees of freedom.
    #[serde(skip)]
    pub(crate) y: Vec<f64>,
    /// Tensions T0 of the inextensible threads, and the stiffness with which they belong to it.
    #[serde(skip)]
    pub(crate) held: Vec<f64>,
    #[serde(skip)]
    pub(crate) penalty: f64,
    /// Gauge pressure, Pa.
    pub pressure: f64,
    /// Enclosed volume, m^3: between the membrane and the planes that close it.
    pub volume: f64,
    /// Stored energy, J.
    pub energy: f64,
    /// Place of each fitting along z from that in the mesh, m.
    pub fittings: Vec<f64>,
    /// Force on each fitting along z that holds it there, N: what the muscle pulls with.
    pub forces: Vec<f64>,
    /// Residual over the mean of the forces that meet at a node.
    pub residual: f64,
    /// Directions in which the energy falls: 0 in a stable equilibrium.
    pub unstable: usize,
    /// Iterations it took.
    pub iterations: usize,
}

/// How often the structure stands in the whole muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Copies {
    /// Round the z axis, side by side: their forces on a fitting add up.
    pub around: f64,
    /// Along it, one behind the other: 2 for half a muscle on its middle plane. Their lengths add up, and the force goes through all.
    pub along: f64,
}

impl Copies {
    /// The whole.
    pub const ONE: Self = Self { around: 1.0, along: 1.0 };

    pub(crate) fn all(self) -> f64 {
        self.around * self.along
    }
}

/// What has been spent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Effort {
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// In elements and their sums.
    pub assembling: Duration,
    /// In factors.
    pub factorising: Duration,
    /// In solving with them.
    pub solving: Duration,
}
