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

/// A node of a sheet: the weights of its neighbours, and the area around.
#[derive(Default)]
struct Around {
    weights: BTreeMap<u32, f64>,
    area: f64,
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
    let cyclic = supports.iter().find(|(_, support)| matches!(support, Support::Cyclic { .. }));
    if let (Some((name, _)), false) = (cyclic, groups.is_empty()) {
        return Err(MembraneError::Structure(format!(
            "sheets that resist bending can't be a sector whose edges follow each other, as `{name}` does: mesh the whole, or a part between planes of symmetry"
        )));
    }
    let planes = planes(mesh, supports)?;
    let mut stars = Stars::default();
    for (group, bending) in groups {
        let sheet = Sheet::new(mesh, group, &planes)?;
        for (node, around) in &sheet.nodes {
            let Some(across) = sheet.across(*node) else { continue };
            let all = around.row(*node);
            match all.len() {
                0..=7 => push(&mut stars.six, &all, around.area, *bending, across),
                8..=9 => push(&mut stars.eight, &all, around.area, *bending, across),
                10..=17 => push(&mut stars.sixteen, &all, around.area, *bending, across),
                many => {
                    return Err(MembraneError::Structure(format!(
                        "node {} of `{group}` has {} neighbours, but a sheet that resists bending at most 16: mesh it again",
                        mesh.number(*node as usize),
                        many - 1
                    )));
                }
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

/// The nodes on each plane of symmetry, with its unit normal.
fn planes(mesh: &Mesh, supports: &[(String, Support)]) -> Result<Vec<(Vec<usize>, Vector)>, MembraneError> {
    let mut planes = Vec::new();
    for (name, support) in supports {
        if let Support::Plane { normal } = support {
            let on = mesh.nodes_of(name).ok_or_else(|| MembraneError::unknown_group(name, mesh))?;
            planes.push((on, scaled(*normal, 1.0 / norm(*normal))));
        }
    }
    Ok(planes)
}

/// A group of triangles.
struct Sheet {
    nodes: BTreeMap<u32, Around>,
    /// Nodes at which it ends, or is sewn together.
    ends: BTreeSet<u32>,
    /// Normals of planes that it crosses at a node.
    mirrors: BTreeMap<u32, Vec<Vector>>,
}

impl Sheet {
    fn new(mesh: &Mesh, group: &str, planes: &[(Vec<usize>, Vector)]) -> Result<Self, MembraneError> {
        let mut sheet = Self { nodes: BTreeMap::new(), ends: BTreeSet::new(), mirrors: BTreeMap::new() };
        let mut edges: BTreeMap<[u32; 2], Vec<[u32; 3]>> = BTreeMap::new();
        for (nodes, flat) in cells(mesh, group)? {
            for k in 0..3 {
                let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3];
                let ([at_b, at_c], area) = corners([flat[a], flat[b], flat[c]]);
                let around = sheet.nodes.entry(nodes[a]).or_default();
                around.area += area;
                // The edge to a corner is opposite to the other one.
                *around.weights.entry(nodes[b]).or_default() += at_c;
                *around.weights.entry(nodes[c]).or_default() += at_b;
                edges.entry([nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]).or_default().push(nodes);
            }
        }
        for (edge, triangles) in edges.into_iter().filter(|(_, triangles)| triangles.len() != 2) {
            let lies_on = |on: &[usize]| edge.iter().all(|node| on.binary_search(&(*node as usize)).is_ok());
            let plane =
                planes.iter().find(|(on, normal)| lies_on(on) && crosses(mesh, triangles[0], *normal));
            match plane.filter(|_| triangles.len() == 1) {
                Some((_, normal)) => {
                    for node in edge {
                        let own = sheet.mirrors.entry(node).or_default();
                        if !own.contains(normal) {
                            own.push(*normal);
                        }
                    }
                }
                None => sheet.ends.extend(edge),
            }
        }
        Ok(sheet)
    }

    /// Normals of the planes of symmetry at a node; `None` if the sheet ends there, or if planes meet at an angle.
    fn across(&self, node: u32) -> Option<Vec<Vector>> {
        let own = self.mirrors.get(&node).cloned().unwrap_or_default();
        let is_square =
            own.iter().enumerate().all(|(i, a)| own[..i].iter().all(|b| dot(*a, *b).abs() < 1e-9));
        (is_square && !self.ends.contains(&node)).then_some(own)
    }
}

/// Nodes of a triangle, and their flat places.
type Cell = ([u32; 3], [Vector; 3]);

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
        cells.extend(own.map(|(i, cell)| (numbers(cell), source.stress_free(i))));
    }
    if is_known { Ok(cells) } else { Err(MembraneError::unknown_group(group, mesh)) }
}

/// Whether a triangle crosses a plane.
fn crosses(mesh: &Mesh, nodes: [u32; 3], normal: Vector) -> bool {
    let [x0, x1, x2] = nodes.map(|node| mesh.nodes[node as usize]);
    let across = cross(sub(x1, x0), sub(x2, x0));
    dot(across, normal).abs() < CROSSES * norm(across)
}
