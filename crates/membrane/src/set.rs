//! All elements of one kind in one group: evaluates them in parallel for the solver.
//!
//! Every element writes to its own part of a buffer, and sums over elements are taken in a fixed order
//! ([`crate::assembly`]), so that results are identical for any number of threads.

use crate::dofs::NodeDofs;
use crate::element::{Cable, Contact, Local, Ring, Star, Triangle, Vector, dot};
use rayon::prelude::*;

/// One kind of element with N nodes.
pub(crate) trait Element<const N: usize>: Send + Sync + core::fmt::Debug {
    /// Quadrature points of the volume.
    type Rule: Send + Sync + core::fmt::Debug;
    fn rule() -> Self::Rule;
    /// Energy and volume.
    fn measure(&self, x: &[Vector; N], penalty: f64, rule: &Self::Rule) -> [f64; 2];
    fn local(&self, x: &[Vector; N], penalty: f64, pressure: f64, rule: &Self::Rule) -> Local<N>;
    fn hold(&mut self, x: &[Vector; N], penalty: f64) -> f64;
    /// The tensions T0 of inextensible threads, to be read and written.
    fn held(&mut self) -> Vec<&mut f64> {
        Vec::new()
    }
}

impl<const N: usize> Element<N> for Cable<N> {
    type Rule = ();
    fn rule() {}
    fn measure(&self, x: &[Vector; N], penalty: f64, (): &()) -> [f64; 2] {
        [self.energy(x, penalty), 0.0]
    }
    fn local(&self, x: &[Vector; N], penalty: f64, _: f64, (): &()) -> Local<N> {
        Self::local(self, x, penalty)
    }
    fn hold(&mut self, x: &[Vector; N], penalty: f64) -> f64 {
        Self::hold(self, x, penalty)
    }
    fn held(&mut self) -> Vec<&mut f64> {
        Self::held(self)
    }
}

impl<const N: usize> Element<N> for Ring<N> {
    type Rule = Vec<(f64, [f64; N], [f64; N])>;
    fn rule() -> Self::Rule {
        Self::volume_rule()
    }
    fn measure(&self, x: &[Vector; N], penalty: f64, rule: &Self::Rule) -> [f64; 2] {
        [self.energy(x, penalty), Self::volume(x, rule)]
    }
    fn local(&self, x: &[Vector; N], penalty: f64, pressure: f64, rule: &Self::Rule) -> Local<N> {
        Self::local(self, x, penalty, pressure, rule)
    }
    fn hold(&mut self, x: &[Vector; N], penalty: f64) -> f64 {
        Self::hold(self, x, penalty)
    }
    fn held(&mut self) -> Vec<&mut f64> {
        Self::held(self)
    }
}

impl<const N: usize> Element<N> for Triangle<N> {
    type Rule = Vec<(f64, [f64; N], [[f64; N]; 2])>;
    fn rule() -> Self::Rule {
        Self::volume_rule()
    }
    fn measure(&self, x: &[Vector; N], _: f64, rule: &Self::Rule) -> [f64; 2] {
        [self.energy(x), Self::volume(x, rule)]
    }
    fn local(&self, x: &[Vector; N], _: f64, pressure: f64, rule: &Self::Rule) -> Local<N> {
        Self::local(self, x, pressure, rule)
    }
    fn hold(&mut self, _: &[Vector; N], _: f64) -> f64 {
        0.0
    }
}

impl Element<1> for Contact {
    type Rule = ();
    fn rule() {}
    fn measure(&self, x: &[Vector; 1], penalty: f64, (): &()) -> [f64; 2] {
        [self.energy(x, penalty), 0.0]
    }
    fn local(&self, x: &[Vector; 1], penalty: f64, _: f64, (): &()) -> Local<1> {
        Self::local(self, x, penalty)
    }
    fn hold(&mut self, _: &[Vector; 1], _: f64) -> f64 {
        0.0
    }
}

impl<const N: usize> Element<N> for Star<N> {
    type Rule = ();
    fn rule() {}
    fn measure(&self, x: &[Vector; N], _: f64, (): &()) -> [f64; 2] {
        [self.energy(x), 0.0]
    }
    fn local(&self, x: &[Vector; N], _: f64, _: f64, (): &()) -> Local<N> {
        Self::local(self, x)
    }
    fn hold(&mut self, _: &[Vector; N], _: f64) -> f64 {
        0.0
    }
}

/// Elements with the nodes of each.
#[derive(Debug)]
pub(crate) struct Set<E: Element<N>, const N: usize> {
    pub(crate) nodes: Vec<[u32; N]>,
    pub(crate) elements: Vec<E>,
    rule: E::Rule,
}

/// The current configuration of the structure.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(crate) x: &'a [Vector],
    pub(crate) dofs: &'a [NodeDofs],
    pub(crate) penalty: f64,
    pub(crate) pressure: f64,
}

/// Output buffers of a set; each element writes its own part.
pub(crate) struct Parts<'a> {
    /// Energy and volume.
    pub(crate) measures: &'a mut [f64],
    /// d(energy)/dy, then d(volume)/dy, for each of the element's own degrees of freedom: 2 x 3 N.
    pub(crate) gradients: &'a mut [f64],
    /// The upper triangle of the stiffness over these degrees of freedom.
    pub(crate) stiffness: &'a mut [f64],
}

