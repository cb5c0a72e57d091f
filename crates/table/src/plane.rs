//! The lookup of splines over two axes, the second one first: the general path with everything known beforehand and no loop left.

use core::array;

use crate::lookup::{Lookup, Sample};
use crate::spline::{Basis, Number, on_line, weighted};
use crate::sqrt::reciprocal_root;

/// 1.5 2^52: added to a small number, the sum is a whole number whose low bits are its own.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Cell of a coordinate in \[0, 1\] and the place in it, without the checks of a conversion. Where two cells meet it may be either.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the low bits are the number of the cell")]
fn cell(v: f64, cells: f64) -> (usize, f64) {
    let along = v * cells;
    let number = smaller((along - 0.5) + WHOLE - WHOLE, cells - 1.0);
    ((number + WHOLE).to_bits() as u32 as usize, along - number)
}

/// The smaller of two numbers, neither of which is a NaN: one instruction.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// [`Lookup::at`] of splines where A is 2.
    #[inline]
    pub(crate) fn in_plane<N: Number>(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        let [first, second] = [&self.axes[0], &self.axes[1]];
        let [x, y] = [point[0], point[1]];
        let distance = x - first.low;
        if !(y >= second.low && y <= second.high && distance >= self.least) {
            return None;
        }
        // The second coordinate; its derivative later.
        let (v, v_by) = second.coordinate(y - second.low);
        let v = smaller(v, 1.0);
        let (s, s_by) = if self.is_root {
            let r = reciprocal_root(distance);
            (distance * r, 0.5 * r)
        } else {
            (distance, 1.0)
        };
        // The first one, with what it takes from the second.
        let (u, u_by, shift);
        if self.is_fitted {
            let cells = self.edge_cells[1];
            let (cell, t) = cell(v, cells);
            let edge = on_line(self.edge, cell, &Basis::at(t))?;
            let [scale, pole] = edge.0;
            let below = 1.0 / (s + pole);
            let q = s * below;
            u = q * scale;
            u_by = scale * pole * below * below;
            shift = q * cells * (edge.1[0] - scale * below * edge.1[1]);
        } else {
            if x > first.high {
                return None;
            }
            (u, u_by) = first.coordinate(s);
            shift = 0.0;
        }
        if !(u <= 1.0 + 4.0 * f64::EPSILON && u >= self.least_u) {
            return None;
        }
        let u = smaller(u, 1.0);
        let [across_cells, along_cells] = [self.cells[0], self.cells[1]];
        let (row, t) = cell(u, across_cells);
        let (column, w) = cell(v, along_cells);
        let (across, along) = (Basis::at(t), Basis::at(w));
        let each = O * N::BYTES;
        let stride = each * self.nodes[1];
        let start = row * stride + column * each;
        let row = |i: usize| {
            let knots = self.data.get(start + i * stride..start + i * stride + 4 * each)?;
            let at = |k: usize| array::from_fn(|o| N::read(&knots[k * each + o * N::BYTES..]));
            let four: [[f64; O]; 4] = [at(0), at(1), at(2), at(3)];
            Some((weighted(along.value, &four), weighted(along.slope, &four)))
        };
        let ((v0, s0), (v1, s1), (v2, s2), (v3, s3)) = (row(0)?, row(1)?, row(2)?, row(3)?);
        let (values, slopes) = ([v0, v1, v2, v3], [s0, s1, s2, s3]);
        let g = weighted(across.value, &values);
        let g_u = weighted(across.slope, &values);
        let g_v = weighted(across.value, &slopes);
        let over = if self.least_u > 0.0 { 1.0 / u } else { 1.0 };
        let [own_u, own_v] = [u_by * s_by, v_by];
        Some(array::from_fn(|o| {
            // (1 - u)^j/u^k and its derivative.
            let (rest, inverse) = (1.0 - self.vanishing[o] * u, 1.0 + self.singular[o] * (over - 1.0));
            let factor = rest * inverse;
            let factor_u = -inverse * (self.vanishing[o] + self.singular[o] * rest * over);
            let by_u = g_u[o] * (factor * across_cells) + g[o] * factor_u;
            let by_v = g_v[o] * (factor * along_cells) + by_u * shift;
            let mut gradient = [0.0; A];
            gradient[0] = by_u * own_u;
            gradient[1] = by_v * own_v;
            Sample { value: g[o] * factor, gradient }
        }))
    }
}
