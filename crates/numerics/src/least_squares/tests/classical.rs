//! The problems of J. J. Moré, B. S. Garbow, K. E. Hillstrom, *Testing Unconstrained Optimization Software*, ACM Transactions on
//! Mathematical Software 7 (1981) 17, whose residuals are rational: the published minima, and the work that each takes (that of
//! the first, Rosenbrock's, is in `searches`). No function
//! of a library is called, so that the counts are those of every machine.

use super::*;
use crate::{Dual, Real};

type X = Dual<6>;

/// Number in the paper, rows, start, published least sum of squares (and place, where it is one), residual number `i`.
struct Problem {
    number: usize,
    rows: usize,
    start: &'static [f64],
    least: f64,
    at: &'static [f64],
    residual: fn(&[X], usize) -> X,
    /// Accepted steps, evaluations without derivatives, evaluations with derivatives.
    work: [usize; 3],
}

const BEALE: [f64; 3] = [1.5, 2.25, 2.625];
const BARD: [f64; 15] =
    [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.1, 4.39];
/// Kowalik and Osborne: y, u.
const ENZYME: [[f64; 2]; 11] = [
    [0.1957, 4.0],
    [0.1947, 2.0],
    [0.1735, 1.0],
    [0.1600, 0.5],
    [0.0844, 0.25],
    [0.0627, 0.167],
    [0.0456, 0.125],
    [0.0342, 0.1],
    [0.0323, 0.0833],
    [0.0235, 0.0714],
    [0.0246, 0.0625],
];

const PROBLEMS: [Problem; 8] = [
    // Freudenstein and Roth: as many rows as parameters, and a minimum at which the Jacobian is singular.
    Problem {
        number: 2,
        rows: 2,
        start: &[0.5, -2.0],
        least: 48.984_253_679,
        at: &[11.412_778_99, -0.896_805_253_3],
        residual: |x, i| {
            let y = x[1];
            if i == 0 {
                x[0] - 13.0 + ((-y + 5.0) * y - 2.0) * y
            } else {
                x[0] - 29.0 + ((y + 1.0) * y - 14.0) * y
            }
        },
        work: [7, 12, 13],
    },
    Problem {
        number: 4,
        rows: 3,
        start: &[1.0, 1.0],
        least: 0.0,
        at: &[1e6, 2e-6],
        residual: |x, i| match i {
            0 => x[0] - 1e6,
            1 => x[1] - 2e-6,
            _ => x[0] * x[1] - 2.0,
        },
        work: [22, 22, 25],
    },
    Problem {
        number: 5,
        rows: 3,
        start: &[1.0, 1.0],
        least: 0.0,
        at: &[3.0, 0.5],
        residual: |x, i| {
            let power = (0..i).fold(x[1], |power, _| power * x[1]);
            -(x[0] * (-power + 1.0)) + BEALE[i]
        },
        work: [9, 10, 13],
    },
    Problem {
        number: 8,
        rows: 15,
        start: &[1.0, 1.0, 1.0],
        least: 8.214_877_306e-3,
        at: &[0.082_410_56, 1.133_036, 2.343_695],
        residual: |x, i| {
            let (u, v) = (i as f64 + 1.0, 15.0 - i as f64);
            -(x[0] + X::from(u) / (x[1] * v + x[2] * u.min(v))) + BARD[i]
        },
        work: [7, 7, 11],
    },
    Problem {
        number: 13,
        rows: 4,
        start: &[3.0, -1.0, 0.0, 1.0],
        least: 0.0,
        at: &[],
        residual: |x, i| match i {
            0 => x[0] + x[1] * 10.0,
            1 => (x[2] - x[3]) * 5.0_f64.sqrt(),
            2 => (x[1] - x[2] * 2.0) * (x[1] - x[2] * 2.0),
            _ => (x[0] - x[3]) * (x[0] - x[3]) * 10.0_f64.sqrt(),
        },
        work: [37, 37, 42],
    },
    Problem {
        number: 14,
        rows: 6,
        start: &[-3.0, -1.0, -3.0, -1.0],
        least: 0.0,
        at: &[1.0; 4],
        residual: |x, i| match i {
            0 => (x[1] - x[0] * x[0]) * 10.0,
            1 => -x[0] + 1.0,
            2 => (x[3] - x[2] * x[2]) * 90.0_f64.sqrt(),
            3 => -x[2] + 1.0,
            4 => (x[1] + x[3] - 2.0) * 10.0_f64.sqrt(),
            _ => (x[1] - x[3]) * 0.1_f64.sqrt(),
        },
        work: [41, 56, 54],
    },
    Problem {
        number: 15,
        rows: 11,
        start: &[0.25, 0.39, 0.415, 0.39],
        least: 3.075_056_038e-4,
        at: &[0.192_806_9, 0.191_282_3, 0.123_056_5, 0.136_062_3],
        residual: |x, i| {
            let [y, u] = ENZYME[i];
            -(x[0] * (x[1] * u + u * u) / (x[2] * u + x[3] + u * u)) + y
        },
        work: [23, 28, 30],
    },
    // Watson, with six parameters.
    Problem {
        number: 20,
        rows: 31,
        start: &[0.0; 6],
        least: 2.287_670_053e-3,
        at: &[-0.015_725, 1.012_435, -0.232_992, 1.260_430, -1.513_729, 0.992_996],
        residual: |x, i| {
            match i {
                29 => return x[0],
                30 => return x[1] - x[0] * x[0] - 1.0,
                _ => {}
            }
            let t = (i as f64 + 1.0) / 29.0;
            let (mut sum, mut slope, mut power) = (x[0], X::from(0.0), 1.0);
            for (j, x) in x.iter().enumerate().take(6).skip(1) {
                slope += *x * (j as f64 * power);
                power *= t;
                sum += *x * power;
            }
            slope - sum * sum - 1.0
        },
        work: [8, 8, 15],
    },
];

#[test]
fn published_minima_are_found_with_no_more_work_than_before() {
    for problem in PROBLEMS {
        let Problem { number, rows, start, least, at, residual, work } = problem;
        let row = move |p: &[f64], i: usize| {
            let variables: Vec<X> = p.iter().enumerate().map(|(j, x)| X::variable(*x, j)).collect();
            let r = residual(&variables, i);
            Some((r.value(), r.gradient()[..p.len()].to_vec()))
        };
        let found = free(&model(rows, start.len(), row), start);
        assert!(found.certificate.converged, "{number}: {:?}", found.certificate);
        assert!(
            (found.cost - least).abs() <= 1e-9 * least + 1e-18,
            "{number}: {} is not {least}",
            found.cost
        );
        for (x, at) in found.theta.iter().zip(at) {
            assert!((x - at).abs() <= 1e-5 * at.abs() + 1e-12, "{number}: {:?}", found.theta);
        }
        assert_eq!([found.iterations, found.evaluations, found.linearisations], work, "{number}");
    }
}
