//! Checks whether the supports hold every part of a structure; otherwise finds the free rigid motions, along
//! and about the axes.
//!
//! The unknowns are the small rigid motions u(x) = t + w x (x - c)/s of each connected piece, and the
//! positions f of the fittings that aren't prescribed. Each direction in which a node is held gives an
//! equation; a node on a fitting has u_z = f, and a node that follows a partner moves like it. The motions
//! that satisfy all equations are free. A line of revolution has a single rigid motion, along z.

use super::Group;
use crate::dofs::{Dofs, NONE, NodeDofs, complement};
use crate::element::{Vector, add, cross, dot, norm, scaled, sub};
use crate::error::MembraneError;
use crate::mesh::Mesh;
use bulge_numerics::vector;

/// The six components of a rigid motion: t and w.
type Motion = [f64; 6];

/// A node is held if it moves less than this fraction of the piece's largest motion.
const HELD: f64 = 1e-6;
/// A node is free if it moves more than this fraction.
const FREE: f64 = 1e-3;

/// A linear equation in a piece's motion and the fittings' positions.
#[derive(Debug, Clone)]
struct Row {
    motion: Motion,
    fittings: Vec<f64>,
}

/// Nodes connected by elements.
struct Piece {
    middle: Vector,
    size: f64,
    is_flat: bool,
    /// Equations, orthonormal in their motions.
    rows: Vec<Row>,
}

struct Pieces<'a> {
    mesh: &'a Mesh,
    dofs: &'a Dofs,
    /// The piece of each node; `NONE` for nodes without an element.
    of: Vec<u32>,
    all: Vec<Piece>,
    /// The remainders of equations whose motion is held already: they only concern the fittings' positions.
    fittings: Vec<Vec<f64>>,
}

/// Checks that every piece is held.
pub(super) fn check(
    mesh: &Mesh,
    groups: &[(String, Group)],
    dofs: &Dofs,
    is_flat: &[bool],
) -> Result<(), MembraneError> {
    let owners = owners(dofs);
    let mut pieces = Pieces::new(mesh, groups, dofs, is_flat, &owners);
    for node in 0..mesh.nodes.len() {
        pieces.hold(node, &owners);
    }
    let not_held = |node: usize, motion: &str| {
        let found = groups.iter().find(|(_, group)| {
            let set = group.elements();
            (0..set.count()).any(|e| set.nodes(e).iter().any(|other| *other as usize == node))
        });
        let (node, group) = (mesh.number(node), found.map_or("", |(name, _)| name.as_str()));
        Err(MembraneError::Structure(format!(
            "nothing holds the part of the mesh with node {node} of `{group}` against every rigid motion: it can {motion}; add a `[[support]]` against that"
        )))
    };
    if let Some((node, motion)) = pieces.free() {
        return not_held(node, &motion);
    }
    pieces.free_fitting().map_or(Ok(()), |node| not_held(node, "move along z with its loaded fitting"))
}

/// The first node of each degree of freedom.
fn owners(dofs: &Dofs) -> Vec<u32> {
    let mut owners = vec![NONE; dofs.all];
    for (i, node) in (0_u32..).zip(&dofs.nodes) {
        for dof in node.dof.iter().filter(|dof| **dof != NONE) {
            let owner = &mut owners[*dof as usize];
            *owner = (*owner).min(i);
        }
    }
    owners
}

impl<'a> Pieces<'a> {
    fn new(
        mesh: &'a Mesh,
        groups: &[(String, Group)],
        dofs: &'a Dofs,
        is_flat: &[bool],
        owners: &[u32],
    ) -> Self {
        let mut links = Links::new(mesh.nodes.len());
        for (_, group) in groups {
            let set = group.elements();
            for e in 0..set.count() {
                set.nodes(e).windows(2).for_each(|pair| links.join(pair[0], pair[1]));
                links.use_node(set.nodes(e));
            }
        }
        for (i, node) in (0_u32..).zip(&dofs.nodes) {
            for dof in node.dof.iter().filter(|dof| **dof != NONE && !dofs.fittings.contains(dof)) {
                links.join(owners[*dof as usize], i);
            }
        }
        let (of, count) = links.numbered();
        let mut pieces: Vec<Piece> = (0..count).map(|_| Piece::default()).collect();
        let mut counts = vec![0_u32; count];
        let known = || of.iter().zip(&mesh.nodes).zip(is_flat).filter(|((piece, _), _)| **piece != NONE);
        for ((piece, place), is_flat) in known() {
            let (piece, count) = (&mut pieces[*piece as usize], &mut counts[*piece as usize]);
            *count += 1;
            piece.middle = add(piece.middle, scaled(sub(*place, piece.middle), 1.0 / f64::from(*count)));
            piece.is_flat |= is_flat;
        }
        for ((piece, place), _) in known() {
            let piece = &mut pieces[*piece as usize];
            piece.size = piece.size.max(norm(sub(*place, piece.middle)));
        }
        Self { mesh, dofs, of, all: pieces, fittings: Vec::new() }
    }

