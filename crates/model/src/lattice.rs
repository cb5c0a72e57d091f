//! A lattice of solved equilibria, between which many rows are interpolated.
//!
//! Shooting takes some 10 to 500 us, and a file may have 10^6 rows. Equilibria are therefore solved on a
//! fixed lattice in ln(p) and in a stretched contraction s, only where rows need them. Rows are interpolated
//! by local Lagrange polynomials of degree 5 in both directions. If the rows lie at a few levels of pressure,
//! a finer lattice may need fewer nodes; along the pressure it is interpolated with degree 2 between the
//! three nearest lines:
//!
//! ```text
//! s = asinh(eps/0.02)    (ln(eps) where the force is infinite at eps = 0)
//! F/p, N/p, r, V  and their derivatives by the shape parameters  =  sum of w_i(ln p) w_j(s) X_ij
//! ```
//!
//! The lattice doesn't move with the parameters, and interpolation is linear in the solved values. The
//! derivatives by the shape parameters are therefore exactly those of the interpolated force. The derivatives
//! by pressure and contraction come from the same polynomials. The error is below 1e-6 of the force, except
//! near the kink where cloth comes taut. In the last two cells before equilibria end the stencils are
//! shifted, and the error is below 1e-4 of full scale (tests). Rows further on are solved directly.

use bulge_fibre::{FibreError, Start};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::answer::{Answer, Graded, SHAPE};
use crate::base::Equilibrium;
use crate::solved::Starts;

/// Nodes of a stencil along the contraction, and along the pressure on a lattice that isn't made for levels.
const WIDTH: usize = 6;
/// Nodes of a stencil along the pressure on a lattice for levels of pressure.
const LEVEL_WIDTH: usize = 3;
/// The smallest number of nodes of a lattice. For fewer rows none pays off.
pub(crate) const FEWEST_NODES: usize = WIDTH * WIDTH;
/// Steps of ln(p) and s at refinement 1.
const STEP: [f64; 2] = [0.15, 0.115];
/// A lattice for levels of pressure divides one of these steps of ln(p) into this many.
const LEVEL_STEPS: i64 = 5;
/// The contraction at which the lattice turns from even to logarithmic spacing.
const BEND: f64 = 0.02;
/// Shifts of a stencil, in nodes, that keep the row inside it, and the largest total shift in both
/// directions. A row that needs more is solved directly.
const INWARDS: [i64; 5] = [0, -1, 1, -2, 2];
const MOST_INWARDS: i64 = 3;
/// Outputs of a node: force, tension, radius, volume.
const OUTPUTS: usize = 4;

/// The contraction at which the search for the nodes of one pressure begins. Every muscle pulls there.
const PULLS: f64 = 0.02;

/// The outputs of an equilibrium, followed by their derivatives by each shape parameter.
type Node = Vec<[f64; OUTPUTS]>;
/// Column of a node, its numbers, and the end of its search.
type Solved = (usize, Node, Option<Start>);

/// Number of nodes that are solved beyond the zero of the force, so that rows up to the zero have complete
/// stencils. Equilibria end soon after, and finding the end takes long. A row there is solved directly.
const BEYOND: usize = 3;

/// The nodes of one pressure.
struct Line {
    solved: Vec<Solved>,
    /// The column at which equilibria end towards larger contractions, and the reason.
    end: Option<(usize, FibreError)>,
}

/// Solved equilibria at the requested nodes.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    singular: bool,
    scale_free: bool,
    shapes: usize,
    steps: [f64; 2],
    /// Nodes of a stencil along the pressure.
    width: usize,
    /// Lowest index and number of nodes, for each direction.
    low: [i64; 2],
    count: [usize; 2],
    /// Whether a row needs a node.
    needed: Vec<bool>,
    /// Whether a node has an equilibrium.
    is_solved: Vec<bool>,
    /// The nodes one after the other, with `1 + shapes` entries each.
    nodes: Vec<[f64; OUTPUTS]>,
    /// For each pressure, the first column without an equilibrium towards larger contractions, and the
    /// reason.
    ends: Vec<Option<(usize, FibreError)>>,
}

/// Position of a row in the lattice: the first node of the stencil, and the distance from it in steps.
#[derive(Debug, Clone, Copy)]
struct Place {
    first: i64,
    offset: f64,
}

/// First and last node that a row needs along the pressure and along the contraction.
pub(crate) type Span = [[i64; 2]; 2];

