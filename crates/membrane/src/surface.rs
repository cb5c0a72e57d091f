//! Checks that the membranes of a mesh enclose a volume, and orients them.
//!
//! The pressure acts along the normals, and the volume is the flux through the elements. Neighbours must
//! therefore face the same side, and an open edge must lie on something that closes it without elements (a
//! fitting, a fixed rim, a plane of symmetry, the other edge of a cyclic sector).

mod rims;
mod sector;

pub(crate) use rims::Rims;
pub(crate) use sector::sector;

use crate::element::{Vector, cross, dot, sub};
use crate::error::MembraneError;
use crate::mesh::{Block, CellKind, Mesh};
use crate::structure::Part;
use std::collections::HashMap;

/// One cell: its block and its number there.
type Cell = (usize, usize);

/// Cells whose nodes must be reversed.
pub(crate) struct Turned {
    is_turned: HashMap<Cell, bool>,
}

/// A side of a cell.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Its two end nodes, the smaller number first.
    nodes: [usize; 2],
    cell: Cell,
    /// Whether the cell traverses it from the smaller to the larger number.
    is_forward: bool,
    middle: Option<usize>,
}

impl Turned {
    pub(crate) fn is_turned(&self, block: usize, cell: usize) -> bool {
        self.is_turned.get(&(block, cell)).copied().unwrap_or(false)
    }
}

/// The blocks of membranes: triangles, and revolved lines.
pub(crate) fn membranes(mesh: &Mesh, parts: &[(String, Part)]) -> Result<Vec<usize>, MembraneError> {
    let mut blocks = Vec::new();
    for (name, _) in parts.iter().filter(|(_, part)| !matches!(part, Part::Cable { .. })) {
        for (b, block) in mesh.blocks.iter().enumerate() {
            if block.group == *name && block.kind != CellKind::Point {
                if blocks.contains(&b) {
                    return Err(MembraneError::Structure(format!(
                        "`{name}` has two parts: only the layers of a membrane of revolution can share a group"
                    )));
                }
                blocks.push(b);
            }
        }
    }
    Ok(blocks)
}

/// The blocks of cables.
fn cables(mesh: &Mesh, parts: &[(String, Part)]) -> Vec<usize> {
    let is_cable = |block: &Block| {
        parts.iter().any(|(name, part)| *name == block.group && matches!(part, Part::Cable { .. }))
    };
    (0..mesh.blocks.len()).filter(|b| is_cable(&mesh.blocks[*b])).collect()
}

/// Checks the membranes, and finds the cells that face the wrong way.
pub(crate) fn oriented(
    mesh: &Mesh,
    parts: &[(String, Part)],
    rims: &Rims<'_>,
) -> Result<Turned, MembraneError> {
    let (triangles, lines): (Vec<usize>, Vec<usize>) = membranes(mesh, parts)?
        .into_iter()
        .partition(|b| matches!(mesh.blocks[*b].kind, CellKind::Triangle3 | CellKind::Triangle6));
    let mut is_turned = HashMap::new();
    let sides = sides(mesh, &triangles);
    check_sides(mesh, &sides, rims)?;
    check_cables(mesh, &sides, &cables(mesh, parts))?;
    spread(mesh, &triangles, &sides, &mut is_turned)?;
    chain(mesh, &lines, rims, &mut is_turned)?;
    Ok(Turned { is_turned })
}

/// The sides of all triangles, sorted so that those with the same nodes are adjacent.
fn sides(mesh: &Mesh, blocks: &[usize]) -> Vec<Side> {
    let mut sides = Vec::new();
    for b in blocks {
        let block = &mesh.blocks[*b];
        if !matches!(block.kind, CellKind::Triangle3 | CellKind::Triangle6) {
            continue;
        }
        for (c, cell) in block.cells.chunks_exact(block.kind.nodes()).enumerate() {
            for k in 0..3 {
                let (from, to) = (cell[k], cell[(k + 1) % 3]);
                sides.push(Side {
                    nodes: [from.min(to), from.max(to)],
                    cell: (*b, c),
                    is_forward: from < to,
                    middle: cell.get(3 + k).copied(),
                });
            }
        }
    }
    // Sorted, so that the first reported error is always the same.
    sides.sort_unstable_by_key(|side| (side.nodes, side.cell));
    sides
}

