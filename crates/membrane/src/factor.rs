//! Factorisation of a sparse symmetric matrix, K = L D L', with the number of its negative eigenvalues.
//!
//! Uses faer. The elimination order and the pattern of L are determined once per structure, the values for
//! each matrix. D gives the number of negative eigenvalues (Sylvester's law of inertia), which is zero in a
//! stable equilibrium.

use crate::assembly::filled;
use crate::error::MembraneError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltParams, LdltRegularization};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};

/// Operations per entry of the factors, as a part of faer's own limit, from which columns are factorised together in
/// dense blocks: an airbag of 1152 triangles takes 60 % of the time in factors then, one of 3200 a third, and one of
/// 512 the same. Rings stay below.
const BLOCKS_FROM: f64 = 0.5;

/// Symbolic and numeric factors, and their workspace.
pub(crate) struct Factor {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: MemBuffer,
    par: Par,
}

/// Inertia of the matrix as a factorisation finds it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Inertia {
    /// The number of negative eigenvalues.
    Negative(usize),
    /// A pivot is zero or not finite.
    Singular,
}

impl Factor {
    /// For matrices with this pattern of the upper triangle, by columns, including the diagonal.
    pub(crate) fn new(columns: Vec<usize>, rows: Vec<usize>, par: Par) -> Result<Self, MembraneError> {
        let n = columns.len() - 1;
        let pattern = SymbolicSparseColMat::new_checked(n, n, columns, None, rows);
        let memory_short = |_| MembraneError::Memory { unknowns: n };
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold(BLOCKS_FROM),
            ..CholeskySymbolicParams::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(pattern.as_ref(), Side::Upper, SymmetricOrdering::Amd, params)
                .map_err(memory_short)?;
        let request = symbolic
            .factorize_numeric_ldlt_scratch::<f64>(par, Spec::<LdltParams, f64>::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, par));
        let memory = MemBuffer::try_new(request).map_err(|_| MembraneError::Memory { unknowns: n })?;
        let values = zeros(symbolic.len_val(), n)?;
        Ok(Self { pattern, symbolic, values, memory, par })
    }

    /// Number of entries of the factors.
    pub(crate) fn size(&self) -> usize {
        self.values.len()
    }

    /// Factorises the matrix with these values.
    pub(crate) fn factorise(&mut self, matrix: &[f64]) -> Inertia {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), matrix);
        let done = self.symbolic.factorize_numeric_ldlt(
            &mut self.values,
            matrix,
            Side::Upper,
            LdltRegularization::default(),
            self.par,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        if done.is_err() {
            return Inertia::Singular;
        }
        self.inertia()
    }

    fn inertia(&self) -> Inertia {
        let mut negative = 0;
        let mut is_good = true;
        let mut see = |pivot: f64| {
            is_good &= pivot.is_finite() && pivot != 0.0;
            negative += usize::from(pivot < 0.0);
        };
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(l) => {
                // D comes first in each column.
                for start in &l.col_ptr()[..l.ncols()] {
                    see(self.values[*start]);
                }
            }
            SymbolicCholeskyRaw::Supernodal(l) => {
                for s in 0..l.n_supernodes() {
                    let columns = l.supernode_end()[s] - l.supernode_begin()[s];
                    let start = l.col_ptr_for_val()[s];
                    let rows = (l.col_ptr_for_val()[s + 1] - start) / columns.max(1);
                    for i in 0..columns {
                        see(self.values[start + i * rows + i]);
                    }
                }
            }
        }
        if is_good { Inertia::Negative(negative) } else { Inertia::Singular }
    }

    /// Replaces a right-hand side by the solution.
    pub(crate) fn solve(&mut self, right: &mut [f64]) {
        let n = right.len();
        let right = MatMut::from_column_major_slice_mut(right, n, 1);
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right,
            self.par,
            MemStack::new(&mut self.memory),
        );
    }
}

/// Storage for `count` entries of a matrix with `unknowns` unknowns.
pub(crate) fn zeros(count: usize, unknowns: usize) -> Result<Vec<f64>, MembraneError> {
    filled(count, 0.0).map_err(|_| MembraneError::Memory { unknowns })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second-difference matrix on a grid of n x n points less `shift`, whose eigenvalues are known.
    fn grid(n: usize, shift: f64) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut columns, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n * n {
            if j >= n {
                rows.push(j - n);
                values.push(-1.0);
            }
            if j % n > 0 {
                rows.push(j - 1);
                values.push(-1.0);
            }
            rows.push(j);
            values.push(4.0 - shift);
            columns.push(rows.len());
        }
        (columns, rows, values)
    }

    #[test]
    fn solves_and_counts_negative_eigenvalues() {
        // The small one is factorised simplicially, the larger one supernodally.
        for n in [3, 40] {
            for shift in [0.0, 0.3, 1.7] {
                let (columns, rows, values) = grid(n, shift);
                let mut factor = Factor::new(columns.clone(), rows.clone(), Par::Seq).unwrap();
                let angle = |i: usize| (i as f64 * core::f64::consts::PI / (n as f64 + 1.0)).cos();
                let below = (1..=n)
                    .flat_map(|i| (1..=n).map(move |j| 4.0 - 2.0 * angle(i) - 2.0 * angle(j) - shift))
                    .filter(|eigenvalue| *eigenvalue < 0.0)
                    .count();
                assert_eq!(factor.factorise(&values), Inertia::Negative(below), "{n} {shift}");
                let exact: Vec<f64> = (0..n * n).map(|i| (i as f64).sin()).collect();
                let mut right = vec![0.0; n * n];
                for j in 0..n * n {
                    for at in columns[j]..columns[j + 1] {
                        let i = rows[at];
                        right[i] += values[at] * exact[j];
                        if i != j {
                            right[j] += values[at] * exact[i];
                        }
                    }
                }
                factor.solve(&mut right);
                for (a, b) in right.iter().zip(&exact) {
                    assert!((a - b).abs() < 1e-9, "{n} {shift}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_zero_pivot_is_said() {
        let mut factor = Factor::new(vec![0, 1, 2], vec![0, 1], Par::Seq).unwrap();
        assert_eq!(factor.factorise(&[1.0, 0.0]), Inertia::Singular);
        assert_eq!(factor.factorise(&[1.0, f64::NAN]), Inertia::Singular);
        assert_eq!(factor.factorise(&[1.0, -2.0]), Inertia::Negative(1));
    }
}
