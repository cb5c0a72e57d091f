//! The lookup of splines over two axes: the general path with everything known beforehand and no loop left, two outputs at a time.
//!
//! What doesn't depend on the output is computed twice, from numbers that are stored twice: so it needn't be spread before it meets the outputs.

use core::array;

use crate::coordinate::{Fixed, INSIDE, WHOLE};
use crate::lookup::{Lookup, Sample};
use crate::pair::{Factors, Pair, Weights};
use crate::spline::{Double, Number};

/// Most pairs of outputs.
const PAIRS: usize = crate::format::MOST_OUTPUTS / 2;

/// Numbers of a table of two axes, most of them twice.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Plane {
    low: [Pair; 2],
    /// Upper ends; where the edge is one, a number before those whose multiples are infinite.
    high: [f64; 2],
    /// Of the first coordinate scale s/(factor s + pole) without fitted edge: scale and pole.
    first: Pair,
    factor: Pair,
    /// Pole of the second coordinate, and its scale by the pole.
    pole: Pair,
    own: Pair,
    is_linear: bool,
    /// From u, and from s/(s + c) of the second axis, to cells.
    across: Cells,
    along: Cells,
    edge: Cells,
    /// From H - L to derivatives by the coordinates.
    across_by: Pair,
    along_by: Pair,
    edge_by: Pair,
    /// Coefficients along the second axis.
    nodes: u32,
    factors: [Factors; PAIRS],
}

impl Plane {
    /// The numbers of a lookup whose others are known.
    pub(crate) fn new<const A: usize, const O: usize>(lookup: &Lookup<'_, A, O>) -> Self {
        if A != 2 {
            return Self::default();
        }
        let [first, second] = [&lookup.axes[0], &lookup.axes[1]];
        let [across, along] = [lookup.cells[0], lookup.cells[1]];
        let is_fitted = lookup.is_fitted;
        // scale, factor and pole.
        let fraction = |axis: &Fixed| {
            if axis.pole == f64::INFINITY { [axis.scale, 0.0, 1.0] } else { [axis.scale, 1.0, axis.pole] }
        };
        // A fitted edge gives six times its numbers.
        let [scale, factor, pole] = if is_fitted { [0.0, 6.0, 0.0] } else { fraction(first) };
        let (end, _) = second.coordinate(second.high - second.low);
        let scale_v = second.scale / if end > 1.0 { end } else { 1.0 };
        let [second_scale, _, second_pole] = fraction(second);
        let both = Pair::both;
        Self {
            low: [both(first.low), both(second.low)],
            high: [if is_fitted { first.low + f64::MAX / 8.0 } else { first.high }, second.high],
            first: Pair([scale, pole]),
            factor: both(factor),
            pole: both(second_pole),
            own: both(second_scale * second_pole),
            is_linear: second.pole == f64::INFINITY,
            across: Cells::new(1.0, across),
            along: Cells::new(scale_v, along),
            edge: Cells::new(scale_v, lookup.edge_cells[1]),
            across_by: both(3.0 * across),
            along_by: both(3.0 * along),
            edge_by: both(3.0 * lookup.edge_cells[1]),
            nodes: u32::try_from(lookup.nodes[1]).unwrap_or(0),
            factors: array::from_fn(|i| {
                let of =
                    |numbers: &[f64; O]| [2 * i, 2 * i + 1].map(|o| numbers.get(o).copied().unwrap_or(0.0));
                Factors::new(of(&lookup.singular), of(&lookup.vanishing))
            }),
        }
    }
}

/// From a coordinate, but for its scale, to equal cells.
#[derive(Debug, Clone, Copy, Default)]
struct Cells {
    number: Pair,
    /// The same, just short of the end.
    inside: Pair,
}

impl Cells {
    fn new(scale: f64, number: f64) -> Self {
        Self { number: Pair::both(scale * number), inside: Pair::both(scale * number * INSIDE) }
    }

    /// Cell and the place in it, without the checks of a conversion. Where two cells meet it may be either.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the low bits are the number of the cell")]
    fn at(&self, q: Pair) -> (usize, Pair) {
        let whole = Pair::both(WHOLE);
        let cell = (q * self.inside - Pair::both(0.5)) + whole;
        (cell.0[0].to_bits() as u32 as usize, q * self.number - (cell - whole))
    }
}

/// Four coefficients of outputs `2 i` and `2 i + 1` (or the last one twice) from the bytes of a row.
#[inline]
fn four<N: Number, const O: usize>(row: &[u8], i: usize) -> [Pair; 4] {
    let outputs = [2 * i, (2 * i + 1).min(O - 1)];
    let at = |k: usize| Pair(outputs.map(|o| N::read(&row[(k * O + o) * N::BYTES..])));
    [at(0), at(1), at(2), at(3)]
}

