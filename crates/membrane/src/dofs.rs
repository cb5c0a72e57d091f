//! Supports as degrees of freedom: every node's position is a linear combination of unknowns.
//!
//! ```text
//! x_a = base_a + sum over k of y_(dof a k) axis_(a k)
//! ```
//!
//! A free node has three degrees of freedom of its own; a node on a plane of symmetry has two, in the plane;
//! a node on an end fitting only shares the fitting's axial position; a node on the far edge of a cyclic
//! sector has those of its partner, with the directions rotated. The degrees of freedom to solve for come
//! first, the prescribed ones last: d(energy)/dy of the latter is the reaction.

use crate::element::{Vector, add, dot, norm, scaled, sub};

/// Marks a missing degree of freedom.
pub(crate) const NONE: u32 = u32::MAX;

/// A node's degrees of freedom.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeDofs {
    pub(crate) dof: [u32; 3],
    pub(crate) axis: [Vector; 3],
    /// Whether the axes are x, y and z, so that no rotation is needed.
    pub(crate) is_plain: bool,
    pub(crate) base: Vector,
}

/// The supports of each node.
#[derive(Debug, Clone)]
pub(crate) struct Supports {
    nodes: Vec<Held>,
    /// Whether each fitting's axial position is solved for.
    fittings: Vec<bool>,
}

#[derive(Debug, Clone, Default)]
struct Held {
    /// Orthonormal directions in which it can't move, and the supports behind them.
    normals: Vec<(Vector, By)>,
    fitting: Option<(usize, By)>,
    partner: Option<Partner>,
}

/// The number of a support that holds a node.
pub(crate) type By = usize;

/// A node across a cyclic sector, and the angle from it, rad.
#[derive(Debug, Clone, Copy)]
struct Partner {
    node: usize,
    angle: f64,
    by: By,
}

