//! Errors of membrane problems: invalid input, and failed solutions.

use crate::mesh::{CellKind, Mesh};
use thiserror::Error;

/// Why there is no equilibrium.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MembraneError {
    /// A node is on two fittings.
    #[error(
        "node {node} rides on two fittings, by `{}` and by `{}`: a node can only ride on one; take it out of one of the groups",
        groups[0], groups[1]
    )]
    TwoFittings {
        /// Number of the node in its file.
        node: u64,
        /// The groups of the two supports.
        groups: [String; 2],
    },
    /// A node on a fitting is also held along z.
    #[error(
        "node {node} rides on a fitting, by `{}`, and is held along z, by `{}`: a fitting moves along z; keep one of the two supports",
        groups[1], groups[0]
    )]
    HeldFitting {
        /// Number of the node in its file.
        node: u64,
        /// The group that is held along z, and the one on the fitting.
        groups: [String; 2],
    },
    /// A node of a cyclic edge is the partner of another one.
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
    /// A node of a cyclic edge has two partners.
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
    /// A cyclic edge is its own partner.
    #[error(
        "`{group}` is to follow `{partner}` turned by {degrees:.6} degrees about z, which is the same edge: name the other edge of the sector as partner, and the angle from it to `{group}`"
    )]
    NoTurn {
        /// The group.
        group: String,
        /// The group that it should follow.
        partner: String,
        /// Angle about z, degrees.
        degrees: f64,
    },
    /// A plane of symmetry doesn't contain the axis.
    #[error(
        "the plane of symmetry of `{group}` misses the z axis by {:.6e} m at node {node}: the volume is measured from the axis; move the mesh so that this plane contains the z axis",
        offset.abs()
    )]
    PlaneOffAxis {
        /// Number of the node in its file.
        node: u64,
        /// The supported group.
        group: String,
        /// Distance from the axis to the plane, m.
        offset: f64,
    },
    /// A plane of symmetry is neither horizontal nor parallel to the axis.
    #[error(
        "the plane of symmetry of `{group}` is oblique: it must be level or contain the z axis, from which the volume is measured; turn the mesh"
    )]
    ObliquePlane {
        /// The supported group.
        group: String,
    },
    /// The nodes of a horizontal plane of symmetry aren't at the same height.
    #[error(
        "the nodes {} and {} of `{group}` lie at different heights, on no level plane of symmetry: move them onto one, or hold them otherwise",
        nodes[0], nodes[1]
    )]
    Uneven {
        /// The supported group.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
    },
    /// The supports leave a rigid motion of a part free.
    #[error(
        "nothing holds the part of the mesh with node {node} of `{group}` against every rigid motion: it can {motion}; add a `[[support]]` against that"
    )]
    NotHeld {
        /// Number of one of its nodes in its file.
        node: u64,
        /// The group.
        group: String,
        /// The free motion.
        motion: String,
    },
    /// An element has no area or length, or folds over.
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
    /// A group doesn't exist in the mesh.
    #[error("the mesh has no group `{group}`; it has {known}")]
    UnknownGroup {
        /// The name as given.
        group: String,
        /// The existing groups.
        known: String,
    },
    /// Cells of a kind from which the part can't be made.
    #[error(
        "`{group}` has cells of the kind {kind:?}: membranes are made of triangles, cables and membranes of revolution of lines"
    )]
    WrongCells {
        /// The group.
        group: String,
        /// The kind of its cells.
        kind: CellKind,
    },
    /// A fitting doesn't exist.
    #[error("there is no fitting {fitting}: {known} are known, counted from 0")]
    NoFitting {
        /// The number as given.
        fitting: usize,
        /// Number of fittings.
        known: usize,
    },
    /// No element is attached to a loaded fitting.
    #[error(
        "no element has a node on the loaded fitting {fitting} (counted from 0): hold a group of a part by it, or leave it out"
    )]
    EmptyFitting {
        /// Its number.
        fitting: usize,
    },
    /// A node of a cyclic edge has no partner.
    #[error(
        "node {node} of `{group}` has no partner in `{partner}`, {degrees:.6} degrees about z: the two edges must have the same nodes"
    )]
    NoPartner {
        /// Number of the node in its file.
        node: u64,
        /// Its group.
        group: String,
        /// The partner's group.
        partner: String,
        /// Angle about z, degrees.
        degrees: f64,
    },
    /// An open edge isn't closed by anything.
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
    /// More than two elements share one edge.
    #[error("{count} elements meet at the edge between the nodes {} and {} (one is element {element} of `{group}`): a membrane has two sides only", nodes[0], nodes[1])]
    Branch {
        /// Number of one of the elements.
        element: u64,
        /// Its group.
        group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
        /// Number of elements at the edge.
        count: usize,
    },
    /// Only one of two neighbours has a middle node on their common edge.
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
        /// The group of the other element.
        other_group: String,
        /// Numbers of the nodes.
        nodes: [u64; 2],
    },
    /// A surface has only one side.
    #[error("the membrane is twisted at element {element} of `{group}`: it has no inside")]
    Twisted {
        /// Number of the element.
        element: u64,
        /// Its group.
        group: String,
    },
    /// Two parts of one group can't lie on each other.
    #[error("`{group}` has two parts: only the layers of a membrane of revolution can share a group")]
    TwoParts {
        /// The group.
        group: String,
    },
    /// There is nothing to solve for.
    #[error("every node is held: nothing can move")]
    NothingMoves,
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
    pub(crate) fn unknown_group(group: &str, mesh: &Mesh) -> Self {
        let mut known: Vec<String> = mesh.blocks.iter().map(|block| format!("`{}`", block.group)).collect();
        known.sort();
        known.dedup();
        let known = if known.is_empty() { "no groups".to_owned() } else { known.join(", ") };
        Self::UnknownGroup { group: group.to_owned(), known }
    }
}
