//! The second derivatives of the residuals, as far as steps have shown them.
//!
//! With `S = sum r_i d2r_i` the sum of squares is `|r + J p|^2 + p^T S p` to second order. Gauss and Newton leave S out. Where
//! residuals stay large, because the model is wrong or incomplete, their steps are then as much too long as S is
//! large against `J^T J`, and a search zigzags. S is built from the changes of the gradient, and used where it foretold the last
//! change of the sum of squares better.
//!
//! J. E. Dennis, D. M. Gay, R. E. Welsch, *An adaptive nonlinear least-squares algorithm*, ACM Trans. Math. Softw. 7 (1981) 348.

use super::linear::Linear;
use super::triangle::Triangle;
use crate::vector::dot;

/// A pivot below this fraction of its column makes `J^T J + S` no basis for a step.
const LEAST_PIVOT: f64 = 1e-8;

/// An approximation of S.
#[derive(Debug, Clone)]
pub(super) struct Second {
    n: usize,
    /// Symmetric, `n x n`.
    s: Vec<f64>,
    /// Whether it foretold the last change better than its absence.
    is_better: bool,
}

impl Second {
    pub(super) fn none(n: usize) -> Self {
        Self { n, s: vec![0.0; n * n], is_better: false }
    }

    /// Starts anew.
    pub(super) fn forget(&mut self) {
        *self = Self::none(self.n);
    }

    fn times(&self, p: &[f64]) -> Vec<f64> {
        self.s.chunks_exact(self.n.max(1)).map(|row| dot(row, p)).collect()
    }

    /// Learns from a decrease of the sum of squares along a step whether it is better than nothing.
    pub(super) fn judge(&mut self, linear: &Linear, p: &[f64], actual: f64) {
        let rp = linear.r.times(p);
        let without = -2.0 * dot(&linear.gradient(), p) - dot(&rp, &rp);
        let with = without - dot(p, &self.times(p));
        self.is_better = (with - actual).abs() < (without - actual).abs();
    }

    /// Learns S from the change of the gradient `J^T r` along a step: `S p = g' - g - J'^T J' p`, by the least symmetric change
    /// that is invariant under scaling of the parameters. What exceeds the new curvature is taken as outdated.
    pub(super) fn learn(&mut self, old_gradient: &[f64], linear: &Linear, p: &[f64]) {
        let y: Vec<f64> = linear.gradient().iter().zip(old_gradient).map(|(new, old)| new - old).collect();
        let gauss = linear.r.transposed_times(&linear.r.times(p));
        let seen: Vec<f64> = y.iter().zip(&gauss).map(|(y, g)| y - g).collect();
        let (known, along) = (self.times(p), dot(&y, p));
        let (of_seen, of_known) = (dot(p, &seen), dot(p, &known));
        if !(along > 0.0 && of_seen.is_finite()) {
            return;
        }
        let keep = (of_seen / of_known).abs();
        // Not a number where both are 0.
        let keep = if keep.is_nan() { 1.0 } else { keep.min(1.0) };
        let rest: Vec<f64> = seen.iter().zip(&known).map(|(seen, known)| seen - keep * known).collect();
        let twice = dot(p, &rest) / along / along;
        for i in 0..self.n {
            for j in 0..self.n {
                let s = &mut self.s[i * self.n + j];
                *s = keep * *s + (rest[i] * (y[j] / along) + (y[i] / along) * rest[j]) - twice * y[i] * y[j];
            }
        }
        if self.s.iter().any(|s| !s.is_finite()) {
            self.forget();
        }
    }

