//! Least-squares polynomials. The Chebyshev polynomials of the range are made orthogonal on the points; the
//! result is converted to powers.

use bulge_numerics::vector::{add, dot, norm};

/// A polynomial and the conditioning of its fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitted<const N: usize> {
    /// Coefficients of the powers N - 1 to 0.
    pub(super) coefficients: [f64; N],
    /// Bound of the condition number of the solved problem, ||R|| ||R^-1|| (Frobenius).
    pub(super) condition: f64,
}

impl<const N: usize> Fitted<N> {
    /// Largest sum of |terms| divided by the largest |sum| in a range: the cancellation in the power basis.
    pub(super) fn cancellation(&self, [from, to]: [f64; 2]) -> f64 {
        let terms = self.coefficients.map(f64::abs);
        let largest = (0..=200)
            .map(|i| value(&self.coefficients, from + (to - from) * f64::from(i) / 200.0).abs())
            .fold(0.0, f64::max);
        value(&terms, from.abs().max(to.abs())) / largest
    }
}

/// Value of a polynomial; the highest power comes first.
pub(super) fn value(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// Least-squares fit through points \[x, y\] of a range. In powers of x in % the condition number would be
/// some 1e8; in T_i(t), with t from -1 to 1, it is below 20.
pub(super) fn fit<const N: usize>(points: &[[f64; 2]], [from, to]: [f64; 2]) -> Fitted<N> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    // Columns T_i at the points, orthonormalised with reorthogonalisation: Q R.
    let columns: Vec<Vec<f64>> =
        (0..N).map(|i| points.iter().map(|[x, _]| chebyshev(i, (x - middle) / half)).collect()).collect();
    let mut r = [[0.0; N]; N];
    let mut done: Vec<Vec<f64>> = Vec::with_capacity(N);
    for (j, mut column) in columns.into_iter().enumerate() {
        for _ in 0..2 {
            for (row, q) in r.iter_mut().zip(&done) {
                let along = dot(q, &column);
                row[j] += along;
                add(&mut column, -along, q);
            }
        }
        let length = norm(&column);
        r[j][j] = length;
        done.push(column.into_iter().map(|c| c / length).collect());
    }
    let y: Vec<f64> = points.iter().map(|[_, y]| *y).collect();
    let mut of_basis = [0.0; N];
    for (number, q) in of_basis.iter_mut().zip(&done) {
        *number = dot(q, &y);
    }
    let of_basis = solved(&r, of_basis);
    Fitted { coefficients: powers(of_basis, middle, half), condition: condition(&r) }
}

fn chebyshev(order: usize, t: f64) -> f64 {
    let (mut now, mut next) = (1.0, t);
    for _ in 0..order {
        (now, next) = (next, 2.0 * t * next - now);
    }
    now
}

/// Solves R x = b.
fn solved<const N: usize>(r: &[[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for i in (0..N).rev() {
        for j in i + 1..N {
            b[i] -= r[i][j] * b[j];
        }
        b[i] /= r[i][i];
    }
    b
}

fn condition<const N: usize>(r: &[[f64; N]; N]) -> f64 {
    let squares = |rows: &[[f64; N]; N]| rows.iter().flatten().map(|x| x * x).sum::<f64>();
    let mut inverse = [[0.0; N]; N];
    for (i, column) in inverse.iter_mut().enumerate() {
        let mut unit = [0.0; N];
        unit[i] = 1.0;
        *column = solved(r, unit);
    }
    (squares(r) * squares(&inverse)).sqrt()
}

/// Converts a sum of T_i((x - middle)/half) to powers of x, the highest first, by Clenshaw's recurrence on
/// polynomials.
fn powers<const N: usize>(of_basis: [f64; N], middle: f64, half: f64) -> [f64; N] {
    // b_k = c_k + 2 t b_{k+1} - b_{k+2}. In the recurrence the lowest power comes first.
    let (mut next, mut after) = ([0.0; N], [0.0; N]);
    for k in (0..N).rev() {
        let twice = if k == 0 { 1.0 } else { 2.0 };
        let mut now = [0.0; N];
        for i in 0..N {
            let below = if i == 0 { 0.0 } else { next[i - 1] };
            now[i] = twice * (below - middle * next[i]) / half - after[i];
        }
        now[0] += of_basis[k];
        (after, next) = (next, now);
    }
    next.reverse();
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_come_back() {
        let wanted = [0.022_54, -2.6296, 113.82, -2386.3, 30_080.0, 71_728.0];
        let points: Vec<[f64; 2]> = (0..=40).map(f64::from).map(|x| [x, value(&wanted, x)]).collect();
        let found: Fitted<6> = fit(&points, [0.0, 40.0]);
        for (found, wanted) in found.coefficients.iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-10, "{found} for {wanted}");
        }
        assert!(found.condition > 1.0 && found.condition < 20.0, "{}", found.condition);
        assert!(found.cancellation([0.0, 40.0]) > 10.0);
    }

    #[test]
    fn what_is_left_is_orthogonal() {
        let points: Vec<[f64; 2]> = (1..=50).map(|i| [f64::from(i), f64::from(i).ln()]).collect();
        let found: Fitted<5> = fit(&points, [1.0, 50.0]);
        for power in 0..5 {
            let left: f64 = points
                .iter()
                .map(|[x, y]| (x / 50.0).powi(power) * (y - value(&found.coefficients, *x)))
                .sum();
            assert!(left.abs() < 1e-11, "{power}: {left:e}");
        }
    }
}
