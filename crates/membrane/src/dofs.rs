//! Supports as degrees of freedom: every node's place is a sum of numbers times directions.
//!
//! ```text
//! x_a = base_a + sum over k of y_(dof a k) axis_(a k)
//! ```
//!
//! A free node has three numbers of its own; one on a plane of symmetry two, in the plane; one on an end fitting only the fitting's axial
//! place, which it shares; one on the far edge of a cyclic sector those of its partner, with the directions turned. The numbers to solve for
//! come first, the prescribed ones last: d(energy)/dy of those is the reaction.

use crate::element::{Vector, add, dot, norm, scaled, sub};
use crate::error::MembraneError;

/// No degree of freedom.
pub(crate) const NONE: u32 = u32::MAX;

/// A node's degrees of freedom.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeDofs {
    pub(crate) dof: [u32; 3],
    pub(crate) axis: [Vector; 3],
    /// Whether the axes are x, y and z, so that nothing has to be turned.
    pub(crate) is_plain: bool,
    pub(crate) base: Vector,
}

/// What holds each node.
#[derive(Debug, Clone)]
pub(crate) struct Supports {
    nodes: Vec<Held>,
    /// Whether each fitting's axial place is solved for.
    fittings: Vec<bool>,
}

#[derive(Debug, Clone, Default)]
struct Held {
    /// Directions in which it can't move, orthonormal.
    normals: Vec<Vector>,
    fitting: Option<usize>,
    /// Partner across a cyclic sector, and the angle from it to this node, rad.
    partner: Option<(usize, f64)>,
}

/// The numbers of all nodes.
#[derive(Debug, Clone)]
pub(crate) struct Dofs {
    pub(crate) nodes: Vec<NodeDofs>,
    /// Numbers to solve for, and all of them.
    pub(crate) free: usize,
    pub(crate) all: usize,
    /// The number of each fitting's axial place.
    pub(crate) fittings: Vec<u32>,
}

impl Supports {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { nodes: vec![Held::default(); nodes], fittings: Vec::new() }
    }

    /// A rigid fitting that moves along z; `is_free`: its place is solved for.
    pub(crate) fn fitting(&mut self, is_free: bool) -> usize {
        self.fittings.push(is_free);
        self.fittings.len() - 1
    }

    /// The node can't move along `normal`.
    pub(crate) fn hold(&mut self, node: usize, normal: Vector) {
        let held = &mut self.nodes[node].normals;
        let mut left = scaled(normal, 1.0 / norm(normal));
        for known in held.iter() {
            left = sub(left, scaled(*known, dot(left, *known)));
        }
        // Nearly what is held already.
        if norm(left) > 1e-6 {
            held.push(scaled(left, 1.0 / norm(left)));
        }
    }

    /// The node can't move.
    pub(crate) fn fix(&mut self, node: usize) {
        for normal in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            self.hold(node, normal);
        }
    }

    /// The node moves with the fitting.
    pub(crate) fn ride(&mut self, node: usize, fitting: usize) -> Result<(), MembraneError> {
        if self.nodes[node].fitting.is_some_and(|other| other != fitting) {
            return Err(MembraneError::TwoFittings { node });
        }
        self.nodes[node].fitting = Some(fitting);
        Ok(())
    }

    /// The node does what `partner` does, turned by `angle` about z.
    pub(crate) fn follow(&mut self, node: usize, partner: usize, angle: f64) {
        if node == partner {
            // On the axis.
            self.hold(node, [1.0, 0.0, 0.0]);
            self.hold(node, [0.0, 1.0, 0.0]);
        } else {
            self.nodes[node].partner = Some((partner, angle));
        }
    }

    /// Degrees of freedom with their values at `places`, the fittings at the place z = 0 of their own motion.
    pub(crate) fn dofs(mut self, places: &[Vector]) -> Result<(Dofs, Vec<f64>), MembraneError> {
        self.hand_over()?;
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
            let axes = complement(&held.normals);
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
            if let Some(fitting) = held.fitting {
                // Held in every direction but that of the fitting.
                node.dof[0] = fittings[fitting];
                node.axis[0] = [0.0, 0.0, 1.0];
            }
        }
        for i in 0..nodes.len() {
            if let Some((partner, angle)) = self.nodes[i].partner {
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

    /// What holds a node that follows its partner holds the partner.
    fn hand_over(&mut self) -> Result<(), MembraneError> {
        for i in 0..self.nodes.len() {
            let Some((partner, angle)) = self.nodes[i].partner else { continue };
            if self.nodes[partner].partner.is_some() {
                return Err(MembraneError::CyclicChain { node: partner });
            }
            for normal in self.nodes[i].normals.clone() {
                self.hold(partner, turned(normal, -angle));
            }
            if let Some(fitting) = self.nodes[i].fitting {
                self.ride(partner, fitting)?;
            }
        }
        Ok(())
    }
}

impl Dofs {
    /// Places of the nodes at the values `y`.
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
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a structure has at most 2^31 numbers: checked where it is built"
)]
fn index(count: usize) -> u32 {
    count as u32
}

/// Orthonormal directions across the given ones: x, y and z where nothing is given.
fn complement(normals: &[Vector]) -> Vec<Vector> {
    let mut known = normals.to_vec();
    let mut found = Vec::new();
    while known.len() < 3 {
        // The coordinate axis of which most is left.
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

/// Turned about z.
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
        supports.follow(2, 1, core::f64::consts::FRAC_PI_2);
        supports.follow(3, 3, core::f64::consts::FRAC_PI_2);
        supports.ride(4, end).unwrap();
        supports.hold(0, [1.0, 1.0, 0.0]);
        let (dofs, mut y) = supports.dofs(&places).unwrap();
        // 2 + 3 + 1 and the fitting.
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
        // In the plane x + y = 3 still.
        assert!((x[0][0] + x[0][1] - 3.0).abs() < 1e-15);
        assert!(norm(sub(turned(x[1], core::f64::consts::FRAC_PI_2), x[2])) < 1e-15);
        assert!(norm(sub(x[3], [0.0, 0.0, 1.5])) < 1e-15);
        assert!(norm(sub(x[4], [2.0, 0.0, 0.5])) < 1e-15);
    }

    #[test]
    fn contradictions_are_refused() {
        let mut supports = Supports::new(2);
        let (a, b) = (supports.fitting(false), supports.fitting(true));
        supports.ride(0, a).unwrap();
        assert!(supports.ride(0, b).is_err());
        let mut supports = Supports::new(3);
        supports.follow(1, 0, 1.0);
        supports.follow(2, 1, 1.0);
        assert!(supports.dofs(&[[1.0, 0.0, 0.0]; 3]).is_err());
    }
}
