//! Lookup of a point: coordinates, the stored polynomial, the factors, and the chain rule back to the axes.

use crate::chebyshev::Polynomial;
use crate::coordinate::{Fixed, cell, rooted};
use crate::format::Form;
use crate::plane::Plane;
use crate::spline::{Basis, Double, Graded, Number, Single, Spline};

/// The value and gradient of an output at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const A: usize> {
    /// Its value.
    pub value: f64,
    /// Its derivatives by the axes: the exact derivatives of the stored polynomial.
    pub gradient: [f64; A],
}

/// A table of `A` axes and `O` outputs, ready for lookups. Copying it is cheap: it borrows the coefficients.
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
    /// Cells along each axis of the outputs, and of the edge.
    pub(crate) cells: [f64; A],
    pub(crate) edge_cells: [f64; A],
    /// Smallest distance from the lower end of axis 0 that is looked up, and its smallest coordinate.
    pub(crate) least: f64,
    pub(crate) least_u: f64,
    /// Exponents k and j of each output: 0 or 1.
    pub(crate) singular: [f64; O],
    pub(crate) vanishing: [f64; O],
    /// Precomputed numbers of the lookup with two axes.
    pub(crate) plane: Plane,
}

/// The coordinates of a point with their derivatives.
pub(crate) struct Place<const A: usize> {
    /// u, v_1, ...
    pub(crate) at: [f64; A],
    /// Derivative of each coordinate by its own axis.
    pub(crate) own: [f64; A],
    /// du/dv_i for the axes 1.., which comes from the fitted edge.
    shift: [f64; A],
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// All outputs at a point with their gradients; `None` outside the domain, for a NaN, and at a singular lower end.
    #[inline]
    #[must_use]
    pub fn at(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        if A == 2 && self.form == Form::Spline {
            return if self.is_single {
                self.in_plane::<Single>(point)
            } else {
                self.in_plane::<Double>(point)
            };
        }
        self.in_space(point)
    }

    /// [`Lookup::at`] for many points, with bit-identical results written into `found`. If the slices differ
    /// in length, the rest of the longer one is left alone. For splines over two axes sixteen or more points
    /// take half the time, since the steps of several points overlap.
    ///
    /// ```
    /// # fn run(table: &bulge_table::Table<'_>) -> Option<()> {
    /// let lookup = table.lookup::<2, 2>().ok()?;
    /// let mut found = [None; 3];
    /// lookup.at_each(&[[0.1, 6.875], [0.2, 6.875], [0.9, 6.875]], &mut found);
    /// let [force, volume] = found[1]?;
    /// # let _ = (force, volume);
    /// assert!(found[2].is_none()); // beyond the largest contraction
    /// # Some(())
    /// # }
    /// ```
    #[inline]
    pub fn at_each(&self, points: &[[f64; A]], found: &mut [Option<[Sample<A>; O]>]) {
        if A == 2 && self.form == Form::Spline {
            if self.is_single {
                self.each_in_plane::<Single>(points, found);
            } else {
                self.each_in_plane::<Double>(points, found);
            }
            return;
        }
        for (point, found) in points.iter().zip(found) {
            *found = self.in_space(*point);
        }
    }

    /// [`Lookup::at`] for any number of axes. It isn't inlined: otherwise the path of two axes would set up
    /// its stack as well.
    #[inline(never)]
    fn in_space(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        let place = self.place(point)?;
        let found = match (self.form, self.is_single) {
            (Form::Spline, true) => self.spline::<Single>(&place),
            (Form::Spline, false) => self.spline::<Double>(&place),
            (Form::Chebyshev, true) => self.polynomial().at::<Single, O>(place.at),
            (Form::Chebyshev, false) => self.polynomial().at::<Double, O>(place.at),
        };
        Some(self.samples(&place, &found))
    }

