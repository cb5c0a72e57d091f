//! Lookup of splines over two axes. It is the general path with all constants precomputed and all loops
//! unrolled, for two outputs at a time. Many points go two at a time through the steps that don't depend on
//! the output.
//!
//! A single point is computed as a pair of identical points, so that its numbers are already duplicated when
//! they meet the two outputs.
//!
//! Many points go through in blocks and stages. A processor looks some three hundred instructions ahead, and
//! holds fewer results. The dependency chain of a lookup is longer than that, a stage is shorter: so the
//! latency of one point is filled with the work of the next. The stages are separate functions, not inlined,
//! that write to memory, because only then does the compiler keep the pairs as pairs. A pair is two points in
//! all stages except that of the rows, where it is two outputs.

use core::array;

use crate::coordinate::{Fixed, INSIDE, WHOLE};
use crate::lookup::{Lookup, Sample};
use crate::pair::{Factors, Pair, Weights};
use crate::spline::{Double, Number};

/// Points that go through the stages together. An even number.
const BLOCK: usize = 16;
/// Fewer points are looked up one by one: setting up a block would cost more than it saves.
const FEW: usize = 4;
/// Most pairs of outputs.
const PAIRS: usize = crate::format::MOST_OUTPUTS / 2;

/// Precomputed numbers of a table of two axes, most of them duplicated in a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Plane {
    low: [Pair; 2],
    /// Upper ends. With a fitted edge, that of the first axis is a number so large that only its multiples
    /// overflow.
    high: [Pair; 2],
    /// Smallest distance from the lower end of the first axis, and smallest coordinate of it.
    least: Pair,
    least_u: Pair,
    /// Scale and pole of the first coordinate scale s/(factor s + pole) without a fitted edge.
    first: Pair,
    factor: Pair,
    /// Pole of the second coordinate; and scale times pole times the factor that turns H - L of the spline
    /// into a derivative.
    pole: Pair,
    own: Pair,
    is_linear: bool,
    /// From u, and from s/(s + c) of the second axis, to cells.
    across: Cells,
    along: Cells,
    edge: Cells,
    /// Factor from H - L to a derivative by the first coordinate.
    across_by: Pair,
    /// The same factor of the edge, relative to that of the second coordinate.
    edge_by: Pair,
    /// Coefficients along the second axis.
    nodes: u32,
    factors: [Factors; PAIRS],
}

impl Plane {
    /// The factors and the chain rule: value and derivatives of an output by the axes, from the value and
    /// derivatives of its spline.
    #[inline]
    fn chain(&self, place: &Chain, factors: &Factors, [g, g_u, g_v]: [Pair; 3]) -> [Pair; 3] {
        let [factor, fall] = factors.at(place.u, place.over);
        let by_u = g_u * (factor * self.across_by) - g * fall;
        let by_v = g_v * (factor * place.own_v) + by_u * place.shift;
        [g * factor, by_u * place.own_u, by_v]
    }

    /// Precomputes the numbers from the other fields of a lookup.
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
        // The spline of a fitted edge yields six times its values, which the factor 6 balances.
        let [scale, factor, pole] = if is_fitted { [0.0, 6.0, 0.0] } else { fraction(first) };
        let (end, _) = second.coordinate(second.high - second.low);
        let scale_v = second.scale / if end > 1.0 { end } else { 1.0 };
        let [second_scale, _, second_pole] = fraction(second);
        let both = Pair::both;
        Self {
            low: [both(first.low), both(second.low)],
            high: [if is_fitted { first.low + f64::MAX / 8.0 } else { first.high }, second.high].map(both),
            least: both(lookup.least),
            least_u: both(lookup.least_u),
            first: Pair([scale, pole]),
            factor: both(factor),
            pole: both(second_pole),
            own: both(second_scale * second_pole * (3.0 * along)),
            is_linear: second.pole == f64::INFINITY,
            across: Cells::new(1.0, across),
            along: Cells::new(scale_v, along),
            edge: Cells::new(scale_v, lookup.edge_cells[1]),
            across_by: both(3.0 * across),
            edge_by: both(lookup.edge_cells[1] / along),
            nodes: u32::try_from(lookup.nodes[1]).unwrap_or(0),
            factors: array::from_fn(|i| {
                let of =
                    |numbers: &[f64; O]| [2 * i, 2 * i + 1].map(|o| numbers.get(o).copied().unwrap_or(0.0));
                Factors::new(of(&lookup.singular), of(&lookup.vanishing))
            }),
        }
    }
}

