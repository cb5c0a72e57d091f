//! What can be wrong with a membrane problem, and how a solution can fail.

use crate::mesh::{CellKind, Mesh};
use thiserror::Error;

/// Why there is no equilibrium to report.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MembraneError {
    /// A node is held by two fittings.
    #[error("node {node} rides on two fittings: a node can only ride on one")]
    TwoFittings {
        /// Index of the node.
        node: usize,
    },
    /// A node of a cyclic edge is the partner of another.
    #[error(
        "node {node} is the partner of one node and follows another: the edges of a cyclic sector must be apart"
    )]
    CyclicChain {
        /// Index of the node.
        node: usize,
    },
    /// An element without area or length, or one that folds over.
    #[error(
        "element {element} of `{group}` has no {what}, or folds over itself: give it nodes that lie apart"
    )]
    Element {
        /// Number of the element in its file.
        element: u64,
        /// The group.
        group: String,
        /// "length" or "area".
        what: &'static str,
    },
    /// A group that the mesh doesn't have.
    #[error("the mesh has no group `{group}`; it has {known}")]
    UnknownGroup {
        /// As it was named.
        group: String,
        /// Those there are.
        known: String,
    },
    /// Cells of a kind that the part can't be made of.
    #[error(
        "`{group}` has cells of the kind {kind:?}: membranes are made of triangles, cables and membranes of revolution of lines"
    )]
    WrongCells {
        /// The group.
        group: String,
        /// The kind of its cells.
        kind: CellKind,
    },
    /// A fitting that isn't there.
    #[error("there is no fitting {fitting}: {known} are known, counted from 0")]
    NoFitting {
        /// As it was named.
        fitting: usize,
        /// How many there are.
        known: usize,
    },
    /// A node of a cyclic edge without a partner.
    #[error(
        "node {node} of `{group}` has no partner in `{partner}`, {degrees:.6} degrees about z: the two edges must have the same nodes"
    )]
    NoPartner {
        /// Number of the node in its file.
        node: u64,
        /// Its group.
        group: String,
        /// The partner's.
        partner: String,
        /// The angle.
        degrees: f64,
    },
    /// An open edge that nothing closes.
    #[error(
        "element {element} of `{group}` has an open edge between the nodes {} and {} with nothing there: the gas would leave; close the mesh, or hold the edge",
        nodes[0], nodes[1]
    )]
    Hole {
        /// Number of the element in its file.
        element: u64,
        /// Its group.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
    },
    /// More than two elements at one edge.
    #[error("{count} elements meet at the edge between the nodes {} and {} (one is element {element} of `{group}`): a membrane has two sides only", nodes[0], nodes[1])]
    Branch {
        /// Number of one of the elements.
        element: u64,
        /// Its group.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
        /// How many.
        count: usize,
    },
    /// An edge with a node in its middle for one neighbour only.
    #[error(
        "the elements {element} and {other} of `{group}` share the edge between the nodes {} and {}, but not the node in its middle: mesh all with the same order",
        nodes[0], nodes[1]
    )]
    MixedOrders {
        /// Number of one element.
        element: u64,
        /// Number of the other.
        other: u64,
        /// The group.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
    },
    /// A surface with one side.
    #[error("the membrane is twisted at element {element} of `{group}`: it has no inside")]
    Twisted {
        /// Number of the element.
        element: u64,
        /// Its group.
        group: String,
    },
    /// Two parts of a group that can't lie on each other.
    #[error("`{group}` has two parts: only the layers of a membrane of revolution can share a group")]
    TwoParts {
        /// The group.
        group: String,
    },
    /// The structure has nothing to solve for.
    #[error("every node is held: nothing can move")]
    NothingMoves,
    /// The factorisation failed for want of memory.
    #[error(
        "no memory for the factors of a stiffness matrix of {unknowns} unknowns: use a coarser mesh or a smaller sector"
    )]
    Memory {
        /// Its size.
        unknowns: usize,
    },
    /// The iterations ended without equilibrium.
    #[error(
        "no equilibrium after {iterations} iterations: the residual is {residual:.1e} of the forces (asked: {asked:.0e})"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// The residual over the forces.
        residual: f64,
        /// What was asked.
        asked: f64,
    },
    /// Pressure is beyond what the structure can hold.
    #[error(
        "no equilibrium at {pressure:.6e} Pa: the last one found is at {last:.6e} Pa, with a volume of {volume:.6e} m^3, beyond which the pressure falls; prescribe the volume instead"
    )]
    LimitPoint {
        /// Pressure asked, Pa.
        pressure: f64,
        /// That of the last equilibrium.
        last: f64,
        /// Its volume, m^3.
        volume: f64,
    },
}

impl MembraneError {
    pub(crate) fn unknown_group(group: &str, mesh: &Mesh) -> Self {
        let mut known: Vec<String> = mesh.blocks.iter().map(|block| format!("`{}`", block.group)).collect();
        known.sort();
        known.dedup();
        let known = if known.is_empty() { "no groups".to_owned() } else { known.join(", ") };
        Self::UnknownGroup { group: group.to_owned(), known }
    }
}