    /// Adds the equations of a node's supports.
    fn hold(&mut self, node: usize, owners: &[u32]) {
        let Some(piece) = self.all.get(self.of[node] as usize) else { return };
        let held: &NodeDofs = &self.dofs.nodes[node];
        let place = self.mesh.nodes[node];
        let known = held.dof.iter().zip(&held.axis).filter(|(dof, _)| **dof != NONE);
        let axes: Vec<Vector> = known.clone().map(|(_, axis)| *axis).collect();
        let none = vec![0.0; self.loaded()];
        let mut rows: Vec<Row> = complement(&axes)
            .into_iter()
            .map(|normal| Row { motion: piece.displacement(place, normal), fittings: none.clone() })
            .collect();
        for (dof, axis) in known {
            let mut row = Row { motion: piece.displacement(place, *axis), fittings: none.clone() };
            let owner = owners[*dof as usize] as usize;
            if let Some(fitting) = self.dofs.fittings.iter().position(|own| own == dof) {
                // Prescribed fittings don't move.
                if let Some(number) = self.number_of(fitting) {
                    row.fittings[number] = -1.0;
                }
            } else if owner == node {
                continue;
            } else if let Some(k) = self.dofs.nodes[owner].dof.iter().position(|own| own == dof) {
                let other = piece.displacement(self.mesh.nodes[owner], self.dofs.nodes[owner].axis[k]);
                row.motion.iter_mut().zip(other).for_each(|(own, other)| *own -= other);
            }
            rows.push(row);
        }
        for row in rows {
            self.take(node, row);
        }
    }

    fn take(&mut self, node: usize, row: Row) {
        let left = self.all[self.of[node] as usize].take(row);
        let Some(mut left) = left else { return };
        for known in &self.fittings {
            subtract(&mut left, known);
        }
        let size = left.iter().map(|x| x * x).sum::<f64>().sqrt();
        if size > HELD {
            self.fittings.push(left.into_iter().map(|x| x / size).collect());
        }
    }

    /// Number of fittings whose positions are solved for.
    fn loaded(&self) -> usize {
        self.dofs.fittings.iter().filter(|dof| (**dof as usize) < self.dofs.free).count()
    }

    /// The index of such a fitting among them.
    fn number_of(&self, fitting: usize) -> Option<usize> {
        let is_loaded = |dof: &u32| (*dof as usize) < self.dofs.free;
        let fittings = &self.dofs.fittings;
        is_loaded(&fittings[fitting]).then(|| fittings[..fitting].iter().filter(|dof| is_loaded(dof)).count())
    }

    /// A node of a piece that can move while all fittings stand still, and its motion.
    fn free(&self) -> Option<(usize, String)> {
        let mut most: Option<(usize, f64, Motion)> = None;
        for (node, place) in self.mesh.nodes.iter().enumerate() {
            let Some(piece) = self.all.get(self.of[node] as usize) else { continue };
            if piece.rows.len() == if piece.is_flat { 1 } else { 6 } {
                continue;
            }
            for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
                let left = piece.left(piece.displacement(*place, axis));
                let size = vector::norm(&left);
                // Take the first one among equals.
                if size > FREE && most.is_none_or(|(_, most, _)| size > 1.5 * most) {
                    most = Some((node, size, left));
                }
            }
        }
        let (node, size, motion) = most?;
        let piece = &self.all[self.of[node] as usize];
        Some((node, piece.described(self.mesh.nodes[node], motion.map(|x| x / size))))
    }

    /// A node on a fitting that isn't held along z.
    fn free_fitting(&self) -> Option<usize> {
        if self.fittings.len() == self.loaded() {
            return None;
        }
        let is_free = |fitting: usize| {
            let Some(number) = self.number_of(fitting) else { return false };
            let mut left = vec![0.0; self.loaded()];
            left[number] = 1.0;
            for known in &self.fittings {
                subtract(&mut left, known);
            }
            left.iter().any(|x| x.abs() > FREE)
        };
        let fitting = (0..self.dofs.fittings.len()).find(|fitting| is_free(*fitting))?;
        self.dofs.nodes.iter().position(|node| node.dof.contains(&self.dofs.fittings[fitting]))
    }
}