/// Map from a coordinate without its scale factor to equal cells.
#[derive(Debug, Clone, Copy, Default)]
struct Cells {
    number: Pair,
    /// The same number, reduced so that a coordinate of 1 stays in the last cell.
    inside: Pair,
}

impl Cells {
    fn new(scale: f64, number: f64) -> Self {
        Self { number: Pair::both(scale * number), inside: Pair::both(scale * number * INSIDE) }
    }

    /// Cells and the positions in them, without the checks of a conversion. At the border of two cells the
    /// result may be either.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the low bits are the number of the cell")]
    fn at(&self, q: Pair) -> ([u32; 2], Pair) {
        let whole = Pair::both(WHOLE);
        let cell = (q * self.inside - Pair::both(0.5)) + whole;
        (cell.0.map(|cell| cell.to_bits() as u32), q * self.number - (cell - whole))
    }
}

/// Four coefficients of outputs `2 i` and `2 i + 1` (or the last one twice) from the bytes of a row.
#[inline]
fn four<N: Number, const O: usize>(row: &[u8], i: usize) -> [Pair; 4] {
    let outputs = [2 * i, (2 * i + 1).min(O - 1)];
    let at = |k: usize| Pair(outputs.map(|o| N::read(&row[(k * O + o) * N::BYTES..])));
    [at(0), at(1), at(2), at(3)]
}

/// One output of a pair's values and derivatives.
#[inline]
fn sample<const A: usize>(found: &[Pair; 3], o: usize) -> Sample<A> {
    let mut gradient = [0.0; A];
    [gradient[0], gradient[1]] = [found[1].0[o], found[2].0[o]];
    Sample { value: found[0].0[o], gradient }
}

/// [`Weights::ends`] of the four rows of coefficients around a point, for a pair of outputs.
type Rows = [[Pair; 2]; 4];

/// 36 times the splines, and 12 times their derivatives by the positions in the cell, from the rows. `along`
/// is the position in the cell along the second axis.
#[inline]
fn crossed(across: &Weights, along: Pair, [[l0, h0], [l1, h1], [l2, h2], [l3, h3]]: &Rows) -> [Pair; 3] {
    let low = across.ends(&[*l0, *l1, *l2, *l3]);
    let high = across.ends(&[*h0, *h1, *h2, *h3]);
    let by_v = [high[0] - low[0], high[1] - low[1]];
    let ends = [low[0] + along * by_v[0], low[1] + along * by_v[1]];
    [across.mean(ends), ends[1] - ends[0], across.mean(by_v)]
}

/// Position of two points along their axes; a single point is stored twice.
#[derive(Debug, Clone, Copy, Default)]
struct Start {
    /// The distance from the lower end or its root, and the derivative.
    s: [Pair; 2],
    /// The second coordinate without its scale factor; and the derivative that multiplies H - L of the spline
    /// along it.
    q: Pair,
    own_v: Pair,
    /// Smallest margin from the ends that don't depend on the other axis; negative or NaN outside.
    within: Pair,
}

/// Whether a margin belongs to a point inside: false for a NaN.
#[inline]
fn is_within(distance: f64) -> bool {
    distance >= 0.0
}

impl Start {
    #[inline]
    fn at(plane: &Plane, is_root: bool, x: Pair, y: Pair) -> Self {
        let distance = x - plane.low[0];
        let (mut q, mut own_v) = (y - plane.low[1], plane.own);
        // `or_less` keeps a NaN only in its last argument, so the terms that may be NaN come last.
        let last = (plane.high[0] - x) + Pair::both(0.0) * q;
        let within = (distance - plane.least).or_less(q).or_less(plane.high[1] - y).or_less(last);
        if !plane.is_linear {
            let below = (q + plane.pole).reciprocal();
            q = q * below;
            own_v = own_v * below * below;
        }
        let mut s = [distance, Pair::both(1.0)];
        if is_root {
            let r = distance.reciprocal_root();
            s = [distance * r, r * Pair::both(0.5)];
        }
        Self { s, q, own_v, within }
    }
}

