//! Closure of the volume at the open edges of membranes: the supports that hold both ends of an edge.

use crate::element::{Vector, dot, norm, scaled, sub};
use crate::error::MembraneError;
use crate::mesh::Mesh;
use crate::structure::Support;

/// Largest distance of a node from a plane, relative to the size of the mesh.
const CLOSE: f64 = 1e-6;

/// The supports of a mesh by the nodes that they hold.
pub(crate) struct Rims<'a> {
    mesh: &'a Mesh,
    supports: &'a [(String, Support)],
    /// (node, closure), sorted.
    at: Vec<(usize, usize)>,
    size: f64,
}

impl<'a> Rims<'a> {
    pub(crate) fn new(mesh: &'a Mesh, supports: &'a [(String, Support)]) -> Result<Self, MembraneError> {
        let nodes = |name: &str| mesh.nodes_of(name).ok_or_else(|| MembraneError::unknown_group(name, mesh));
        let mut at = Vec::new();
        for (i, (name, support)) in supports.iter().enumerate() {
            let closure = 2 * first_alike(supports, i);
            at.extend(nodes(name)?.into_iter().map(|node| (node, closure)));
            if let Support::Cyclic { partner, .. } = support {
                at.extend(nodes(partner)?.into_iter().map(|node| (node, closure + 1)));
            }
        }
        at.sort_unstable();
        at.dedup();
        Ok(Self { mesh, supports, at, size: mesh.size() })
    }

    /// The closures at a node: twice the number of a support, plus 1 at the partners of a cyclic edge.
    fn at(&self, node: usize) -> &[(usize, usize)] {
        let from = self.at.partition_point(|(other, _)| *other < node);
        let many = self.at[from..].partition_point(|(other, _)| *other == node);
        &self.at[from..from + many]
    }

    pub(crate) fn holds(&self, node: usize) -> bool {
        !self.at(node).is_empty()
    }

    /// The supports that hold both ends of an edge.
    pub(super) fn common(&self, nodes: [usize; 2]) -> impl Iterator<Item = &'a (String, Support)> {
        let [a, b] = nodes.map(|node| self.at(node));
        let both = a.iter().filter(|(_, one)| b.iter().any(|(_, other)| one == other));
        both.map(|(_, closure)| &self.supports[closure / 2])
    }

    /// Whether anything closes the volume at an open edge. An error if it is only a plane from which the
    /// volume isn't measured.
    pub(super) fn closes(&self, nodes: [usize; 2]) -> Result<bool, MembraneError> {
        let mut refused = None;
        for (name, support) in self.common(nodes) {
            match self.fault(name, support, nodes) {
                None => return Ok(true),
                fault => refused = refused.or(fault),
            }
        }
        refused.map_or(Ok(false), Err)
    }

    /// Why a plane doesn't close the volume at an edge.
    pub(super) fn fault(&self, group: &str, support: &Support, nodes: [usize; 2]) -> Option<MembraneError> {
        let Support::Plane { normal } = support else { return None };
        let normal = scaled(*normal, 1.0 / norm(*normal));
        let [a, b] = nodes.map(|node| self.mesh.nodes[node]);
        let [first, second] = nodes.map(|node| self.mesh.number(node));
        let is_direction = normal.iter().all(|x| x.is_finite());
        if !is_direction || (normal[2].abs() > CLOSE && normal[0].hypot(normal[1]) > CLOSE) {
            return Some(MembraneError::Structure(format!(
                "the plane of symmetry of `{group}` is oblique: it must be level or contain the z axis, from which the volume is measured; turn the mesh"
            )));
        }
        if normal[2].abs() <= CLOSE {
            let off = |place: Vector| dot(normal, place);
            let far = usize::from(off(b).abs() > off(a).abs());
            let offset = off([a, b][far]);
            let is_far = offset.abs() > CLOSE * self.size;
            return is_far.then(|| {
                MembraneError::Structure(format!(
                    "the plane of symmetry of `{group}` misses the z axis by {:.6e} m at node {}: the volume is measured from the axis; move the mesh so that this plane contains the z axis",
                    offset.abs(),
                    [first, second][far]
                ))
            });
        }
        let is_uneven = dot(normal, sub(a, b)).abs() > CLOSE * self.size;
        is_uneven.then(|| {
            MembraneError::Structure(format!(
                "the nodes {first} and {second} of `{group}` lie at different heights, on no level plane of symmetry: move them onto one, or hold them otherwise"
            ))
        })
    }
}

/// The first support with the same closure: two fixed groups, or two groups on one fitting, form one rim.
fn first_alike(supports: &[(String, Support)], i: usize) -> usize {
    let own = &supports[i].1;
    let is_rigid = matches!(own, Support::Fixed | Support::Fitting { .. });
    let alike = supports.iter().position(|(_, other)| is_rigid && other == own);
    alike.unwrap_or(i)
}
