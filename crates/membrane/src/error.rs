//! Errors of membrane problems: invalid input, and failed solutions.

use crate::mesh::Mesh;
use bulge_muscles::shown::listed;
use std::collections::BTreeSet;
use thiserror::Error;

/// Why there is no equilibrium.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MembraneError {
    /// The mesh, its groups and its supports make no structure: what is wrong, where, and what to do instead.
    #[error("{0}")]
    Structure(String),
    /// The matrix or its factors need too much memory.
    #[error(
        "no memory for a stiffness matrix of {unknowns} unknowns and its factors: use a coarser mesh or a smaller sector"
    )]
    Memory {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// There is no gas to enclose.
    #[error(
        "there is no gas to close in: {volume:.3e} m^3 at {pressure:.3e} Pa absolute; inflate it by a step with a `pressure` before"
    )]
    NoGas {
        /// Volume, m^3.
        volume: f64,
        /// Absolute pressure, Pa.
        pressure: f64,
    },
    /// The structure has turned inside out, or its ends have passed each other.
    #[error("the membrane collapses: {what}; hold its ends, or load it less")]
    Collapsed {
        /// What was detected.
        what: String,
    },
    /// Inextensible threads whose length the loads change.
    #[error(
        "the inextensible threads can't keep their length: {stretch:.1e} is left (asked: {asked:.0e}); the ends may be farther apart than they reach"
    )]
    Overstretched {
        /// Largest stretch less 1.
        stretch: f64,
        /// The tolerance.
        asked: f64,
    },
    /// The iterations ended without an equilibrium.
    #[error(
        "no equilibrium after {iterations} iterations: the residual is {residual:.1e} of the forces (asked: {asked:.0e})"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// Residual relative to the forces.
        residual: f64,
        /// The tolerance.
        asked: f64,
    },
    /// The pressure exceeds the largest one that the structure can hold.
    #[error(
        "no equilibrium at {pressure:.6e} Pa: the last one found is at {last:.6e} Pa, with a volume of {volume:.6e} m^3, beyond which the pressure falls; prescribe the volume instead"
    )]
    LimitPoint {
        /// Prescribed pressure, Pa.
        pressure: f64,
        /// Pressure of the last equilibrium, Pa.
        last: f64,
        /// Volume of the last equilibrium, m^3.
        volume: f64,
    },
}

impl MembraneError {
    /// A group that doesn't exist in the mesh.
    pub(crate) fn unknown_group(group: &str, mesh: &Mesh) -> Self {
        let known: BTreeSet<&str> = mesh.blocks.iter().map(|block| block.group.as_str()).collect();
        let known = if known.is_empty() { "no groups".to_owned() } else { listed(20, "`", known) };
        Self::Structure(format!("the mesh has no group `{group}`; it has {known}"))
    }

    /// There is nothing to solve for.
    pub(crate) fn nothing_moves() -> Self {
        Self::Structure("every node is held: nothing can move".to_owned())
    }
}