/// 1/Q and c of the edge (times six) at two points, each with H - L of its spline. Without a fitted edge:
/// scale and pole of the coordinate.
#[derive(Debug, Clone, Copy, Default)]
struct Edge {
    scale: [Pair; 2],
    pole: [Pair; 2],
}

/// What the chain rule needs for two points besides the spline.
#[derive(Debug, Clone, Copy, Default)]
struct Chain {
    /// The first coordinate and its inverse.
    u: Pair,
    over: Pair,
    /// Derivatives of the first coordinate by its own axis and by the second axis; derivative of the second
    /// coordinate as in [`Start`].
    own_u: Pair,
    shift: Pair,
    own_v: Pair,
}

impl Chain {
    /// One of both points, duplicated.
    #[inline]
    fn only(&self, point: usize) -> Self {
        let both = |two: Pair| Pair::both(two.0[point]);
        let Self { u, over, own_u, shift, own_v } = *self;
        Self { u: both(u), over: both(over), own_u: both(own_u), shift: both(shift), own_v: both(own_v) }
    }
}

/// Cells of two points in the table, and positions in them.
#[derive(Debug, Clone, Copy, Default)]
struct Places {
    row: [u32; 2],
    column: [u32; 2],
    /// Positions in their cells.
    t: Pair,
    w: Pair,
    chain: Chain,
    /// Smallest margin from all ends, in mixed units; negative or NaN outside.
    within: Pair,
}

