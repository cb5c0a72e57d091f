//! Fibres that stretch: the tension at every radius follows from the first integral, and the difference of the forces from its derivatives there.
//!
//! ```text
//! H(r, T) = H_mid                              gives T(r)
//! N cos(chi) = F + A        G = N - F - A      gives 1 - cos(chi) = G/N
//! G = rho (s + rho g),      s = |k| N at mid-length,      g(rho) = integral from 0 to 1 of (1 - t) G''(t rho) dt,      G'' = dh/dr - A''
//! ```
//!
//! with rho = |r_mid - r|. G'' is known wherever T is ([`Net::local`]), and nothing is a difference of large numbers: near a saddle, where s is exp(-50), as elsewhere.
//! T and g are smooth functions of rho, interpolated between Chebyshev's points (L. N. Trefethen, *Approximation Theory and Approximation Practice*, SIAM 2013,
//! chapters 2 to 8): twice as many, until the last coefficients of both vanish.

use arrayvec::ArrayVec;
use bulge_numerics::{Real, gauss};
use std::f64::consts::PI;
use std::sync::LazyLock;

use super::{Ends, Local, Meridian, Point};
use crate::meridian::Middle;
use crate::net::Net;

/// Intervals between Chebyshev's points: the first that is enough.
const INTERVALS: [usize; 4] = [8, 16, 32, 64];
/// Points for the most intervals.
const MOST: usize = 65;
/// Size of the last two Chebyshev coefficients, relative to the function, from which on it counts as resolved: the integrals then err by about the square root of the ratio of
/// two coefficients less.
const RESOLVED: f64 = 3e-12;
/// Newton steps for a tension from that of a neighbour.
const STEPS: u32 = 20;
/// Step of the tension, relative, at which they end: the next one is rounding.
const SETTLED: f64 = 1e-9;

/// Chebyshev's points between 0 (mid-length) and 1 (fitting), with what interpolates and integrates between them.
struct Grid {
    places: Vec<f64>,
    /// Barycentric weights.
    weights: Vec<f64>,
    /// Row i: weights of the values in the integral of (1 - t) f(t x_i) over t from 0 to 1.
    doubly: Vec<Vec<f64>>,
    /// Weights of the values in the last two Chebyshev coefficients.
    last: [Vec<f64>; 2],
}

impl Grid {
    fn new(intervals: usize) -> Self {
        let angle = |i: usize| PI * i as f64 / intervals as f64;
        let half = |i: usize| if i == 0 || i == intervals { 0.5 } else { 1.0 };
        let weight = |i: usize| if i.is_multiple_of(2) { half(i) } else { -half(i) };
        let of_all = |f: &dyn Fn(usize) -> f64| (0..=intervals).map(f).collect::<Vec<_>>();
        let mut grid = Self {
            places: of_all(&|i| (0.5 * angle(i)).sin().powi(2)),
            weights: of_all(&weight),
            doubly: Vec::new(),
            last: [
                of_all(&|i| weight(i) / intervals as f64),
                of_all(&|i| 2.0 * weight(i) * angle(i).cos() / intervals as f64),
            ],
        };
        grid.doubly = grid.places.iter().map(|x| grid.integrated(*x)).collect();
        grid
    }

    /// Weights of the values in the integral of (1 - t) f(t x) over t from 0 to 1.
    fn integrated(&self, x: f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.places.len()];
        // Pieces on which the rule of six points is exact for polynomials of this degree, up to rounding.
        let pieces = self.places.len().div_ceil(4);
        for piece in 0..pieces {
            for (node, weight) in gauss::SIX {
                let t = (piece as f64 + node) / pieces as f64;
                let factor = weight / pieces as f64 * (1.0 - t);
                for (sum, share) in weights.iter_mut().zip(self.shares(t * x)) {
                    *sum += factor * share;
                }
            }
        }
        weights
    }

    /// The weights of the values in the interpolated one at `x`: the barycentric formula.
    fn shares(&self, x: f64) -> ArrayVec<f64, MOST> {
        let pairs = self.places.iter().zip(&self.weights);
        let mut shares: ArrayVec<f64, MOST> = pairs.map(|(place, weight)| weight / (x - place)).collect();
        let sum: f64 = shares.iter().sum();
        if sum.is_finite() {
            let per_sum = 1.0 / sum;
            shares.iter_mut().for_each(|share| *share *= per_sum);
        } else {
            // One of the points.
            shares.iter_mut().for_each(|share| *share = f64::from(u8::from(share.is_infinite())));
        }
        shares
    }

    /// Whether values at the points are those of a function that they resolve.
    fn resolves(&self, values: &(impl Iterator<Item = f64> + Clone)) -> bool {
        let sum = |weights: &[f64]| weights.iter().zip(values.clone()).map(|(w, v)| w * v).sum::<f64>().abs();
        let largest = values.clone().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        sum(&self.last[0]) + sum(&self.last[1]) <= RESOLVED * largest
    }
}

static GRIDS: LazyLock<[Grid; INTERVALS.len()]> = LazyLock::new(|| INTERVALS.map(Grid::new));

/// What is known at one of Chebyshev's points.
#[derive(Debug, Clone, Copy)]
struct Node<D> {
    strain: D,
    /// g.
    curve: D,
}

