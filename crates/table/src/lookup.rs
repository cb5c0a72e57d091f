//! Looking up a point: coordinates, the stored polynomial, the factors, and the chain rule back.

use crate::chebyshev::Polynomial;
use crate::coordinate::{Fixed, cell, rooted, stretched};
use crate::format::Form;
use crate::spline::{Basis, Double, Graded, Number, Single, Spline, on_line};

/// An output at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const A: usize> {
    /// Its value.
    pub value: f64,
    /// Its derivatives by the axes; exactly those of `value` as it is stored.
    pub gradient: [f64; A],
}

/// A table of `A` axes and `O` outputs, ready to be looked up. Copying it is cheap; it holds no coefficients, only where they are.
#[derive(Debug, Clone, Copy)]
pub struct Lookup<'a, const A: usize, const O: usize> {
    pub(crate) form: Form,
    pub(crate) is_single: bool,
    pub(crate) is_root: bool,
    pub(crate) is_fitted: bool,
    pub(crate) axes: [Fixed; A],
    pub(crate) nodes: [usize; A],
    pub(crate) edge_nodes: [usize; A],
    pub(crate) edge: &'a [u8],
    pub(crate) data: &'a [u8],
    pub(crate) is_singular: [bool; O],
    pub(crate) any_singular: bool,
    pub(crate) vanishes: [bool; O],
}

/// The coordinates of a point with their derivatives.
struct Place<const A: usize> {
    /// u, v_1, ...
    at: [f64; A],
    /// d(coordinate)/dx of its own axis.
    own: [f64; A],
    /// du/dv_i of the axes 1.., through the fitted edge.
    shift: [f64; A],
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// All outputs at a point with their gradients; `None` outside the domain, for a NaN, and at a singular lower end.
    #[must_use]
    pub fn at(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        let place = self.place(point)?;
        let found = match (self.form, self.is_single) {
            (Form::Spline, true) => self.spline::<Single>(&place),
            (Form::Spline, false) => self.spline::<Double>(&place),
            (Form::Chebyshev, true) => Some(self.polynomial().at::<Single, O>(place.at)),
            (Form::Chebyshev, false) => Some(self.polynomial().at::<Double, O>(place.at)),
        }?;
        Some(self.samples(&place, &found))
    }

    /// The upper end of axis 0 at the other axes' values (that of axis 0 in `point` is ignored); `None` outside.
    #[must_use]
    pub fn upper_end(&self, point: [f64; A]) -> Option<f64> {
        let mut place = Place { at: [0.0; A], own: [1.0; A], shift: [0.0; A] };
        for i in 1..A {
            [place.at[i], place.own[i]] = self.axes[i].at(point[i])?;
        }
        if !self.is_fitted {
            return Some(self.axes[0].high);
        }
        let edge = self.edge(&place)?;
        // q K = 1 with q = s/(s + c).
        let s = edge.value[1] / (edge.value[0] - 1.0);
        Some(self.axes[0].low + if self.is_root { s * s } else { s })
    }

    #[inline]
    fn place(&self, point: [f64; A]) -> Option<Place<A>> {
        let mut place = Place { at: [0.0; A], own: [1.0; A], shift: [0.0; A] };
        for i in 1..A {
            [place.at[i], place.own[i]] = self.axes[i].at(point[i])?;
        }
        let first = &self.axes[0];
        let distance = point[0] - first.low;
        // At the lower end itself the root has no derivative, and its bits must be those of a normal number. Also refuses NaN.
        let least = if self.is_root { f64::MIN_POSITIVE } else { 0.0 };
        if !(distance >= least && (self.is_fitted || point[0] <= first.high)) {
            return None;
        }
        let [s, s_by] = rooted(distance, self.is_root);
        let (u, by_s);
        if self.is_fitted {
            let edge = self.edge(&place)?;
            let [scale, pole] = edge.value;
            let below = 1.0 / (s + pole);
            let q = s * below;
            for i in 1..A {
                place.shift[i] = q * (edge.by[i][0] - scale * below * edge.by[i][1]);
            }
            (u, by_s) = (q * scale, scale * pole * below * below);
        } else {
            let [q, by] = stretched(s, first.pole);
            (u, by_s) = (q * first.scale, by * first.scale);
        }
        if u > 1.0 + 4.0 * f64::EPSILON || u.is_nan() || (self.any_singular && u <= 0.0) {
            return None;
        }
        place.at[0] = u.min(1.0);
        place.own[0] = by_s * s_by;
        Some(place)
    }

    /// K and c with their derivatives by v_1 ..
    #[inline]
    fn edge(&self, place: &Place<A>) -> Option<Graded<A, 2>> {
        let mut cells = [0; A];
        let mut basis = [Basis::default(); A];
        for i in 1..A {
            let (cell, t) = cell(place.at[i], self.edge_nodes[i]);
            (cells[i], basis[i]) = (cell, Basis::at(t));
        }
        let mut edge = if A == 2 {
            on_line(self.edge, cells[1], &basis[1])?
        } else {
            Spline { data: self.edge, first: 1, nodes: self.edge_nodes }.at::<Double, 2>(cells, &basis)
        };
        for (by, nodes) in edge.by.iter_mut().zip(self.edge_nodes).skip(1) {
            for number in by {
                *number *= (nodes - 3) as f64;
            }
        }
        Some(edge)
    }

    fn polynomial(&self) -> Polynomial<'_, A> {
        Polynomial { data: self.data, orders: self.nodes }
    }

    #[inline]
    fn spline<N: Number>(&self, place: &Place<A>) -> Option<Graded<A, O>> {
        let mut cells = [0; A];
        let mut basis = [Basis::default(); A];
        for i in 0..A {
            let (cell, t) = cell(place.at[i], self.nodes[i]);
            (cells[i], basis[i]) = (cell, Basis::at(t));
        }
        let mut found = if A == 2 {
            let plane = Spline { data: self.data, first: 0, nodes: [self.nodes[0], self.nodes[1]] };
            let flat = plane.in_plane::<N, O>([cells[0], cells[1]], &[basis[0], basis[1]])?;
            let mut found = Graded { value: flat.value, by: [[0.0; O]; A] };
            found.by[0] = flat.by[0];
            found.by[1] = flat.by[1];
            found
        } else {
            Spline { data: self.data, first: 0, nodes: self.nodes }.at::<N, O>(cells, &basis)
        };
        for (by, nodes) in found.by.iter_mut().zip(self.nodes) {
            for number in by {
                *number *= (nodes - 3) as f64;
            }
        }
        Some(found)
    }

    /// The factors (1 - u)^j/u^k, and the chain rule.
    #[inline]
    fn samples(&self, place: &Place<A>, found: &Graded<A, O>) -> [Sample<A>; O] {
        let u = place.at[0];
        let over = if self.any_singular { 1.0 / u } else { 1.0 };
        core::array::from_fn(|o| {
            let (mut factor, mut by_u) = (1.0, 0.0);
            if self.vanishes[o] {
                (factor, by_u) = (1.0 - u, -1.0);
            }
            if self.is_singular[o] {
                (factor, by_u) = (factor * over, (by_u - factor * over) * over);
            }
            let g = found.value[o];
            let along = found.by[0][o] * factor + g * by_u;
            let mut gradient = [0.0; A];
            gradient[0] = along * place.own[0];
            for i in 1..A {
                gradient[i] = (found.by[i][o] * factor + along * place.shift[i]) * place.own[i];
            }
            Sample { value: g * factor, gradient }
        })
    }
}