    /// The upper end of axis 0 at the values of the other axes (the value of axis 0 in `point` is ignored);
    /// `None` outside.
    #[must_use]
    pub fn upper_end(&self, point: [f64; A]) -> Option<f64> {
        let place = self.others(point)?;
        if !self.is_fitted {
            return Some(self.axes[0].high);
        }
        let edge = self.edge(&place);
        // Solves q K = 1 with q = s/(s + c) for s.
        let s = edge.value[1] / (edge.value[0] - 1.0);
        Some(self.axes[0].low + if self.is_root { s * s } else { s })
    }

    /// The coordinates of the axes 1..
    pub(crate) fn others(&self, point: [f64; A]) -> Option<Place<A>> {
        let mut place = Place { at: [0.0; A], own: [1.0; A], shift: [0.0; A] };
        for (i, x) in point.iter().enumerate().skip(1) {
            [place.at[i], place.own[i]] = self.axes[i].at(*x)?;
        }
        Some(place)
    }

    #[inline]
    fn place(&self, point: [f64; A]) -> Option<Place<A>> {
        let mut place = self.others(point)?;
        let first = &self.axes[0];
        let distance = point[0] - first.low;
        // Written so that it also refuses NaN.
        if !(distance >= self.least && (self.is_fitted || point[0] <= first.high)) {
            return None;
        }
        let [s, s_by] = rooted(distance, self.is_root);
        let (u, by_s);
        if self.is_fitted {
            let edge = self.edge(&place);
            let [scale, pole] = edge.value;
            let below = 1.0 / (s + pole);
            let q = s * below;
            for (shift, by) in place.shift.iter_mut().zip(&edge.by).skip(1) {
                *shift = q * (by[0] - scale * below * by[1]);
            }
            (u, by_s) = (q * scale, scale * pole * below * below);
        } else {
            (u, by_s) = first.coordinate(s);
        }
        if !(u <= 1.0 + 4.0 * f64::EPSILON && u >= self.least_u) {
            return None;
        }
        place.at[0] = u.min(1.0);
        place.own[0] = by_s * s_by;
        Some(place)
    }

    /// 1/Q and c with their derivatives by v_1 ..
    pub(crate) fn edge(&self, place: &Place<A>) -> Graded<A, 2> {
        let mut cells = [0; A];
        let mut basis = [Basis::default(); A];
        for i in 1..A {
            let (cell, t) = cell(place.at[i], self.edge_nodes[i]);
            (cells[i], basis[i]) = (cell, Basis::at(t));
        }
        let edge = Spline { data: self.edge, first: 1, nodes: self.edge_nodes };
        edge.at::<Double, 2>(cells, &basis).per_unit(self.edge_cells)
    }

    fn polynomial(&self) -> Polynomial<'_, A> {
        Polynomial { data: self.data, orders: self.nodes }
    }

    fn spline<N: Number>(&self, place: &Place<A>) -> Graded<A, O> {
        let mut cells = [0; A];
        let mut basis = [Basis::default(); A];
        for i in 0..A {
            let (cell, t) = cell(place.at[i], self.nodes[i]);
            (cells[i], basis[i]) = (cell, Basis::at(t));
        }
        let spline = Spline { data: self.data, first: 0, nodes: self.nodes };
        spline.at::<N, O>(cells, &basis).per_unit(self.cells)
    }

    /// Applies the factors (1 - u)^j/u^k and the chain rule.
    fn samples(&self, place: &Place<A>, found: &Graded<A, O>) -> [Sample<A>; O] {
        let u = place.at[0];
        let over = 1.0 / u;
        core::array::from_fn(|o| {
            let (mut factor, mut by_u) = (1.0, 0.0);
            if self.vanishing[o] > 0.0 {
                (factor, by_u) = (1.0 - u, -1.0);
            }
            if self.singular[o] > 0.0 {
                (factor, by_u) = (factor * over, (by_u - factor * over) * over);
            }
            let g = found.value[o];
            let along = found.by[0][o] * factor + g * by_u;
            let mut gradient = [0.0; A];
            gradient[0] = along * place.own[0];
            for (i, by) in gradient.iter_mut().enumerate().skip(1) {
                *by = (found.by[i][o] * factor + along * place.shift[i]) * place.own[i];
            }
            Sample { value: g * factor, gradient }
        })
    }
}
