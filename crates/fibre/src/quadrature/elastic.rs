//! Fibres that stretch. The tension at every radius follows from the first integral, and the difference of
//! the forces from its derivatives at that radius.
//!
//! ```text
//! H(r, T) = H_mid                              gives T(r)
//! N cos(chi) = F + A        G = N - F - A      gives 1 - cos(chi) = G/N
//! G = rho (s + rho g),      s = |k| N at mid-length,      g(rho) = integral from 0 to 1 of (1 - t) G''(t rho) dt,      G'' = dh/dr - A''
//! ```
//!
//! with rho = |r_mid - r|. G'' is known wherever T is ([`Net::local`]). Nothing is a difference of large
//! numbers, not even near a saddle, where s is exp(-50). T and g are smooth functions of rho and are
//! interpolated between Chebyshev's points (see `chebyshev`). Their number is doubled until the last
//! coefficients of both vanish. Where that takes too many points, the meridian is cut into pieces. One piece
//! begins where cloth comes taut: there H and G' are continuous and G'' jumps.

use arrayvec::ArrayVec;
use bulge_numerics::Real;
use std::borrow::Cow;

use super::chebyshev::{GRIDS, Grid, INTERVALS, MOST};
use super::{Ends, Local, Meridian, Point};
use crate::meridian::Middle;
use crate::net::{self, Net};

/// Pieces of a meridian, and points on all of them, at most.
const MOST_PIECES: usize = 6;
const MOST_NODES: usize = 200;
/// Newton steps for a tension from that of a neighbour.
const STEPS: u32 = 20;
/// Relative step of the tension at which the Newton steps end. The next step is rounding.
const SETTLED: f64 = 1e-9;

/// The values at one of Chebyshev's points.
#[derive(Debug, Clone, Copy)]
struct Node<D> {
    strain: D,
    /// g of its piece.
    curve: D,
}

/// A part of the way from mid-length to the fitting on which one law acts and one grid is enough. There
/// G = G_0 + x (G'_0 + x g), with x from the beginning of the piece.
#[derive(Debug, Clone, Copy)]
struct Piece<D> {
    span: Span,
    /// Index of its first node.
    first: usize,
    /// G_0, G'_0.
    rise: D,
    slope: D,
}

/// Where a piece lies, as parts of rho at the fitting.
#[derive(Debug, Clone, Copy)]
struct Span {
    from: f64,
    to: f64,
    /// Whether the cloth is slack there although it is taut at mid-length.
    slack: bool,
    grid: usize,
}

impl Span {
    fn grid(&self) -> &'static Grid {
        &GRIDS[self.grid]
    }

    fn parts(&self) -> impl Iterator<Item = f64> {
        let (from, length) = (self.from, self.to - self.from);
        self.grid().places.iter().map(move |place| from + length * place)
    }
}

/// A meridian of elastic fibres.
pub(super) struct Elastic<'a, D: Real> {
    ends: Ends<D>,
    /// N - A at mid-length.
    force: D,
    /// H.
    energy: D,
    pieces: ArrayVec<Piece<D>, MOST_PIECES>,
    nodes: ArrayVec<Node<D>, MOST_NODES>,
    /// Where the last piece ends: tension, G, G' and G''.
    tension: D,
    rise: D,
    slope: D,
    bend: D,
    /// The net that acts at mid-length.
    net: Cow<'a, Net<D>>,
}

/// The pieces of a meridian and the tensions at their points.
pub(super) struct Tensions {
    spans: ArrayVec<Span, MOST_PIECES>,
    values: ArrayVec<f64, MOST_NODES>,
}

impl Tensions {
    /// Takes as many points as resolve the meridian from a middle. `None` if there is no meridian, or if it
    /// takes too many points. The points are added to `evaluations`.
    pub(super) fn of(net: &Net<f64>, middle: &Middle<f64>, evaluations: &mut u32) -> Option<Self> {
        let mut meridian = Elastic::begun(net, middle);
        let mut found = Self { spans: ArrayVec::new(), values: ArrayVec::new() };
        let kink = meridian.kink().filter(|kink| *kink < 1.0);
        let mut rest: ArrayVec<(f64, f64, bool), MOST_PIECES> = ArrayVec::new();
        rest.extend(kink.map(|kink| (kink, 1.0, true)));
        rest.push((0.0, kink.unwrap_or(1.0), false));
        while let Some((from, to, slack)) = rest.pop() {
            let span = |grid| Span { from, to, slack, grid };
            let mut resolved = false;
            for grid in 0..INTERVALS.len() {
                let values = meridian.tensions(&span(grid), evaluations)?;
                let tried = meridian.beside(&span(grid), &values)?;
                if tried.is_resolved {
                    found.values.try_extend_from_slice(&values).ok()?;
                    found.spans.try_push(span(grid)).ok()?;
                    meridian.add(&tried)?;
                    resolved = true;
                    break;
                }
            }
            if !resolved {
                let middle = 0.5 * (from + to);
                rest.try_push((middle, to, slack)).ok()?;
                rest.try_push((from, middle, slack)).ok()?;
            }
        }
        Some(found)
    }
}