fn check_sides(mesh: &Mesh, sides: &[Side], rims: &Rims<'_>) -> Result<(), MembraneError> {
    for found in sides.chunk_by(|a, b| a.nodes == b.nodes) {
        match found {
            [open] if !rims.closes(open.nodes)? => return Err(hole(mesh, open.cell, open.nodes)),
            [one, two] if one.middle != two.middle => {
                return Err(mixed_orders(mesh, one.cell, two.cell, one.nodes));
            }
            [] | [_] | [_, _] => (),
            [first, ..] => return Err(branch(mesh, first.cell, first.nodes, found.len())),
        }
    }
    Ok(())
}

/// Checks that a cable along the side of a triangle has a middle node exactly if the triangle has one.
fn check_cables(mesh: &Mesh, sides: &[Side], cables: &[usize]) -> Result<(), MembraneError> {
    for b in cables {
        let block = &mesh.blocks[*b];
        if !matches!(block.kind, CellKind::Line2 | CellKind::Line3) {
            continue;
        }
        for (c, cell) in block.cells.chunks_exact(block.kind.nodes()).enumerate() {
            let nodes = [cell[0].min(cell[1]), cell[0].max(cell[1])];
            let side = sides.get(sides.partition_point(|side| side.nodes < nodes));
            match side {
                Some(side) if side.nodes == nodes && side.middle != cell.get(2).copied() => {
                    return Err(mixed_orders(mesh, (*b, c), side.cell, nodes));
                }
                _ => (),
            }
        }
    }
    Ok(())
}

/// Only one of two neighbours has a middle node on their common edge.
fn mixed_orders(mesh: &Mesh, one: Cell, two: Cell, nodes: [usize; 2]) -> MembraneError {
    let (one, two, [a, b]) = (name(mesh, one), name(mesh, two), nodes.map(|node| mesh.number(node)));
    MembraneError::Structure(format!(
        "{one} and {two} share the edge between the nodes {a} and {b}, but not the node in its middle: mesh all with the same order"
    ))
}

/// An open edge isn't closed by anything.
fn hole(mesh: &Mesh, cell: Cell, nodes: [usize; 2]) -> MembraneError {
    let (element, [a, b]) = (name(mesh, cell), nodes.map(|node| mesh.number(node)));
    MembraneError::Structure(format!(
        "{element} has an open edge between the nodes {a} and {b} with nothing there: the gas would leave; close the mesh, or hold the edge"
    ))
}

/// More than two elements share one edge.
fn branch(mesh: &Mesh, cell: Cell, nodes: [usize; 2], count: usize) -> MembraneError {
    let (element, [a, b]) = (name(mesh, cell), nodes.map(|node| mesh.number(node)));
    MembraneError::Structure(format!(
        "{count} elements meet at the edge between the nodes {a} and {b} (one is {element}): a membrane has two sides only"
    ))
}

/// Orients each connected surface consistently: outwards, if its volume determines the direction.
fn spread(
    mesh: &Mesh,
    blocks: &[usize],
    sides: &[Side],
    is_turned: &mut HashMap<Cell, bool>,
) -> Result<(), MembraneError> {
    let mut neighbours: HashMap<Cell, Vec<(Cell, bool)>> = HashMap::new();
    for found in sides.chunk_by(|a, b| a.nodes == b.nodes) {
        if let [a, b] = found {
            // Neighbours that face the same side traverse their common side in opposite directions.
            let is_same = a.is_forward != b.is_forward;
            neighbours.entry(a.cell).or_default().push((b.cell, is_same));
            neighbours.entry(b.cell).or_default().push((a.cell, is_same));
        }
    }
    for b in blocks {
        let block = &mesh.blocks[*b];
        for c in 0..block.cells.len() / block.kind.nodes() {
            if is_turned.contains_key(&(*b, c)) {
                continue;
            }
            let mut surface = vec![(*b, c)];
            is_turned.insert((*b, c), false);
            let (mut next, mut volume, mut size) = (0, 0.0, 0.0);
            while let Some(cell) = surface.get(next).copied() {
                next += 1;
                let turned = is_turned[&cell];
                let own = flux(mesh, cell);
                volume += if turned { -own } else { own };
                size += own.abs();
                for (other, is_same) in neighbours.get(&cell).into_iter().flatten() {
                    let wanted = turned == *is_same;
                    match is_turned.get(other) {
                        Some(there) if *there == wanted => (),
                        Some(_) => {
                            let element = name(mesh, *other);
                            return Err(MembraneError::Structure(format!(
                                "the membrane is twisted at {element}: it has no inside"
                            )));
                        }
                        None => {
                            is_turned.insert(*other, wanted);
                            surface.push(*other);
                        }
                    }
                }
            }
            if volume < -1e-9 * size {
                for cell in surface {
                    is_turned.entry(cell).and_modify(|turned| *turned = !*turned);
                }
            }
        }
    }
    Ok(())
}

