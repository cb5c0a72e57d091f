//! Triangular factors by Householder reflections: of a block of columns, and of two stacked triangles.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins 2013, section 5.2; the tree of
//! blocks is TSQR (J. Demmel, L. Grigori, M. Hoemmen, J. Langou, *SIAM J. Sci. Comput.* 34 (2012) A206).
//! There is no pivoting and no absolute threshold: scaling a column by a power of two scales that column of
//! the triangle by the same factor, bit for bit.

use crate::vector::{dot, norm};

/// An upper triangle of `n` columns, stored by columns with its zeros.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangle {
    n: usize,
    data: Vec<f64>,
}

impl Triangle {
    /// The triangle of a matrix, stored by columns of `rows` entries, which is overwritten. It has as many
    /// columns as the matrix; missing rows are zero.
    pub(super) fn of_columns(data: &mut [f64], rows: usize, n: usize) -> Self {
        debug_assert_eq!(data.len(), rows * n);
        for j in 0..n.min(rows) {
            let (left, right) = data.split_at_mut((j + 1) * rows);
            let v = &mut left[j * rows + j..];
            let (head, tail) = v.split_at_mut(1);
            let Some(tau) = reflector(&mut head[0], tail) else { continue };
            for column in right.chunks_exact_mut(rows) {
                let (top, below) = column[j..].split_at_mut(1);
                reflect(tau, tail, &mut top[0], below);
            }
        }
        let mut triangle = Self { n, data: vec![0.0; n * n] };
        for (j, column) in data.chunks_exact(rows.max(1)).enumerate() {
            let filled = rows.min(j + 1);
            triangle.data[j * n..j * n + filled].copy_from_slice(&column[..filled]);
        }
        triangle
    }

    /// The triangle of two stacked triangles of equal size.
    pub(super) fn above(mut self, mut below: Self) -> Self {
        let n = self.n;
        for j in 0..n {
            let (left, right) = below.data.split_at_mut((j + 1) * n);
            let tail = &mut left[j * n..=j * n + j];
            let Some(tau) = reflector(&mut self.data[j * n + j], tail) else { continue };
            for (c, column) in right.chunks_exact_mut(n).enumerate() {
                reflect(tau, tail, &mut self.data[(j + 1 + c) * n + j], &mut column[..=j]);
            }
        }
        self
    }

    /// Number of columns.
    pub(super) const fn size(&self) -> usize {
        self.n
    }

    /// Entry in row `i` and column `j`.
    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        self.data[j * self.n + i]
    }

    /// Column `j` down to the diagonal.
    pub(super) fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.n..=j * self.n + j]
    }

    /// The leading triangle of `n` columns.
    pub(super) fn leading(&self, n: usize) -> Self {
        let mut part = Self { n, data: Vec::with_capacity(n * n) };
        for j in 0..n {
            part.data.extend_from_slice(&self.data[j * self.n..j * self.n + n]);
        }
        part
    }

    /// The triangle with column `j` multiplied by `factors[j]`.
    pub(super) fn scaled(&self, factors: &[f64]) -> Self {
        let mut part = self.clone();
        for (column, factor) in part.data.chunks_exact_mut(self.n.max(1)).zip(factors) {
            for x in column {
                *x *= factor;
            }
        }
        part
    }

    /// Solves `R x = b` in place for the first `x.len()` columns, whose diagonal entries must be nonzero.
    pub(super) fn solve(&self, x: &mut [f64]) {
        for j in (0..x.len()).rev() {
            x[j] /= self.at(j, j);
            let (above, rest) = x.split_at_mut(j);
            for (x, r) in above.iter_mut().zip(self.column(j)) {
                *x -= r * rest[0];
            }
        }
    }

    /// Solves `R^T x = b` in place for the first `x.len()` columns, whose diagonal entries must be nonzero.
    pub(super) fn solve_transposed(&self, x: &mut [f64]) {
        for j in 0..x.len() {
            let (above, rest) = x.split_at_mut(j);
            let sum: f64 = above.iter().zip(self.column(j)).map(|(x, r)| x * r).sum();
            rest[0] = (rest[0] - sum) / self.at(j, j);
        }
    }

    /// `R x`.
    pub(super) fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.n];
        for (j, x) in x.iter().enumerate() {
            for (p, r) in product.iter_mut().zip(self.column(j)) {
                *p += r * x;
            }
        }
        product
    }

    /// `R^T x`.
    pub(super) fn transposed_times(&self, x: &[f64]) -> Vec<f64> {
        (0..self.n).map(|j| self.column(j).iter().zip(x).map(|(r, x)| r * x).sum()).collect()
    }

    /// Euclidean norms of the columns.
    pub(super) fn column_norms(&self) -> Vec<f64> {
        (0..self.n).map(|j| norm(self.column(j))).collect()
    }
}

