//! Membranes of revolution: lines in the half-plane (r, z) that carry sheets and families of threads.
//!
//! With s the length along the stress-free meridian, R its radius and x = (r, z):
//!
//! ```text
//! l1 = |dx/ds|     l2 = r/R
//! sheet              energy = integral of 2 pi R W(l1, l2) ds
//! n threads at angle a to the meridian:   l_f^2 = l1^2 cos^2 a + l2^2 sin^2 a,   energy = integral of n phi(l_f)/cos a ds
//! V = pi integral of r^2 dz
//! ```
//!
//! The threads are pinned to each other where they cross, as in a braid. Half of them run at +a and half at
//! -a, or all at a = 0.

use super::shape::{line_strain, line_volume};
use super::{Local, Vector, mixed, norm};
use crate::material::{Principal, Sheet, Tension, Thread, pull};
use core::f64::consts::PI;
use serde::Serialize;

/// A layer of a membrane of revolution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum RingLayer {
    /// A sheet.
    Sheet {
        /// Its material.
        sheet: Sheet,
        /// Ratio of its stress-free circumference to that of the mesh; above 1 for a pleated cloth.
        fullness: f64,
    },
    /// Threads.
    Threads {
        /// The material of each thread.
        thread: Thread,
        /// Number of threads around the circumference.
        count: f64,
        /// Angle to the meridian in the mesh, rad; its absolute value is at most 89 degrees.
        angle: f64,
    },
}

/// A layer with the state variables of its points.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    kind: RingLayer,
    /// T0 of each thread at each point.
    held: [f64; 2],
}

impl Layer {
    /// Number of threads in it.
    pub(crate) fn count(&self) -> f64 {
        match self.kind {
            RingLayer::Sheet { .. } => 0.0,
            RingLayer::Threads { count, .. } => count,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Point<const N: usize> {
    n: [f64; N],
    /// Derivatives of the shape functions by the stress-free length.
    by: [f64; N],
    /// The stress-free length that it represents; the next field is the radius there.
    length: f64,
    radius: f64,
}

/// An element of revolution.
#[derive(Debug, Clone)]
pub(crate) struct Ring<const N: usize> {
    points: Vec<Point<N>>,
    pub(crate) layers: Vec<Layer>,
}

/// The energy of all layers per unit length as a function of the squares c1 = l1^2, c2 = l2^2, and its
/// derivatives.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    w: f64,
    w1: f64,
    w2: f64,
    w11: f64,
    w12: f64,
    w22: f64,
}

/// Forces of one layer at the middle of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Carried {
    /// Forces per unit current length along the meridian and around, N/m, and stretches.
    Sheet { force: [f64; 2], stretch: [f64; 2], tension: Tension, folded: f64 },
    /// Tension of each thread, N, its stretch, and its angle to the meridian, rad.
    Threads { tension: f64, stretch: f64, angle: f64 },
}

impl<const N: usize> Ring<N> {
    /// An element through the stress-free positions of its nodes (y = 0, x the radius); `None` if it has no
    /// length, folds over, or lies on the axis.
    pub(crate) fn new(places: &[Vector; N], layers: &[RingLayer]) -> Option<Self> {
        let mut points = Vec::new();
        for (weight, n, d) in line_strain::<N>() {
            let speed = norm(mixed(places, &d));
            let radius = mixed(places, &n)[0];
            if !(speed.is_finite() && speed > 0.0 && radius > 0.0) {
                return None;
            }
            points.push(Point { n, by: d.map(|d| d / speed), length: weight * speed, radius });
        }
        let layers = layers.iter().map(|kind| Layer { kind: *kind, held: [0.0; 2] }).collect();
        Some(Self { points, layers })
    }

    #[inline]
    fn squares(point: &Point<N>, x: &[Vector; N]) -> (Vector, f64, f64, f64) {
        let tangent = mixed(x, &point.by);
        let r = mixed(x, &point.n)[0];
        let c1 = tangent[0] * tangent[0] + tangent[2] * tangent[2];
        let l2 = r / point.radius;
        (tangent, r, c1, l2 * l2)
    }

