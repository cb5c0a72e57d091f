//! Times the closed form and the shooting on the 1000 contractions that the peers also solve (5 to 40 %, l0/R
//! = 6.875). Each solve begins without a neighbouring solution. It prints one line per method: name,
//! microseconds per solve, sum of f over the contractions (S1 eq. 28).

use bulge_benches::{CONTRACTIONS, Failure, SLENDERNESS, contraction, median_us, pleated, solve};
use bulge_fibre::{Approach, FibreError, closed_form};
use std::hint::black_box;

fn report(name: &str, rounds: usize, sum: impl Fn() -> Result<f64, FibreError>) -> Result<(), Failure> {
    let total = sum()?;
    let time = median_us(rounds, CONTRACTIONS, || {
        let _ = black_box(sum());
    });
    println!("{name}\t{time:.4}\t{total:.12}");
    Ok(())
}

fn main() -> Result<(), Failure> {
    let sum = |f: &dyn Fn(f64) -> Result<f64, FibreError>| (0..CONTRACTIONS).map(|i| f(contraction(i))).sum();
    report("closed form", 51, || {
        sum(&|contraction| Ok(closed_form::solve(contraction, SLENDERNESS, 0.0)?.force.value))
    })?;
    let problem = pleated(None)?;
    // f = F/(p (n/2 pi) sin(2 pi/n) l0^2)
    let polygon = 40.0 / std::f64::consts::TAU * (std::f64::consts::TAU / 40.0).sin();
    let scale = 1e5 * polygon * 0.11 * 0.11;
    for (name, rounds, approach) in [
        ("closed form through Problem::solve", 51, Approach::ClosedForm),
        ("shooting through Problem::solve", 11, Approach::Shooting),
    ] {
        report(name, rounds, || {
            sum(&|contraction| Ok(solve(&problem, contraction, approach)?.force_n / scale))
        })?;
    }
    Ok(())
}
