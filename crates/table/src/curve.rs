//! A table with all axes but axis 0 fixed, for example one muscle. Its lookup along axis 0 needs neither the
//! table nor the edge.

use crate::coordinate::{cell, near, rooted};
use crate::format::Form;
use crate::lookup::{Lookup, Sample};
use crate::spline::{Basis, Double, Number, Single, Spline};

/// A table along axis 0 at fixed values of the others, for tables of splines with at most `N` coefficients
/// along axis 0. It holds its own coefficients, A O N numbers, and no longer needs the table: 3 kB for two
/// axes, two outputs and N = 96.
///
/// ```
/// # fn run(table: &bulge_table::Table<'_>) -> Option<()> {
/// let lookup = table.lookup::<2, 2>().ok()?;
/// let muscle = lookup.curve::<96>([0.0, 6.875])?; // l0/R = 6.875; the contraction is ignored
/// let [force, volume] = muscle.at(0.2)?;          // the same as lookup.at([0.2, 6.875])
/// # let _ = (force, volume);
/// # Some(())
/// # }
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Curve<const A: usize, const O: usize, const N: usize> {
    low: f64,
    high: f64,
    is_root: bool,
    least: f64,
    least_u: f64,
    /// Factor and pole of the coordinate; the pole is infinite for a linear one.
    scale: f64,
    pole: f64,
    /// d ln(scale)/dx_i and d(pole)/dx_i of the axes 1..
    scale_by: [f64; A],
    pole_by: [f64; A],
    cells: f64,
    /// For each coefficient along axis 0: the outputs, then their derivatives by the axes 1..
    knots: [[[f64; O]; A]; N],
    singular: [f64; O],
    vanishing: [f64; O],
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// The table at fixed values of the axes 1.. (the value of axis 0 in `point` is ignored); `None` outside,
    /// for tables of Chebyshev polynomials, and for more than `N` coefficients along axis 0.
    #[must_use]
    pub fn curve<const N: usize>(&self, point: [f64; A]) -> Option<Curve<A, O, N>> {
        if self.form != Form::Spline || self.nodes[0] > N {
            return None;
        }
        let place = self.others(point)?;
        let first = &self.axes[0];
        let mut curve = Curve {
            low: first.low,
            high: first.high,
            is_root: self.is_root,
            least: self.least,
            least_u: self.least_u,
            scale: first.scale,
            pole: first.pole,
            scale_by: [0.0; A],
            pole_by: [0.0; A],
            cells: self.cells[0],
            knots: [[[0.0; O]; A]; N],
            singular: self.singular,
            vanishing: self.vanishing,
        };
        if self.is_fitted {
            let edge = self.edge(&place);
            [curve.scale, curve.pole] = edge.value;
            for i in 1..A {
                curve.scale_by[i] = edge.by[i][0] / edge.value[0] * place.own[i];
                curve.pole_by[i] = edge.by[i][1] * place.own[i];
            }
            // With a fitted edge the upper end is where u is 1.
            curve.high = f64::INFINITY;
        }
        if self.is_single {
            self.knots::<Single, N>(&place.at, &place.own, &mut curve.knots);
        } else {
            self.knots::<Double, N>(&place.at, &place.own, &mut curve.knots);
        }
        Some(curve)
    }

    /// Contracts all axes except the first.
    fn knots<B: Number, const N: usize>(
        &self,
        at: &[f64; A],
        own: &[f64; A],
        knots: &mut [[[f64; O]; A]; N],
    ) {
        let mut cells = [0; A];
        let mut basis = [Basis::default(); A];
        for i in 1..A {
            (cells[i], basis[i]) = {
                let (cell, t) = cell(at[i], self.nodes[i]);
                (cell, Basis::at(t))
            };
        }
        // One index along axis 0 spans the coefficients of all other axes and all outputs.
        let row = self.nodes[1..].iter().product::<usize>() * O * B::BYTES;
        for (i, knot) in knots.iter_mut().enumerate().take(self.nodes[0]) {
            let data = self.data.get(i * row..(i + 1) * row).unwrap_or_default();
            let found = Spline { data, first: 1, nodes: self.nodes }.at::<B, O>(cells, &basis);
            knot[0] = found.value;
            for axis in 1..A {
                knot[axis] = found.by[axis].map(|by| by * self.cells[axis] * own[axis]);
            }
        }
    }
}

impl<const A: usize, const O: usize, const N: usize> Curve<A, O, N> {
    /// All outputs with their gradients by all axes; `None` outside, for a NaN, and at a singular lower end.
    #[inline]
    #[must_use]
    pub fn at(&self, x: f64) -> Option<[Sample<A>; O]> {
        let distance = x - self.low;
        if !(distance >= self.least && x <= self.high) {
            return None;
        }
        let [s, s_by] = rooted(distance, self.is_root);
        let (u, by_s, over_pole);
        if self.pole == f64::INFINITY {
            (u, by_s, over_pole) = (self.scale * s, self.scale, 0.0);
        } else {
            let below = 1.0 / (s + self.pole);
            u = self.scale * (s * below);
            (by_s, over_pole) = (self.scale * self.pole * below * below, below);
        }
        if !(u <= 1.0 + 4.0 * f64::EPSILON && u >= self.least_u) {
            return None;
        }
        let (cell, t) = near(u, self.cells);
        let basis = Basis::at(t);
        let knots: &[[[f64; O]; A]; 4] = self.knots.get(cell..)?.first_chunk()?;
        let over = if self.least_u > 0.0 { 1.0 / u } else { 1.0 };
        Some(core::array::from_fn(|o| {
            let sum = |w: &[f64; 4], axis: usize| {
                (w[0] * knots[0][axis][o] + w[1] * knots[1][axis][o])
                    + (w[2] * knots[2][axis][o] + w[3] * knots[3][axis][o])
            };
            let (g, g_u) = (sum(&basis.value, 0), sum(&basis.slope, 0));
            // (1 - u)^j/u^k and its derivative.
            let (rest, inverse) = (1.0 - self.vanishing[o] * u, 1.0 + self.singular[o] * (over - 1.0));
            let factor = rest * inverse;
            let factor_u = -inverse * (self.vanishing[o] + self.singular[o] * rest * over);
            let by_u = g_u * (factor * self.cells) + g * factor_u;
            let mut gradient = [0.0; A];
            gradient[0] = by_u * by_s * s_by;
            for (axis, by) in gradient.iter_mut().enumerate().skip(1) {
                let shift = u * (self.scale_by[axis] - over_pole * self.pole_by[axis]);
                *by = sum(&basis.value, axis) * factor + by_u * shift;
            }
            Sample { value: g * factor, gradient }
        }))
    }
}