    /// The energy of all layers at a point.
    #[inline]
    fn stored(&self, index: usize, point: &Point<N>, c1: f64, c2: f64, penalty: f64) -> Sum {
        let mut sum = Sum::default();
        for layer in &self.layers {
            match layer.kind {
                RingLayer::Sheet { sheet, fullness } => {
                    let area = 2.0 * PI * point.radius * fullness;
                    // The sheet's l2 refers to its own stress-free radius.
                    let over = 1.0 / (fullness * fullness);
                    let Principal { energy: e, .. } = sheet.principal(c1, c2 * over);
                    sum.w += area * e.w;
                    sum.w1 += area * e.w1;
                    sum.w2 += area * e.w2 * over;
                    sum.w11 += area * e.w11;
                    sum.w12 += area * e.w12 * over;
                    sum.w22 += area * e.w22 * over * over;
                }
                RingLayer::Threads { thread, count, angle } => {
                    let stiffness = match thread {
                        Thread::Elastic { stiffness } => stiffness,
                        Thread::Inextensible => penalty,
                    };
                    let (sin, cos) = angle.sin_cos();
                    let (a, b) = (cos * cos, sin * sin);
                    let stretch = (a * c1 + b * c2).sqrt();
                    let pull = pull(stiffness, layer.held[index], stretch);
                    let each = count / cos;
                    // dl/dc = a/(2 l).
                    let first = each * pull.tension / (2.0 * stretch);
                    let second = each * (pull.stiffness - pull.tension / stretch) / (4.0 * stretch * stretch);
                    sum.w += each * pull.energy;
                    sum.w1 += first * a;
                    sum.w2 += first * b;
                    sum.w11 += second * a * a;
                    sum.w12 += second * a * b;
                    sum.w22 += second * b * b;
                }
            }
        }
        sum
    }

    pub(crate) fn energy(&self, x: &[Vector; N], penalty: f64) -> f64 {
        let mut sum = 0.0;
        for (i, point) in self.points.iter().enumerate() {
            let (_, _, c1, c2) = Self::squares(point, x);
            sum += point.length * self.stored(i, point, c1, c2, penalty).w;
        }
        sum
    }

    pub(crate) fn volume(x: &[Vector; N], rule: &[(f64, [f64; N], [f64; N])]) -> f64 {
        rule.iter().map(|(w, n, d)| PI * w * mixed(x, n)[0].powi(2) * mixed(x, d)[2]).sum()
    }

    /// Quadrature points of [`Ring::volume`].
    pub(crate) fn volume_rule() -> Vec<(f64, [f64; N], [f64; N])> {
        line_volume()
    }

    pub(crate) fn local(
        &self,
        x: &[Vector; N],
        penalty: f64,
        pressure: f64,
        rule: &[(f64, [f64; N], [f64; N])],
    ) -> Local<N> {
        let mut out = Local::ZERO;
        for (i, point) in self.points.iter().enumerate() {
            let (tangent, r, c1, c2) = Self::squares(point, x);
            let e = self.stored(i, point, c1, c2, penalty);
            out.energy += point.length * e.w;
            // dc1 = 2 x'.dx', dc2 = 2 r dr/R^2.
            let over = 1.0 / (point.radius * point.radius);
            for a in 0..N {
                let c1_a = [2.0 * tangent[0] * point.by[a], 2.0 * tangent[2] * point.by[a]];
                let c2_a = 2.0 * r * over * point.n[a];
                out.force[a][0] += point.length * (e.w1 * c1_a[0] + e.w2 * c2_a);
                out.force[a][2] += point.length * e.w1 * c1_a[1];
                for b in a..N {
                    let c1_b = [2.0 * tangent[0] * point.by[b], 2.0 * tangent[2] * point.by[b]];
                    let c2_b = 2.0 * r * over * point.n[b];
                    let bend = 2.0 * e.w1 * point.by[a] * point.by[b];
                    let hoop = 2.0 * e.w2 * over * point.n[a] * point.n[b];
                    let k = &mut out.stiffness[a][b];
                    k[0][0] += point.length
                        * (bend
                            + hoop
                            + e.w11 * c1_a[0] * c1_b[0]
                            + e.w12 * (c1_a[0] * c2_b + c2_a * c1_b[0])
                            + e.w22 * c2_a * c2_b);
                    k[0][2] += point.length * (e.w11 * c1_a[0] * c1_b[1] + e.w12 * c2_a * c1_b[1]);
                    k[2][0] += point.length * (e.w11 * c1_a[1] * c1_b[0] + e.w12 * c1_a[1] * c2_b);
                    k[2][2] += point.length * (bend + e.w11 * c1_a[1] * c1_b[1]);
                }
            }
        }
        for (w, n, d) in rule {
            let (r, dz) = (mixed(x, n)[0], mixed(x, d)[2]);
            out.volume += PI * w * r * r * dz;
            for a in 0..N {
                out.sweep[a][0] += 2.0 * PI * w * r * dz * n[a];
                out.sweep[a][2] += PI * w * r * r * d[a];
                for b in a..N {
                    let k = &mut out.stiffness[a][b];
                    let weight = 2.0 * PI * w * pressure;
                    k[0][0] -= weight * dz * n[a] * n[b];
                    k[0][2] -= weight * r * n[a] * d[b];
                    k[2][0] -= weight * r * d[a] * n[b];
                }
            }
        }
        out
    }