impl Default for Piece {
    fn default() -> Self {
        Self { middle: [0.0; 3], size: 0.0, is_flat: false, rows: Vec::new() }
    }
}

impl Piece {
    /// The displacement of a position along a direction, as a linear form of the motion.
    fn displacement(&self, place: Vector, along: Vector) -> Motion {
        if self.is_flat {
            return [0.0, 0.0, along[2], 0.0, 0.0, 0.0];
        }
        let arm = scaled(sub(place, self.middle), 1.0 / self.size.max(f64::MIN_POSITIVE));
        let [x, y, z] = along;
        let [a, b, c] = cross(arm, along);
        [x, y, z, a, b, c]
    }

    /// The remainder of a motion orthogonal to the rows.
    fn left(&self, mut motion: Motion) -> Motion {
        for row in &self.rows {
            subtract(&mut motion, &row.motion);
        }
        motion
    }

    /// Adds an equation. Returns its fitting part if it contains nothing new about the motion.
    fn take(&mut self, mut row: Row) -> Option<Vec<f64>> {
        for known in &self.rows {
            let share = subtract(&mut row.motion, &known.motion);
            vector::add(&mut row.fittings, -share, &known.fittings);
        }
        let size = vector::norm(&row.motion);
        if size <= HELD {
            return Some(row.fittings);
        }
        row.motion = row.motion.map(|x| x / size);
        row.fittings.iter_mut().for_each(|x| *x /= size);
        self.rows.push(row);
        None
    }

    /// Whether a motion is free and moves this position.
    fn frees(&self, motion: Motion, place: Vector) -> bool {
        let size = vector::norm(&motion);
        let is_held = self.rows.iter().any(|row| vector::dot(&row.motion, &motion).abs() > 1e-5 * size);
        let moved = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| vector::dot(&self.displacement(place, axis), &motion));
        !is_held && norm(moved) > FREE * size
    }

    /// The free motions along and about the axes, or else the one that was found.
    fn described(&self, place: Vector, motion: Motion) -> String {
        let (mut found, mut turns) = (Vec::new(), Vec::new());
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let axis: Vector = core::array::from_fn(|i| f64::from(u8::from(i == k)));
            let [x, y, z] = axis;
            if self.frees([x, y, z, 0.0, 0.0, 0.0], place) {
                found.push(format!("move along {name}"));
            }
            let [a, b, c] = cross(axis, self.middle);
            let [p, q, r] = scaled(axis, self.size);
            if !self.is_flat && self.frees([a, b, c, p, q, r], place) {
                turns.push(format!("turn about {name}"));
            }
        }
        found.extend(turns);
        if !found.is_empty() {
            return found.join(", ");
        }
        let (along, about) = ([motion[0], motion[1], motion[2]], [motion[3], motion[4], motion[5]]);
        let length = dot(about, about);
        if length < 1e-12 {
            return format!("move along {}", written(along, 3));
        }
        let through = add(self.middle, scaled(cross(about, along), self.size / length));
        let along = scaled(about, 1.0 / length.sqrt());
        format!("turn about the line through {} m along {}", written(through, 6), written(along, 3))
    }
}

/// Three numbers as text, without -0.
fn written(v: Vector, digits: i32) -> String {
    let unit = 10.0_f64.powi(digits);
    let [x, y, z] = v.map(|x| (x * unit).round() / unit + 0.0);
    format!("({x}, {y}, {z})")
}

/// Subtracts the projection on a unit vector.
fn subtract(from: &mut [f64], unit: &[f64]) -> f64 {
    let share = vector::dot(from, unit);
    vector::add(from, -share, unit);
    share
}

/// Connectivity of nodes (disjoint sets).
struct Links {
    parent: Vec<u32>,
    is_used: Vec<bool>,
}

impl Links {
    fn new(nodes: usize) -> Self {
        Self { parent: (0_u32..).take(nodes).collect(), is_used: vec![false; nodes] }
    }

    fn use_node(&mut self, nodes: &[u32]) {
        for node in nodes {
            self.is_used[*node as usize] = true;
        }
    }

    fn root(&mut self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            let next = self.parent[self.parent[node as usize] as usize];
            self.parent[node as usize] = next;
            node = next;
        }
        node
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// The piece of each node, and the number of pieces.
    fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut of = vec![NONE; self.parent.len()];
        let mut count = 0;
        for node in (0_u32..).take(self.parent.len()) {
            if self.is_used[node as usize] {
                let root = self.root(node) as usize;
                if of[root] == NONE {
                    of[root] = count;
                    count += 1;
                }
                of[node as usize] = of[root];
            }
        }
        (of, count as usize)
    }
}