    /// A triangle `A` and a right-hand side `b` with `A^T A = J^T J + S` and `A^T b = J^T r`, for parameters multiplied by
    /// `scale`. `None` if S is no help or the sum isn't positive definite.
    pub(super) fn triangle(&self, linear: &Linear, scale: &[f64]) -> Option<(Triangle, Vec<f64>)> {
        if !self.is_better || scale.iter().any(|scale| *scale <= 0.0) {
            return None;
        }
        let n = self.n;
        let hessian = |i: usize, j: usize| {
            let gauss = dot(linear.r.column(i.min(j)), &linear.r.column(i.max(j))[..=i.min(j)]);
            (gauss + self.s[i * n + j]) / (scale[i] * scale[j])
        };
        let mut columns = vec![0.0; n * n];
        for j in 0..n {
            for i in 0..=j {
                let (left, right) = columns.split_at(j * n);
                let sum = if i == j {
                    dot(&right[..j], &right[..j])
                } else {
                    dot(&left[i * n..i * n + i], &right[..i])
                };
                let rest = hessian(i, j) - sum;
                columns[j * n + i] = if i < j {
                    rest / columns[i * n + i]
                } else if rest > LEAST_PIVOT * hessian(j, j).abs() {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
        }
        let triangle = Triangle::of_columns(&mut columns, n, n);
        let mut b: Vec<f64> = linear.gradient().iter().zip(scale).map(|(g, scale)| g / scale).collect();
        triangle.solve_transposed(&mut b);
        Some((triangle, b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::Residuals;
    use crate::least_squares::linear::linearise;
    use std::convert::Infallible;
    use std::ops::Range;

    /// Three residuals with second derivatives that don't vanish.
    struct Bowl;

    impl Residuals for Bowl {
        type Error = Infallible;

        fn rows(&self) -> usize {
            3
        }

        fn parameters(&self) -> usize {
            2
        }

        fn evaluate(
            &self,
            theta: &[f64],
            rows: Range<usize>,
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), Infallible> {
            let [x, y] = [theta[0], theta[1]];
            residuals.copy_from_slice(&[x * x + 3.0, x + y - 1.0, x * y + 2.0 * y * y + 5.0][rows.clone()]);
            if let Some(jacobian) = jacobian {
                jacobian
                    .copy_from_slice(&[2.0 * x, 0.0, 1.0, 1.0, y, x + 4.0 * y][2 * rows.start..2 * rows.end]);
            }
            Ok(())
        }
    }

    fn at(theta: [f64; 2]) -> (Linear, Vec<f64>) {
        let mut residuals = vec![0.0; 3];
        (linearise(&Bowl, &theta, &mut residuals).unwrap(), residuals)
    }

    fn close(a: &[f64], b: &[f64], within: f64) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within), "{a:?} {b:?}");
    }

    /// After each step the change of the gradient along it is known exactly, and S stays symmetric; after many short ones S is that
    /// of the residuals: `sum r_i d2r_i = [[2 r0, r2], [r2, 4 r2]]`.
    #[test]
    fn steps_show_the_second_derivatives() {
        let mut second = Second::none(2);
        let mut theta = [0.3, 0.4];
        let (mut old, _) = at(theta);
        for i in 0..12 {
            let step = [[1e-4, 0.0], [0.0, 1e-4], [1e-4, 1e-4], [1e-4, -2e-4]][i % 4];
            theta = [theta[0] + step[0], theta[1] + step[1]];
            let (new, _) = at(theta);
            second.learn(&old.gradient(), &new, &step);
            let gauss = new.r.transposed_times(&new.r.times(&step));
            let seen: Vec<f64> = (0..2).map(|j| new.gradient()[j] - old.gradient()[j] - gauss[j]).collect();
            close(&second.times(&step), &seen, 1e-15);
            assert!((second.s[1] - second.s[2]).abs() < 1e-9 * second.s[3].abs());
            old = new;
        }
        let (linear, r) = at(theta);
        close(&second.s, &[2.0 * r[0], r[2], r[2], 4.0 * r[2]], 2e-2 * r[2]);
        // It foretells the change along a longer step, which the Jacobian alone doesn't.
        let step = [-0.05, -0.08];
        let (_, far) = at([theta[0] + step[0], theta[1] + step[1]]);
        second.judge(&linear, &step, dot(&r, &r) - dot(&far, &far));
        assert!(second.is_better);
        // The triangle is that of the whole curvature, in the scale of the parameters.
        let scale = [3.0, 0.5];
        let (a, b) = second.triangle(&linear, &scale).unwrap();
        for (j, e) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let p = [e[0] / scale[0], e[1] / scale[1]];
            let gauss = linear.r.transposed_times(&linear.r.times(&p));
            let whole: Vec<f64> = second
                .times(&p)
                .iter()
                .zip(gauss)
                .zip(scale)
                .map(|((s, g), scale)| (s + g) / scale)
                .collect();
            close(&a.transposed_times(&a.times(&e)), &whole, 1e-9);
            assert!((a.transposed_times(&b)[j] - linear.gradient()[j] / scale[j]).abs() < 1e-9);
        }
        // Where it was worse, and where the sum is no bowl, it isn't used.
        second.judge(&linear, &step, f64::MAX);
        assert!(second.triangle(&linear, &scale).is_none());
        let saddle = Second { s: vec![-1e3, 0.0, 0.0, 1.0], is_better: true, ..second };
        assert!(saddle.triangle(&linear, &scale).is_none());
    }
}
