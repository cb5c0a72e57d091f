//! Converts supports of groups into degrees of freedom of nodes.

use super::{Fitting, Support};
use crate::dofs::{Clash, ClashKind, Dofs, Supports};
use crate::error::MembraneError;
use crate::mesh::Mesh;
use core::f64::consts::TAU;

/// Degrees of freedom, with their values at the positions of the mesh. `is_used` marks nodes of elements,
/// `is_flat` those of membranes of revolution.
pub(super) fn dofs(
    mesh: &Mesh,
    supports: &[(String, Support)],
    fittings: &[Fitting],
    is_used: &[bool],
    is_flat: &[bool],
) -> Result<(Dofs, Vec<f64>), MembraneError> {
    let mut held = Supports::new(mesh.nodes.len());
    for fitting in fittings {
        held.fitting(*fitting == Fitting::Loaded);
    }
    for (node, (is_used, is_flat)) in is_used.iter().zip(is_flat).enumerate() {
        if !is_used {
            held.fix(node, supports.len());
        } else if *is_flat {
            held.hold(node, [0.0, 1.0, 0.0], supports.len());
        }
    }
    let mut is_ridden = vec![false; fittings.len()];
    for (by, (name, support)) in supports.iter().enumerate() {
        let nodes = used(mesh, name, is_used)?;
        match support {
            Support::Fitting { fitting } if *fitting >= fittings.len() => {
                let known = fittings.len();
                return Err(MembraneError::Structure(format!(
                    "there is no fitting {fitting}: {known} are known, counted from 0"
                )));
            }
            Support::Fitting { fitting } => is_ridden[*fitting] |= !nodes.is_empty(),
            Support::Cyclic { partner, angle } => check_turn(name, partner, *angle)?,
            _ => (),
        }
        hold(mesh, supports, by, &nodes, is_used, &mut held)?;
    }
    let mut all = fittings.iter().zip(&is_ridden);
    if let Some(fitting) = all.position(|(kind, is_ridden)| *kind == Fitting::Loaded && !is_ridden) {
        return Err(MembraneError::Structure(format!(
            "no element has a node on the loaded fitting {fitting} (counted from 0): hold a group of a part by it, or leave it out"
        )));
    }
    held.dofs(&mesh.nodes).map_err(|clash| named(mesh, supports, clash))
}

/// The nodes of a group that belong to elements; others don't move, whatever their supports say.
fn used(mesh: &Mesh, group: &str, is_used: &[bool]) -> Result<Vec<usize>, MembraneError> {
    let mut nodes = mesh.nodes_of(group).ok_or_else(|| MembraneError::unknown_group(group, mesh))?;
    nodes.retain(|node| is_used[*node]);
    Ok(nodes)
}

fn check_turn(group: &str, partner: &str, angle: f64) -> Result<(), MembraneError> {
    let turn = angle.rem_euclid(TAU);
    let is_turn = turn.min(TAU - turn) > 1e-6;
    if group != partner && is_turn {
        return Ok(());
    }
    Err(MembraneError::Structure(format!(
        "`{group}` is to follow `{partner}` turned by {:.6} degrees about z, which is the same edge: name the other edge of the sector as partner, and the angle from it to `{group}`",
        angle.to_degrees()
    )))
}

fn hold(
    mesh: &Mesh,
    supports: &[(String, Support)],
    by: usize,
    nodes: &[usize],
    is_used: &[bool],
    held: &mut Supports,
) -> Result<(), MembraneError> {
    let (name, support) = &supports[by];
    let clash = |clash| named(mesh, supports, clash);
    if let Support::Cyclic { partner, angle } = support {
        let partners = used(mesh, partner, is_used)?;
        for (node, partner) in mesh.partners(name, nodes, partner, &partners, *angle)? {
            held.follow(node, partner, *angle, by).map_err(clash)?;
        }
        return Ok(());
    }
    for node in nodes.iter().copied() {
        let [x, y, _] = mesh.nodes[node];
        let mut across = |normals: [[f64; 3]; 2]| normals.map(|normal| held.hold(node, normal, by));
        match support {
            Support::Fixed => held.fix(node, by),
            Support::Plane { normal } => held.hold(node, *normal, by),
            Support::Slide if x.hypot(y) > 0.0 => drop(across([[x, y, 0.0], [-y, x, 0.0]])),
            Support::Axis | Support::Slide => drop(across([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])),
            Support::Fitting { fitting } => held.ride(node, *fitting, by).map_err(clash)?,
            Support::Cyclic { .. } => (),
        }
    }
    Ok(())
}

/// The error of a clash, with numbers and names from the mesh.
fn named(mesh: &Mesh, supports: &[(String, Support)], clash: Clash) -> MembraneError {
    let node = mesh.number(clash.node);
    let [first, second] = clash.by.map(|by| supports.get(by).map_or("", |(name, _)| name.as_str()));
    let what = match clash.kind {
        ClashKind::TwoFittings => format!(
            "rides on two fittings, by `{first}` and by `{second}`: a node can only ride on one; take it out of one of the groups"
        ),
        ClashKind::TwoPartners => format!(
            "follows two nodes, by `{first}` and by `{second}`: a node can only follow one; take it out of one of the groups"
        ),
        ClashKind::Chain => format!(
            "is the partner of a node of `{first}` and follows another itself, by `{second}`: the two edges of a cyclic sector must be apart; leave one of the supports out"
        ),
        ClashKind::HeldFitting => format!(
            "rides on a fitting, by `{second}`, and is held along z, by `{first}`: a fitting moves along z; keep one of the two supports"
        ),
    };
    MembraneError::Structure(format!("node {node} {what}"))
}
