//! A mesh: nodes, and blocks of cells with names to which a case assigns materials, loads and supports.

mod any_format;
mod error;
mod msh;
mod vtu;

pub use error::MeshError;

use crate::dofs::turned;
use crate::element::{norm, sub};
use crate::error::MembraneError;

/// Kind of a cell. Nodes are ordered as in Gmsh: corners first, then the midpoints of the edges 1-2, 2-3,
/// 3-1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
pub enum CellKind {
    /// One node, for a support or for output.
    Point,
    /// A cable or a membrane of revolution with two nodes.
    Line2,
    /// The same with a middle node.
    Line3,
    /// A membrane with three corners.
    Triangle3,
    /// A membrane with additional nodes on its edges.
    Triangle6,
}

impl CellKind {
    /// Its number of nodes.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Self::Point => 1,
            Self::Line2 => 2,
            Self::Line3 | Self::Triangle3 => 3,
            Self::Triangle6 => 6,
        }
    }
}

/// Cells of one kind under one name (a physical group of Gmsh).
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The group's name; empty if the mesh has none.
    pub group: String,
    /// What the cells are.
    pub kind: CellKind,
    /// Indices into [`Mesh::nodes`], `kind.nodes()` for each cell.
    pub cells: Vec<usize>,
    /// The number of each cell in its file, for messages.
    pub numbers: Vec<u64>,
    /// Positions of each cell's nodes in the flat, stress-free pattern of the cloth, one for each entry of
    /// `cells`, m. `None`: the mesh itself is stress-free.
    pub pattern: Option<Vec<[f64; 2]>>,
}

/// Nodes and cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Positions, m. A membrane of revolution lies in the plane y = 0 with its axis along z: x is the radius.
    pub nodes: Vec<[f64; 3]>,
    /// The number of each node in its file, for messages.
    pub numbers: Vec<u64>,
    /// The cells.
    pub blocks: Vec<Block>,
}

impl Mesh {
    /// The nodes of all cells of a group, in ascending order without duplicates; `None` if there is no such
    /// group.
    #[must_use]
    pub fn nodes_of(&self, group: &str) -> Option<Vec<usize>> {
        let mut nodes = Vec::new();
        let mut is_known = false;
        for block in self.blocks.iter().filter(|block| block.group == group) {
            is_known = true;
            nodes.extend_from_slice(&block.cells);
        }
        nodes.sort_unstable();
        nodes.dedup();
        is_known.then_some(nodes)
    }

    /// The number of a node in its file.
    pub(crate) fn number(&self, node: usize) -> u64 {
        self.numbers.get(node).copied().unwrap_or(node as u64 + 1)
    }

    /// The diagonal of the bounding box of all nodes, m.
    pub(crate) fn size(&self) -> f64 {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for place in &self.nodes {
            for (range, x) in range.iter_mut().zip(place) {
                *range = [range[0].min(*x), range[1].max(*x)];
            }
        }
        range.iter().map(|[low, high]| (high - low).powi(2)).sum::<f64>().sqrt()
    }

    /// Each node of a group with the node of `partner` from which it is `angle` away about z.
    pub(crate) fn partners(
        &self,
        group: &str,
        nodes: &[usize],
        partner: &str,
        partners: &[usize],
        angle: f64,
    ) -> Result<Vec<(usize, usize)>, MembraneError> {
        let size = nodes.iter().flat_map(|node| self.nodes[*node]).fold(0.0_f64, |a, x| a.max(x.abs()));
        // Sorted by z, so that only a few need to be compared.
        let mut sorted: Vec<(f64, usize)> =
            partners.iter().map(|node| (self.nodes[*node][2], *node)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let close = 1e-6 * size;
        nodes
            .iter()
            .map(|node| {
                let place = turned(self.nodes[*node], -angle);
                let from = sorted.partition_point(|(z, _)| *z < place[2] - close);
                let found = sorted[from..]
                    .iter()
                    .take_while(|(z, _)| *z <= place[2] + close)
                    .find(|(_, other)| norm(sub(self.nodes[*other], place)) <= close);
                found.map(|(_, other)| (*node, *other)).ok_or_else(|| {
                    MembraneError::Structure(format!(
                        "node {} of `{group}` has no partner in `{partner}`, {:.6} degrees about z: the two edges must have the same nodes",
                        self.number(*node),
                        angle.to_degrees()
                    ))
                })
            })
            .collect()
    }
}
