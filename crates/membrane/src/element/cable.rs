//! Cables: threads along the edges of a mesh, with two or three nodes, under large displacements.
//!
//! ```text
//! energy = integral of phi(l) dS,   l = |dx/dS|
//! ```

use super::shape::line_strain;
use super::{Local, Vector, mixed, norm};
use crate::material::{Thread, pull};

/// A strain point of a cable: derivatives of the shape functions by the unstretched length, and the length
/// that it represents.
#[derive(Debug, Clone, Copy)]
struct Point<const N: usize> {
    by: [f64; N],
    length: f64,
}

/// A cable element.
#[derive(Debug, Clone)]
pub(crate) struct Cable<const N: usize> {
    points: Vec<Point<N>>,
    thread: Thread,
    /// The fraction of the cable that belongs to the structure.
    share: f64,
    /// Tensions T0 of an inextensible thread at each point.
    held: Vec<f64>,
}

impl<const N: usize> Cable<N> {
    /// A cable through the stress-free positions of its nodes; `None` if it has no length or folds over.
    pub(crate) fn new(places: &[Vector; N], thread: Thread, share: f64) -> Option<Self> {
        let mut points = Vec::new();
        for (weight, _, d) in line_strain::<N>() {
            let speed = norm(mixed(places, &d));
            if !(speed.is_finite() && speed > 0.0) {
                return None;
            }
            points.push(Point { by: d.map(|d| d / speed), length: weight * speed });
        }
        let held = vec![0.0; points.len()];
        Some(Self { points, thread, share, held })
    }

    /// Stiffness EA: the thread's own, or `penalty` for an inextensible one.
    fn stiffness(&self, penalty: f64) -> f64 {
        match self.thread {
            Thread::Elastic { stiffness } => stiffness,
            Thread::Inextensible => penalty,
        }
    }

    pub(crate) fn energy(&self, x: &[Vector; N], penalty: f64) -> f64 {
        let stiffness = self.stiffness(penalty);
        let each = self.points.iter().zip(&self.held);
        let sum: f64 = each
            .map(|(point, t0)| point.length * pull(stiffness, *t0, norm(mixed(x, &point.by))).energy)
            .sum();
        self.share * sum
    }

    pub(crate) fn local(&self, x: &[Vector; N], penalty: f64) -> Local<N> {
        let mut out = Local::ZERO;
        let stiffness = self.stiffness(penalty);
        for (point, t0) in self.points.iter().zip(&self.held) {
            let tangent = mixed(x, &point.by);
            let stretch = norm(tangent);
            let pull = pull(stiffness, *t0, stretch);
            let length = self.share * point.length;
            out.energy += length * pull.energy;
            if pull.tension <= 0.0 {
                continue;
            }
            // dl = t.dx'/l, d2l = (dx'.dx' - dl^2)/l.
            let along = tangent.map(|t| t / stretch);
            let across = pull.tension / stretch;
            for a in 0..N {
                for i in 0..3 {
                    out.force[a][i] += length * pull.tension * along[i] * point.by[a];
                }
                for b in a..N {
                    let weight = length * point.by[a] * point.by[b];
                    for i in 0..3 {
                        out.stiffness[a][b][i][i] += weight * across;
                        for j in 0..3 {
                            out.stiffness[a][b][i][j] +=
                                weight * (pull.stiffness - across) * along[i] * along[j];
                        }
                    }
                }
            }
        }
        out
    }

    /// Tension at the middle of the cable, N, and the stretch there.
    pub(crate) fn tension(&self, x: &[Vector; N], penalty: f64) -> (f64, f64) {
        let stiffness = self.stiffness(penalty);
        let (mut tension, mut stretch, mut length) = (0.0, 0.0, 0.0);
        for (point, t0) in self.points.iter().zip(&self.held) {
            let l = norm(mixed(x, &point.by));
            tension += point.length * pull(stiffness, *t0, l).tension;
            stretch += point.length * l;
            length += point.length;
        }
        (tension / length, stretch / length)
    }

    /// The tensions T0, if it is inextensible.
    pub(crate) fn held(&mut self) -> Vec<&mut f64> {
        match self.thread {
            Thread::Elastic { .. } => Vec::new(),
            Thread::Inextensible => self.held.iter_mut().collect(),
        }
    }

    /// Transfers the tensions of an inextensible thread to T0. Returns the largest |l - 1| of a taut one.
    pub(crate) fn hold(&mut self, x: &[Vector; N], penalty: f64) -> f64 {
        if self.thread != Thread::Inextensible {
            return 0.0;
        }
        let mut worst = 0.0_f64;
        for (point, t0) in self.points.iter().zip(&mut self.held) {
            let stretch = norm(mixed(x, &point.by));
            *t0 = pull(penalty, *t0, stretch).tension;
            if *t0 > 0.0 {
                worst = worst.max((stretch - 1.0).abs());
            }
        }
        worst
    }
}
