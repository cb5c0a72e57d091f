//! Problems with known solutions, for the tests of searches and profiles.

mod classical;
mod large_residuals;
mod profiles;
mod searches;

use super::*;
use std::ops::Range;

type Row = Option<(f64, Vec<f64>)>;
type RowOf<'a> = dyn Fn(&[f64], usize) -> Row + Sync + 'a;

/// A problem from a function of the parameters and the row; `None` where it has no value. A boxed function, so that the searches are
/// compiled once for all problems.
struct Model<'a> {
    rows: usize,
    parameters: usize,
    block: usize,
    joint: bool,
    row: Box<RowOf<'a>>,
}

impl Residuals for Model<'_> {
    type Error = String;

    fn rows(&self) -> usize {
        self.rows
    }

    fn parameters(&self) -> usize {
        self.parameters
    }

    fn block(&self) -> usize {
        self.block
    }

    fn joint(&self) -> bool {
        self.joint
    }

    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), String> {
        assert!(rows.len() <= self.block && residuals.len() == rows.len());
        for (i, row) in rows.enumerate() {
            let (r, derivatives) =
                (self.row)(theta, row).ok_or_else(|| format!("no value in row {row} at {theta:?}"))?;
            residuals[i] = r;
            if let Some(jacobian) = jacobian.as_deref_mut() {
                jacobian[i * self.parameters..(i + 1) * self.parameters].copy_from_slice(&derivatives);
            }
        }
        Ok(())
    }
}

fn model<'a>(rows: usize, parameters: usize, row: impl Fn(&[f64], usize) -> Row + Sync + 'a) -> Model<'a> {
    Model { rows, parameters, block: 4096, joint: false, row: Box::new(row) }
}

/// `r = (10 (y - x^2), 1 - x)`.
fn rosenbrock() -> Model<'static> {
    model(2, 2, |p, row| {
        Some(match row {
            0 => (10.0 * (p[1] - p[0] * p[0]), vec![-20.0 * p[0], 10.0]),
            _ => (1.0 - p[0], vec![-1.0, 0.0]),
        })
    })
}

/// A decay `a exp(-b t)` at `t = 0, 0.5, ...` with errors of some per cent; parameters in units of `scale`, rows in the order `order`.
fn decay(rows: usize, scale: [f64; 2], order: fn(usize, usize) -> usize) -> Model<'static> {
    model(rows, 2, move |p, row| {
        let (i, a, b) = (order(row, rows), p[0] * scale[0], p[1] * scale[1]);
        let e = (-b * time(i)).exp();
        Some((a * e - decay_data(i), vec![e * scale[0], -a * time(i) * e * scale[1]]))
    })
}

fn time(i: usize) -> f64 {
    0.5 * i as f64
}

fn decay_data(i: usize) -> f64 {
    3.0 * (-0.7 * time(i)).exp() + 0.05 * ((i * i * 7 + 2 * i) % 11) as f64 / 11.0
}

fn in_order(row: usize, _: usize) -> usize {
    row
}

fn least<P: Residuals<Error = String>>(problem: &P, start: &[f64], bounds: &Bounds) -> Minimum {
    minimise(problem, start, bounds, &Options::default()).unwrap()
}

fn free<P: Residuals<Error = String>>(problem: &P, start: &[f64]) -> Minimum {
    least(problem, start, &Bounds::none(start.len()))
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * e.abs().max(1e-3), "{found:?} is not {expected:?}");
    }
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// `((x^2 - 1), (x - 1)/10)`: the least minimum 0 at 1, and another near -1.
fn two_minima() -> Model<'static> {
    model(2, 1, |p, i| {
        Some(if i == 0 { (p[0] * p[0] - 1.0, vec![2.0 * p[0]]) } else { (0.1 * (p[0] - 1.0), vec![0.1]) })
    })
}