    /// The tensions T0 of inextensible threads.
    pub(crate) fn held(&mut self) -> Vec<&mut f64> {
        let is_held = |layer: &&mut Layer| {
            matches!(layer.kind, RingLayer::Threads { thread: Thread::Inextensible, .. })
        };
        self.layers.iter_mut().filter(is_held).flat_map(|layer| layer.held.iter_mut()).collect()
    }

    /// Transfers the tensions of inextensible threads to T0. Returns the largest |l - 1| of a taut one.
    pub(crate) fn hold(&mut self, x: &[Vector; N], penalty: f64) -> f64 {
        let mut worst = 0.0_f64;
        for layer in &mut self.layers {
            let RingLayer::Threads { thread: Thread::Inextensible, angle, .. } = layer.kind else { continue };
            let (sin, cos) = angle.sin_cos();
            for (point, t0) in self.points.iter().zip(&mut layer.held) {
                let (_, _, c1, c2) = Self::squares(point, x);
                let stretch = (cos * cos * c1 + sin * sin * c2).sqrt();
                *t0 = pull(penalty, *t0, stretch).tension;
                if *t0 > 0.0 {
                    worst = worst.max((stretch - 1.0).abs());
                }
            }
        }
        worst
    }

    /// Forces of each layer, averaged over the points.
    pub(crate) fn carried(&self, x: &[Vector; N], penalty: f64) -> Vec<Carried> {
        self.layers.iter().map(|layer| self.carried_by(layer, x, penalty)).collect()
    }

    fn carried_by(&self, layer: &Layer, x: &[Vector; N], penalty: f64) -> Carried {
        let share = 1.0 / self.points.len() as f64;
        match layer.kind {
            RingLayer::Sheet { sheet, fullness } => {
                let (mut force, mut stretch, mut tension) = ([0.0; 2], [0.0; 2], Tension::Taut);
                for point in &self.points {
                    let (_, _, c1, c2) = Self::squares(point, x);
                    let c2 = c2 / (fullness * fullness);
                    let at = sheet.principal(c1, c2);
                    let (l1, l2) = (c1.sqrt(), c2.sqrt());
                    // Per current length across: dW/dl1/l2 and dW/dl2/l1.
                    force[0] += share * 2.0 * at.energy.w1 * l1 / l2;
                    force[1] += share * 2.0 * at.energy.w2 * l2 / l1;
                    stretch[0] += share * l1;
                    stretch[1] += share * l2;
                    tension = tension.min(at.tension);
                }
                Carried::Sheet { force, stretch, tension, folded: sheet.folded(stretch, tension) }
            }
            RingLayer::Threads { thread, angle, .. } => {
                let stiffness = match thread {
                    Thread::Elastic { stiffness } => stiffness,
                    Thread::Inextensible => penalty,
                };
                let (sin, cos) = angle.sin_cos();
                let (mut tension, mut stretch, mut now) = (0.0, 0.0, 0.0);
                for (point, t0) in self.points.iter().zip(&layer.held) {
                    let (_, _, c1, c2) = Self::squares(point, x);
                    let l = (cos * cos * c1 + sin * sin * c2).sqrt();
                    tension += share * pull(stiffness, *t0, l).tension;
                    stretch += share * l;
                    now += share * (sin * c2.sqrt()).atan2(cos * c1.sqrt());
                }
                Carried::Threads { tension, stretch, angle: now }
            }
        }
    }

    /// Stress-free area of the mesh in this element.
    pub(crate) fn area(&self) -> f64 {
        self.points.iter().map(|point| 2.0 * PI * point.radius * point.length).sum()
    }
}
