//! Sheets that resist bending: each node with its neighbours.

use super::{Source, Support};
use crate::element::{Star, Vector, corners, cross, dot, norm, scaled, sub};
use crate::error::MembraneError;
use crate::mesh::{CellKind, Mesh};
use crate::set::{Elements, Set};
use std::collections::{BTreeMap, BTreeSet};

/// Cosine between the normals of a sheet and of a plane of symmetry below which the sheet crosses the plane; else it touches
/// it, and is a fold or a seam there.
const CROSSES: f64 = 0.5;

/// Sine of the angle between planes of symmetry below which they are one.
const SAME: f64 = 1e-6;
/// Cosine of the angle over an edge from which a mesh is folded there: 60 degrees.
const FOLDED: f64 = 0.5;
/// Distance of a neighbour from the plane of the others, over its own, that isn't rounding.
const CURVED: f64 = 1e-6;
/// Weight of a neighbour over that of the node that is rounding: edges opposite to two right angles have none.
const NONE: f64 = 1e-12;

/// The nodes of sheets that resist bending, by how many neighbours they have: up to 6, 8 and 16. A mesh of the plane has 6 on
/// average; fewer places take less memory.
#[derive(Debug)]
pub(crate) struct Stars {
    six: Set<Star<7>, 7>,
    eight: Set<Star<9>, 9>,
    sixteen: Set<Star<17>, 17>,
}

impl Default for Stars {
    fn default() -> Self {
        let (six, eight) = (Set::new(Vec::new(), Vec::new()), Set::new(Vec::new(), Vec::new()));
        Self { six, eight, sixteen: Set::new(Vec::new(), Vec::new()) }
    }
}

impl Stars {
    pub(crate) fn sets(&self) -> [&dyn Elements; 3] {
        [&self.six, &self.eight, &self.sixteen]
    }
}

/// A node of the sheets: the weights of its neighbours, the area around, the sum of bending stiffness times area, and whether
/// all triangles around are flat where the mesh puts them.
#[derive(Default)]
struct Around {
    weights: BTreeMap<u32, f64>,
    area: f64,
    bending: f64,
    is_placed: bool,
}

impl Around {
    /// The node itself, and the neighbours with a weight.
    fn row(&self, node: u32) -> Vec<(u32, f64)> {
        let own = -self.weights.values().sum::<f64>();
        let neighbours = self.weights.iter().filter(|(_, w)| w.abs() > NONE * own.abs());
        [(node, own)].into_iter().chain(neighbours.map(|(node, w)| (*node, *w))).collect()
    }
}

/// The nodes of groups with these bending stiffnesses \[N m\].
pub(super) fn stars(
    mesh: &Mesh,
    supports: &[(String, Support)],
    groups: &[(String, f64)],
) -> Result<Stars, MembraneError> {
    let mut stars = Stars::default();
    if groups.is_empty() {
        return Ok(stars);
    }
    if let Some((name, _)) = supports.iter().find(|(_, support)| matches!(support, Support::Cyclic { .. })) {
        return Err(MembraneError::Structure(format!(
            "sheets that resist bending can't be a sector whose edges follow each other, as `{name}` does: mesh a part between planes of symmetry, or the whole"
        )));
    }
    let sheets = Sheets::new(mesh, supports, groups)?;
    for (node, around) in &sheets.nodes {
        let Some(across) = sheets.across(*node) else { continue };
        let all = around.row(*node);
        let number = mesh.number(*node as usize);
        if around.is_placed && is_curved(mesh, &all) {
            return Err(MembraneError::Structure(format!(
                "the mesh is curved at node {number}, but sheets that resist bending are flat when free of stress: give its cells a flat pattern, or leave `bending` out"
            )));
        }
        let bending = around.bending / around.area;
        match all.len() {
            0..=7 => push(&mut stars.six, &all, around.area, bending, across),
            8..=9 => push(&mut stars.eight, &all, around.area, bending, across),
            10..=17 => push(&mut stars.sixteen, &all, around.area, bending, across),
            many => {
                return Err(MembraneError::Structure(format!(
                    "node {number} has {} neighbours, but in a sheet that resists bending at most 16: mesh it again",
                    many - 1
                )));
            }
        }
    }
    Ok(stars)
}

fn push<const N: usize>(
    set: &mut Set<Star<N>, N>,
    all: &[(u32, f64)],
    area: f64,
    bending: f64,
    across: Vec<Vector>,
) {
    let at = |i: usize| all.get(i).copied().unwrap_or((all[0].0, 0.0));
    set.nodes.push(core::array::from_fn(|i| at(i).0));
    set.elements.push(Star::new(core::array::from_fn(|i| at(i).1), area, bending, across));
}

/// Whether a node and its neighbours don't lie in a plane in the mesh.
fn is_curved(mesh: &Mesh, all: &[(u32, f64)]) -> bool {
    let own = mesh.nodes[all[0].0 as usize];
    let rays: Vec<Vector> = all[1..].iter().map(|(node, _)| sub(mesh.nodes[*node as usize], own)).collect();
    let normals = rays.iter().enumerate().flat_map(|(i, a)| rays[..i].iter().map(|b| cross(*a, *b)));
    let Some(normal) = normals.max_by(|a, b| norm(*a).total_cmp(&norm(*b))) else { return false };
    rays.iter().any(|ray| dot(*ray, normal).abs() > CURVED * norm(*ray) * norm(normal))
}

/// The groups that resist bending, as one sheet where they share nodes.
struct Sheets {
    nodes: BTreeMap<u32, Around>,
    /// Nodes at which it ends, or is folded.
    ends: BTreeSet<u32>,
    /// Normals of planes that it crosses at a node.
    mirrors: BTreeMap<u32, Vec<Vector>>,
}

