//! An equilibrium, its tolerances, and the effort for it.

use serde::Serialize;
use std::time::Duration;

/// Convergence criteria of an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Residual of each node relative to the mean of the forces that meet at a node.
    pub residual: f64,
    /// Largest error of the stretch of an inextensible thread.
    pub stretch: f64,
    /// Most iterations for one equilibrium. Most take some tens. Slack cloth that is inflated from a flat
    /// mesh folds and unfolds on its way, more often on finer meshes: a square airbag of 28800 triangles
    /// takes 350 if it has no coarser mesh to start from.
    pub iterations: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { residual: 1e-10, stretch: 1e-11, iterations: 2000 }
    }
}

/// An equilibrium of the whole structure: energies, forces and volumes include every copy of a sector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// Values of the degrees of freedom.
    #[serde(skip)]
    pub(crate) y: Vec<f64>,
    /// Tensions T0 of the inextensible threads; the next field is the penalty stiffness that belongs to them.
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
    /// Displacement of each fitting along z from its position in the mesh, m.
    pub fittings: Vec<f64>,
    /// Force along z that holds each fitting in place, N: the pulling force of the muscle.
    pub forces: Vec<f64>,
    /// Residual relative to the mean of the forces that meet at a node.
    pub residual: f64,
    /// Number of directions in which the energy decreases: 0 in a stable equilibrium.
    pub unstable: usize,
    /// Number of iterations.
    pub iterations: usize,
}

/// How often the structure occurs in the whole muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Copies {
    /// Side by side around the z axis: their forces on a fitting add up.
    pub around: f64,
    /// One behind the other along the axis: 2 for half a muscle on its middle plane. Their lengths add up,
    /// and the same force goes through all.
    pub along: f64,
}

impl Copies {
    /// A single copy.
    pub const ONE: Self = Self { around: 1.0, along: 1.0 };

    pub(crate) fn all(self) -> f64 {
        self.around * self.along
    }
}

/// Computational effort.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Effort {
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Time for elements and their sums.
    pub assembling: Duration,
    /// Time for factorisations.
    pub factorising: Duration,
    /// Time for solving with the factors.
    pub solving: Duration,
}

impl std::ops::AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.iterations += other.iterations;
        self.factorisations += other.factorisations;
        self.assembling += other.assembling;
        self.factorising += other.factorising;
        self.solving += other.solving;
    }
}
