//! What can be wrong with a membrane problem, and how a solution can fail.

use crate::mesh::{CellKind, Mesh};
use thiserror::Error;

/// Why there is no equilibrium to report.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MembraneError {
    /// A node is held by two fittings.
    #[error(
        "node {node} rides on two fittings, by `{}` and by `{}`: a node can only ride on one; take it out of one of the groups",
        groups[0], groups[1]
    )]
    TwoFittings {
        /// Number of the node in its file.
        node: u64,
        /// The groups that are held.
        groups: [String; 2],
    },
    /// A node on a fitting is held along z, too.
    #[error(
        "node {node} rides on a fitting, by `{}`, and is held along z, by `{}`: a fitting moves along z; keep one of the two supports",
        groups[1], groups[0]
    )]
    HeldFitting {
        /// Number of the node in its file.
        node: u64,
        /// The group that is held along z, and that on the fitting.
        groups: [String; 2],
    },
    /// A node of a cyclic edge is the partner of another.
    #[error(
        "node {node} is the partner of a node of `{}` and follows another itself, by `{}`: the two edges of a cyclic sector must be apart; leave one of the supports out",
        groups[0], groups[1]
    )]
    CyclicChain {
        /// Number of the node in its file.
        node: u64,
        /// The groups that follow.
        groups: [String; 2],
    },
    /// A node of a cyclic edge with two partners.
    #[error(
        "node {node} follows two nodes, by `{}` and by `{}`: a node can only follow one; take it out of one of the groups",
        groups[0], groups[1]
    )]
    TwoPartners {
        /// Number of the node in its file.
        node: u64,
        /// The groups that follow.
        groups: [String; 2],
    },
    /// A cyclic edge that is its own partner.
    #[error(
        "`{group}` is to follow `{partner}` turned by {degrees:.6} degrees about z, which is the same edge: name the other edge of the sector as partner, and the angle from it to `{group}`"
    )]
    NoTurn {
        /// The group.
        group: String,
        /// The one that it is to follow.
        partner: String,
        /// The angle.
        degrees: f64,
    },
    /// A plane of symmetry beside the axis.
    #[error(
        "the plane of symmetry of `{group}` misses the z axis by {:.6e} m at node {node}: the volume is measured from the axis; move the mesh so that this plane contains the z axis",
        offset.abs()
    )]
    PlaneOffAxis {
        /// Number of the node in its file.
        node: u64,
        /// The group that is held.
        group: String,
        /// From the axis to the plane, m.
        offset: f64,
    },
    /// A plane of symmetry that is neither level nor upright.
    #[error(
        "the plane of symmetry of `{group}` is oblique: it must be level or contain the z axis, from which the volume is measured; turn the mesh"
    )]
    ObliquePlane {
        /// The group that is held.
        group: String,
    },
    /// A level plane of symmetry whose nodes aren't level.
    #[error(
        "the nodes {} and {} of `{group}` lie at different heights, on no level plane of symmetry: move them onto one, or hold them otherwise",
        nodes[0], nodes[1]
    )]
    Uneven {
        /// The group that is held.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
    },
    /// A rigid motion of a part that nothing holds.
    #[error(
        "nothing holds the part of the mesh with node {node} of `{group}` against every rigid motion: it can {motion}; add a `[[support]]` against that"
    )]
    NotHeld {
        /// Number of one of its nodes in its file.
        node: u64,
        /// The group.
        group: String,
        /// How it can move.
        motion: String,
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
    /// A loaded fitting that pulls at nothing.
    #[error(
        "no element has a node on the loaded fitting {fitting} (counted from 0): hold a group of a part by it, or leave it out"
    )]
    EmptyFitting {
        /// Its number.
        fitting: usize,
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
        "element {element} of `{group}` and element {other} of `{other_group}` share the edge between the nodes {} and {}, but not the node in its middle: mesh all with the same order",
        nodes[0], nodes[1]
    )]
    MixedOrders {
        /// Number of one element.
        element: u64,
        /// Its group.
        group: String,
        /// Number of the other.
        other: u64,
        /// The group of that.
        other_group: String,
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
    /// The matrix or its factors failed for want of memory.
    #[error(
        "no memory for a stiffness matrix of {unknowns} unknowns and its factors: use a coarser mesh or a smaller sector"
    )]
    Memory {
        /// Its size.
        unknowns: usize,
    },
    /// Nothing to close in.
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
        /// What was found.
        what: String,
    },
    /// Inextensible threads that the loads stretch all the same.
    #[error(
        "the inextensible threads can't keep their length: {stretch:.1e} is left (asked: {asked:.0e}); the ends may be farther apart than they reach"
    )]
    Overstretched {
        /// Largest stretch less 1.
        stretch: f64,
        /// What was asked.
        asked: f64,
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
