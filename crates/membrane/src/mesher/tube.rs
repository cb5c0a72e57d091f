//! Meshes a quarter of a tube with triangles.

use super::grid::{Surface, grid};
use super::revolved::Grading;
use crate::mesh::Mesh;
use core::f64::consts::FRAC_PI_2;

/// A quarter of a tube about z, from the plane y = 0 to the plane x = 0, with `cells` around and along.
///
/// Groups: `wall`; `left` (y = 0) and `right` (x = 0); `first` (z = 0) and `last`, its ends.
#[must_use]
pub fn tube(radius: f64, length: f64, cells: [usize; 2], is_quadratic: bool, grading: Grading) -> Mesh {
    let place = |u: f64, v: f64| {
        let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
        // Exactly on the planes, without rounding errors.
        let [x, y] = [if u >= 1.0 { 0.0 } else { cos }, sin];
        [radius * x, radius * y, length * grading.at(v)]
    };
    let mut mesh = grid(&Surface { place: &place, pattern: None, cells, is_quadratic });
    for block in &mut mesh.blocks {
        let name = match block.group.as_str() {
            "cloth" => "wall",
            "u0" => "left",
            "u1" => "right",
            "v0" => "first",
            _ => "last",
        };
        name.clone_into(&mut block.group);
    }
    mesh
}
