//! Tensor products of Chebyshev polynomials for several outputs on the unit cube. They are fitted at Gauss
//! points until the coefficients have decayed, and are then evaluated instead of the solver.

use rayon::prelude::*;
use std::f64::consts::PI;

use super::field::NoValue;

/// Orders of the first try.
const FIRST_ORDERS: usize = 8;
/// Number of coefficients at the end of each axis that must be small.
const LAST: usize = 2;
/// Two tries in a row that don't reduce the tail by this factor have reached the noise of the solver.
const PROGRESS: f64 = 0.5;
/// Most values of a fit.
const MOST_VALUES: usize = 4_000_000;

/// A function from unit coordinates to outputs.
type Function<'a> = &'a (dyn Fn(&[f64], &mut [f64]) -> Result<(), NoValue> + Sync);

/// Polynomials of `outputs` outputs. The outputs vary fastest, then the last axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polynomial {
    pub(crate) orders: Vec<usize>,
    pub(crate) outputs: usize,
    pub(crate) coefficients: Vec<f64>,
    /// Bound of the omitted part along each axis, relative to the largest value.
    pub(crate) tails: Vec<f64>,
}

/// Chebyshev points of the first kind on \[0, 1\], without the ends.
pub(crate) fn gauss_points(count: usize) -> Vec<f64> {
    let n = count as f64;
    (0..count).map(|k| 0.5 - 0.5 * (PI * (k as f64 + 0.5) / n).cos()).collect()
}

/// Matrix from values at `count` Gauss points to the first `orders` coefficients, row by row.
pub(crate) fn cosines(orders: usize, count: usize) -> Vec<f64> {
    let n = count as f64;
    (0..orders)
        .flat_map(|i| {
            (0..count).map(move |k| {
                let factor = if i == 0 { 1.0 } else { 2.0 } / n;
                // The points rise while their angles fall from pi.
                factor * (i as f64 * PI * (1.0 - (k as f64 + 0.5) / n)).cos()
            })
        })
        .collect()
}

/// Multiplies a tensor of the given shape along the axis `axis` by a matrix of `rows` rows. `inner` numbers
/// follow the axes.
pub(crate) fn along(
    tensor: &[f64],
    shape: &[usize],
    axis: usize,
    inner: usize,
    matrix: &[f64],
    rows: usize,
) -> Vec<f64> {
    let (before, length) = (shape[..axis].iter().product::<usize>(), shape[axis]);
    let after = shape[axis + 1..].iter().product::<usize>() * inner;
    let mut product = vec![0.0; before * rows * after];
    for b in 0..before {
        for row in 0..rows {
            let into = &mut product[(b * rows + row) * after..][..after];
            for k in 0..length {
                let weight = matrix[row * length + k];
                let from = &tensor[(b * length + k) * after..][..after];
                for (sum, value) in into.iter_mut().zip(from) {
                    *sum += weight * value;
                }
            }
        }
    }
    product
}

/// Weighted sum over the last axis of a tensor.
fn contracted(tensor: &[f64], outputs: usize, weights: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; tensor.len() / weights.len()];
    for (sums, block) in sums.chunks_exact_mut(outputs).zip(tensor.chunks_exact(outputs * weights.len())) {
        for (values, weight) in block.chunks_exact(outputs).zip(weights) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
    }
    sums
}

/// T_i(2u - 1) and its derivative with respect to u.
pub(crate) fn basis(u: f64, orders: usize) -> [Vec<f64>; 2] {
    let x = 2.0 * u - 1.0;
    let (mut values, mut slopes) = (Vec::with_capacity(orders), Vec::with_capacity(orders));
    let (mut before, mut now) = ([1.0, 0.0], [x, 2.0]);
    for _ in 0..orders {
        values.push(before[0]);
        slopes.push(before[1]);
        let next = [2.0 * x * now[0] - before[0], 2.0 * x * now[1] - before[1] + 4.0 * now[0]];
        (before, now) = (now, next);
    }
    [values, slopes]
}

