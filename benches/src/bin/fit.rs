//! Times the fit of four effects to 10^4 simulated rows and the comparison on 10^5 (see
//! `bulge_benches::measured`).
//!
//! `fit [FILE]` prints one line per task: name, seconds, and for the fit the four numbers in SI. If a FILE is
//! given, the rows of the fit are written to it for other programs: pressure, contraction, direction, rate
//! and force, all in SI.

use bulge_benches::Failure;
use bulge_benches::measured::{TRUTH, columns, effects, muscle};
use bulge_effects::Catalogue;
use bulge_inference::{Fitting, Options, compare, fit_effects};
use bulge_measurements::Data;
use bulge_model::Record;
use bulge_muscles::Quantity;
use std::fmt::Write;
use std::time::Instant;

const ROUNDS: usize = 5;

/// Median seconds, and the last result.
fn median<T>(rounds: usize, mut run: impl FnMut() -> Result<T, Failure>) -> Result<(f64, T), Failure> {
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..rounds {
        let start = Instant::now();
        last = Some(run()?);
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok((times[rounds / 2], last.ok_or("no round was run")?))
}

/// The rows with the quantities of the motion that a model needs.
fn table(record: &Record) -> String {
    let mut text = "pressure_pa,contraction,direction,rate_per_s,force_n\n".to_owned();
    for (moment, force) in record.moments().iter().zip(record.force()) {
        // Writing to a string can't fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{force}",
            moment.pressure, moment.contraction, moment.direction, moment.rate
        );
    }
    text
}

fn main() -> Result<(), Failure> {
    let muscle = muscle()?;
    let catalogue = Catalogue::builtin();
    let chosen = effects(&catalogue)?;
    let options = Options::new(catalogue, chosen);
    let few = Data::from_columns(columns(10_000)?)?;
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, table(&Record::new(&few, muscle.length().si())))?;
    }
    let (time, found): (f64, Fitting) = median(ROUNDS, || Ok(fit_effects(&few, &muscle, &options)?))?;
    if !found.fit.convergence.converged {
        return Err(found.fit.convergence.reason.into());
    }
    let numbers: Vec<String> = found.fit.theta.iter().map(ToString::to_string).collect();
    println!("fit of four effects, {} rows\t{time:.4}\t{}", few.len(), numbers.join("\t"));
    let truth: Vec<String> = TRUTH.iter().map(|(_, value)| value.to_string()).collect();
    println!("hidden numbers\t0\t{}", truth.join("\t"));
    let many = Data::from_columns(columns(100_000)?)?;
    let (time, _) = median(3, || Ok(compare(&many, &muscle, &options)?))?;
    println!("compare with four effects, {} rows\t{time:.4}", many.len());
    Ok(())
}