/// The volume between a triangle's corners and the axis.
fn flux(mesh: &Mesh, (b, c): Cell) -> f64 {
    let block = &mesh.blocks[b];
    let cell = &block.cells[c * block.kind.nodes()..];
    let [p, q, r]: [Vector; 3] = [0, 1, 2].map(|k| mesh.nodes[cell[k]]);
    let mean = [(p[0] + q[0] + r[0]) / 3.0, (p[1] + q[1] + r[1]) / 3.0, 0.0];
    0.25 * dot(mean, cross(sub(q, p), sub(r, p)))
}

/// Checks lines of revolution: every node joins two of them, or is an end that is held or lies on the axis.
fn chain(
    mesh: &Mesh,
    blocks: &[usize],
    rims: &Rims<'_>,
    is_turned: &mut HashMap<Cell, bool>,
) -> Result<(), MembraneError> {
    let mut at: HashMap<usize, Vec<(Cell, bool)>> = HashMap::new();
    for b in blocks {
        let block = &mesh.blocks[*b];
        for (c, cell) in block.cells.chunks_exact(block.kind.nodes()).enumerate() {
            at.entry(cell[0]).or_default().push(((*b, c), true));
            at.entry(cell[1]).or_default().push(((*b, c), false));
        }
    }
    let size = mesh.nodes.iter().fold(0.0_f64, |a, x| a.max(x[0].abs()));
    let mut nodes: Vec<_> = at.iter().collect();
    nodes.sort_by_key(|(node, _)| **node);
    for (node, ends) in &nodes {
        let is_closed = rims.holds(**node) || mesh.nodes[**node][0] <= 1e-9 * size;
        match ends.len() {
            1 if !is_closed => return Err(hole(mesh, ends[0].0, [**node; 2])),
            1 | 2 => (),
            count => return Err(branch(mesh, ends[0].0, [**node; 2], count)),
        }
    }
    // From one element to the next, all in one direction; upwards if that can be decided.
    for (_, ends) in &nodes {
        let first = ends[0].0;
        if is_turned.contains_key(&first) {
            continue;
        }
        let mut line = vec![first];
        is_turned.insert(first, false);
        let (mut next, mut rise) = (0, 0.0);
        while let Some((b, c)) = line.get(next).copied() {
            next += 1;
            let block = &mesh.blocks[b];
            let cell = &block.cells[c * block.kind.nodes()..];
            let turned = is_turned[&(b, c)];
            let (p, q) = (mesh.nodes[cell[0]], mesh.nodes[cell[1]]);
            let own = (p[0] * p[0] + p[0] * q[0] + q[0] * q[0]) * (q[2] - p[2]);
            rise += if turned { -own } else { own };
            for (node, is_start) in [(cell[0], true), (cell[1], false)] {
                for (other, other_is_start) in &at[&node] {
                    is_turned.entry(*other).or_insert_with(|| {
                        line.push(*other);
                        // One ends where the next begins.
                        turned ^ (is_start == *other_is_start)
                    });
                }
            }
        }
        if rise < 0.0 {
            for cell in line {
                is_turned.entry(cell).and_modify(|turned| *turned = !*turned);
            }
        }
    }
    Ok(())
}

/// Number and group of a cell, for messages.
fn name(mesh: &Mesh, (b, c): Cell) -> String {
    let Block { numbers, group, .. } = &mesh.blocks[b];
    format!("element {} of `{group}`", numbers.get(c).copied().unwrap_or(c as u64 + 1))
}

