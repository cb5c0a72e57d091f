//! Map from a point to the unit coordinates, with derivatives.

use crate::sqrt::reciprocal_root;

/// The coordinate of an axis without a fitted edge.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fixed {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Infinite for a linear coordinate.
    pub(crate) pole: f64,
    /// The coordinate is `scale` q; 1/(high - low) for a linear one.
    pub(crate) scale: f64,
}

impl Fixed {
    /// v in \[0, 1\] and dv/dx; `None` outside.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> Option<[f64; 2]> {
        if !(x >= self.low && x <= self.high) {
            return None;
        }
        let (v, by_x) = self.coordinate(x - self.low);
        // Rounding may pass 1 at the upper end.
        Some([v.min(1.0), by_x])
    }

    /// The coordinate and its derivative at a distance s from the lower end.
    #[inline]
    pub(crate) fn coordinate(&self, s: f64) -> (f64, f64) {
        if self.pole == f64::INFINITY {
            return (self.scale * s, self.scale);
        }
        let below = 1.0 / (s + self.pole);
        (self.scale * (s * below), self.scale * (self.pole * below * below))
    }
}

/// s and ds/dx at a distance > 0 from the lower end: s is the distance or its square root.
#[inline]
pub(crate) fn rooted(distance: f64, is_root: bool) -> [f64; 2] {
    if !is_root {
        return [distance, 1.0];
    }
    let r = reciprocal_root(distance);
    [distance * r, 0.5 * r]
}

/// Cell of a coordinate in \[0, 1\] in a spline with `nodes` >= 4 coefficients, and the position in the cell
/// from 0 to 1.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and 2^32")]
pub(crate) fn cell(v: f64, nodes: usize) -> (usize, f64) {
    let along = v * (nodes - 3) as f64;
    let cell = (along as usize).min(nodes - 4);
    (cell, along - cell as f64)
}

/// 1.5 2^52: adding it to a small number rounds that to an integer, which the low bits of the sum hold.
pub(crate) const WHOLE: f64 = 6_755_399_441_055_744.0;
/// Factor that keeps a coordinate of 1, and rounding above it, in the last cell.
pub(crate) const INSIDE: f64 = 1.0 - 8.0 * f64::EPSILON;

/// As [`cell`], without the checks of a conversion. At the border of two cells the result may be either.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the low bits are the number of the cell")]
pub(crate) fn near(v: f64, cells: f64) -> (usize, f64) {
    let cell = (v * (cells * INSIDE) - 0.5) + WHOLE;
    (cell.to_bits() as u32 as usize, v * cells - (cell - WHOLE))
}