/// Turns a column into the reflector `1 - tau v v^T` with `v = (1, tail)` that maps it onto its first entry; `None` for a zero tail.
fn reflector(head: &mut f64, tail: &mut [f64]) -> Option<f64> {
    let below = dot(tail, tail);
    if below == 0.0 {
        return None;
    }
    let length = (*head * *head + below).sqrt();
    // This sign adds magnitudes, so there is no cancellation.
    let image = if *head > 0.0 { -length } else { length };
    let pivot = *head - image;
    let tau = -pivot / image;
    let inverse = 1.0 / pivot;
    for x in tail {
        *x *= inverse;
    }
    *head = image;
    Some(tau)
}

/// Applies a reflector to a column.
fn reflect(tau: f64, v: &[f64], top: &mut f64, below: &mut [f64]) {
    let w = tau * (*top + dot(v, below));
    *top -= w;
    for (x, v) in below.iter_mut().zip(v) {
        *x -= w * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full matrix of small integers, by columns.
    fn matrix(rows: usize, n: usize) -> Vec<f64> {
        (0..rows * n).map(|i| ((i * i * 7 + 3 * i) % 23) as f64 - 11.0 + 0.125 * (i % 3) as f64).collect()
    }

    fn gram(columns: &[f64], rows: usize, n: usize) -> Vec<f64> {
        let column = |j: usize| &columns[j * rows..(j + 1) * rows];
        (0..n * n).map(|ij| dot(column(ij / n), column(ij % n))).collect()
    }

    #[test]
    fn triangle_has_the_gram_matrix_of_the_columns() {
        for (rows, n) in [(30, 5), (5, 5), (3, 5), (0, 2), (1, 1), (7, 0)] {
            let a = matrix(rows, n);
            let r = Triangle::of_columns(&mut a.clone(), rows, n);
            let expected = gram(&a, rows, n);
            for i in 0..n {
                let column: Vec<f64> = (0..n).map(|row| r.at(row, i)).collect();
                assert!(column[i + 1..].iter().all(|x| *x == 0.0));
                for (found, expected) in r.transposed_times(&column).iter().zip(&expected[i * n..]) {
                    assert!((found - expected).abs() < 1e-11, "{rows} x {n}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn two_triangles_are_as_one_matrix() {
        let (rows, n) = (40, 6);
        let a = matrix(rows, n);
        let part = |range: std::ops::Range<usize>| {
            let mut columns: Vec<f64> = Vec::new();
            for j in 0..n {
                columns.extend(&a[j * rows..][range.clone()]);
            }
            Triangle::of_columns(&mut columns, range.len(), n)
        };
        let whole = Triangle::of_columns(&mut a.clone(), rows, n);
        let stacked = part(0..17).above(part(17..19)).above(part(19..40));
        for j in 0..n {
            // Rows are unique up to their sign.
            for (x, y) in stacked.column(j).iter().zip(whole.column(j)) {
                assert!((x.abs() - y.abs()).abs() < 1e-11, "{x} {y}");
            }
        }
    }

    #[test]
    fn solves_with_the_triangle_and_its_transpose() {
        let r = Triangle::of_columns(&mut matrix(12, 4), 12, 4);
        let x = [1.0, -2.0, 0.5, 3.0];
        let mut back = r.times(&x);
        r.solve(&mut back);
        let mut forth = r.transposed_times(&x);
        r.solve_transposed(&mut forth);
        for (i, x) in x.iter().enumerate() {
            assert!((back[i] - x).abs() < 1e-13 && (forth[i] - x).abs() < 1e-13);
        }
    }

    #[test]
    fn powers_of_two_pass_through_bit_for_bit() {
        let a = matrix(20, 4);
        let factors = [1.0, 2.0_f64.powi(30), 2.0_f64.powi(-25), 4.0];
        let mut scaled: Vec<f64> = a.iter().enumerate().map(|(i, x)| x * factors[i / 20]).collect();
        let plain = Triangle::of_columns(&mut a.clone(), 20, 4).scaled(&factors);
        assert_eq!(plain, Triangle::of_columns(&mut scaled, 20, 4));
    }
}