/// The tension at which H has the value `energy`.
pub(crate) fn tension_at(net: &Net<f64>, r: f64, energy: f64, near: f64) -> Option<f64> {
    let mut tension = near;
    for _ in 0..STEPS {
        let slope = slope_of_energy(net, r, tension);
        let step = (net.hamiltonian(r, tension) - energy) / slope;
        tension -= step;
        if !step.is_finite() {
            return None;
        }
        // In fibres that are nearly slack the tension is less than the rounding of the rubber's energy.
        if step.abs() <= SETTLED * tension.abs().max(energy.abs()) {
            return Some(tension - (net.hamiltonian(r, tension) - energy) / slope);
        }
    }
    None
}

/// Whether the tension follows from H without a search.
fn is_inextensible(net: &Net<f64>) -> bool {
    net.compliance == 0.0
}

/// dH/dT = sigma dN/dT.
pub(crate) fn slope_of_energy(net: &Net<f64>, r: f64, tension: f64) -> f64 {
    let local = net.local(r, tension);
    local.sigma * local.force_t
}

/// A piece with its nodes, and where it ends.
struct Tried<D> {
    piece: Piece<D>,
    nodes: ArrayVec<Node<D>, MOST>,
    tension: D,
    rise: D,
    slope: D,
    bend: D,
    is_resolved: bool,
}

impl<'a, D: Real> Elastic<'a, D> {
    pub(super) fn of(net: &'a Net<D>, middle: &Middle<D>, tensions: &Tensions) -> Option<Self> {
        let mut meridian = Self::begun(net, middle);
        let mut values = tensions.values.as_slice();
        for span in &tensions.spans {
            let (here, rest) = values.split_at_checked(span.grid().places.len())?;
            let piece = meridian.beside(span, here)?;
            meridian.add(&piece)?;
            values = rest;
        }
        Some(meridian)
    }

    /// At mid-length.
    fn begun(net: &'a Net<D>, middle: &Middle<D>) -> Self {
        let ends = Ends::of(net, middle);
        let net = net.acting_at(ends.r_m.value());
        let zero = D::from(0.0);
        Self {
            force: middle.force - net.area(ends.r_m),
            energy: net.hamiltonian(ends.r_m, middle.tension),
            pieces: ArrayVec::new(),
            nodes: ArrayVec::new(),
            tension: middle.tension,
            rise: zero,
            slope: middle.curvature * middle.force * ends.side,
            bend: zero,
            net,
            ends,
        }
    }

    fn law(&self, span: &Span) -> Cow<'_, Net<D>> {
        if span.slack { self.net.without_cloth() } else { Cow::Borrowed(&self.net) }
    }

    fn radius(&self, part: f64) -> D {
        self.ends.r_m - self.ends.bulge * part
    }

    /// The next piece, on which the fibres have tensions near `values`.
    fn beside(&self, span: &Span, values: &[f64]) -> Option<Tried<D>> {
        let net = self.law(span);
        let (plain, grid) = (net.constant(), span.grid());
        let mut strains: ArrayVec<D, MOST> = ArrayVec::new();
        let mut bends: ArrayVec<D, MOST> = ArrayVec::new();
        let mut tension = self.tension;
        for (part, value) in span.parts().zip(values) {
            let r = self.radius(part);
            let local = if is_inextensible(&plain) {
                let (found, local) = net.local_with_energy(r, self.energy);
                tension = found;
                local
            } else {
                // One Newton step that carries the derivatives.
                let gap = net.hamiltonian(r, D::from(*value)) - self.energy;
                tension = -gap / slope_of_energy(&plain, r.value(), *value) + *value;
                net.local(r, tension)
            };
            strains.push(net.compliance * tension);
            bends.push(local.hoop_r - net.section(r).area_rr);
        }
        let sum = |weights: &[f64]| {
            let terms = weights.iter().zip(&bends);
            terms.fold(D::from(0.0), |sum, (weight, value)| value.scale_add(*weight, sum))
        };
        let (size, bend) = (self.ends.size, *bends.last()?);
        let mut slope = self.slope;
        if let (Some(cloth), Some(last)) = (&self.net.cloth, self.pieces.last())
            && span.slack
            && !last.span.slack
        {
            // The pieces stay where they are while the radius at which G'' jumps moves.
            let moved = self.ends.r_m - cloth.radius - size * span.from;
            slope += (self.bend - *bends.first()?) * moved;
        }
        let nodes: ArrayVec<Node<D>, MOST> = strains
            .iter()
            .zip(&grid.doubly)
            .map(|(strain, row)| Node { strain: *strain, curve: sum(row) })
            .collect();
        let length = size * (span.to - span.from);
        let curve = nodes.last()?.curve;
        let is_resolved = grid.resolves(&nodes.iter().map(|node| node.strain.value() + 1.0), 0.0)
            && grid.resolves(
                &nodes.iter().map(|node| node.curve.value()),
                (self.rise / length.squared()).value(),
            );
        Some(Tried {
            piece: Piece { span: *span, first: self.nodes.len(), rise: self.rise, slope },
            nodes,
            tension,
            rise: self.rise + length * (slope + length * curve),
            slope: slope + length * sum(&grid.singly),
            bend,
            is_resolved,
        })
    }

    fn add(&mut self, tried: &Tried<D>) -> Option<()> {
        self.nodes.try_extend_from_slice(&tried.nodes).ok()?;
        self.pieces.try_push(tried.piece).ok()?;
        (self.tension, self.rise, self.slope, self.bend) =
            (tried.tension, tried.rise, tried.slope, tried.bend);
        Some(())
    }
}

