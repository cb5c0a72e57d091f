//! Times one lookup of force, volume and gradients and its direct solution. It prints median nanoseconds over
//! rounds as JSON for `peers/table.py`, with the file name of the table.
//!
//! ```sh
//! cargo run --release -p bulge-benches --bin lookup FOLDER
//! ```

use bulge_benches::{Failure, median_us, random_points};
use bulge_fibre::closed_form;
use bulge_sweep::{Plan, tabulate};
use bulge_table::Table;
use serde_json::json;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

const FAMILY: &str = include_str!("../../../crates/cli/data/family.toml");
const POINTS: usize = 4096;
const ROUNDS: usize = 15;
/// Passes over the points in one round of lookups.
const PASSES: usize = 100;

/// Median nanoseconds of a call, in rounds of `count` calls.
fn median(count: usize, round: impl FnMut()) -> f64 {
    1e3 * median_us(ROUNDS, count, round)
}

fn main() -> Result<(), Failure> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name a folder for the table")?);
    let plan = Plan::from_toml(FAMILY, "family.toml", None)?;
    let wish = plan.table.clone().ok_or("no table is wished")?;
    let start = Instant::now();
    let built = tabulate(&plan, &wish, &|_| ())?;
    let seconds = start.elapsed().as_secs_f64();
    std::fs::write(folder.join("family.bulge"), &built.bytes)?;
    let table = Table::from_bytes(&built.bytes)?;
    let lookup = table.lookup::<2, 2>()?;
    let points = random_points(&lookup, POINTS);
    let looked_up = median(PASSES * POINTS, || {
        for _ in 0..PASSES {
            for point in &points {
                black_box(lookup.at(black_box(*point)));
            }
        }
    });
    let mut found = vec![None; POINTS];
    let of_many = median(PASSES * POINTS, || {
        for _ in 0..PASSES {
            lookup.at_each(black_box(&points), &mut found);
            black_box(&found);
        }
    });
    let curve = lookup.curve::<96>([0.0, 6.875]).ok_or("the table has more coefficients than expected")?;
    let along_curve = median(PASSES * POINTS, || {
        for _ in 0..PASSES {
            for point in &points {
                black_box(curve.at(black_box(0.75 * point[0])));
            }
        }
    });
    let solved = median(POINTS, || {
        for [contraction, slenderness] in &points {
            let _ = black_box(closed_form::solve(black_box(*contraction), *slenderness, 0.0));
        }
    });
    let document = json!({
        "lookup_ns": looked_up,
        "many_ns": of_many,
        "curve_ns": along_curve,
        "solve_ns": solved,
        "build_s": seconds,
        "bytes": built.bytes.len(),
        "met": built.is_met,
    });
    println!("{document}");
    Ok(())
}
