//! Times membrane cases of `meshes/`, and reports their errors and the distribution of the time in a Newton
//! iteration.
//!
//! It prints one line per case: name, unknowns, states, iterations, seconds, then the shares of elements,
//! factors and solving, and the error.

use bulge_benches::Failure;
use bulge_membrane::case::{Case, Row};
use std::path::Path;
use std::time::Instant;

/// A case with changes to its text; its error is computed from the last row.
struct Question {
    name: &'static str,
    file: &'static str,
    changes: &'static [(&'static str, &'static str)],
    error: fn(&Row) -> String,
    /// Number of runs; the shortest counts.
    runs: usize,
}

/// Results of shooting at 1e-13.
const TUBE_FORCE: f64 = -4.509_371_885_7;
const TUBE_RADIUS: f64 = 14.138_745_874_6e-3;

fn tube(row: &Row) -> String {
    let force = row.force.unwrap_or(f64::NAN) / TUBE_FORCE - 1.0;
    let radius = 0.5 * row.diameter / TUBE_RADIUS - 1.0;
    format!("radius {radius:.1e}, force {force:.1e}")
}

fn volume(row: &Row) -> String {
    format!("V = {:.5e} m^3", row.volume)
}

fn force(row: &Row) -> String {
    format!("F = {:.2} N", row.force.unwrap_or(f64::NAN))
}

const QUESTIONS: &[Question] = &[
    Question {
        name: "tube, 30 quadratic elements of revolution",
        file: "tube.toml",
        changes: &[],
        error: tube,
        runs: 50,
    },
    Question {
        name: "tube, 200 quadratic elements of revolution",
        file: "tube.toml",
        changes: &[("[30]", "[200]")],
        error: tube,
        runs: 20,
    },
    Question {
        name: "tube, 24 x 48 cells of triangles",
        file: "tube-3d.toml",
        changes: &[],
        error: tube,
        runs: 5,
    },
    Question {
        name: "square airbag, 3200 triangles",
        file: "airbag.toml",
        changes: &[],
        error: volume,
        runs: 3,
    },
    Question {
        name: "square airbag, 12800 triangles",
        file: "airbag.toml",
        changes: &[("[40, 40]", "[80, 80]")],
        error: volume,
        runs: 1,
    },
    Question {
        name: "square airbag, 51200 triangles",
        file: "airbag.toml",
        changes: &[("[40, 40]", "[160, 160]")],
        error: volume,
        runs: 1,
    },
    Question {
        name: "pleated muscle, 18 x 60 cells, 1 to 35 % at 1, 2, 3 bar",
        file: "ppam.toml",
        changes: &[],
        error: force,
        runs: 1,
    },
    Question {
        name: "tube of triangles, 10^5 unknowns, 10 pressures",
        file: "tube-3d.toml",
        changes: &[
            ("[24, 48]", "[129, 258]"),
            ("pressure = \"30 kPa\"", "pressure = \"30 kPa\"\nstates = 10"),
        ],
        error: tube,
        runs: 1,
    },
];

fn ask(question: &Question, folder: &Path) -> Result<(), Failure> {
    let path = folder.join(question.file);
    let mut text = std::fs::read_to_string(&path)?;
    for (from, to) in question.changes {
        text = text.replace(from, to);
    }
    let mut best = f64::INFINITY;
    let mut line = String::new();
    for _ in 0..question.runs {
        let clock = Instant::now();
        let case = Case::from_toml(&text, question.file, Some(folder))?;
        let mut run = case.start()?;
        let row = run.last_row(|_| ())?;
        let time = clock.elapsed().as_secs_f64();
        if time < best {
            best = time;
            let effort = run.effort();
            let share = |part: std::time::Duration| 100.0 * part.as_secs_f64() / time;
            line = format!(
                "{}\t{}\t{}\t{}\t{time:.2e} s\telements {:.0} %, factors {:.0} %, solving {:.0} %\t{}",
                question.name,
                run.sizes()[0],
                case.states(),
                effort.iterations,
                share(effort.assembling),
                share(effort.factorising),
                share(effort.solving),
                (question.error)(&row)
            );
        }
    }
    println!("{line}");
    Ok(())
}

/// `membrane [PART OF A NAME]`
fn main() -> Result<(), Failure> {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../meshes");
    for question in QUESTIONS.iter().filter(|question| question.name.contains(&wanted)) {
        ask(question, &folder)?;
    }
    if let Some(peak) = bulge_benches::peak() {
        println!("peak memory, MiB\t{peak}");
    }
    Ok(())
}
