//! The ends of a muscle: the fittings between which a contraction is measured, and the direction in which
//! they pull.

use serde::Serialize;

use crate::mesh::Mesh;
use crate::state::Copies;
use crate::structure::Support;

/// The uppermost and the lowest fitting by the mean z of their nodes in the mesh. With a single fitting, the
/// other end is a plane or is fixed, and doesn't move.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ends {
    /// The fitting that approaches the other end as the muscle contracts: the upper one if there are two.
    pub moving: usize,
    /// The fitting at the other end.
    pub other: Option<usize>,
    /// 1 if the moving end is the upper one, -1 if it is the lower one.
    pub sign: f64,
    /// Distance between the two in the mesh, m; for a single fitting, its distance from the far end of the
    /// mesh.
    pub distance: f64,
}

impl Ends {
    /// `None` without fittings.
    pub(crate) fn of(mesh: &Mesh, supports: &[(String, Support)], fittings: usize) -> Option<Self> {
        let mean = |fitting: usize| {
            let (mut sum, mut count) = (0.0, 0_usize);
            for (group, support) in supports {
                if *support == (Support::Fitting { fitting }) {
                    for node in mesh.nodes_of(group).unwrap_or_default() {
                        sum += mesh.nodes[node][2];
                        count += 1;
                    }
                }
            }
            sum / count.max(1) as f64
        };
        let heights: Vec<(f64, usize)> = (0..fittings).map(|fitting| (mean(fitting), fitting)).collect();
        let by_height = |a: &&(f64, usize), b: &&(f64, usize)| a.0.total_cmp(&b.0);
        let ((high, upper), (low, lower)) =
            (*heights.iter().max_by(by_height)?, *heights.iter().min_by(by_height)?);
        if upper != lower {
            return Some(Self { moving: upper, other: Some(lower), sign: 1.0, distance: high - low });
        }
        let range = mesh
            .nodes
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x[2]), b.max(x[2])]);
        let (up, down) = (range[1] - high, high - range[0]);
        let sign = if up > down { -1.0 } else { 1.0 };
        Some(Self { moving: upper, other: None, sign, distance: up.max(down) })
    }

    /// Increase of the distance between the ends relative to the mesh, m, from the positions of all fittings.
    pub(crate) fn apart(&self, places: &[f64]) -> f64 {
        self.sign * (places[self.moving] - self.other.map_or(0.0, |other| places[other]))
    }

    /// The position of the moving fitting at a contraction.
    pub(crate) fn place(&self, contraction: f64, length: f64, copies: Copies, places: &[f64]) -> f64 {
        let other = self.other.map_or(0.0, |other| places[other]);
        other - self.sign * contraction * length / copies.along
    }
}