impl<const A: usize, const O: usize> Lookup<'_, A, O> {
    /// [`Lookup::at`] for splines with A = 2.
    #[inline]
    pub(crate) fn in_plane<N: Number>(&self, point: [f64; A]) -> Option<[Sample<A>; O]> {
        all(|i| self.two_in_plane::<N>(point[0], point[1], i))
    }

    /// Values and derivatives of a pair of outputs. It isn't inlined, so that they pass through memory as in
    /// the stages.
    #[inline(never)]
    fn two_in_plane<N: Number>(&self, x: f64, y: f64, i: usize) -> Option<[Pair; 3]> {
        let plane = &self.plane;
        let start = Start::at(plane, self.is_root, Pair::both(x), Pair::both(y));
        // 1/Q and c of the edge form one pair.
        let (mut edge, mut edge_by) = (plane.first, Pair::default());
        if self.is_fitted {
            let (cell, t) = plane.edge.at(start.q);
            let knots: &[[u8; 16]; 4] = self.edge.as_chunks().0.get(cell[0] as usize..)?.first_chunk()?;
            let weights = Weights::at(t);
            let ends = weights.ends(&knots.map(|k| Pair([Double::read(&k[..8]), Double::read(&k[8..])])));
            (edge, edge_by) = (weights.mean(ends), ends[1] - ends[0]);
        }
        let twice = |i: usize| [Pair::both(edge.0[i]), Pair::both(edge_by.0[i])];
        let places = self.both_places(&start, &Edge { scale: twice(0), pole: twice(1) });
        let [across, along] = Weights::of_each(Pair([places.t.0[0], places.w.0[0]]));
        let found = crossed(&across, places.w, &self.rows_at::<N>(&places, 0, i, &along)?);
        Some(plane.chain(&places.chain.only(0), &plane.factors[if O > 2 { i } else { 0 }], found))
    }

    /// Cells and positions of two points. They are arbitrary for points outside.
    #[inline]
    fn both_places(&self, start: &Start, edge: &Edge) -> Places {
        let (plane, [s, s_by]) = (&self.plane, start.s);
        let ([scale, scale_by], [pole, pole_by]) = (edge.scale, edge.pole);
        let below = (s * plane.factor + pole).reciprocal();
        let part = scale * below;
        let u = part * s;
        // `or_less` keeps a NaN only in its last argument: it may come from the start or from u.
        let last = start.within + Pair::both(0.0) * u;
        let within = (Pair::both(1.0 + 4.0 * f64::EPSILON) - u).or_less(u - plane.least_u);
        let within = within.or_less(last);
        let (row, t) = plane.across.at(u);
        let u = u.or_less(Pair::both(1.0));
        let (column, w) = plane.along.at(start.q);
        let chain = Chain {
            u,
            // Outputs that aren't singular multiply the inverse by 0, so it must be finite at u = 0.
            over: u.or_more(Pair::both(f64::MIN_POSITIVE)).reciprocal(),
            own_u: part * (pole * below) * s_by,
            shift: (s * below) * (scale_by - part * pole_by) * (plane.edge_by * start.own_v),
            own_v: start.own_v,
        };
        Places { row, column, t, w, chain, within }
    }

    /// The rows of a pair of outputs around one of two points, contracted with the weights `along`; `None`
    /// outside.
    #[inline]
    fn rows_at<N: Number>(&self, place: &Places, point: usize, i: usize, along: &Weights) -> Option<Rows> {
        if !is_within(place.within.0[point]) {
            return None;
        }
        let i = if O > 2 { i } else { 0 };
        let each = O * N::BYTES;
        let stride = each * self.plane.nodes as usize;
        let start = place.row[point] as usize * stride + place.column[point] as usize * each;
        let patch = self.data.get(start..start + (3 * stride + 4 * each))?;
        let rows = [0, 1, 2, 3].map(|k| patch.get(k * stride..k * stride + 4 * each));
        let (fourth, third, second, first) = (rows[3]?, rows[2]?, rows[1]?, rows[0]?);
        Some([first, second, third, fourth].map(|row| along.ends(&four::<N, O>(row, i))))
    }

    /// [`Lookup::at_each`] for splines with A = 2.
    pub(crate) fn each_in_plane<N: Number>(&self, points: &[[f64; A]], found: &mut [Option<[Sample<A>; O]>]) {
        if points.len().min(found.len()) < FEW {
            for (point, found) in points.iter().zip(found) {
                *found = self.in_plane::<N>(*point);
            }
            return;
        }
        let plane = &self.plane;
        let factors: [Factors; O] = array::from_fn(|o| plane.factors[o / 2].only(o % 2));
        let [scale, pole] = plane.first.0.map(|number| [Pair::both(number), Pair::default()]);
        let mut edges = [Edge { scale, pole }; BLOCK / 2];
        let mut starts = [Start::default(); BLOCK / 2];
        let mut places = [Places::default(); BLOCK / 2];
        let mut inside = [false; BLOCK];
        let mut rows = [Rows::default(); BLOCK];
        let mut splines = [[[Pair::default(); 3]; 2]; BLOCK / 2];
        for (points, found) in points.chunks(BLOCK).zip(found.chunks_mut(BLOCK)) {
            let count = points.len().min(found.len());
            let pairs = count.div_ceil(2);
            for (two, start) in points[..count].chunks(2).zip(&mut starts) {
                self.two_starts(two, start);
            }
            if self.is_fitted {
                for (start, edge) in starts.iter().zip(&mut edges).take(pairs) {
                    self.two_edges(start, edge);
                }
            }
            for ((start, edge), places) in starts.iter().zip(&edges).zip(&mut places).take(pairs) {
                self.two_places(start, edge, places);
            }
            for i in 0..O.div_ceil(2) {
                for (k, rows) in rows.iter_mut().enumerate().take(count) {
                    inside[k] = self.rows_of_two::<N>(&places[k / 2], k % 2, i, rows);
                }
                for ((rows, places), splines) in rows.chunks(2).zip(&places).zip(&mut splines).take(pairs) {
                    two_crossed(places, rows, splines);
                }
                let factors = [2 * i, (2 * i + 1).min(O - 1)].map(|o| factors[o]);
                for (k, two) in found[..count].chunks_mut(2).enumerate() {
                    let done: [[Pair; 3]; 2] =
                        array::from_fn(|o| plane.chain(&places[k].chain, &factors[o], splines[k][o]));
                    for (point, found) in two.iter_mut().enumerate() {
                        if inside[2 * k + point] {
                            give(found, i, &done, point);
                        } else {
                            *found = None;
                        }
                    }
                }
            }
        }
    }

    #[inline(never)]
    fn two_starts(&self, two: &[[f64; A]], to: &mut Start) {
        let [Some(first), Some(last)] = [two.first(), two.last()] else { return };
        let [x, y] = [0, 1].map(|axis| Pair([first[axis], last[axis]]));
        *to = Start::at(&self.plane, self.is_root, x, y);
    }

    #[inline(never)]
    fn two_edges(&self, start: &Start, to: &mut Edge) {
        let (cells, t) = self.plane.edge.at(start.q);
        let edge: &[[u8; 16]] = self.edge.as_chunks().0;
        let knots = |cell: u32| {
            let cell = cell as usize;
            edge.get(cell..cell.saturating_add(4)).and_then(<[_]>::first_chunk::<4>)
        };
        let Some(none) = edge.first_chunk() else { return };
        let [a, b] = [knots(cells[0]).unwrap_or(none), knots(cells[1]).unwrap_or(none)];
        let weights = Weights::at(t);
        let number = |k: &[u8; 16], at: usize| Double::read(&k[8 * at..]);
        let [scale, pole] = [0, 1].map(|at| {
            let ends = weights.ends(&array::from_fn(|k| Pair([number(&a[k], at), number(&b[k], at)])));
            [weights.mean(ends), ends[1] - ends[0]]
        });
        *to = Edge { scale, pole };
    }

    #[inline(never)]
    fn two_places(&self, start: &Start, edge: &Edge, to: &mut Places) {
        *to = self.both_places(start, edge);
    }

    /// The rows around one of two points; false outside.
    #[inline(never)]
    fn rows_of_two<N: Number>(&self, place: &Places, point: usize, i: usize, to: &mut Rows) -> bool {
        let point = point % 2;
        let Some(rows) = self.rows_at::<N>(place, point, i, &Weights::at(Pair::both(place.w.0[point])))
        else {
            return false;
        };
        *to = rows;
        true
    }
}

