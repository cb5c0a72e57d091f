//! Contact of a node with its mirror image: no node passes through a plane of symmetry.
//!
//! ```text
//! energy = sum over planes of k g^2/2 where g < 0,   g = n.x - d
//! ```
//!
//! k is [`STIFF`] times what a node of the sheets resists at rest, or the penalty of the pressure's forces if that is
//! more. The energy of a structure contains it; it is as small as the depths g, which nobody sees.

use super::{Local, Vector, dot, scaled};

/// A plane of symmetry: its normal, which points to the side of the mesh, and its distance from the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mirror {
    pub(crate) normal: Vector,
    pub(crate) offset: f64,
}

/// A node with the planes that stop it.
#[derive(Debug, Clone)]
pub(crate) struct Contact {
    planes: Vec<Mirror>,
    /// Length over which the penalty, a force, acts.
    size: f64,
    /// Least stiffness k \[N/m\].
    least: f64,
}

/// Stiffness over that of a node: depths are smaller than strains, and factors keep their digits.
const STIFF: f64 = 100.0;

impl Contact {
    pub(crate) fn new(planes: Vec<Mirror>, size: f64) -> Self {
        Self { planes, size, least: 0.0 }
    }

    /// With the stiffness of a node at rest.
    pub(crate) fn stiffened(&mut self, node: f64) {
        self.least = STIFF * node;
    }

    fn stiffness(&self, penalty: f64) -> f64 {
        self.least.max(penalty / self.size)
    }

    /// The planes behind which the node is, with its distance.
    fn behind(&self, x: Vector) -> impl Iterator<Item = (Vector, f64)> {
        self.planes
            .iter()
            .map(move |plane| (plane.normal, dot(plane.normal, x) - plane.offset))
            .filter(|(_, gap)| *gap < 0.0)
    }

    pub(crate) fn energy(&self, [x]: &[Vector; 1], penalty: f64) -> f64 {
        0.5 * self.stiffness(penalty) * self.behind(*x).map(|(_, gap)| gap * gap).sum::<f64>()
    }

    pub(crate) fn local(&self, x: &[Vector; 1], penalty: f64) -> Local<1> {
        let stiffness = self.stiffness(penalty);
        let mut out = Local { energy: self.energy(x, penalty), ..Local::ZERO };
        for (normal, gap) in self.behind(x[0]) {
            for (i, part) in scaled(normal, stiffness).into_iter().enumerate() {
                out.force[0][i] += gap * part;
                for (j, other) in normal.iter().enumerate() {
                    out.stiffness[0][0][i][j] += part * other;
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_and_stiffness_are_derivatives_of_the_energy_behind_a_plane_and_nothing_is_before_it() {
        let normal = [0.6, 0.8, 0.0];
        let mut contact = Contact::new(
            vec![Mirror { normal, offset: 1.0 }, Mirror { normal: [0.0, 0.0, 1.0], offset: 0.0 }],
            2.0,
        );
        contact.stiffened(0.02);
        assert!((contact.energy(&[[0.0, 0.0, -0.1]], 0.0) - (0.01 + 1.0)).abs() < 1e-15);
        let energy = |x: Vector| contact.energy(&[x], 6.0);
        assert!(energy([1.0, 0.6, 0.1]) < 1e-30);
        // k = 6/2, or 100 times 0.02; g = -0.5 and -0.2.
        let behind = [0.5, 0.25, -0.2];
        assert!((energy(behind) - 1.5 * (0.25 + 0.04)).abs() < 1e-15);
        let local = contact.local(&[behind], 6.0);
        let h = 1e-6;
        for i in 0..3 {
            let moved = |by: f64| {
                let mut x = behind;
                x[i] += by;
                x
            };
            let slope = (energy(moved(h)) - energy(moved(-h))) / (2.0 * h);
            assert!((local.force[0][i] - slope).abs() < 1e-9);
            let [after, before] = [h, -h].map(|by| contact.local(&[moved(by)], 6.0).force[0]);
            for j in 0..3 {
                let bend = (after[j] - before[j]) / (2.0 * h);
                assert!((local.stiffness[0][0][i][j] - bend).abs() < 1e-8);
            }
        }
    }
}
