//! The fraction of a full turn about z that a mesh covers, if its supports determine it.

use super::rims::Rims;
use super::sides;
use crate::error::MembraneError;
use crate::mesh::{CellKind, Mesh};
use crate::structure::{Part, Support};
use core::f64::consts::TAU;

/// Angles closer than this are equal, rad.
const CLOSE: f64 = 1e-5;

/// The angle of the sector, rad: between the edges of a cyclic one, or between two planes of symmetry. `None`
/// if nothing determines it.
pub(crate) fn sector(
    mesh: &Mesh,
    parts: &[(String, Part)],
    supports: &[(String, Support)],
) -> Result<Option<f64>, MembraneError> {
    for (_, support) in supports {
        if let Support::Cyclic { angle, .. } = support {
            let angle = angle.rem_euclid(TAU);
            return Ok(Some(angle.min(TAU - angle)));
        }
    }
    if parts.iter().any(|(_, part)| matches!(part, Part::Revolved { .. })) {
        return Ok(Some(TAU));
    }
    if !supports.iter().any(|(_, support)| is_upright(support)) {
        return Ok(None);
    }
    let blocks = super::membranes(mesh, parts)?;
    Ok(between(mesh, &rays(mesh, &blocks, supports)?, &blocks))
}

fn is_upright(support: &Support) -> bool {
    matches!(support, Support::Plane { normal } if normal[2].abs() <= 1e-6 * normal[0].hypot(normal[1]))
}

/// The directions from the axis in which open edges lie in planes of symmetry.
fn rays(mesh: &Mesh, blocks: &[usize], supports: &[(String, Support)]) -> Result<Vec<f64>, MembraneError> {
    let (rims, size) = (Rims::new(mesh, supports)?, mesh.size());
    let mut rays: Vec<f64> = Vec::new();
    for found in sides(mesh, blocks).chunk_by(|a, b| a.nodes == b.nodes) {
        let [open] = found else { continue };
        for (name, support) in rims.common(open.nodes).filter(|(_, support)| is_upright(support)) {
            if rims.fault(name, support, open.nodes).is_some() {
                continue;
            }
            for [x, y, _] in open.nodes.map(|node| mesh.nodes[node]) {
                let ray = y.atan2(x);
                if x.hypot(y) > 1e-3 * size && !rays.iter().any(|other| is_near(ray - other)) {
                    rays.push(ray);
                }
            }
        }
    }
    Ok(rays)
}

/// Whether an angle is a whole number of turns.
fn is_near(angle: f64) -> bool {
    let angle = angle.rem_euclid(TAU);
    angle.min(TAU - angle) < CLOSE
}

/// The angle from one of two rays to the other, across the mesh.
fn between(mesh: &Mesh, rays: &[f64], blocks: &[usize]) -> Option<f64> {
    let [from, to] = rays[..] else { return None };
    let turn = (to - from).rem_euclid(TAU);
    let (mut is_inside, mut is_outside) = (false, false);
    for block in blocks.iter().map(|b| &mesh.blocks[*b]).filter(|block| block.kind != CellKind::Point) {
        for cell in block.cells.chunks_exact(block.kind.nodes()) {
            let corners = cell.iter().take(3).map(|node| mesh.nodes[*node]);
            let [x, y] = corners.fold([0.0, 0.0], |[x, y], place| [x + place[0], y + place[1]]);
            let angle = (y.atan2(x) - from).rem_euclid(TAU);
            is_inside |= angle < turn;
            is_outside |= angle > turn;
        }
    }
    match (is_inside, is_outside) {
        (true, false) => Some(turn),
        (false, true) => Some(TAU - turn),
        _ => None,
    }
}
