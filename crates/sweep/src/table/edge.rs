//! The fitted upper end (edge) of axis 0: K = 1/q(edge) and the pole c, as cubic B-splines over the other
//! axes.

use rayon::prelude::*;

use super::certificate::golden;
use super::coordinate::{Coordinate, Coordinates, b_splines, point_of};
use super::field::{Field, NoValue};
use super::polynomial::Polynomial;

/// Most orders along an axis of the polynomial between solver and spline.
const MOST_ORDERS: usize = 96;
/// Points at which the spline is compared with the polynomial.
const POINTS: u64 = 4000;
/// Most nodes along an axis.
const MOST_NODES: usize = 4096;
/// Wanted error of the polynomial; the root found by the solver is not more accurate.
const WANTED: f64 = 1e-13;

/// An edge, ready to be stored.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Edge {
    /// Nodes on each axis; 0 on the first.
    pub(crate) nodes: Vec<usize>,
    pub(crate) numbers: Vec<f64>,
    /// Largest relative error of K and c at the points where they were compared.
    pub(crate) error: f64,
    /// Largest upper end at these points.
    pub(crate) high: f64,
    /// K and c as polynomials that follow the solver closely.
    fit: Polynomial,
}

impl Edge {
    /// Fits the edge of a field to a relative error of K below `wanted`, or as well as `most_bytes` allow.
    pub(crate) fn fitted(
        field: &dyn Field,
        coordinates: &Coordinates,
        wanted: f64,
        most_bytes: usize,
    ) -> Result<Self, NoValue> {
        let others = &field.axes()[1..];
        // The axes after the first have ends of their own.
        let alone = Coordinates { axes: coordinates.axes[1..].to_vec(), tilt: Vec::new() };
        let inverse = |unit: &[f64], values: &mut [f64]| {
            let point = point_of(others, &alone, unit, &|_| Err(NoValue(String::new())))?;
            let first = coordinates.first(unit);
            values[0] = 1.0 / first.q(field.upper_end(&point)?);
            values[1] = first.pole;
            if values[0].is_finite() && values[0] > 0.0 {
                Ok(())
            } else {
                Err(NoValue(format!(
                    "at {point:?} axis `{}` has no room above its lower end",
                    field.axes()[0].name
                )))
            }
        };
        let axes = others.len();
        let fit = Polynomial::fitted(axes, 2, MOST_ORDERS, WANTED, &inverse)?;
        let mut nodes = vec![11; axes];
        loop {
            let edge = Self::sampled(fit.clone(), &nodes, coordinates);
            let larger: Vec<usize> = nodes.iter().map(|n| (n - 3) * 3 / 2 + 3).collect();
            let bytes = 16 * larger.iter().product::<usize>();
            if edge.error <= wanted || bytes > most_bytes || larger[0] > MOST_NODES {
                return Ok(edge);
            }
            nodes = larger;
        }
    }

    fn sampled(fit: Polynomial, nodes: &[usize], coordinates: &Coordinates) -> Self {
        let numbers = fit.splines(nodes);
        let exact = |unit: &[f64]| {
            let (mut values, mut by) = ([0.0; 2], vec![0.0; 2 * nodes.len()]);
            fit.at(unit, &mut values, &mut by);
            values
        };
        let at = |k: u64| {
            let unit = golden(k, nodes.len());
            let exact = exact(&unit);
            let off = |which: usize| (spline(&numbers, nodes, &unit, which) / exact[which] - 1.0).abs();
            off(0).max(off(1))
        };
        let error = (0..POINTS).into_par_iter().map(at).reduce(|| 0.0, f64::max);
        // Largest end, at the points and in the corners.
        let corners = (0..1_usize << nodes.len())
            .map(|corner| (0..nodes.len()).map(|i| (corner >> i & 1) as f64).collect::<Vec<f64>>());
        let high = (0..POINTS)
            .map(|k| golden(k, nodes.len()))
            .chain(corners)
            .map(|unit| coordinates.first(&unit).of_q(1.0 / exact(&unit)[0]))
            .fold(f64::NEG_INFINITY, f64::max);
        Self { nodes: std::iter::once(0).chain(nodes.iter().copied()).collect(), numbers, error, high, fit }
    }

    /// The upper end of axis 0 as stored, at unit coordinates of the other axes.
    pub(crate) fn stored(&self, coordinates: &Coordinates, unit: &[f64]) -> f64 {
        let number = |which| spline(&self.numbers, &self.nodes[1..], unit, which);
        let first = Coordinate { pole: number(1), ..coordinates.axes[0] };
        first.of_q(1.0 / number(0))
    }

    /// The upper end of axis 0 at values of the other axes, to the accuracy of the polynomial.
    pub(crate) fn upper_end(&self, coordinates: &Coordinates, highs: &[f64], others: &[f64]) -> f64 {
        let unit = coordinates.units(highs, others);
        let (mut values, mut by) = ([0.0; 2], vec![0.0; 2 * unit.len()]);
        self.fit.at(&unit, &mut values, &mut by);
        coordinates.first(&unit).of_q(1.0 / values[0])
    }
}

/// One of the two numbers of a B-spline at unit coordinates, by the formula of the reader, axis by axis.
fn spline(numbers: &[f64], nodes: &[usize], unit: &[f64], number: usize) -> f64 {
    let mut places = Vec::with_capacity(nodes.len());
    for (u, n) in unit.iter().zip(nodes) {
        let along = u * (n - 3) as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and the nodes")]
        let cell = (along as usize).min(n - 4);
        places.push((cell, b_splines(along - cell as f64)));
    }
    let mut sum = 0.0;
    for choice in 0..4_usize.pow(u32::try_from(nodes.len()).unwrap_or(0)) {
        let (mut node, mut weight) = (0, 1.0);
        for (i, (cell, basis)) in places.iter().enumerate() {
            let which = choice >> (2 * i) & 3;
            node = node * nodes[i] + cell + which;
            weight *= basis[which];
        }
        sum += weight * numbers[2 * node + number];
    }
    sum
}
