//! Singular values of small triangles and eigenvalues of small symmetric matrices by Jacobi rotations.
//!
//! One-sided: M. R. Hestenes, *J. SIAM* 6 (1958) 51; two-sided: C. G. J. Jacobi 1846, as in G. H. Golub, C. F. Van Loan, *Matrix
//! Computations*, 4th ed., Johns Hopkins 2013, sections 8.5 and 8.6. Jacobi's methods are the accurate ones for small matrices:
//! tiny singular values of a matrix with well-scaled columns come out with relative accuracy (J. Demmel, K. Veselic, *SIAM J.
//! Matrix Anal. Appl.* 13 (1992) 1204).

use crate::vector::{dot, norm};

/// Most sweeps over all pairs; a dozen is far more than matrices of some 40 columns need.
const SWEEPS: usize = 60;

/// Singular values in descending order, each with its right singular vector.
///
/// `columns` are the columns of the matrix, all of one length.
pub(super) fn right_singular(mut columns: Vec<Vec<f64>>) -> Vec<(f64, Vec<f64>)> {
    let n = columns.len();
    let mut vectors: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let (a, b) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
                let c = dot(&columns[p], &columns[q]);
                if c.abs() <= f64::EPSILON * (a * b).sqrt() {
                    continue;
                }
                rotated = true;
                let (cos, sin) = rotation(a, b, c);
                rotate(&mut columns, p, q, cos, sin);
                rotate(&mut vectors, p, q, cos, sin);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut pairs: Vec<_> = columns.iter().map(|c| norm(c)).zip(vectors).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs
}

/// Eigenvalues of a symmetric matrix in ascending order, each with its unit eigenvector. `rows` are the rows of the matrix.
pub(super) fn symmetric_eigen(mut rows: Vec<Vec<f64>>) -> Vec<(f64, Vec<f64>)> {
    let n = rows.len();
    let mut vectors: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let size = norm(&rows.concat());
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                if rows[p][q].abs() <= f64::EPSILON * 1e-2 * size {
                    continue;
                }
                rotated = true;
                let (cos, sin) = rotation(rows[p][p], rows[q][q], rows[p][q]);
                rotate(&mut rows, p, q, cos, sin);
                for row in &mut rows {
                    (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                }
                rotate(&mut vectors, p, q, cos, sin);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut pairs: Vec<_> = rows.iter().enumerate().map(|(i, row)| row[i]).zip(vectors).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

/// Cosine and sine of the smaller rotation that makes `[[a, c], [c, b]]` diagonal.
fn rotation(a: f64, b: f64, c: f64) -> (f64, f64) {
    let zeta = (b - a) / (2.0 * c);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cos = 1.0 / tangent.hypot(1.0);
    (cos, cos * tangent)
}

/// Rotates two vectors of a list into each other.
fn rotate(vectors: &mut [Vec<f64>], p: usize, q: usize, cos: f64, sin: f64) {
    let (left, right) = vectors.split_at_mut(q);
    for (x, y) in left[p].iter_mut().zip(&mut right[0]) {
        (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiny_singular_values_are_relatively_exact() {
        // Laeuchli's matrix [1 1; e 0; 0 e]: singular values sqrt(2 + e^2) and e.
        let e = 1e-9;
        let pairs = right_singular(vec![vec![1.0, e, 0.0], vec![1.0, 0.0, e]]);
        assert!((pairs[0].0 - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!((pairs[1].0 / e - 1.0).abs() < 1e-7, "{:e}", pairs[1].0);
        let half = 0.5_f64.sqrt();
        assert!((pairs[1].1[0].abs() - half).abs() < 1e-12 && (pairs[1].1[0] + pairs[1].1[1]).abs() < 1e-12);
    }

    #[test]
    fn zero_columns_are_null_directions() {
        let pairs = right_singular(vec![vec![0.0, 0.0], vec![3.0, 4.0]]);
        assert_eq!((pairs[0].0, pairs[1].0), (5.0, 0.0));
        assert_eq!(pairs[1].1, [1.0, 0.0]);
        assert!(right_singular(Vec::new()).is_empty());
    }

    #[test]
    fn eigenvalues_of_the_second_difference() {
        // tridiag(-1, 2, -1) of size n: 4 sin^2(i pi / (2 n + 2)).
        let n = 7;
        let entry = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let matrix: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        for (i, (value, vector)) in symmetric_eigen(matrix.clone()).into_iter().enumerate() {
            let s = ((i + 1) as f64 * std::f64::consts::PI / (2 * n + 2) as f64).sin();
            assert!((value - 4.0 * s * s).abs() < 1e-14);
            for (row, x) in matrix.iter().zip(&vector) {
                assert!((dot(row, &vector) - value * x).abs() < 1e-14);
            }
        }
    }
}