impl Polynomial {
    /// Fits a function of unit coordinates until the omitted part is below `wanted` of the largest value of
    /// each output, or until a higher order no longer helps. The fit runs in parallel and doesn't depend on
    /// the number of threads.
    pub(crate) fn fitted(
        axes: usize,
        outputs: usize,
        most_orders: usize,
        wanted: f64,
        function: Function<'_>,
    ) -> Result<Self, NoValue> {
        let mut orders = vec![FIRST_ORDERS.min(most_orders); axes];
        let mut stalled = vec![0; axes];
        let mut fit = Self::interpolated(&orders, outputs, function)?;
        loop {
            let mut next = orders.clone();
            for i in 0..axes {
                if fit.tails[i] > wanted && stalled[i] < 2 {
                    next[i] = (orders[i] + (orders[i] / 2).max(2)).min(most_orders);
                }
            }
            if next == orders || next.iter().product::<usize>() * outputs > MOST_VALUES {
                return Ok(fit);
            }
            let finer = Self::interpolated(&next, outputs, function)?;
            for i in 0..axes {
                let grew = next[i] > orders[i];
                stalled[i] = match (grew, finer.tails[i] > PROGRESS * fit.tails[i]) {
                    (true, true) => stalled[i] + 1,
                    (true, false) => 0,
                    (false, _) => stalled[i],
                };
            }
            (fit, orders) = (finer, next);
        }
    }

    fn interpolated(orders: &[usize], outputs: usize, function: Function<'_>) -> Result<Self, NoValue> {
        let points: Vec<Vec<f64>> = orders.iter().map(|n| gauss_points(*n)).collect();
        let count: usize = orders.iter().product();
        let mut tensor = vec![0.0; count * outputs];
        tensor.par_chunks_mut(outputs).enumerate().try_for_each(|(mut index, values)| {
            let mut unit = vec![0.0; orders.len()];
            for i in (0..orders.len()).rev() {
                unit[i] = points[i][index % orders[i]];
                index /= orders[i];
            }
            function(&unit, values)
        })?;
        let mut sizes = vec![0.0_f64; outputs];
        for values in tensor.chunks_exact(outputs) {
            for (size, value) in sizes.iter_mut().zip(values) {
                *size = size.max(value.abs());
            }
        }
        for axis in 0..orders.len() {
            let matrix = cosines(orders[axis], orders[axis]);
            tensor = along(&tensor, orders, axis, outputs, &matrix, orders[axis]);
        }
        let mut fit = Self { orders: orders.to_vec(), outputs, coefficients: tensor, tails: Vec::new() };
        fit.tails = (0..orders.len()).map(|axis| fit.tail(axis, &sizes)).collect();
        Ok(fit)
    }

    /// Sum of the last coefficients along an axis, at the worst place across it. The omitted part is about as
    /// large.
    fn tail(&self, axis: usize, sizes: &[f64]) -> f64 {
        let (length, outputs) = (self.orders[axis], self.outputs);
        let across: usize = self.orders[axis + 1..].iter().product();
        let mut worst = 0.0_f64;
        for (o, size) in sizes.iter().enumerate() {
            let mut sum = 0.0;
            for (place, values) in self.coefficients.chunks_exact(outputs).enumerate() {
                if place / across % length + LAST >= length {
                    sum += values[o].abs();
                }
            }
            worst = worst.max(sum / size.max(f64::MIN_POSITIVE));
        }
        worst
    }

    /// Values of all outputs and their derivatives by the coordinates at a point: `by[i * outputs + o]`.
    pub(crate) fn at(&self, unit: &[f64], values: &mut [f64], by: &mut [f64]) {
        let axes = self.orders.len();
        // Contract the last axis first, with one tensor for the values and one for each derivative so far.
        let mut tensors: Vec<Vec<f64>> = Vec::new();
        for axis in (0..axes).rev() {
            let [value, slope] = basis(unit[axis], self.orders[axis]);
            let first = tensors.first().unwrap_or(&self.coefficients);
            let mut next = Vec::with_capacity(axes + 1);
            next.push(contracted(first, self.outputs, &value));
            next.push(contracted(first, self.outputs, &slope));
            next.extend(tensors.iter().skip(1).map(|tensor| contracted(tensor, self.outputs, &value)));
            tensors = next;
        }
        values.copy_from_slice(&tensors[0]);
        for (into, tensor) in by.chunks_exact_mut(self.outputs).zip(&tensors[1..]) {
            into.copy_from_slice(tensor);
        }
    }

