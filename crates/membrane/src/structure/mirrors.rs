//! Planes of symmetry that cloth must not pass through: on their other side is its mirror image.

use super::{Group, Support};
use crate::element::{Contact, Mirror, Vector, dot, norm, scaled};
use crate::error::MembraneError;
use crate::mesh::Mesh;
use crate::set::Set;

/// Distance from a plane, relative to the size of the mesh, that is rounding.
const ON: f64 = 1e-9;

/// A contact for each node of a triangle with the planes on which it doesn't lie.
pub(super) fn contacts(
    mesh: &Mesh,
    groups: &[(String, Group)],
    supports: &[(String, Support)],
    names: &[String],
) -> Result<Set<Contact, 1>, MembraneError> {
    let size = mesh.size();
    let mut nodes: Vec<u32> = Vec::new();
    for (_, group) in
        groups.iter().filter(|(_, group)| matches!(group, Group::Triangle3(_) | Group::Triangle6(_)))
    {
        let set = group.elements();
        nodes.extend((0..set.count()).flat_map(|element| set.nodes(element)));
    }
    nodes.sort_unstable();
    nodes.dedup();
    if let (Some(name), true) = (names.first(), nodes.is_empty()) {
        return Err(MembraneError::Structure(format!(
            "`{name}` has `contact`, which stops triangles, and there are none: leave it out"
        )));
    }
    let mut planes: Vec<(Mirror, Vec<usize>)> = Vec::new();
    for (name, support) in supports.iter().filter(|(name, _)| names.contains(name)) {
        let Support::Plane { normal } = support else { continue };
        let found = mirror(mesh, &nodes, name, *normal)?;
        // A plane that two supports state stops the cloth once.
        let is_new = |(plane, _): &(Mirror, Vec<usize>)| planes.iter().all(|(known, _)| known != plane);
        if let Some(found) = found.filter(is_new) {
            planes.push(found);
        }
    }
    let with = |node: &u32| {
        let own = planes.iter().filter(|(_, on)| on.binary_search(&(*node as usize)).is_err());
        let own: Vec<Mirror> = own.map(|(plane, _)| *plane).collect();
        (!own.is_empty()).then(|| ([*node], Contact::new(own, size)))
    };
    let (nodes, contacts) = nodes.iter().filter_map(with).unzip();
    Ok(Set::new(nodes, contacts))
}

/// The plane in which an edge is held, with the nodes of the edge; `None` if the mesh is flat on it and may go to either
/// side.
fn mirror(
    mesh: &Mesh,
    nodes: &[u32],
    name: &str,
    normal: Vector,
) -> Result<Option<(Mirror, Vec<usize>)>, MembraneError> {
    let on = mesh.nodes_of(name).ok_or_else(|| MembraneError::unknown_group(name, mesh))?;
    let normal = scaled(normal, 1.0 / norm(normal));
    let offset = on.first().map_or(0.0, |node| dot(normal, mesh.nodes[*node]));
    let gaps = || nodes.iter().map(|node| dot(normal, mesh.nodes[*node as usize]) - offset);
    let close = ON * mesh.size();
    let side = match (gaps().all(|gap| gap >= -close), gaps().all(|gap| gap <= close)) {
        (true, true) => return Ok(None),
        (true, false) => 1.0,
        (false, true) => -1.0,
        (false, false) => {
            return Err(MembraneError::Structure(format!(
                "cloth lies on both sides of the plane of `{name}`: `contact` is for a plane of symmetry that the cloth doesn't pass through; leave it out"
            )));
        }
    };
    Ok(Some((Mirror { normal: scaled(normal, side), offset: side * offset }, on)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesher::{Surface, grid};

    fn mesh(place: &dyn Fn(f64, f64) -> Vector) -> Mesh {
        grid(&Surface { place, pattern: None, cells: [4, 4], is_quadratic: false })
    }

    #[test]
    fn a_plane_stops_cloth_on_one_side_of_an_edge() {
        let mesh = mesh(&|u, v| [-u, v, v * (u - 0.4)]);
        let all: Vec<u32> = (0..25).collect();
        let (plane, on) = mirror(&mesh, &all, "u0", [2.0, 0.0, 0.0]).unwrap().unwrap();
        assert_eq!((plane, on.len()), (Mirror { normal: [-1.0, 0.0, 0.0], offset: 0.0 }, 5));
        let (plane, _) = mirror(&mesh, &all, "v1", [0.0, 2.0, 0.0]).unwrap().unwrap();
        assert_eq!(plane, Mirror { normal: [0.0, -1.0, 0.0], offset: -1.0 });
        let error = mirror(&mesh, &all, "v0", [0.0, 0.0, 1.0]).unwrap_err().to_string();
        assert!(error.contains("on both sides of the plane of `v0`"), "{error}");
    }

    #[test]
    fn a_mesh_that_is_flat_on_a_plane_may_leave_it_to_either_side() {
        let mesh = mesh(&|u, v| [u, v, 0.0]);
        assert!(mirror(&mesh, &[0, 7, 24], "u1", [0.0, 0.0, 3.0]).unwrap().is_none());
    }
}