/// The nodes of a cell in reverse order.
pub(crate) fn backwards<T, const N: usize>(kind: CellKind, mut nodes: [T; N]) -> [T; N] {
    match kind {
        CellKind::Point => (),
        CellKind::Line2 | CellKind::Line3 => nodes.swap(0, 1),
        CellKind::Triangle3 => nodes.swap(1, 2),
        CellKind::Triangle6 => {
            nodes.swap(1, 2);
            nodes.swap(3, 5);
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::Support;

    /// As [`super::oriented`], with one part `skin` or `wall` and the nodes of `held` fixed.
    fn oriented(mesh: &Mesh, held: &[usize]) -> Result<Turned, MembraneError> {
        let mut mesh = mesh.clone();
        let part = match mesh.blocks[0].kind {
            CellKind::Line2 => Part::Revolved { layers: Vec::new() },
            _ => Part::Membrane { sheet: None, warp: [1.0, 0.0, 0.0] },
        };
        let parts = [(mesh.blocks[0].group.clone(), part)];
        mesh.blocks.push(Block {
            group: "rim".to_owned(),
            kind: CellKind::Point,
            cells: held.to_vec(),
            numbers: held.iter().map(|node| *node as u64).collect(),
            pattern: None,
        });
        let supports = [("rim".to_owned(), Support::Fixed)];
        super::oriented(&mesh, &parts, &Rims::new(&mesh, &supports)?)
    }

    /// A tetrahedron's surface with some faces inside out.
    fn tetrahedron() -> Mesh {
        let faces = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]];
        Mesh {
            nodes: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            numbers: vec![11, 12, 13, 14],
            blocks: vec![Block {
                group: "skin".to_owned(),
                kind: CellKind::Triangle3,
                cells: faces.concat(),
                numbers: vec![21, 22, 23, 24],
                pattern: None,
            }],
        }
    }

    #[test]
    fn a_closed_surface_faces_outwards() {
        let mesh = tetrahedron();
        let turned = oriented(&mesh, &[]).unwrap();
        let volume: f64 =
            (0..4).map(|c| flux(&mesh, (0, c)) * if turned.is_turned(0, c) { -1.0 } else { 1.0 }).sum();
        assert!((volume - 1.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn a_hole_a_branch_and_a_twist_are_named() {
        let mut mesh = tetrahedron();
        let face = mesh.blocks[0].cells.split_off(9);
        let error = oriented(&mesh, &[]).err().unwrap();
        assert!(error.to_string().contains("an open edge between the nodes 11 and 13 "), "{error}");
        // If its rim is held, the surface is closed.
        assert!(oriented(&mesh, &[0, 2, 3]).is_ok());
        mesh.blocks[0].cells.extend(face.iter().chain(&face));
        mesh.blocks[0].numbers.push(25);
        let error = oriented(&mesh, &[]).err().unwrap();
        assert!(error.to_string().starts_with("3 elements meet at the edge"), "{error}");
        // A strip of triangles with a half twist, held at its edge.
        let strip = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
        mesh.nodes = (0..5).map(|i| [f64::from(i).cos(), f64::from(i).sin(), f64::from(i * i)]).collect();
        mesh.blocks[0].cells = strip.concat();
        let error = oriented(&mesh, &[0, 1, 2, 3, 4]).err().unwrap();
        assert!(error.to_string().starts_with("the membrane is twisted at element"), "{error}");
    }

    #[test]
    fn a_line_has_two_ends() {
        let line = |z: [f64; 3], cells: Vec<usize>| Mesh {
            nodes: z.map(|z| [1.0, 0.0, z]).to_vec(),
            numbers: vec![1, 2, 3],
            blocks: vec![Block {
                group: "wall".to_owned(),
                kind: CellKind::Line2,
                cells,
                numbers: vec![1, 2],
                pattern: None,
            }],
        };
        let mesh = line([0.0, 1.0, 2.0], vec![0, 1, 2, 1]);
        let turned = oriented(&mesh, &[0, 2]).unwrap();
        assert_eq!([turned.is_turned(0, 0), turned.is_turned(0, 1)], [false, true]);
        let down = line([2.0, 1.0, 0.0], vec![0, 1, 1, 2]);
        assert!(oriented(&down, &[0, 2]).unwrap().is_turned(0, 1));
        let error = oriented(&mesh, &[0]).err().unwrap();
        assert!(error.to_string().contains("an open edge between the nodes 3 and 3 "), "{error}");
    }
}
