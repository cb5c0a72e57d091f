//! Elements: the stored energy of each and the volume under it, with the forces and stiffness derived from
//! them.

#![expect(
    clippy::needless_range_loop,
    reason = "an index runs over the nodes or directions of several arrays at once"
)]

mod cable;
mod contact;
mod ring;
mod shape;
mod star;
mod triangle;

pub(crate) use cable::Cable;
pub(crate) use contact::{Contact, Mirror};
pub use ring::RingLayer;
pub(crate) use ring::{Carried as CarriedByRing, Layer, Ring};
pub(crate) use star::{Star, corners};
pub(crate) use triangle::{Carried, Triangle};

/// A vector.
pub(crate) type Vector = [f64; 3];

/// Energy less pressure times volume of one element at the positions of its N nodes: value, volume, gradients
/// and stiffness.
#[derive(Debug, Clone)]
pub(crate) struct Local<const N: usize> {
    /// Stored energy.
    pub(crate) energy: f64,
    /// Volume between the element and the axis.
    pub(crate) volume: f64,
    /// d(energy)/dx.
    pub(crate) force: [Vector; N],
    /// d(volume)/dx.
    pub(crate) sweep: [Vector; N],
    /// Second derivatives of energy - p volume, node by node; only those with the first node's number <= the
    /// second's.
    pub(crate) stiffness: [[[Vector; 3]; N]; N],
}

impl<const N: usize> Local<N> {
    pub(crate) const ZERO: Self = Self {
        energy: 0.0,
        volume: 0.0,
        force: [[0.0; 3]; N],
        sweep: [[0.0; 3]; N],
        stiffness: [[[[0.0; 3]; 3]; N]; N],
    };
}

#[inline]
pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(crate) fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn scaled(a: Vector, by: f64) -> Vector {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline]
pub(crate) fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Weighted sum of positions.
#[inline]
pub(crate) fn mixed<const N: usize>(x: &[Vector; N], weights: &[f64; N]) -> Vector {
    let mut sum = [0.0; 3];
    for (x, w) in x.iter().zip(weights) {
        sum = add(sum, scaled(*x, *w));
    }
    sum
}

#[cfg(test)]
mod tests;