impl Sheets {
    fn new(
        mesh: &Mesh,
        supports: &[(String, Support)],
        groups: &[(String, f64)],
    ) -> Result<Self, MembraneError> {
        let (mut held, mut planes) = (BTreeSet::new(), Vec::new());
        for (name, support) in supports {
            let on = mesh.nodes_of(name).ok_or_else(|| MembraneError::unknown_group(name, mesh))?;
            held.extend(on.iter().copied());
            if let Support::Plane { normal } = support {
                planes.push((on, scaled(*normal, 1.0 / norm(*normal))));
            }
        }
        let mut sheets = Self { nodes: BTreeMap::new(), ends: BTreeSet::new(), mirrors: BTreeMap::new() };
        let mut edges: BTreeMap<[u32; 2], Vec<[u32; 3]>> = BTreeMap::new();
        for (group, bending) in groups {
            for Cell { nodes, flat, is_placed } in cells(mesh, group)? {
                for k in 0..3 {
                    let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3];
                    let ([at_b, at_c], area) = corners([flat[a], flat[b], flat[c]]);
                    let around = sheets
                        .nodes
                        .entry(nodes[a])
                        .or_insert(Around { is_placed: true, ..Around::default() });
                    around.area += area;
                    around.bending += area * bending;
                    around.is_placed &= is_placed;
                    // The edge to a corner is opposite to the other one.
                    *around.weights.entry(nodes[b]).or_default() += at_c;
                    *around.weights.entry(nodes[c]).or_default() += at_b;
                    edges.entry([nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]).or_default().push(nodes);
                }
            }
        }
        for (edge, triangles) in edges {
            if let [one, other] = triangles[..]
                && !is_folded(mesh, edge, one, other)
            {
                continue;
            }
            let lies_on = |on: &[usize]| edge.iter().all(|node| on.binary_search(&(*node as usize)).is_ok());
            let plane =
                planes.iter().find(|(on, normal)| lies_on(on) && crosses(mesh, triangles[0], *normal));
            match plane.filter(|_| triangles.len() == 1) {
                Some((_, normal)) => {
                    for node in edge {
                        sheets.mirrors.entry(node).or_default().push(*normal);
                    }
                }
                // Where it isn't held, ripples along an edge would cost nothing.
                None if edge.iter().all(|node| held.contains(&(*node as usize))) => sheets.ends.extend(edge),
                None => {
                    let [a, b] = edge.map(|node| mesh.number(node as usize));
                    return Err(MembraneError::Structure(format!(
                        "a sheet that resists bending ends or is folded between the nodes {a} and {b}, where nothing holds it: it needs a support or a plane of symmetry there, or `bending` in the material of the group beside it as well"
                    )));
                }
            }
        }
        Ok(sheets)
    }

    /// Unit vectors across all planes of symmetry at a node, at right angles; `None` if the sheet ends there.
    fn across(&self, node: u32) -> Option<Vec<Vector>> {
        let mut across: Vec<Vector> = Vec::new();
        for normal in self.mirrors.get(&node).into_iter().flatten() {
            let rest = across.iter().fold(*normal, |rest, own| sub(rest, scaled(*own, dot(*own, rest))));
            if norm(rest) > SAME {
                across.push(scaled(rest, 1.0 / norm(rest)));
            }
        }
        (!self.ends.contains(&node)).then_some(across)
    }
}

/// Nodes of a triangle and their flat places, and whether these are those of the mesh.
struct Cell {
    nodes: [u32; 3],
    flat: [Vector; 3],
    is_placed: bool,
}

/// The triangles of a group.
fn cells(mesh: &Mesh, group: &str) -> Result<Vec<Cell>, MembraneError> {
    let mut cells = Vec::new();
    let mut is_known = false;
    for block in mesh.blocks.iter().filter(|block| block.group == group) {
        is_known = true;
        match block.kind {
            CellKind::Point => continue,
            CellKind::Triangle3 => (),
            kind => {
                return Err(MembraneError::Structure(format!(
                    "`{group}` has cells of the kind {kind:?}: only triangles with three nodes resist bending"
                )));
            }
        }
        let source = Source { mesh, block, is_turned: &|_| false };
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a mesh has fewer than 2^31 nodes: checked when it is read"
        )]
        let numbers = |cell: &[usize; 3]| cell.map(|node| node as u32);
        let own = block.cells.as_chunks::<3>().0.iter().enumerate();
        cells.extend(own.map(|(i, cell)| Cell {
            nodes: numbers(cell),
            flat: source.stress_free(i),
            is_placed: block.pattern.is_none(),
        }));
    }
    if is_known { Ok(cells) } else { Err(MembraneError::unknown_group(group, mesh)) }
}

/// Whether two triangles are folded over their edge in the mesh, as two sheets are that are joined at a seam.
fn is_folded(mesh: &Mesh, [a, b]: [u32; 2], one: [u32; 3], other: [u32; 3]) -> bool {
    let at = |node: u32| mesh.nodes[node as usize];
    let third = |nodes: [u32; 3]| nodes.into_iter().find(|node| ![a, b].contains(node)).map_or(at(a), at);
    let edge = sub(at(b), at(a));
    let [up, down] = [one, other].map(|nodes| cross(edge, sub(third(nodes), at(a))));
    // Opposite to each other where the sheet goes on.
    dot(up, down) > -FOLDED * norm(up) * norm(down)
}

/// Whether a triangle crosses a plane.
fn crosses(mesh: &Mesh, nodes: [u32; 3], normal: Vector) -> bool {
    let [x0, x1, x2] = nodes.map(|node| mesh.nodes[node as usize]);
    let across = cross(sub(x1, x0), sub(x2, x0));
    dot(across, normal).abs() < CROSSES * norm(across)
}