    /// The polynomials truncated to the given orders along each axis.
    pub(crate) fn truncated(&self, orders: &[usize]) -> Self {
        let mut kept = Vec::with_capacity(orders.iter().product::<usize>() * self.outputs);
        for (mut place, values) in self.coefficients.chunks_exact(self.outputs).enumerate() {
            let mut inside = true;
            for (all, kept) in self.orders.iter().zip(orders).rev() {
                inside &= place % all < *kept;
                place /= all;
            }
            if inside {
                kept.extend_from_slice(values);
            }
        }
        Self { orders: orders.to_vec(), outputs: self.outputs, coefficients: kept, tails: self.tails.clone() }
    }

    /// Coefficients of cubic B-splines with `nodes` coefficients along each axis. They interpolate the
    /// polynomials at the ends of all cells, and the slopes at the ends of the axes.
    pub(crate) fn splines(&self, nodes: &[usize]) -> Vec<f64> {
        let mut tensor = self.coefficients.clone();
        let mut shape = self.orders.clone();
        for (axis, count) in nodes.iter().enumerate() {
            let matrix = interpolation(*count, shape[axis]);
            tensor = along(&tensor, &shape, axis, self.outputs, &matrix, *count);
            shape[axis] = *count;
        }
        tensor
    }
}

/// The matrix from Chebyshev coefficients to the coefficients of the interpolating B-spline with `count` >=
/// 4, row by row. For each order:
///
/// ```text
/// (c_{k-1} + 4 c_k + c_{k+1})/6 = T(k - 1),  k = 1 .. n - 2,     (c_2 - c_0)/2 = h T'(0),     (c_{n-1} - c_{n-3})/2 = h T'(1)
/// ```
fn interpolation(count: usize, orders: usize) -> Vec<f64> {
    let cells = (count - 3) as f64;
    let inner = count - 2;
    let nodes: Vec<[Vec<f64>; 2]> = (0..inner).map(|k| basis(k as f64 / cells, orders)).collect();
    let mut matrix = vec![0.0; count * orders];
    // Thomas elimination for rows (1 4 1); by the end conditions the first row is (4 2) and the last (2 4).
    let below = |k: usize| if k == inner - 1 { 2.0 } else { 1.0 };
    let (mut upper, mut pivots) = (vec![0.5; inner], vec![4.0; inner]);
    for k in 1..inner {
        pivots[k] = 4.0 - below(k) * upper[k - 1];
        upper[k] = 1.0 / pivots[k];
    }
    for order in 0..orders {
        let slopes = [nodes[0][1][order] / cells, nodes[inner - 1][1][order] / cells];
        let mut right: Vec<f64> = nodes.iter().map(|node| 6.0 * node[0][order]).collect();
        right[0] += 2.0 * slopes[0];
        right[inner - 1] -= 2.0 * slopes[1];
        right[0] /= pivots[0];
        for k in 1..inner {
            right[k] = (right[k] - below(k) * right[k - 1]) / pivots[k];
        }
        for k in (0..inner - 1).rev() {
            right[k] -= upper[k] * right[k + 1];
        }
        for (k, value) in right.iter().enumerate() {
            matrix[(k + 1) * orders + order] = *value;
        }
        matrix[order] = right[1] - 2.0 * slopes[0];
        matrix[(count - 1) * orders + order] = right[inner - 2] + 2.0 * slopes[1];
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::coordinate::b_splines;
    use super::*;

    #[expect(clippy::unnecessary_wraps, reason = "what is fitted may have no value")]
    fn waves(unit: &[f64], values: &mut [f64]) -> Result<(), NoValue> {
        values[0] = (3.0 * unit[0] + unit[1] * unit[2]).sin();
        values[1] = (unit[0] - 2.0 * unit[1]).exp() + unit[2];
        Ok(())
    }

    #[test]
    fn smooth_functions_are_met_with_their_derivatives() {
        let fit = Polynomial::fitted(3, 2, 40, 1e-13, &waves).unwrap();
        let (mut values, mut by) = ([0.0; 2], [0.0; 6]);
        for unit in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.3, 0.7, 0.1], [0.9, 0.2, 0.6]] {
            fit.at(&unit, &mut values, &mut by);
            let (wave, growth) = (3.0 * unit[0] + unit[1] * unit[2], (unit[0] - 2.0 * unit[1]).exp());
            let exact =
                [3.0 * wave.cos(), growth, unit[2] * wave.cos(), -2.0 * growth, unit[1] * wave.cos(), 1.0];
            assert!((values[0] - wave.sin()).abs() < 1e-12 && (values[1] - growth - unit[2]).abs() < 1e-12);
            for (found, exact) in by.iter().zip(exact) {
                assert!((found - exact).abs() < 1e-10, "{unit:?}: {found} {exact}");
            }
        }
        // A linear axis needs no more orders than its tail is judged by.
        assert!(fit.orders[2] < fit.orders[0] + 5);
    }

    /// Value and derivative of a spline at 0 <= u <= 1 along one axis.
    fn spline(coefficients: &[f64], u: f64) -> [f64; 2] {
        let cells = (coefficients.len() - 3) as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let cell = ((u * cells) as usize).min(coefficients.len() - 4);
        let weights = b_splines(u * cells - cell as f64);
        let moved = b_splines(u * cells - cell as f64 + 1e-6);
        let sum = |w: [f64; 4]| (0..4).map(|k| w[k] * coefficients[cell + k]).sum::<f64>();
        [sum(weights), (sum(moved) - sum(weights)) / 1e-6 * cells]
    }

    #[test]
    fn splines_interpolate_with_end_slopes_and_fourth_order() {
        let function = |u: f64| (4.0 * u).sin() + u;
        let exact = |unit: &[f64], values: &mut [f64]| {
            values[0] = function(unit[0]);
            Ok(())
        };
        let fit = Polynomial::fitted(1, 1, 40, 1e-14, &exact).unwrap();
        for count in [4, 5, 9] {
            let coefficients = fit.splines(&[count]);
            for k in 0..count - 2 {
                let u = k as f64 / (count - 3) as f64;
                assert!((spline(&coefficients, u)[0] - function(u)).abs() < 1e-13);
            }
            assert!((spline(&coefficients, 0.0)[1] - 5.0).abs() < 1e-4);
        }
        let error = |count: usize| {
            let coefficients = fit.splines(&[count]);
            (0..1000)
                .map(|k| f64::from(k) / 999.0)
                .fold(0.0_f64, |worst, u| worst.max((spline(&coefficients, u)[0] - function(u)).abs()))
        };
        let order = (error(43) / error(83)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn a_spline_over_two_axes_is_the_product() {
        let product = |unit: &[f64], values: &mut [f64]| {
            values[0] = unit[0].powi(3) * (1.0 + unit[1]);
            values[1] = unit[1].powi(2) - unit[0];
            Ok(())
        };
        let fit = Polynomial::fitted(2, 2, 12, 1e-14, &product).unwrap();
        let coefficients = fit.splines(&[5, 6]);
        for (u, v) in [(0.2, 0.9), (0.71, 0.33), (1.0, 0.0)] {
            let across = |j: usize, o: usize| {
                let line: Vec<f64> = (0..5).map(|i| coefficients[(i * 6 + j) * 2 + o]).collect();
                spline(&line, u)[0]
            };
            let at = |o: usize| spline(&(0..6).map(|j| across(j, o)).collect::<Vec<_>>(), v)[0];
            // Cubics are reproduced exactly.
            assert!((at(0) - u * u * u * (1.0 + v)).abs() < 1e-12 && (at(1) - v * v + u).abs() < 1e-12);
        }
    }

    #[test]
    fn truncation_keeps_the_first_orders() {
        let fit = Polynomial::fitted(3, 2, 40, 1e-13, &waves).unwrap();
        let short = fit.truncated(&[2, 3, 1]);
        assert_eq!(short.coefficients.len(), 12);
        // Coefficient (1, 2, 0) of output 1.
        let (n, m) = (fit.orders[1], fit.orders[2]);
        assert_eq!(short.coefficients[11].to_bits(), fit.coefficients[((n + 2) * m) * 2 + 1].to_bits());
    }
}