/// Supports that contradict each other at a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Clash {
    pub(crate) node: usize,
    pub(crate) kind: ClashKind,
    /// The supports; the second one is at fault if their order matters.
    pub(crate) by: [By; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClashKind {
    /// The node is on two fittings.
    TwoFittings,
    /// The node follows two others.
    TwoPartners,
    /// The node follows one node and is the partner of another.
    Chain,
    /// The node is held along z, and is on a fitting, which moves in that direction.
    HeldFitting,
}

/// The degrees of freedom of all nodes.
#[derive(Debug, Clone)]
pub(crate) struct Dofs {
    pub(crate) nodes: Vec<NodeDofs>,
    /// Number of degrees of freedom to solve for; the next field counts all.
    pub(crate) free: usize,
    pub(crate) all: usize,
    /// The degree of freedom of each fitting's axial position.
    pub(crate) fittings: Vec<u32>,
}

impl Supports {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { nodes: vec![Held::default(); nodes], fittings: Vec::new() }
    }

    /// Adds a rigid fitting that moves along z; `is_free` means that its position is solved for.
    pub(crate) fn fitting(&mut self, is_free: bool) -> usize {
        self.fittings.push(is_free);
        self.fittings.len() - 1
    }

    /// Holds the node along `normal`.
    pub(crate) fn hold(&mut self, node: usize, normal: Vector, by: By) {
        let held = &mut self.nodes[node].normals;
        let mut left = scaled(normal, 1.0 / norm(normal));
        for (known, _) in held.iter() {
            left = sub(left, scaled(*known, dot(left, *known)));
        }
        // A direction that is nearly held already is skipped.
        if norm(left) > 1e-6 {
            held.push((scaled(left, 1.0 / norm(left)), by));
        }
    }

    /// Fixes the node.
    pub(crate) fn fix(&mut self, node: usize, by: By) {
        for normal in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            self.hold(node, normal, by);
        }
    }

    /// Attaches the node to the fitting.
    pub(crate) fn ride(&mut self, node: usize, fitting: usize, by: By) -> Result<(), Clash> {
        match self.nodes[node].fitting {
            Some((other, before)) if other != fitting => {
                Err(Clash { node, kind: ClashKind::TwoFittings, by: [before, by] })
            }
            Some(_) => Ok(()),
            None => {
                self.nodes[node].fitting = Some((fitting, by));
                Ok(())
            }
        }
    }

    /// Lets the node follow `partner`, rotated by `angle` about z.
    pub(crate) fn follow(&mut self, node: usize, partner: usize, angle: f64, by: By) -> Result<(), Clash> {
        if node == partner {
            // A node on the axis is its own partner.
            self.hold(node, [1.0, 0.0, 0.0], by);
            self.hold(node, [0.0, 1.0, 0.0], by);
            return Ok(());
        }
        match self.nodes[node].partner {
            Some(other) if other.node != partner || (other.angle - angle).abs() > 1e-6 => {
                Err(Clash { node, kind: ClashKind::TwoPartners, by: [other.by, by] })
            }
            _ => {
                self.nodes[node].partner = Some(Partner { node: partner, angle, by });
                Ok(())
            }
        }
    }

    /// Degrees of freedom with their values at `places`; the fittings' positions start at 0.
    pub(crate) fn dofs(mut self, places: &[Vector]) -> Result<(Dofs, Vec<f64>), Clash> {
        self.hand_over()?;
        self.check_fittings()?;
        let mut nodes = vec![
            NodeDofs { dof: [NONE; 3], axis: [[0.0; 3]; 3], is_plain: false, base: [0.0; 3] };
            places.len()
        ];
        let mut values = Vec::new();
        for (i, held) in self.nodes.iter().enumerate() {
            if held.partner.is_some() {
                continue;
            }
            let node = &mut nodes[i];
            node.base = places[i];
            if held.fitting.is_some() {
                continue;
            }
            let normals: Vec<Vector> = held.normals.iter().map(|(normal, _)| *normal).collect();
            let axes = complement(&normals);
            node.is_plain = held.normals.is_empty();
            for (k, axis) in axes.iter().enumerate() {
                node.dof[k] = index(values.len());
                node.axis[k] = *axis;
                let value = dot(places[i], *axis);
                values.push(value);
                node.base = sub(node.base, scaled(*axis, value));
            }
        }
        let mut fittings = vec![NONE; self.fittings.len()];
        for is_free in [true, false] {
            for (fitting, free) in fittings.iter_mut().zip(&self.fittings) {
                if *free == is_free {
                    *fitting = index(values.len());
                    values.push(0.0);
                }
            }
        }
        let free = values.len() - self.fittings.iter().filter(|free| !**free).count();
        for (node, held) in nodes.iter_mut().zip(&self.nodes) {
            if let Some((fitting, _)) = held.fitting {
                // Held in every direction except that of the fitting.
                node.dof[0] = fittings[fitting];
                node.axis[0] = [0.0, 0.0, 1.0];
            }
        }
        for i in 0..nodes.len() {
            if let Some(Partner { node: partner, angle, .. }) = self.nodes[i].partner {
                let own = nodes[partner];
                nodes[i] = NodeDofs {
                    dof: own.dof,
                    axis: own.axis.map(|axis| turned(axis, angle)),
                    is_plain: false,
                    base: turned(own.base, angle),
                };
            }
        }
        let all = values.len();
        Ok((Dofs { nodes, free, all, fittings }, values))
    }

    /// Transfers the supports of a node that follows its partner to the partner.
    fn hand_over(&mut self) -> Result<(), Clash> {
        for i in 0..self.nodes.len() {
            let Some(Partner { node: partner, angle, by }) = self.nodes[i].partner else { continue };
            if let Some(next) = self.nodes[partner].partner {
                return Err(Clash { node: partner, kind: ClashKind::Chain, by: [by, next.by] });
            }
            for (normal, by) in self.nodes[i].normals.clone() {
                self.hold(partner, turned(normal, -angle), by);
            }
            if let Some((fitting, by)) = self.nodes[i].fitting {
                self.ride(partner, fitting, by)?;
            }
        }
        Ok(())
    }

    /// Checks that no support holds a node on a fitting along z. A fitting moves along z and holds its nodes
    /// across it already.
    fn check_fittings(&self) -> Result<(), Clash> {
        for (node, held) in self.nodes.iter().enumerate() {
            let Some((_, fitting)) = held.fitting else { continue };
            if let Some((_, by)) = held.normals.iter().find(|(normal, _)| normal[2].abs() > 1e-6) {
                return Err(Clash { node, kind: ClashKind::HeldFitting, by: [*by, fitting] });
            }
        }
        Ok(())
    }
}

impl Dofs {
    /// Positions of the nodes for the values `y`.
    pub(crate) fn places(&self, y: &[f64], out: &mut Vec<Vector>) {
        out.clear();
        out.extend(self.nodes.iter().map(|node| {
            let mut x = node.base;
            for (dof, axis) in node.dof.iter().zip(&node.axis) {
                if *dof != NONE {
                    x = add(x, scaled(*axis, y[*dof as usize]));
                }
            }
            x
        }));
    }