impl Lattice {
    /// An empty lattice: for rows at levels of pressure, or with the usual steps in ln(p).
    pub(crate) fn unsolved(equilibrium: &Equilibrium, shapes: usize, refinement: f64, levels: bool) -> Self {
        let scale_free = equilibrium.is_scale_free();
        let [by_pressure, by_contraction] = STEP.map(|step| step / refinement);
        Self {
            singular: equilibrium.is_singular(),
            scale_free,
            shapes,
            steps: [if levels { by_pressure / LEVEL_STEPS as f64 } else { by_pressure }, by_contraction],
            width: if scale_free {
                1
            } else if levels {
                LEVEL_WIDTH
            } else {
                WIDTH
            },
            low: [0, 0],
            count: [0, 0],
            needed: Vec::new(),
            is_solved: Vec::new(),
            nodes: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Marks the nodes that rows need, without solving them. If a zero error moves a row into the next cell
    /// while the lattice is held, the row is interpolated with a shifted stencil.
    pub(crate) fn around(mut self, spans: &[Span]) -> Self {
        let Some(first) = spans.first() else { return self };
        let mut extent = *first;
        for span in spans {
            for axis in 0..2 {
                extent[axis] = [extent[axis][0].min(span[axis][0]), extent[axis][1].max(span[axis][1])];
            }
        }
        self.low = [extent[0][0], extent[1][0]];
        self.count = [0, 1].map(|axis| usize::try_from(extent[axis][1] - extent[axis][0] + 1).unwrap_or(0));
        let mut needed = vec![false; self.count[0] * self.count[1]];
        for span in spans {
            for i in span[0][0]..=span[0][1] {
                for j in span[1][0]..=span[1][1] {
                    if let Some(place) = self.index(i, j) {
                        needed[place] = true;
                    }
                }
            }
        }
        self.needed = needed;
        self
    }

    /// Whether the lattice is made for rows at levels of pressure.
    pub(crate) fn is_of_levels(&self) -> bool {
        self.width == LEVEL_WIDTH
    }

    /// Number of nodes to solve.
    pub(crate) fn needed(&self) -> usize {
        self.needed.iter().filter(|needed| **needed).count()
    }

    /// Whether both lattices need the same nodes with the same number of derivatives.
    pub(crate) fn has_nodes_of(&self, other: &Self) -> bool {
        let kind = |lattice: &Self| (lattice.singular, lattice.scale_free, lattice.shapes);
        let steps = |lattice: &Self| lattice.steps.map(f64::to_bits);
        kind(self) == kind(other)
            && steps(self) == steps(other)
            && (self.low, self.count) == (other.low, other.count)
            && self.needed == other.needed
    }

    /// Solves the nodes, the pressures in parallel. Also returns the ends of the searches. A search starts at
    /// the entry of `starts` for its node, or else at the neighbouring node.
    pub(crate) fn solved(mut self, equilibrium: &Equilibrium, starts: &Starts) -> (Self, Starts) {
        let lines: Vec<Line> =
            (0..self.count[0]).into_par_iter().map(|row| self.line(equilibrium, row, starts)).collect();
        let columns = self.count[1];
        let stride = 1 + self.shapes;
        self.is_solved = vec![false; self.needed.len()];
        self.nodes = vec![[0.0; OUTPUTS]; stride * self.needed.len()];
        let mut ends = HashMap::new();
        for (row, line) in lines.into_iter().enumerate() {
            self.ends.push(line.end);
            for (column, node, start) in line.solved {
                if let Some(start) = start {
                    ends.insert(self.key(row, column), start);
                }
                let place = row * columns + column;
                self.is_solved[place] = true;
                self.nodes[place * stride..][..stride].copy_from_slice(&node);
            }
        }
        (self, Arc::new(ends))
    }

    /// The lattice of a shape whose parameters differ by `moved`, to first order.
    pub(crate) fn moved(&self, moved: &[f64]) -> Self {
        let mut lattice = self.clone();
        for node in lattice.nodes.chunks_exact_mut(1 + self.shapes) {
            let Some((outputs, slopes)) = node.split_first_mut() else { continue };
            for (slope, moved) in slopes.iter().zip(moved) {
                for (output, slope) in outputs.iter_mut().zip(slope) {
                    *output += slope * moved;
                }
            }
        }
        lattice
    }

    /// Solves the nodes of one pressure, outwards from the contraction at which every muscle pulls. A
    /// direction stops at the end of equilibria, so that no search beyond it is wasted.
    fn line(&self, equilibrium: &Equilibrium, row: usize, starts: &Starts) -> Line {
        let columns = self.count[1];
        let needed: Vec<usize> = (0..columns).filter(|column| self.needed[row * columns + column]).collect();
        let middle = needed.partition_point(|column| self.contraction(*column) < PULLS);
        let (below, above) = needed.split_at(middle);
        let mut found = Line { solved: Vec::with_capacity(needed.len()), end: None };
        let mut first = None;
        // Upwards first: the first equilibrium found also starts the way down.
        let ways: [(bool, &mut dyn Iterator<Item = &usize>); 2] =
            [(true, &mut above.iter()), (false, &mut below.iter().rev())];
        for (is_upwards, way) in ways {
            let mut near: Option<Start> = first.clone();
            let (mut any, mut pushing) = (false, 0);
            for &column in way {
                let from = starts.get(&self.key(row, column)).or(near.as_ref());
                match self.solve(equilibrium, row, column, from) {
                    Ok((node, start)) => {
                        (any, near) = (true, start.clone());
                        first = first.or_else(|| start.clone());
                        pushing = if node[0][0] < 0.0 { pushing + 1 } else { 0 };
                        found.solved.push((column, node, start));
                        if is_upwards && pushing == BEYOND {
                            break;
                        }
                    }
                    Err(error) if is_upwards => {
                        found.end = Some((column, error));
                        break;
                    }
                    Err(_) if any => break,
                    Err(_) => {}
                }
            }
        }
        found
    }

    /// The reason why there is no equilibrium at a contraction, or none if there may be one. Equilibria must
    /// have ended more than a cell before at both neighbouring pressures.
    fn beyond(&self, pressure: f64, contraction: f64) -> Option<&FibreError> {
        let cell = |axis: usize, x: f64| Some(index_of((x / self.steps[axis]).floor())? - self.low[axis]);
        let column = cell(1, self.contraction_axis(contraction)?)?;
        let line = if self.scale_free { 0 } else { cell(0, self.pressure_axis(pressure)?)? };
        let end = |line: i64| {
            let (end, error) = self.ends.get(usize::try_from(line).ok()?)?.as_ref()?;
            (usize::try_from(column).ok()? > *end).then_some(error)
        };
        let error = end(line)?;
        (self.scale_free || end(line + 1).is_some()).then_some(error)
    }

    /// Index of a node in the steps of the finer lattice.
    fn key(&self, row: usize, column: usize) -> [i64; 2] {
        // Indices are below 1e6 (see `place`).
        let unit = if self.is_of_levels() { 1 } else { LEVEL_STEPS };
        [
            unit * (self.low[0] + i64::try_from(row).unwrap_or(0)),
            self.low[1] + i64::try_from(column).unwrap_or(0),
        ]
    }

    fn contraction(&self, column: usize) -> f64 {
        let s = (self.low[1] as f64 + column as f64) * self.steps[1];
        if self.singular { s.exp() } else { BEND * s.sinh() }
    }

    /// First and last nodes that a row needs at a pressure and in a range of contractions, for each
    /// direction. None outside the range of a lattice.
    pub(crate) fn span(&self, pressure: f64, [low, high]: [f64; 2]) -> Option<Span> {
        let p = self.place(0, self.pressure_axis(pressure)?)?;
        let at = |contraction| self.place(1, self.contraction_axis(contraction)?);
        let a = at(low)?;
        let b = if high > low { at(high)? } else { a };
        let [pressures, contractions] = [0, 1].map(|axis| self.last(axis));
        let p = if self.scale_free { 0 } else { p.first };
        Some([[p, p + pressures], [a.first.min(b.first), b.first.max(a.first) + contractions]])
    }

    fn pressure_axis(&self, pressure: f64) -> Option<f64> {
        (pressure > 0.0 && pressure.is_finite()).then(|| if self.scale_free { 0.0 } else { pressure.ln() })
    }

    fn contraction_axis(&self, contraction: f64) -> Option<f64> {
        if self.singular {
            return (contraction > 0.0).then(|| contraction.ln());
        }
        // asinh(x) to within 1e-15: a place needs no relative accuracy.
        let x = (contraction / BEND).abs();
        contraction.is_finite().then(|| (x + (x * x + 1.0).sqrt()).ln().copysign(contraction))
    }

    /// Distance from the first to the last node of a stencil.
    fn last(&self, axis: usize) -> i64 {
        let width = if axis == 0 { self.width } else { WIDTH };
        i64::try_from(width).unwrap_or(1) - 1
    }

    /// The stencil whose middle is nearest to a coordinate.
    fn place(&self, axis: usize, x: f64) -> Option<Place> {
        let steps = x / self.steps[axis];
        let first = index_of((steps - 0.5 * (self.last(axis) - 1) as f64).floor())?;
        Some(Place { first, offset: steps - first as f64 })
    }

    fn index(&self, i: i64, j: i64) -> Option<usize> {
        let row = usize::try_from(i - self.low[0]).ok().filter(|row| *row < self.count[0])?;
        let column = usize::try_from(j - self.low[1]).ok().filter(|column| *column < self.count[1])?;
        Some(row * self.count[1] + column)
    }

    fn solve(
        &self,
        equilibrium: &Equilibrium,
        row: usize,
        column: usize,
        from: Option<&Start>,
    ) -> Result<(Node, Option<Start>), FibreError> {
        let logarithm = (self.low[0] as f64 + row as f64) * self.steps[0];
        let pressure = if self.scale_free { 1e5 } else { logarithm.exp() };
        let (answer, start) = equilibrium.answer(pressure, self.contraction(column), from)?;
        let outputs = [
            (&answer.force, pressure),
            (&answer.tension, pressure),
            (&answer.mid_radius, 1.0),
            (&answer.volume, 1.0),
        ];
        let values = outputs.map(|(output, unit)| output.value / unit);
        let slopes = (0..self.shapes).map(|j| outputs.map(|(output, unit)| output.by_shape[j] / unit));
        Ok((std::iter::once(values).chain(slopes).collect(), start))
    }

    /// The stencil around a pressure and a contraction, shifted inwards where equilibria end. Rows in the
    /// last cells then still lie between solved nodes. The first solved stencil in the order of [`INWARDS`]
    /// is taken, with shifts along the contraction tried first. None if there is none.
    fn within(&self, around: [Place; 2]) -> Option<[Place; 2]> {
        let moved = |place: Place, shift: i64| Place {
            first: place.first + shift,
            offset: place.offset - shift as f64,
        };
        let is_solved = |[pressure, contraction]: &[Place; 2]| {
            (pressure.first..).zip(0..self.width).all(|(row, _)| {
                let start = self
                    .index(row, contraction.first)
                    .filter(|_| self.index(row, contraction.first + self.last(1)).is_some());
                let nodes = start.and_then(|start| self.is_solved.get(start..start + WIDTH));
                nodes.is_some_and(|nodes| nodes.iter().all(|solved| *solved))
            })
        };
        let pressures = if self.scale_free { &INWARDS[..1] } else { &INWARDS };
        pressures
            .iter()
            .flat_map(|p| INWARDS.iter().map(move |e| [*p, *e]))
            .filter(|[p, e]| p.abs() + e.abs() <= MOST_INWARDS)
            .map(|[p, e]| [moved(around[0], p), moved(around[1], e)])
            .find(is_solved)
    }

    /// The interpolated answer, or none if nodes are missing.
    pub(crate) fn answer(&self, pressure: f64, contraction: f64) -> Option<Answer> {
        let x = self.pressure_axis(pressure)?;
        let s = self.contraction_axis(contraction)?;
        let mut around = [self.place(0, x)?, self.place(1, s)?];
        if self.scale_free {
            around[0].first = 0;
        }
        let [along_p, along_s] = self.within(around)?;
        let (wp, dp) = match self.width {
            1 => flat(),
            LEVEL_WIDTH => parabola(along_p.offset),
            _ => weights(along_p.offset),
        };
        let (first, rows) = (along_p.first, self.width);
        let (ws, ds) = weights(along_s.offset);
        // Values with their derivatives by the shape, and the slopes of the values per step.
        let mut starts = [0; WIDTH];
        for (start, row) in starts.iter_mut().zip(first..).take(rows) {
            *start = self.index(row, along_s.first)?;
        }
        let stride = 1 + self.shapes;
        // Each entry is summed separately, so that its sums stay in registers.
        let summed = |entry: usize, along_p: &[f64; WIDTH], along_s: &[f64; WIDTH]| {
            let mut sum = [0.0; OUTPUTS];
            for (start, along_p) in starts.iter().zip(along_p).take(rows) {
                let nodes = &self.nodes[start * stride..(start + WIDTH) * stride];
                for (node, along_s) in nodes.chunks_exact(stride).zip(along_s) {
                    let weight = along_p * along_s;
                    for (sum, value) in sum.iter_mut().zip(&node[entry]) {
                        *sum += weight * value;
                    }
                }
            }
            sum
        };
        let slopes = [summed(0, &dp, &ws), summed(0, &wp, &ds)];
        let mut sums = [[0.0; OUTPUTS]; 1 + SHAPE];
        for (entry, sum) in sums.iter_mut().enumerate().take(stride) {
            *sum = summed(entry, &wp, &ws);
        }
        let s_by_contraction = if self.singular {
            1.0 / contraction
        } else {
            1.0 / (contraction * contraction + BEND * BEND).sqrt()
        };
        let output = |k: usize| {
            let per_p = slopes[0][k] / self.steps[0];
            let by_contraction = slopes[1][k] / self.steps[1] * s_by_contraction;
            let is_force = k < 2;
            let unit = if is_force { pressure } else { 1.0 };
            let mut by_shape = [0.0; SHAPE];
            for (j, slope) in by_shape.iter_mut().enumerate().take(self.shapes) {
                *slope = unit * sums[1 + j][k];
            }
            Graded {
                value: unit * sums[0][k],
                // F = p X(ln p): X + X'.
                by_pressure: if is_force { sums[0][k] + per_p } else { per_p / pressure },
                by_contraction: unit * by_contraction,
                by_shape,
            }
        };
        Some(Answer { force: output(0), tension: output(1), mid_radius: output(2), volume: output(3) })
    }
}

/// Interpolates if the lattice covers the point. Otherwise solves directly and counts the search in `alone`,
/// unless equilibria are known to end before this point, where a search would fail.
pub(crate) fn answer(
    lattice: Option<&Lattice>,
    equilibrium: &Equilibrium,
    [pressure, contraction]: [f64; 2],
    slot: &mut Option<Start>,
    alone: &AtomicUsize,
) -> Result<Answer, FibreError> {
    if let Some(answer) = lattice.and_then(|lattice| lattice.answer(pressure, contraction)) {
        return Ok(answer);
    }
    if let Some(error) = lattice.and_then(|lattice| lattice.beyond(pressure, contraction)) {
        return Err(error.clone());
    }
    alone.fetch_add(1, Ordering::Relaxed);
    let (answer, start) = equilibrium.answer(pressure, contraction, slot.as_ref())?;
    if start.is_some() {
        *slot = start;
    }
    Ok(answer)
}

/// Weights of a single node, with zero slope.
fn flat() -> ([f64; WIDTH], [f64; WIDTH]) {
    let mut one = [0.0; WIDTH];
    one[0] = 1.0;
    (one, [0.0; WIDTH])
}

/// A whole number below 1e6 as an index.
fn index_of(whole: f64) -> Option<i64> {
    #[expect(clippy::cast_possible_truncation, reason = "below 1e6")]
    let index = whole as i64;
    (whole.abs() < 1e6).then_some(index)
}

/// Lagrange weights of the nodes 0 to 2 at `t`, and their slopes.
fn parabola(t: f64) -> ([f64; WIDTH], [f64; WIDTH]) {
    let (mut w, mut d) = ([0.0; WIDTH], [0.0; WIDTH]);
    w[..LEVEL_WIDTH].copy_from_slice(&[0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0)]);
    d[..LEVEL_WIDTH].copy_from_slice(&[t - 1.5, 2.0 - 2.0 * t, t - 0.5]);
    (w, d)
}

/// Lagrange weights of the nodes 0 to 5 at `t`, and their slopes.
fn weights(t: f64) -> ([f64; WIDTH], [f64; WIDTH]) {
    // (-1)^(5 - k) k! (5 - k)!
    const BELOW: [f64; WIDTH] = [-120.0, 24.0, -12.0, 12.0, -24.0, 120.0];
    let mut w = [0.0; WIDTH];
    let mut d = [0.0; WIDTH];
    for k in 0..WIDTH {
        let (mut product, mut slope) = (1.0, 0.0);
        for i in (0..WIDTH).filter(|i| *i != k) {
            let factor = t - i as f64;
            slope = slope * factor + product;
            product *= factor;
        }
        w[k] = product / BELOW[k];
        d[k] = slope / BELOW[k];
    }
    (w, d)
}

#[cfg(test)]
pub(crate) mod tests;
