//! The domain map as a table: `cargo run --release -p bulge-validation --bin domain -- 100000 [SEED]`, with what went wrong beneath.

use bulge_validation::domain::{Count, found_by_integrals, map};
use std::process::ExitCode;

/// Questions where none are stated.
const COUNT: usize = 100_000;
/// Questions of which those that are solved are searched for by the first integrals.
const SEARCHED: usize = 150;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Option<Vec<u64>> = arguments.iter().map(|text| text.parse().ok()).collect();
    let (count, seed) = match numbers.as_deref() {
        Some([]) => (COUNT, 1),
        Some([count]) => (usize::try_from(*count).unwrap_or(COUNT), 1),
        Some([count, seed]) => (usize::try_from(*count).unwrap_or(COUNT), *seed),
        _ => {
            eprintln!("write the number of questions, and the seed if it isn't to be 1: `domain 100000 1`");
            return ExitCode::from(2);
        }
    };
    let counts = map(seed, count);
    println!(
        "{:<29} {:>9} {:>7} {:>6} {:>7} {:>6} {:>6} {:>6} {:>11}",
        "kind", "questions", "solved", "1", "3", "4", "wrong", "panic", "evaluations"
    );
    let mut whole = Count { kind: "all", ..Count::default() };
    for one in &counts {
        print(one);
        whole.solved += one.solved;
        whole.input += one.input;
        whole.no_solution += one.no_solution;
        whole.not_converged += one.not_converged;
        whole.wrong += one.wrong;
        whole.panicked += one.panicked;
        whole.evaluations = whole.evaluations.max(one.evaluations);
        for (sum, judged) in whole.judged.iter_mut().zip(one.judged) {
            *sum += judged;
        }
    }
    print(&whole);
    let [pulls, beyond, none, unknown] = whole.judged;
    println!(
        "status 4 by the first integrals: {pulls} have an equilibrium, {beyond} one that pushes or is slack, {none} none, {unknown} can't be told"
    );
    let (solved, found, missed) = found_by_integrals(seed, count.min(SEARCHED));
    println!("of {solved} that are solved the first integrals find {found}; not");
    for case in &missed {
        println!("{case}");
    }
    for one in &counts {
        for case in &one.cases {
            println!("{}: {case}", one.kind);
        }
    }
    ExitCode::SUCCESS
}

fn print(one: &Count) {
    println!(
        "{:<29} {:>9} {:>7} {:>6} {:>7} {:>6} {:>6} {:>6} {:>11}",
        one.kind,
        one.all(),
        one.solved,
        one.input,
        one.no_solution,
        one.not_converged,
        one.wrong,
        one.panicked,
        one.evaluations
    );
}
