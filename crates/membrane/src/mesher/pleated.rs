//! The cloth of a pleated muscle between its fibres, as half a lobe or as a whole one.

use super::grid::{Surface, grid};
use crate::mesh::Mesh;
use core::f64::consts::PI;

/// A pleated muscle: n fibres on a circle at each end fitting, and between neighbours a strip of cloth,
/// folded outwards into one pleat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pleated {
    /// Number of fibres.
    pub fibres: usize,
    /// Radius of the fibres at the fittings, m.
    pub radius: f64,
    /// Unpressurised length between the fittings, m.
    pub length: f64,
    /// Circumference of the cloth when spread out flat, m.
    pub circumference: f64,
    /// Height of the pleats above the fibres at the fittings, m.
    pub depth: f64,
    /// Cells around (of the sector) and along (of half the length).
    pub cells: [usize; 2],
    /// Whether triangles have six nodes.
    pub is_quadratic: bool,
}

impl Pleated {
    /// Half a lobe, from a fibre to the top of a pleat, over half the length; the middle of the muscle is at
    /// z = 0. The muscle consists of 4 n of them.
    ///
    /// Groups: `cloth`; `fibre`, in the plane y = 0; `top`, in the plane at an angle of pi/n to it; `middle`,
    /// z = 0; `end`, on the fitting.
    #[must_use]
    pub fn half_lobe(&self) -> Mesh {
        self.sector(0.5)
    }

    /// A whole lobe between two fibres over half the length; the muscle consists of 2 n of them. Group `top`
    /// is then the next fibre's edge, 2 pi/n from `fibre`.
    #[must_use]
    pub fn lobe(&self) -> Mesh {
        self.sector(1.0)
    }

    fn sector(&self, share: f64) -> Mesh {
        let n = self.fibres as f64;
        let angle = 2.0 * PI / n * share;
        let strip = self.circumference / n * share;
        let place = |u: f64, v: f64| {
            // The pleat is highest in the middle of a lobe.
            let out = 1.0 - (2.0 * share * u - 1.0).abs();
            let (r, theta) = (self.radius + self.depth * out, angle * u);
            [r * theta.cos(), r * theta.sin(), 0.5 * self.length * v]
        };
        let pattern = |u: f64, v: f64| [strip * u, 0.5 * self.length * v];
        let mut mesh = grid(&Surface {
            place: &place,
            pattern: Some(&pattern),
            cells: self.cells,
            is_quadratic: self.is_quadratic,
        });
        for block in &mut mesh.blocks {
            let name = match block.group.as_str() {
                "u0" => "fibre",
                "u1" => "top",
                "v0" => "middle",
                "v1" => "end",
                _ => continue,
            };
            name.clone_into(&mut block.group);
        }
        mesh
    }
}
