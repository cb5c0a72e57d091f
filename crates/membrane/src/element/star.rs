//! Bending of a sheet about a node: the Laplacian of the positions from the node and its neighbours.
//!
//! ```text
//! energy = D/(2 A) |b|^2,   b = sum over neighbours of (cot a + cot b)/2 (x_j - x_i),   A a third of the triangles around
//! ```
//! The weights are those of linear elements on the flat sheet, a and b the angles opposite to the edge to the neighbour. b/A
//! is the Laplacian, twice the mean curvature along the normal where the sheet bends without stretch, and the sum over all nodes
//! is the energy of a plate that is free of stress when flat, by the mixed method of Ciarlet and Raviart (1974) with lumped areas
//! (Bergou, Wardetzky, Harmon, Zorin and Grinspun 2006, A quadratic bending model for inextensible surfaces). It is quadratic in
//! the positions and never negative.
//!
//! Nodes at which a sheet ends have none, so that it hinges freely there; something must hold them, since fields whose Laplacian
//! is zero everywhere else cost nothing. At a plane of symmetry the images are summed as well: b loses its part across the plane
//! and doubles, A doubles, and half of the energy belongs to the structure; likewise where several planes meet.

use super::{Local, Vector, add, cross, dot, mixed, norm, scaled, sub};

/// A node with its neighbours; places that aren't needed repeat the node.
#[derive(Debug, Clone)]
pub(crate) struct Star<const N: usize> {
    weights: [f64; N],
    stiffness: f64,
    /// Unit vectors across the planes of symmetry through the node.
    across: Vec<Vector>,
}

/// Half the cotangents at the second and third corner of a triangle, and its area.
pub(crate) fn corners([x0, x1, x2]: [Vector; 3]) -> ([f64; 2], f64) {
    let twice = norm(cross(sub(x1, x0), sub(x2, x0)));
    let half = |a: Vector, b: Vector| 0.5 * dot(a, b) / twice;
    ([half(sub(x0, x1), sub(x2, x1)), half(sub(x0, x2), sub(x1, x2))], 0.5 * twice)
}

impl<const N: usize> Star<N> {
    /// With the weights of node and neighbours, the area of the triangles around, D \[N m\], and what is across the planes of
    /// symmetry through the node, unit vectors at right angles.
    pub(crate) fn new(weights: [f64; N], area: f64, bending: f64, across: Vec<Vector>) -> Self {
        let share = area / 3.0;
        // With k images b and A are k times as large, and a k-th of the energy counts: D/(2 A) |b|^2 stays as it is.
        Self { weights, stiffness: bending / share, across }
    }

    fn projected(&self, mut vector: Vector) -> Vector {
        for normal in &self.across {
            vector = add(vector, scaled(*normal, -dot(*normal, vector)));
        }
        vector
    }

    pub(crate) fn energy(&self, x: &[Vector; N]) -> f64 {
        let bent = self.projected(mixed(x, &self.weights));
        0.5 * self.stiffness * dot(bent, bent)
    }

    pub(crate) fn local(&self, x: &[Vector; N]) -> Local<N> {
        let bent = self.projected(mixed(x, &self.weights));
        let mut out = Local { energy: 0.5 * self.stiffness * dot(bent, bent), ..Local::ZERO };
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| self.projected(axis));
        for a in 0..N {
            let own = self.stiffness * self.weights[a];
            out.force[a] = scaled(bent, own);
            for b in a..N {
                out.stiffness[a][b] = unit.map(|row| scaled(row, own * self.weights[b]));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_and_stiffness_are_derivatives_of_the_energy() {
        let weights = [-1.3, 0.4, 0.7, 0.2];
        let x = [[0.1, 0.2, 0.3], [1.0, -0.4, 0.2], [-0.6, 0.8, 0.1], [0.3, 0.5, -0.9]];
        for across in [vec![], vec![[0.0, 0.6, 0.8]], vec![[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]]] {
            let star = Star::new(weights, 0.8, 0.7, across);
            let (local, step) = (star.local(&x), 1e-5);
            assert!((local.energy / star.energy(&x) - 1.0).abs() < 1e-14);
            for a in 0..4 {
                for i in 0..3 {
                    let at = |by: f64| {
                        let mut x = x;
                        x[a][i] += by;
                        star.local(&x)
                    };
                    let (up, down) = (at(step), at(-step));
                    let force = (up.energy - down.energy) / (2.0 * step);
                    assert!((force - local.force[a][i]).abs() < 1e-9, "{a} {i}");
                    for b in 0..=a {
                        for j in 0..3 {
                            let found = (up.force[b][j] - down.force[b][j]) / (2.0 * step);
                            assert!((found - local.stiffness[b][a][j][i]).abs() < 1e-8, "{a} {b} {i} {j}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn cotangents_and_area_of_a_triangle() {
        // Angles of 45, 90 and 45 degrees.
        let ([one, two], area) = corners([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0]]);
        assert!(one.abs() < 1e-15 && (two - 0.5).abs() < 1e-15 && (area - 2.0).abs() < 1e-15);
    }
}
