//! Restricted likelihood of noise variances under a linear model (Patterson and Thompson 1971; Harville
//! 1977).

use bulge_model::Record;
use nalgebra::{DMatrix, DMatrixView};
use rayon::prelude::*;

use crate::median::median;
use crate::noise::law::NoiseLaw;
use crate::noise::orthonormal::Basis;
use crate::noise::whitening::{Components, Layout, Whitening};

/// Rows whose products one thread sums.
const ROWS: usize = 512;

/// Restricted likelihood of the residuals of a linear model X with orthonormal columns, as a function of the
/// covariance K.
///
/// ```text
/// D = log|K| + log|X' K^-1 X| + q,    q = y' (K^-1 - K^-1 X (X' K^-1 X)^-1 X' K^-1) y
/// ```
/// If only the ratios of the variances are free, the best common factor is q/(n - r), and D = .. + (n - r) (1
/// + log(q/(n - r))).
#[derive(Debug, Clone)]
pub(crate) struct RestrictedLikelihood {
    pub(crate) layout: Layout,
    /// X and the residuals of y: n rows of r + 1 values.
    columns: Vec<f64>,
    rank: usize,
    /// Residual variance as for independent noise, with n - r degrees of freedom.
    pub(crate) variance: f64,
    /// Whether the input variances fix the scale.
    pub(crate) absolute: bool,
}

/// The likelihood at one covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Deviance {
    /// -2 log L up to a constant.
    pub(crate) value: f64,
    /// Best common factor of the variances; 1 if the scale is fixed.
    pub(crate) factor: f64,
}

impl RestrictedLikelihood {
    /// The likelihood of values on a layout; none if the basis leaves no degree of freedom.
    pub(crate) fn new(layout: Layout, basis: &Basis, values: &[f64]) -> Option<Self> {
        let (n, rank) = (values.len(), basis.rank());
        let freedom = n.checked_sub(rank).filter(|freedom| *freedom > 0)?;
        let mut left = values.to_vec();
        basis.remove_from(&mut left);
        let variance = left.iter().map(|x| x * x).sum::<f64>() / freedom as f64;
        let mut columns = Vec::with_capacity(n * (rank + 1));
        for (row, value) in left.iter().enumerate() {
            columns.extend(basis.columns.iter().map(|column| column[row]));
            columns.push(*value);
        }
        let absolute = layout.known.iter().any(|v| *v > 0.0);
        Some(Self { layout, columns, rank, variance, absolute })
    }

    /// Rows less independent columns.
    pub(crate) fn freedom(&self) -> f64 {
        (self.layout.rows.len() - self.rank) as f64
    }

    /// Degrees of freedom of the sweeps' offsets: for each sweep the squared norm of its normalised constant
    /// outside the columns, summed.
    pub(crate) fn offset_freedom(&self) -> f64 {
        let width = self.rank + 1;
        let left = |block: &std::ops::Range<usize>| {
            let inside: f64 = (0..self.rank)
                .map(|j| block.clone().map(|i| self.columns[i * width + j]).sum::<f64>().powi(2))
                .sum();
            (1.0 - inside / block.len().max(1) as f64).max(0.0)
        };
        self.layout.blocks.iter().map(left).sum()
    }

    /// Typical variance that noise of the inputs contributes to the force \[N^2\]. Rows of doubtful direction
    /// have a large variance of their own, which isn't the rig's.
    pub(crate) fn usual_input_variance(&self) -> f64 {
        median(&mut self.layout.known.clone())
    }

    /// The likelihood of some of the rows, with the columns that are independent there.
    pub(crate) fn on(&self, keep: &[bool]) -> Option<Self> {
        let width = self.rank + 1;
        let kept = || self.columns.chunks_exact(width).zip(keep).filter(|(_, keep)| **keep);
        let values: Vec<f64> = kept().map(|(row, _)| row[self.rank]).collect();
        let design: Vec<f64> = kept().flat_map(|(row, _)| &row[..self.rank]).copied().collect();
        let basis = Basis::of(&design, values.len());
        Some(Self { absolute: self.absolute, ..Self::new(self.layout.kept(keep), &basis, &values)? })
    }

