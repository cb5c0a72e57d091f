//! Benchmarks of Bulge: the muscles that are measured, and the timing functions that the programs share.

use bulge_effects::{Effect, user};
use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_muscles::{
    Angle, Braided, Construction, Ends, Length, Muscle, MuscleError, Parameter, Pressure, preset,
};
use bulge_numerics::Random;
use bulge_table::Lookup;
use std::error::Error;
use std::time::Instant;

pub mod measured;
mod parquet;

pub use parquet::parquet;

/// Any error that stops a benchmark.
pub type Failure = Box<dyn Error>;

/// Slenderness l0/R of the pleated muscle of the benchmarks (`ppam-2-r16`).
pub const SLENDERNESS: f64 = 6.875;
/// Contractions of the comparison with other programs: 1000 from 5 to 40 %.
pub const CONTRACTIONS: usize = 1000;

/// Contraction number `i` of the comparison with other programs.
#[must_use]
pub fn contraction(i: usize) -> f64 {
    0.05 + 0.35 * i as f64 / (CONTRACTIONS - 1) as f64
}

/// The pleated muscle, l0/R = 6.875, n = 40, at 1 bar. If a stiffness EA \[N\] is given, its fibres are
/// elastic.
///
/// # Errors
/// Never: the numbers are valid.
pub fn pleated(stiffness: Option<f64>) -> Result<Problem, Failure> {
    let muscle = preset("ppam-2-r16")?;
    let muscle = match stiffness {
        Some(stiffness) => muscle.with(Parameter::FibreStiffness, stiffness)?,
        None => muscle,
    };
    Ok(Problem::new(&muscle, Pressure::bar(1.0))?)
}

/// A braid with r0 = 10 mm and 25 degrees at rest.
fn braid_muscle(length_over_radius: f64, ends: Ends) -> Result<Muscle, MuscleError> {
    let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0))?.with_ends(ends);
    Muscle::new("braid", Length::mm(10.0 * length_over_radius), Construction::Braided(braided))
}

/// A clamped braid with the given l0/r0, at 3 bar.
///
/// # Errors
/// If l0/r0 is out of range.
pub fn braid(length_over_radius: f64) -> Result<Problem, Failure> {
    Ok(Problem::new(&braid_muscle(length_over_radius, Ends::Clamped)?, Pressure::bar(3.0))?)
}

/// The clamped braid with l0/r0 = 25 and a rubber bladder of 1.5 mm, at 3 bar.
///
/// # Errors
/// Never: the numbers are valid.
pub fn bladder() -> Result<Problem, Failure> {
    let rubber = [(Parameter::Wall, 0.0015), (Parameter::C10, 2e5), (Parameter::C01, 5e4)];
    let muscle = braid_muscle(25.0, Ends::Clamped)?.with_all(&rubber)?;
    Ok(Problem::new(&muscle, Pressure::bar(3.0))?)
}

/// The rubber of [`bladder`] as a user-defined formula.
const RUBBER: &str = r#"[effects.rubber]
title = "Mooney-Rivlin"
energy = "h*(c10*(l1^2 + l2^2 + 1/(l1*l2)^2 - 3) + c01*(1/l1^2 + 1/l2^2 + (l1*l2)^2 - 3))"
parameters.c10 = { unit = "kPa", typical = "200 kPa", low = "0 kPa", high = "3000 kPa" }
parameters.c01 = { unit = "kPa", typical = "50 kPa", low = "0 kPa", high = "3000 kPa" }
parameters.h = { unit = "mm", typical = "1.5 mm", low = "0.5 mm", high = "5 mm" }
"#;

/// The braid of [`bladder`] with its rubber as a formula.
///
/// # Errors
/// Never: the numbers are valid.
pub fn rubber_as_formula() -> Result<Problem, Failure> {
    let rubber: Box<dyn Effect> = Box::new(user::from_toml(RUBBER, "rubber")?.remove(0));
    let parts = rubber.reshaped(&[2e5, 5e4, 1.5e-3], &braid_muscle(25.0, Ends::Clamped)?)?;
    Ok(Problem::new(parts, Pressure::bar(3.0))?)
}

/// The textbook cylinder, at 3 bar.
///
/// # Errors
/// Never: the numbers are valid.
pub fn cylinder() -> Result<Problem, Failure> {
    Ok(Problem::new(&braid_muscle(25.0, Ends::Cylinder)?, Pressure::bar(3.0))?)
}

/// Force, volume and derivatives at a contraction, solved without a neighbouring solution as a start.
///
/// # Errors
/// See [`FibreError`].
pub fn solve(problem: &Problem, contraction: f64, approach: Approach) -> Result<Response, FibreError> {
    problem.solve(Given::Contraction(contraction), approach)
}

/// Median over `rounds` of the time of one call of `run`, divided by `calls`, in microseconds.
pub fn median_us(rounds: usize, calls: usize, mut run: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..rounds)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e6 / calls as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[rounds / 2]
}

/// Random points in the domain of a table, where the end of the first axis depends on the second one.
#[must_use]
pub fn random_points<const O: usize>(lookup: &Lookup<'_, 2, O>, count: usize) -> Vec<[f64; 2]> {
    let mut random = Random::new(1, 0);
    let mut points = Vec::with_capacity(count);
    while points.len() < count {
        let second = 2.0 + 98.0 * random.uniform();
        if let Some(end) = lookup.upper_end([0.0, second]) {
            points.push([end * random.uniform(), second]);
        }
    }
    points
}

/// Peak of the resident memory \[MiB\].
#[must_use]
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}
