//! Tridiagonal systems of diagonally dominant matrices.

/// Rows `low[i] x[i-1] + diagonal[i] x[i] + high[i] x[i+1] = right[i]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Tridiagonal {
    pub low: Vec<f64>,
    pub diagonal: Vec<f64>,
    pub high: Vec<f64>,
    pub right: Vec<f64>,
}

impl Tridiagonal {
    /// Sets all rows to zero, for n unknowns; reuses the memory.
    pub(super) fn reset(&mut self, n: usize) {
        for row in [&mut self.low, &mut self.diagonal, &mut self.high, &mut self.right] {
            row.clear();
            row.resize(n, 0.0);
        }
    }

    /// Adds a conductance between x\[i-1\] and x\[i\] to both rows.
    pub(super) fn couple(&mut self, i: usize, conductance: f64) {
        self.diagonal[i - 1] += conductance;
        self.diagonal[i] += conductance;
        self.high[i - 1] -= conductance;
        self.low[i] -= conductance;
    }

    /// Solves by Thomas' algorithm. It needs no pivoting, since the rows or the columns are diagonally
    /// dominant.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let n = x.len();
        for i in 1..n {
            let factor = self.low[i] / self.diagonal[i - 1];
            self.diagonal[i] -= factor * self.high[i - 1];
            self.right[i] -= factor * self.right[i - 1];
        }
        for i in (0..n).rev() {
            let above = if i + 1 < n { self.high[i] * x[i + 1] } else { 0.0 };
            x[i] = (self.right[i] - above) / self.diagonal[i];
        }
    }
}
