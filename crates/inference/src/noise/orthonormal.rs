//! Orthonormal basis of the column space of a matrix at its numerical rank: pivoted Gram-Schmidt, twice, then
//! one-sided Jacobi (Golub and Van Loan 2013, 5.2, 8.6).

use bulge_numerics::vector::{add, dot, norm};

/// Singular values below this fraction of the largest one count as 0; the columns are scaled to norm 1.
const RANK: f64 = 1e-6;
/// A remainder below this fraction of its column is rounding error.
const ROUNDING: f64 = 1e-13;
/// Columns whose cosine is below this count as orthogonal.
const ORTHOGONAL: f64 = 1e-12;
const SWEEPS: usize = 30;

/// Columns of length n, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Basis {
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Basis {
    /// Basis of n x m values, row by row; columns that are 0 are left out.
    pub(crate) fn of(values: &[f64], n: usize) -> Self {
        let m = values.len().checked_div(n).unwrap_or(0);
        let columns: Vec<Vec<f64>> = (0..m)
            .filter_map(|j| {
                // Scale by the largest value first, because squares may overflow.
                let column: Vec<f64> = values.iter().skip(j).step_by(m).copied().collect();
                let largest = column.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let column: Vec<f64> = column.iter().map(|x| x / largest).collect();
                let length = norm(&column);
                (largest > 0.0).then(|| column.iter().map(|x| x / length).collect())
            })
            .collect();
        let (basis, triangle) = gram_schmidt(columns);
        let directions = left_directions(triangle, basis.len());
        let columns = directions
            .iter()
            .map(|direction| {
                let mut column = vec![0.0; n];
                for (part, q) in direction.iter().zip(&basis) {
                    add(&mut column, *part, q);
                }
                column
            })
            .collect();
        Self { columns }
    }

    /// Number of independent columns.
    pub(crate) fn rank(&self) -> usize {
        self.columns.len()
    }

    /// Subtracts from a vector its projection on the basis.
    pub(crate) fn remove_from(&self, vector: &mut [f64]) {
        for _ in 0..2 {
            for column in &self.columns {
                let part = dot(column, vector);
                add(vector, -part, column);
            }
        }
    }
}

/// Orthonormal vectors, pivoted on the largest remainder, and the coefficients of each column in them:
/// columns of R.
fn gram_schmidt(mut columns: Vec<Vec<f64>>) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut triangle: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    let mut left: Vec<usize> = (0..columns.len()).collect();
    while let Some((place, rest)) = left
        .iter()
        .enumerate()
        .map(|(place, j)| (place, norm(&columns[*j])))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
        && rest > ROUNDING
    {
        let pivot = left[place];
        let mut q = std::mem::take(&mut columns[pivot]);
        // A second pass removes what rounding left along the earlier vectors.
        for (i, before) in basis.iter().enumerate() {
            let part = dot(before, &q);
            triangle[pivot][i] += part;
            add(&mut q, -part, before);
        }
        let length = norm(&q);
        if length <= ROUNDING {
            left.remove(place);
            continue;
        }
        for x in &mut q {
            *x /= length;
        }
        left.remove(place);
        triangle[pivot].push(length);
        for j in &left {
            let part = dot(&q, &columns[*j]);
            triangle[*j].push(part);
            add(&mut columns[*j], -part, &q);
        }
        basis.push(q);
    }
    (basis, triangle)
}

/// Left singular vectors of the matrix with these columns (short ones end in zeros), for singular values that
/// count.
fn left_directions(mut columns: Vec<Vec<f64>>, rows: usize) -> Vec<Vec<f64>> {
    for column in &mut columns {
        column.resize(rows, 0.0);
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for i in 1..columns.len() {
            let (before, after) = columns.split_at_mut(i);
            let second = &mut after[0];
            for first in before {
                turned |= rotate(first, second);
            }
        }
        if !turned {
            break;
        }
    }
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    let largest = lengths.iter().copied().fold(0.0, f64::max);
    let mut kept: Vec<(f64, Vec<f64>)> =
        lengths.into_iter().zip(columns).filter(|(length, _)| *length > RANK * largest).collect();
    kept.sort_by(|a, b| b.0.total_cmp(&a.0));
    kept.into_iter().map(|(length, column)| column.iter().map(|x| x / length).collect()).collect()
}

/// Rotates two columns in their plane until they are orthogonal. Returns whether they were not orthogonal
/// before.
fn rotate(first: &mut [f64], second: &mut [f64]) -> bool {
    let (a, b, c) = (dot(first, first), dot(second, second), dot(first, second));
    if c == 0.0 || c.abs() <= ORTHOGONAL * (a * b).sqrt() || a.min(b) <= (ROUNDING * ROUNDING) * a.max(b) {
        return false;
    }
    let zeta = (b - a) / (2.0 * c);
    let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let cosine = (1.0 + tangent * tangent).sqrt().recip();
    let sine = cosine * tangent;
    for (x, y) in first.iter_mut().zip(second) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_columns_count_once_and_the_rest_is_orthonormal() {
        let n = 300;
        let values: Vec<f64> = (0..n)
            .flat_map(|i| {
                let x = f64::from(i) / f64::from(n);
                // Powers of very different size, a sum of two, a nearly dependent column, one just above the
                // limit, and zeros.
                let near = 1e9 * x * x;
                [
                    1.0,
                    1e-9 * x,
                    near,
                    near + 1e-9 * x,
                    near * (1.0 + 1e-8 * x),
                    x + 1e-4 * (40.0 * x).sin(),
                    0.0,
                ]
            })
            .collect();
        let basis = Basis::of(&values, 300);
        assert_eq!(basis.rank(), 4);
        for (i, a) in basis.columns.iter().enumerate() {
            for (j, b) in basis.columns.iter().enumerate() {
                assert!((dot(a, b) - f64::from(u8::from(i == j))).abs() < 1e-10);
            }
        }
        let mut column: Vec<f64> = values.iter().skip(5).step_by(7).copied().collect();
        basis.remove_from(&mut column);
        assert!(norm(&column) < 1e-9);
    }
}