impl Elastic<'_, f64> {
    /// The tensions at the points of the next piece.
    fn tensions(&self, span: &Span, evaluations: &mut u32) -> Option<ArrayVec<f64, MOST>> {
        let net = self.law(span);
        let (mut r, mut tension) = (self.radius(span.from), self.tension);
        let mut values = ArrayVec::new();
        if is_inextensible(&net) {
            // There is no root to look for.
            values.extend(span.parts().map(|_| tension));
            *evaluations += u32::try_from(values.len()).unwrap_or(u32::MAX);
            return Some(values);
        }
        for part in span.parts() {
            let next = self.radius(part);
            let near = tension + net.local(r, tension).tension_r * (next - r);
            tension = tension_at(&net, next, self.energy, near)?;
            r = next;
            values.push(tension);
            *evaluations += 1;
        }
        Some(values)
    }
}

impl<D: Real> Meridian<D> for Elastic<'_, D> {
    fn ends(&self) -> &Ends<D> {
        &self.ends
    }

    fn ratio(&self) -> f64 {
        let first = self.nodes.first().map_or(f64::NAN, |node| node.curve.value());
        let slope = self.pieces.first().map_or(f64::NAN, |piece| piece.slope.value());
        self.ends.size.value() * first / slope
    }

    fn kink(&self) -> Option<f64> {
        let cloth = self.net.cloth?;
        Some(((self.ends.r_m - cloth.radius) / self.ends.size).value())
    }

    fn at(&self, point: &Point) -> Local<D> {
        #[cfg(test)]
        crate::work::count();
        let Ends { r_m, size, q2, .. } = self.ends;
        let zero = D::from(0.0);
        let reaches = |piece: &&Piece<D>| piece.span.to >= point.part && piece.span.slack == point.slack;
        let Some(piece) = self.pieces.iter().find(reaches).or(self.pieces.last()) else {
            // Without pieces there is no meridian.
            let none = D::from(f64::NAN);
            return Local { y: none, r: none, sigma: none, strain: none, g: none, whole: none, turned: none };
        };
        let Span { from, to, .. } = piece.span;
        let shares = piece.span.grid().shares((point.part - from) / (to - from));
        let nodes = self.nodes.iter().skip(piece.first).zip(&shares);
        let [strain, curve] = nodes.fold([zero; 2], |[strain, curve], (node, share)| {
            [node.strain.scale_add(*share, strain), node.curve.scale_add(*share, curve)]
        });
        let r = self.radius(point.part);
        let y = r * r;
        let sigma = ((strain + 1.0).squared() - q2 * y).sqrt();
        let (rho, x) = (size * point.part, size * (point.part - from));
        let mut g = piece.slope + x * curve;
        if from > 0.0 {
            g = (piece.rise + x * g) / rho;
        }
        let rise = g * rho;
        let force = self.force + self.net.area(r) + rise;
        Local { y, r, sigma, strain, g: sigma * g / (r + r_m), whole: sigma * force, turned: rise / force }
    }

    fn at_fitting(&self, net: &Net<D>, end: &Local<D>) -> (D, net::Local<D>) {
        (self.tension, net.local(end.r, self.tension))
    }
}