    /// The likelihood at the variances `components`; none if the covariance is singular. O(n r^2).
    pub(crate) fn deviance(&self, components: &Components) -> Option<Deviance> {
        let whitening = Whitening::of(components, &self.layout).ok()?;
        let mut columns = self.columns.clone();
        whitening.apply(&mut columns).ok()?;
        let width = self.rank + 1;
        let mut gram = products(&columns, width);
        cholesky(&mut gram, width)?;
        let diagonal = |i: usize| gram[i * width + i];
        let determinants =
            whitening.log_determinant() + 2.0 * (0..self.rank).map(|i| diagonal(i).ln()).sum::<f64>();
        let left = diagonal(self.rank).powi(2);
        let deviance = if self.absolute {
            Deviance { value: determinants + left, factor: 1.0 }
        } else {
            let factor = left / self.freedom();
            Deviance { value: determinants + self.freedom() * (1.0 + factor.ln()), factor }
        };
        deviance.value.is_finite().then_some(deviance)
    }
}

/// Log restricted likelihood of values under a law and a linear model, up to a constant of the model:
/// `design` is n x m values, row by row. None if the covariance is singular or the model leaves no degree of
/// freedom.
pub(crate) fn log_likelihood(
    law: &NoiseLaw,
    record: &Record,
    input_variances: &[f64],
    design: &[f64],
    values: &[f64],
) -> Option<f64> {
    let layout = Layout::new(record, &vec![true; record.len()], input_variances, law.time).ok()?;
    let basis = Basis::of(design, values.len());
    let likelihood =
        RestrictedLikelihood { absolute: true, ..RestrictedLikelihood::new(layout, &basis, values)? };
    Some(-0.5 * likelihood.deviance(&Components::of(law).ok()?)?.value)
}

impl Layout {
    /// The layout of some of its rows; gaps over rows that are left out add up.
    pub(crate) fn kept(&self, keep: &[bool]) -> Self {
        let mut layout = Self { blocks: Vec::new(), rows: Vec::new(), gaps: Vec::new(), known: Vec::new() };
        for block in &self.blocks {
            let start = layout.rows.len();
            let mut since = 0.0;
            for i in block.clone() {
                since += self.gaps[i];
                if keep[i] {
                    layout.gaps.push(if layout.rows.len() == start { 0.0 } else { since });
                    layout.rows.push(self.rows[i]);
                    layout.known.push(self.known[i]);
                    since = 0.0;
                }
            }
            if layout.rows.len() > start {
                layout.blocks.push(start..layout.rows.len());
            }
        }
        layout
    }
}

/// Gram matrix of columns that are given row by row, `width` values in a row. The order of summation is
/// fixed.
fn products(columns: &[f64], width: usize) -> Vec<f64> {
    let part = |rows: &[f64]| {
        // Row-major storage read as column-major: rows of the table are columns of the view.
        let across = DMatrixView::from_slice(rows, width, rows.len() / width);
        let along = DMatrixView::from_slice_with_strides(rows, rows.len() / width, width, width, 1);
        let mut gram = DMatrix::zeros(width, width);
        gram.gemm(1.0, &across, &along, 0.0);
        gram
    };
    let parts: Vec<DMatrix<f64>> = columns.par_chunks(ROWS * width).map(part).collect();
    let mut gram = DMatrix::zeros(width, width);
    for part in &parts {
        gram += part;
    }
    // The matrix is symmetric, so column-major equals row-major.
    gram.data.into()
}

/// Lower Cholesky factor in place; none if the matrix isn't positive definite.
fn cholesky(matrix: &mut [f64], width: usize) -> Option<()> {
    for i in 0..width {
        let (above, rest) = matrix.split_at_mut(i * width);
        let line = &mut rest[..=i];
        for j in 0..i {
            let other = &above[j * width..=j * width + j];
            let sum: f64 = line[..j].iter().zip(other).map(|(x, y)| x * y).sum();
            line[j] = (line[j] - sum) / other[j];
        }
        let rest = line[i] - line[..i].iter().map(|x| x * x).sum::<f64>();
        line[i] = Some(rest).filter(|rest| *rest > 0.0)?.sqrt();
    }
    Some(())
}