/// Splines of both outputs at two points. `rows` is a slice to keep the compiler from loading a number
/// together with its neighbour: the two were written separately, so that a joint load would wait until both
/// have reached memory.
#[inline(never)]
fn two_crossed(places: &Places, rows: &[Rows], to: &mut [[Pair; 3]; 2]) {
    let [first, last] = rows else { return };
    let across = Weights::at(places.t);
    for (o, to) in to.iter_mut().enumerate() {
        let both = array::from_fn(|k| array::from_fn(|end| Pair([first[k][end].0[o], last[k][end].0[o]])));
        *to = crossed(&across, places.w, &both);
    }
}

/// Writes outputs `2 i` and `2 i + 1` of a point inside.
#[inline]
fn give<const A: usize, const O: usize>(
    found: &mut Option<[Sample<A>; O]>,
    i: usize,
    done: &[[Pair; 3]; 2],
    point: usize,
) {
    if O <= 2 {
        *found = Some(array::from_fn(|o| sample(&done[o % 2], point)));
        return;
    }
    if i == 0 {
        *found = Some([Sample { value: 0.0, gradient: [0.0; A] }; O]);
    }
    if let Some(all) = found {
        for (to, done) in all[2 * i..].iter_mut().zip(done) {
            *to = sample(done, point);
        }
    }
}

/// Collects all outputs from the pairs.
#[inline]
fn all<const A: usize, const O: usize>(pair: impl Fn(usize) -> Option<[Pair; 3]>) -> Option<[Sample<A>; O]> {
    if O <= 2 {
        let found = pair(0)?;
        return Some(array::from_fn(|o| sample(&found, o)));
    }
    let mut samples = [Sample { value: 0.0, gradient: [0.0; A] }; O];
    for (i, samples) in samples.chunks_mut(2).enumerate() {
        let found = pair(i)?;
        for (o, to) in samples.iter_mut().enumerate() {
            *to = sample(&found, o);
        }
    }
    Some(samples)
}
