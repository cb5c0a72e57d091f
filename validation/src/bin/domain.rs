//! Prints the domain map as a table, followed by the failed cases:
//! `cargo run --release -p bulge-validation --bin domain -- 100000 [SEED]`. It can also list some of the
//! questions one by one: `domain 51553..51554 [SEED]`.

use bulge_validation::domain::{Count, found_by_integrals, listed, map};
use std::ops::Range;
use std::process::ExitCode;

/// Default number of questions.
const COUNT: usize = 100_000;
/// Number of questions whose solutions are also searched for by the first integrals.
const SEARCHED: usize = 150;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some((range, seed)) = asked_one_by_one(&arguments) {
        for line in listed(seed, range) {
            println!("{line}");
        }
        return ExitCode::SUCCESS;
    }
    let numbers: Option<Vec<u64>> = arguments.iter().map(|text| text.parse().ok()).collect();
    let (count, seed) = match numbers.as_deref() {
        Some([]) => (COUNT, 1),
        Some([count]) => (usize::try_from(*count).unwrap_or(COUNT), 1),
        Some([count, seed]) => (usize::try_from(*count).unwrap_or(COUNT), *seed),
        _ => {
            eprintln!(
                "write the number of questions, or some of them as a range, and the seed if it isn't to be 1: `domain 100000 1`, `domain 25318..25319`"
            );
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

/// A range of questions, with the seed.
fn asked_one_by_one(arguments: &[String]) -> Option<(Range<usize>, u64)> {
    let (range, seed) = match arguments {
        [range] => (range, 1),
        [range, seed] => (range, seed.parse().ok()?),
        _ => return None,
    };
    let (from, to) = range.split_once("..")?;
    Some((from.parse().ok()?..to.parse().ok()?, seed))
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
