//! Counts invariants of random equilibria and random diagnoses, and the rate at which a diagnosis says the
//! same of half of its rows: `cargo run --release -p bulge-validation --bin invariants -- equilibria 100000
//! [SEED]`, or `-- decisions 200 [SEED]`.

use bulge_inference::{Verdict, wilson};
use bulge_validation::decisions::{Case, asked, checked, drawn, half, summary, thinned};
use bulge_validation::domain;
use bulge_validation::sample::Sampler;
use rayon::prelude::*;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize| arguments.get(place).map_or(Some(1), |text| text.parse().ok());
    let asked = (arguments.first().map(String::as_str), number(1), number(2), arguments.len());
    match asked {
        (Some("equilibria"), Some(count), Some(seed), 2 | 3) => equilibria(count, seed),
        (Some("decisions"), Some(count), Some(seed), 2 | 3) => decisions(count, seed),
        _ => {
            eprintln!(
                "write what is counted, how many, and the seed if it isn't to be 1: `invariants equilibria 100000 1`, `invariants decisions 200`"
            );
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// Random bytes of case `number`.
fn bytes(seed: u64, number: u64) -> Vec<u8> {
    let mut sampler = Sampler::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(number));
    (0..80).map(|_| u8::try_from(sampler.below(256)).unwrap_or(0)).collect()
}

fn equilibria(count: u64, seed: u64) {
    let found: Vec<_> =
        (0..count).into_par_iter().map(|number| domain::equilibria(&bytes(seed, number))).collect();
    let all: u64 = found.iter().flatten().map(|count| u64::from(*count)).sum();
    let broken: Vec<_> = found.iter().filter_map(|found| found.as_ref().err()).collect();
    println!("{count} questions, {all} equilibria, {} broken invariants", broken.len());
    for one in broken {
        println!("{}", one.0);
    }
}

/// Whether less data say the same: of tests whose whole data name an effect, the part that names the same;
/// and of those that name none, the part that names none either.
#[derive(Default)]
struct Rate {
    same: usize,
    other: usize,
    silent: usize,
}

impl Rate {
    fn add(&mut self, whole: &(Verdict, Vec<String>), less: &(Verdict, Vec<String>)) {
        if whole.1 == less.1 {
            self.same += 1;
        } else if less.1.is_empty() {
            self.silent += 1;
        } else {
            self.other += 1;
        }
    }

    fn print(&self, what: &str) {
        let all = self.same + self.other + self.silent;
        let share = |count: usize| {
            let [low, high] = wilson(count, all).map(|end| 100.0 * end);
            format!("{:.0} % ({low:.0} to {high:.0})", 100.0 * count as f64 / all.max(1) as f64)
        };
        println!(
            "| {what} | {all} | {} | {} | {} |",
            share(self.same),
            share(self.silent),
            share(self.other)
        );
    }
}

/// Invariants of a test, and the answers to all of it, to every second row, and to each half.
type Answers = (Result<u32, String>, [Option<(Verdict, Vec<String>)>; 4]);

fn answers(case: &Case) -> Answers {
    let data = [Ok(case.data.clone()), thinned(&case.data), half(&case.data, false), half(&case.data, true)];
    let answer = data.map(|data| {
        let found = asked(case, &data.ok()?).ok()?;
        let (verdict, names) = summary(&found);
        Some((verdict, names.into_iter().map(str::to_owned).collect()))
    });
    (checked(case), answer)
}

fn decisions(count: u64, seed: u64) {
    let found: Vec<_> = (0..count)
        .into_par_iter()
        .filter_map(|number| {
            let case = drawn(&mut Sampler::of_bytes(&bytes(seed, number)))?;
            let answers = answers(&case);
            Some((number, case.hidden, answers))
        })
        .collect();
    let mut named: [Rate; 3] = Default::default();
    let mut quiet: [Rate; 3] = Default::default();
    let (mut diagnoses, mut broken) = (0, Vec::new());
    for (number, hidden, (checked, answers)) in &found {
        match checked {
            Ok(count) => diagnoses += count,
            Err(what) => broken.push(format!("number {number}, hidden `{hidden}`: {what}")),
        }
        let [Some(whole), less @ ..] = answers else { continue };
        let rates = if whole.1.is_empty() { &mut quiet } else { &mut named };
        for (rate, less) in rates.iter_mut().zip(less) {
            if let Some(less) = less {
                diagnoses += 1;
                rate.add(whole, less);
            }
        }
    }
    println!("{} tests, {diagnoses} diagnoses, {} broken invariants", found.len(), broken.len());
    println!("| less data | tests | the same names | none | other names |");
    println!("|---|---|---|---|---|");
    for (kind, rates) in [("named", &named), ("none named", &quiet)] {
        for (what, rate) in ["every second row", "the first half", "the second half"].iter().zip(rates) {
            rate.print(&format!("{kind}: {what}"));
        }
    }
    for one in broken {
        println!("{one}");
    }
}