/// Interface of a set to the solver.
pub(crate) trait Elements: Send + Sync + core::fmt::Debug {
    /// Number of elements.
    fn count(&self) -> usize;
    /// The nodes of one element.
    fn nodes(&self, element: usize) -> &[u32];
    /// Number of nodes per element.
    fn each(&self) -> usize;
    fn measure(&self, place: Place<'_>, out: &mut [f64]);
    fn work(&self, place: Place<'_>, out: Parts<'_>);
    /// Transfers the tensions of inextensible threads to T0. Returns the largest |l - 1| of a taut one.
    fn hold(&mut self, place: Place<'_>) -> f64;
    /// The tensions T0, to be read and written.
    fn held(&mut self) -> Vec<&mut f64>;
}

/// Measures, gradients and stiffness of one element.
type Slices<'a> = ((&'a mut [f64], &'a mut [f64]), &'a mut [f64]);

/// With fewer elements, threads cost more than they gain.
const ALONE: usize = 256;
/// Elements per task.
const BATCH: usize = 64;

/// Number of entries in the upper triangle of a matrix with n rows.
pub(crate) fn packed(n: usize) -> usize {
    n * (n + 1) / 2
}

impl<E: Element<N>, const N: usize> Set<E, N> {
    pub(crate) fn new(nodes: Vec<[u32; N]>, elements: Vec<E>) -> Self {
        Self { nodes, elements, rule: E::rule() }
    }

    #[inline]
    fn at(&self, element: usize, x: &[Vector]) -> [Vector; N] {
        self.nodes[element].map(|node| x[node as usize])
    }

    fn one(&self, element: usize, place: Place<'_>, out: &mut Parts<'_>) {
        let x = self.at(element, place.x);
        let local = self.elements[element].local(&x, place.penalty, place.pressure, &self.rule);
        (out.measures[0], out.measures[1]) = (local.energy, local.volume);
        let own = self.nodes[element].map(|node| &place.dofs[node as usize]);
        let (force, sweep) = out.gradients.split_at_mut(3 * N);
        let mut at = 0;
        for a in 0..N {
            for k in 0..3 {
                force[3 * a + k] = dot(own[a].axis[k], local.force[a]);
                sweep[3 * a + k] = dot(own[a].axis[k], local.sweep[a]);
            }
        }
        // Row by row in the upper triangle.
        for a in 0..N {
            for k in 0..3 {
                for b in a..N {
                    let block = &local.stiffness[a][b];
                    let row = if own[a].is_plain {
                        block[k]
                    } else {
                        let axis = own[a].axis[k];
                        let mut row = [0.0; 3];
                        for (i, axis) in axis.iter().enumerate() {
                            for (row, value) in row.iter_mut().zip(&block[i]) {
                                *row += axis * value;
                            }
                        }
                        row
                    };
                    for l in if a == b { k } else { 0 }..3 {
                        out.stiffness[at] = if own[b].is_plain { row[l] } else { dot(row, own[b].axis[l]) };
                        at += 1;
                    }
                }
            }
        }
    }
}

impl<E: Element<N>, const N: usize> Elements for Set<E, N> {
    fn count(&self) -> usize {
        self.elements.len()
    }

    fn nodes(&self, element: usize) -> &[u32] {
        &self.nodes[element]
    }

    fn each(&self) -> usize {
        N
    }

    fn measure(&self, place: Place<'_>, out: &mut [f64]) {
        let one = |(e, out): (usize, &mut [f64])| {
            out.copy_from_slice(&self.elements[e].measure(&self.at(e, place.x), place.penalty, &self.rule));
        };
        if self.count() < ALONE {
            out.chunks_exact_mut(2).enumerate().for_each(one);
        } else {
            out.par_chunks_exact_mut(2).enumerate().with_min_len(BATCH).for_each(one);
        }
    }

    fn work(&self, place: Place<'_>, out: Parts<'_>) {
        let size = packed(3 * N);
        let one = |(e, ((measures, gradients), stiffness)): (usize, Slices<'_>)| {
            self.one(e, place, &mut Parts { measures, gradients, stiffness });
        };
        if self.count() < ALONE {
            let each = out.measures.chunks_exact_mut(2);
            let each = each.zip(out.gradients.chunks_exact_mut(6 * N));
            each.zip(out.stiffness.chunks_exact_mut(size)).enumerate().for_each(one);
        } else {
            let each = out.measures.par_chunks_exact_mut(2);
            let each = each.zip(out.gradients.par_chunks_exact_mut(6 * N));
            let each = each.zip(out.stiffness.par_chunks_exact_mut(size));
            each.enumerate().with_min_len(BATCH).for_each(one);
        }
    }

    fn held(&mut self) -> Vec<&mut f64> {
        self.elements.iter_mut().flat_map(Element::held).collect()
    }

    fn hold(&mut self, place: Place<'_>) -> f64 {
        let mut worst = 0.0_f64;
        for (element, nodes) in self.elements.iter_mut().zip(&self.nodes) {
            let x = nodes.map(|node| place.x[node as usize]);
            worst = worst.max(element.hold(&x, place.penalty));
        }
        worst
    }
}
