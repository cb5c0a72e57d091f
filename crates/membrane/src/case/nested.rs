//! Nested iteration: the first state of a fine mesh starts from that of a mesh with half as many cells along
//! each side, which starts from a coarser one.
//!
//! Slack cloth that is inflated from a flat mesh folds and unfolds before it is taut, and every fold takes
//! iterations. On a coarse mesh there are few of them, and each costs little. What is left for the fine mesh is
//! an error of the size of a coarse cell.

use super::Case;
use crate::element::{Vector, add, scaled, sub};
use crate::mesh::Mesh;
use crate::mesher::{Surface, grid};
use crate::state::{Effort, State, Tolerance};

/// Fewest cells along a side of the coarser mesh.
const FEWEST: usize = 8;
/// Residual of a coarser mesh: far below what its cells are wrong by.
const RESIDUAL: f64 = 1e-6;

/// A mesh of [`grid`]: its cells along u and v, and whether its triangles have six nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lattice {
    pub(super) cells: [usize; 2],
    pub(super) is_quadratic: bool,
}

impl Lattice {
    /// Intervals between nodes along u and v.
    fn intervals(self) -> [usize; 2] {
        self.cells.map(|cells| if self.is_quadratic { 2 * cells } else { cells })
    }

    fn nodes(self) -> usize {
        self.intervals().iter().map(|count| count + 1).product()
    }

    /// Half as many cells along each side; `None` if they are odd or too few.
    fn halved(self) -> Option<Self> {
        let is_good = |cells: &usize| cells.is_multiple_of(2) && *cells >= 2 * FEWEST;
        self.cells.iter().all(is_good).then(|| Self { cells: self.cells.map(|cells| cells / 2), ..self })
    }

    /// The coarser mesh of a fine one: every other node along u and v.
    fn coarser(self, half: Self, fine: &Mesh) -> Mesh {
        let [nu, nv] = self.intervals();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of nodes")]
        let number = |u: f64, v: f64| {
            let [i, j] = [u * nu as f64, v * nv as f64].map(|place| place.round() as usize);
            j * (nu + 1) + i
        };
        let mut flat = vec![[0.0; 2]; fine.nodes.len()];
        for block in &fine.blocks {
            for (node, place) in block.cells.iter().zip(block.pattern.iter().flatten()) {
                flat[*node] = *place;
            }
        }
        let is_flat = fine.blocks.iter().any(|block| block.pattern.is_some());
        let place = |u: f64, v: f64| fine.nodes[number(u, v)];
        let pattern = |u: f64, v: f64| flat[number(u, v)];
        let pattern: Option<&dyn Fn(f64, f64) -> [f64; 2]> = if is_flat { Some(&pattern) } else { None };
        let Self { cells, is_quadratic } = half;
        let mut mesh = grid(&Surface { place: &place, pattern, cells, is_quadratic });
        for (own, block) in mesh.blocks.iter_mut().zip(&fine.blocks) {
            own.group.clone_from(&block.group);
        }
        mesh
    }

    /// Values at the nodes from those at every other node: means of the two or four around.
    fn prolonged(self, coarse: &[Vector]) -> Vec<Vector> {
        let [nu, nv] = self.intervals();
        let at = |i: usize, j: usize| coarse[j * (nu / 2 + 1) + i];
        let mean = |a: Vector, b: Vector| scaled(add(a, b), 0.5);
        let node = |i: usize, j: usize| {
            let across = |j: usize| mean(at(i / 2, j), at(i.div_ceil(2), j));
            mean(across(j / 2), across(j.div_ceil(2)))
        };
        (0..=nv).flat_map(|j| (0..=nu).map(move |i| (i, j))).map(|(i, j)| node(i, j)).collect()
    }
}

/// A state of a coarser mesh, with where it puts the nodes of the fine one, m; and the effort for it.
type Coarse = (Option<(Vec<Vector>, State)>, Effort);

impl Case {
    /// The first state of step `at` on a coarser mesh, if it has an equilibrium. `None` if there is no such mesh.
    pub(super) fn coarsely(&self, at: usize) -> Option<Coarse> {
        let lattice = self.lattice.filter(|lattice| lattice.nodes() == self.mesh.nodes.len())?;
        let half = lattice.halved()?;
        let mesh = lattice.coarser(half, &self.mesh);
        let tolerance = Tolerance { residual: self.tolerance.residual.max(RESIDUAL), ..self.tolerance };
        let steps = vec![self.steps.get(at)?.clone()];
        let coarse = Self { mesh, steps, tolerance, lattice: Some(half), ..self.clone() };
        let mut run = coarse.start().ok()?;
        let found = run.advance(|_, _| ()).and_then(Result::ok).map(|(_, state, _)| {
            let nodes = run.places(&state).into_iter().zip(&coarse.mesh.nodes);
            let moved: Vec<Vector> = nodes.map(|(place, rest)| sub(place, *rest)).collect();
            let moved = lattice.prolonged(&moved);
            (self.mesh.nodes.iter().zip(&moved).map(|(rest, by)| add(*rest, *by)).collect(), state)
        });
        Some((found, run.effort()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::norm;
    use crate::mesher::{Grading, Pleated, tube};

    #[test]
    fn half_as_many_cells_are_the_mesh_that_the_mesher_makes_of_them() {
        for is_quadratic in [false, true] {
            let made = |cells: [usize; 2]| tube(0.01, 0.06, cells, is_quadratic, Grading::Ends(3.0));
            let pleated = |cells| {
                let (fibres, radius, length, circumference, depth) = (40, 0.016, 0.11, 0.288, 0.0045);
                Pleated { fibres, radius, length, circumference, depth, cells, is_quadratic }.half_lobe()
            };
            let fine = Lattice { cells: [16, 32], is_quadratic };
            let half = fine.halved().unwrap();
            assert_eq!(half.cells, [8, 16]);
            assert_eq!(half.halved(), None);
            for made in [&made as &dyn Fn([usize; 2]) -> Mesh, &pleated] {
                let (found, expected) = (fine.coarser(half, &made(fine.cells)), made(half.cells));
                assert_eq!(found.blocks, expected.blocks);
                for (found, expected) in found.nodes.iter().zip(&expected.nodes) {
                    assert!(norm(sub(*found, *expected)) < 1e-15, "{found:?} {expected:?}");
                }
            }
        }
        let odd = Lattice { cells: [18, 60], is_quadratic: false }.halved().unwrap();
        assert_eq!(odd.halved(), None);
    }

    #[test]
    fn what_is_bilinear_is_carried_over_exactly() {
        for is_quadratic in [false, true] {
            let fine = Lattice { cells: [16, 18], is_quadratic };
            let values = |lattice: Lattice| -> Vec<Vector> {
                let [nu, nv] = lattice.intervals();
                let of = |u: f64, v: f64| [1.0 + u, u * v, 2.0 * v - u];
                let at = |i: usize, j: usize| of(i as f64 / nu as f64, j as f64 / nv as f64);
                (0..=nv).flat_map(|j| (0..=nu).map(move |i| at(i, j))).collect()
            };
            let found = fine.prolonged(&values(fine.halved().unwrap()));
            let expected = values(fine);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert!(norm(sub(*found, expected)) < 1e-14, "{found:?} {expected:?}");
            }
        }
    }
}
