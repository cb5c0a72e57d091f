//! Force at a million pairs of contraction and slenderness. The Python package is measured against it.
//!
//! ```text
//! cargo run --release -p bulge-sweep --example pairs -- PAIRS.f64 [RUNS]
//! ```
//! `PAIRS.f64` holds all contractions, then all slendernesses, as little-endian doubles. The program prints
//! the seconds of each run, and the sum of the forces.

use bulge_fibre::Approach;
use bulge_muscles::preset;
use bulge_sweep::plan::Quantity;
use bulge_sweep::{Family, Output, Values, evaluate};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name a file of pairs")?;
    let runs: usize = arguments.next().map_or(Ok(1), |runs| runs.parse())?;
    let bytes = std::fs::read(path)?;
    let numbers: Vec<f64> = bytes
        .chunks_exact(8)
        .map(|chunk| chunk.try_into().map(f64::from_le_bytes))
        .collect::<Result<_, _>>()?;
    let (contraction, slenderness) = numbers.split_at(numbers.len() / 2);
    let axes = vec![Quantity::Contraction, Quantity::Slenderness];
    let family = Family::of(&preset("ppam-2-r16")?, Vec::new(), 1e5, Approach::Auto, axes)?;
    for _ in 0..runs {
        let started = Instant::now();
        let values = [Values::Each(contraction), Values::Each(slenderness)];
        let points = evaluate(&family, &values, contraction.len(), &[Output::Force], 1, &|_| ());
        let seconds = started.elapsed().as_secs_f64();
        println!("{seconds:.6} {:.6}", points.outputs[0].iter().sum::<f64>());
    }
    Ok(())
}