    /// Values for positions of the nodes and of the fittings: what [`Self::places`] undoes.
    pub(crate) fn values(&self, places: &[Vector], fittings: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.all];
        for (node, place) in self.nodes.iter().zip(places) {
            for (dof, axis) in node.dof.iter().zip(&node.axis).filter(|(dof, _)| **dof != NONE) {
                y[*dof as usize] = dot(*place, *axis);
            }
        }
        for (dof, place) in self.fittings.iter().zip(fittings) {
            y[*dof as usize] = *place;
        }
        y
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a structure has at most 2^31 numbers: checked where it is built"
)]
fn index(count: usize) -> u32 {
    count as u32
}

/// Orthonormal directions orthogonal to the given ones: x, y and z if nothing is given.
pub(crate) fn complement(normals: &[Vector]) -> Vec<Vector> {
    let mut known = normals.to_vec();
    let mut found = Vec::new();
    while known.len() < 3 {
        // Take the coordinate axis with the largest remainder.
        let best = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| known.iter().fold(axis, |left, n| sub(left, scaled(*n, dot(left, *n)))))
            .into_iter()
            .reduce(|a, b| if norm(b) > norm(a) + 1e-9 { b } else { a });
        let Some(best) = best else { break };
        let axis = scaled(best, 1.0 / norm(best));
        known.push(axis);
        found.push(axis);
    }
    found
}

/// Rotates a vector about z.
pub(crate) fn turned(v: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_stay_where_their_supports_leave_them() {
        let places = [[1.0, 2.0, 3.0], [1.0, 0.0, 2.0], [0.0, 1.0, 5.0], [0.0, 0.0, 1.0], [2.0, 0.0, 0.0]];
        let mut supports = Supports::new(5);
        let end = supports.fitting(false);
        // 1 and 2 are partners over a quarter turn; 3 lies on the axis; 4 on the fitting.
        supports.follow(2, 1, core::f64::consts::FRAC_PI_2, 0).unwrap();
        supports.follow(3, 3, core::f64::consts::FRAC_PI_2, 0).unwrap();
        supports.ride(4, end, 1).unwrap();
        supports.hold(0, [1.0, 1.0, 0.0], 2);
        let (dofs, mut y) = supports.dofs(&places).unwrap();
        // 2 + 3 + 1, and the fitting.
        assert_eq!((dofs.free, dofs.all), (6, 7));
        let mut x = Vec::new();
        dofs.places(&y, &mut x);
        for i in [0, 1, 3, 4] {
            assert!(norm(sub(x[i], places[i])) < 1e-15, "{i}");
        }
        for value in &mut y {
            *value += 0.5;
        }
        dofs.places(&y, &mut x);
        // Still in the plane x + y = 3.
        assert!((x[0][0] + x[0][1] - 3.0).abs() < 1e-15);
        assert!(norm(sub(turned(x[1], core::f64::consts::FRAC_PI_2), x[2])) < 1e-15);
        assert!(norm(sub(x[3], [0.0, 0.0, 1.5])) < 1e-15);
        assert!(norm(sub(x[4], [2.0, 0.0, 0.5])) < 1e-15);
    }

    #[test]
    fn contradictions_are_refused() {
        let clash = |node, kind, by| Err(Clash { node, kind, by });
        let places = [[1.0, 0.0, 0.0]; 3];
        let mut supports = Supports::new(2);
        let (a, b) = (supports.fitting(false), supports.fitting(true));
        supports.ride(0, a, 5).unwrap();
        supports.ride(0, a, 6).unwrap();
        assert_eq!(supports.ride(0, b, 7), clash(0, ClashKind::TwoFittings, [5, 7]));
        // A fitting holds its nodes across the axis anyway.
        supports.hold(0, [1.0, 1.0, 0.0], 8);
        assert!(supports.clone().dofs(&places[..2]).is_ok());
        supports.hold(0, [0.0, 0.0, 1.0], 9);
        assert_eq!(supports.dofs(&places[..2]).err(), clash(0, ClashKind::HeldFitting, [9, 5]).err());
        let mut supports = Supports::new(3);
        supports.follow(1, 0, 1.0, 3).unwrap();
        supports.follow(1, 0, 1.0, 4).unwrap();
        assert_eq!(supports.follow(1, 2, 1.0, 5), clash(1, ClashKind::TwoPartners, [4, 5]));
        supports.follow(2, 1, 1.0, 6).unwrap();
        assert_eq!(supports.dofs(&places).err(), clash(1, ClashKind::Chain, [6, 4]).err());
        // A fixed partner, and a node on a fitting that follows it.
        let mut supports = Supports::new(2);
        let end = supports.fitting(true);
        supports.fix(0, 1);
        supports.follow(1, 0, 1.0, 2).unwrap();
        supports.ride(1, end, 3).unwrap();
        assert_eq!(supports.dofs(&places[..2]).err(), clash(0, ClashKind::HeldFitting, [1, 3]).err());
    }
}