/// A meridian of elastic fibres.
pub(super) struct Elastic<D> {
    ends: Ends<D>,
    /// N - A at mid-length.
    force: D,
    /// s.
    slope: D,
    grid: &'static Grid,
    nodes: ArrayVec<Node<D>, MOST>,
    /// Tension at the fitting.
    tension: D,
    net: Net<D>,
}

/// The tensions at Chebyshev's points, and how many there are.
pub(super) struct Tensions {
    grid: usize,
    values: ArrayVec<f64, MOST>,
}

impl Tensions {
    /// As many as resolve the meridian from a middle; none where there is none, or where that takes too many. They are added to `evaluations`.
    pub(super) fn of(net: &Net<f64>, middle: &Middle<f64>, evaluations: &mut u32) -> Option<Self> {
        let r_m = net.end_radius + middle.bulge;
        let energy = net.hamiltonian(r_m, middle.tension);
        (0..INTERVALS.len()).find_map(|grid| {
            let mut values = ArrayVec::new();
            let (mut r, mut tension) = (r_m, middle.tension);
            for place in &GRIDS[grid].places {
                let next = r_m - middle.bulge * place;
                let near = tension + net.local(r, tension).tension_r * (next - r);
                tension = tension_at(net, next, energy, near)?;
                r = next;
                values.push(tension);
                *evaluations += 1;
            }
            let tensions = Self { grid, values };
            Elastic::of(net, middle, &tensions).is_resolved().then_some(tensions)
        })
    }
}

/// The tension at which H has a value.
fn tension_at(net: &Net<f64>, r: f64, energy: f64, near: f64) -> Option<f64> {
    let mut tension = near;
    for _ in 0..STEPS {
        let slope = slope_of_energy(net, r, tension);
        let step = (net.hamiltonian(r, tension) - energy) / slope;
        tension -= step;
        if !step.is_finite() {
            return None;
        }
        if step.abs() <= SETTLED * tension.abs() {
            return Some(tension - (net.hamiltonian(r, tension) - energy) / slope);
        }
    }
    None
}

/// dH/dT = sigma dN/dT.
fn slope_of_energy(net: &Net<f64>, r: f64, tension: f64) -> f64 {
    let local = net.local(r, tension);
    local.sigma * local.force_t
}

impl<D: Real> Elastic<D> {
    pub(super) fn of(net: &Net<D>, middle: &Middle<D>, tensions: &Tensions) -> Self {
        let ends = Ends::of(net, middle);
        let force = net.local(ends.r_m, middle.tension).force;
        let energy = net.hamiltonian(ends.r_m, middle.tension);
        let plain = net.constant();
        let grid = &GRIDS[tensions.grid];
        let mut strains: ArrayVec<D, MOST> = ArrayVec::new();
        let mut second: ArrayVec<D, MOST> = ArrayVec::new();
        let mut last = middle.tension;
        for (place, value) in grid.places.iter().zip(&tensions.values) {
            let r = ends.r_m - middle.bulge * *place;
            // One Newton step that carries the derivatives.
            let gap = net.hamiltonian(r, D::from(*value)) - energy;
            last = -gap / slope_of_energy(&plain, r.value(), *value) + *value;
            strains.push(net.compliance * last);
            second.push(net.local(r, last).hoop_r - net.section(r).area_rr);
        }
        let curve = |weights: &[f64]| {
            let terms = weights.iter().zip(&second);
            terms.fold(D::from(0.0), |sum, (weight, value)| value.scale_add(*weight, sum))
        };
        let nodes =
            strains.iter().zip(&grid.doubly).map(|(strain, row)| Node { strain: *strain, curve: curve(row) });
        Self {
            force: force - net.area(ends.r_m),
            slope: middle.curvature * force * ends.side,
            grid,
            nodes: nodes.collect(),
            tension: last,
            net: *net,
            ends,
        }
    }

    fn is_resolved(&self) -> bool {
        let strains = self.nodes.iter().map(|node| node.strain.value() + 1.0);
        let curves = self.nodes.iter().map(|node| node.curve.value());
        self.grid.resolves(&strains) && self.grid.resolves(&curves)
    }
}

impl<D: Real> Meridian<D> for Elastic<D> {
    fn ends(&self) -> &Ends<D> {
        &self.ends
    }

    fn ratio(&self) -> f64 {
        let first = self.nodes.first().map_or(f64::NAN, |node| node.curve.value());
        self.ends.size.value() * first / self.slope.value()
    }

    fn kink(&self) -> Option<f64> {
        None
    }

    fn at(&self, point: &Point) -> Local<D> {
        let Ends { r_m, bulge, size, q2, .. } = self.ends;
        let r = r_m - bulge * point.part;
        let y = r * r;
        let zero = D::from(0.0);
        let shares = self.grid.shares(point.part);
        let [strain, curve] =
            self.nodes.iter().zip(&shares).fold([zero; 2], |[strain, curve], (node, share)| {
                [node.strain.scale_add(*share, strain), node.curve.scale_add(*share, curve)]
            });
        let sigma = ((strain + 1.0).squared() - q2 * y).sqrt();
        let rho = size * point.part;
        let g = self.slope + rho * curve;
        let rise = g * rho;
        let force = self.force + self.net.area(r) + rise;
        Local { y, r, sigma, strain, g: sigma * g / (r + r_m), whole: sigma * force, turned: rise / force }
    }

    fn end_tension(&self, _: &Net<D>, _: &Local<D>) -> D {
        self.tension
    }
}