/// An output of a pair's values and derivatives.
#[inline]
fn sample<const A: usize>(found: &[Pair; 3], o: usize) -> Sample<A> {
    let mut gradient = [0.0; A];
    [gradient[0], gradient[1]] = [found[1].0[o], found[2].0[o]];
    Sample { value: found[0].0[o], gradient }
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// [`Lookup::at`] of splines where A is 2.
    #[inline]
    pub(crate) fn in_plane<N: Number>(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        if O > 2 {
            return self.all_in_plane::<N>(point);
        }
        let found = self.two_in_plane::<N>(point[0], point[1], 0)?;
        Some(array::from_fn(|o| sample(&found, o)))
    }

    fn all_in_plane<N: Number>(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        let mut samples = [Sample { value: 0.0, gradient: [0.0; A] }; O];
        for (i, samples) in samples.chunks_mut(2).enumerate() {
            let found = self.two_in_plane::<N>(point[0], point[1], i)?;
            for (o, to) in samples.iter_mut().enumerate() {
                *to = sample(&found, o);
            }
        }
        Some(samples)
    }

    /// Values and derivatives of a pair of outputs. A function of its own, since pairs that are returned in memory stay pairs.
    #[inline(never)]
    fn two_in_plane<N: Number>(&self, x: f64, y: f64, i: usize) -> Option<[Pair; 3]> {
        let plane = &self.plane;
        let i = if O > 2 { i } else { 0 };
        let distance = Pair::both(x) - plane.low[0];
        let is_inside = y >= plane.low[1].0[0] && y <= plane.high[1];
        if !(is_inside && distance.0[0] >= self.least && x <= plane.high[0]) {
            return None;
        }
        // The second coordinate, but for its scale.
        let mut q = Pair::both(y) - plane.low[1];
        let mut own_v = plane.own;
        if !plane.is_linear {
            let below = (q + plane.pole).reciprocal();
            q = q * below;
            own_v = own_v * below * below;
        }
        let (mut s, mut s_by) = (distance, Pair::both(1.0));
        if self.is_root {
            let r = distance.reciprocal_root();
            (s, s_by) = (distance * r, r * Pair::both(0.5));
        }
        // The first one, with what it takes from the second.
        let (mut edge, mut edge_by) = (plane.first, Pair::default());
        if self.is_fitted {
            let (cell, t) = plane.edge.at(q);
            let knots: &[[u8; 16]; 4] = self.edge.as_chunks().0.get(cell..)?.first_chunk()?;
            let knot = |k: &[u8; 16]| Pair([Double::read(&k[..8]), Double::read(&k[8..])]);
            let weights = Weights::at(t);
            let ends = weights.ends(&[knot(&knots[0]), knot(&knots[1]), knot(&knots[2]), knot(&knots[3])]);
            (edge, edge_by) = (weights.mean(ends), (ends[1] - ends[0]) * plane.edge_by);
        }
        let [scale, pole] = edge.0.map(Pair::both);
        let [scale_by, pole_by] = edge_by.0.map(Pair::both);
        let below = (s * plane.factor + pole).reciprocal();
        let part = scale * below;
        let u = part * s;
        let own_u = part * (pole * below) * s_by;
        let shift = (s * below) * (scale_by - part * pole_by);
        if !(u.0[0] <= 1.0 + 4.0 * f64::EPSILON && u.0[0] >= self.least_u) {
            return None;
        }
        // The patch.
        let (row, t) = plane.across.at(u);
        let (column, w) = plane.along.at(q);
        let (across, along) = (Weights::at(t), Weights::at(w));
        let each = O * N::BYTES;
        let stride = each * plane.nodes as usize;
        let start = row * stride + column * each;
        let patch = self.data.get(start..start + (3 * stride + 4 * each))?;
        let rows = [0, 1, 2, 3].map(|k| patch.get(k * stride..k * stride + 4 * each));
        let (fourth, third, second, first) = (rows[3]?, rows[2]?, rows[1]?, rows[0]?);
        let [l0, h0] = along.ends(&four::<N, O>(first, i));
        let [l1, h1] = along.ends(&four::<N, O>(second, i));
        let [l2, h2] = along.ends(&four::<N, O>(third, i));
        let [l3, h3] = along.ends(&four::<N, O>(fourth, i));
        let low = across.ends(&[l0, l1, l2, l3]);
        let high = across.ends(&[h0, h1, h2, h3]);
        let ends = [along.mean([low[0], high[0]]), along.mean([low[1], high[1]])];
        let g = across.mean(ends);
        let g_u = ends[1] - ends[0];
        let g_v = across.mean([high[0] - low[0], high[1] - low[1]]);
        // The factors, and the chain rule.
        let u = u.at_most(1.0);
        let over = if self.least_u > 0.0 { u.reciprocal() } else { Pair::both(1.0) };
        let [factor, fall] = plane.factors[i].at(u, over);
        let by_u = g_u * (factor * plane.across_by) - g * fall;
        let by_v = g_v * (factor * (plane.along_by * own_v)) + by_u * (shift * own_v);
        Some([g * factor, by_u * own_u, by_v])
    }
}
