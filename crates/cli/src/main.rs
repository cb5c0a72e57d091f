//! The command `bulge`: one file per command. This file selects the command and turns errors into messages
//! and exit statuses.

mod air;
mod arguments;
mod characteristics;
mod compare;
mod curve;
mod data;
mod demo;
mod diagnose;
mod effects;
mod failure;
mod files;
mod fit;
mod heat;
mod joint;
mod keys;
mod membrane;
mod muscle;
mod next;
mod open;
mod plan;
mod predict;
mod restricted;
mod said;
#[cfg(test)]
#[path = "../tests/program/schema.rs"]
mod schema;
mod sense;
mod shape;
mod shell;
mod simulate;
mod size;
mod sketch;
mod sweep;
mod table;
mod text;
mod validate;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

use bulge_muscles::shown::shortened;
use failure::Failure;

/// Shape, force and volume of pneumatic artificial muscles.
///
/// Pleated (PPAM) and braided (McKibben, Festo Fluidic Muscle) muscles from one meridian equation. MUSCLE is a TOML file or the name of a
/// shipped muscle (`bulge muscle` lists them).
///
/// Exit status: 0 done; 1 the input is wrong; 2 usage; 3 no solution exists; 4 it did not converge.
#[derive(Debug, Parser)]
#[command(name = "bulge", version, max_term_width = 110)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

/// Defines the commands, and how one of them is run.
macro_rules! commands {
    ($($(#[$about:meta])* $name:ident($of:ty),)*) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($(#[$about])* $name($of),)*
        }

        impl Command {
            fn run(&self) -> Result<String, Failure> {
                match self {
                    $(Self::$name(command) => command.run(),)*
                }
            }
        }
    };
}

commands! {
    /// The tour, on shipped muscles: shapes, VTK, characteristics (what runs when no command is given)
    Demo(demo::Demo),
    /// One equilibrium: force, length, volume, fibre tension, stiffness, meridian
    Shape(shape::ShapeCommand),
    /// Isobaric characteristics: force and volume over the contraction
    Curve(curve::CurveCommand),
    /// A finite-element membrane case: from a mesh to shape, force, wrinkles and VTK
    Membrane(membrane::MembraneCommand),
    /// A parallel, resumable sweep of a family of muscles, into Parquet files and a certified table
    Sweep(sweep::SweepCommand),
    /// Look into a table: values, gradients, certified errors
    Table(table::TableCommand),
    /// The workbench: a page in the browser that compares, live
    Open(open::OpenCommand),
    /// Model against measurement: where it fails, and how the error falls as effects are added
    Compare(compare::CompareCommand),
    /// From a load over a stroke to muscles, lengths and pressures
    Size(Box<size::SizeCommand>),
    /// The air in a muscle: shut in, flowing through a valve, used in a stroke
    Air(Box<air::AirCommand>),
    /// A channel of liquid metal around a muscle: resistance against contraction
    Sense(Box<sense::SenseCommand>),
    /// How warm a muscle gets that is charged again and again
    Heat(Box<heat::HeatCommand>),
    /// Two antagonistic muscles on a joint: angle, torque, stiffness, pressures
    Joint(Box<joint::JointCommand>),
    /// Which physical effect is missing, and how sure that is
    Diagnose(diagnose::DiagnoseCommand),
    /// Fit effects to measurements, and write the muscle with what was learnt
    Fit(fit::FitCommand),
    /// Before measuring: detection limits, and which effects a test could not tell apart
    Plan(plan::PlanCommand),
    /// A (learnt) muscle on new rows: the force with intervals, and residuals where a force was measured
    Predict(predict::PredictCommand),
    /// The next experiment, which best separates the effects that measurements leave open
    Next(next::NextCommand),
    /// Synthetic measurements with chosen (hidden) effects, noise and rig errors
    Simulate(simulate::SimulateCommand),
    /// The catalogue of physical effects, and of the papers' force laws
    Effects(effects::EffectsCommand),
    /// Shipped muscles: list them, or print one as a file to start from
    Muscle(muscle::MuscleCommand),
    /// The verification tables: every check, its error, its tolerance
    Validate(validate::Validate),
    /// A file with every key, and what each means: muscle, data, sweep and others
    Keys(keys::KeysCommand),
    /// Completions for a shell
    Completions(shell::CompletionsCommand),
    /// Manual pages
    Man(shell::ManCommand),
}

/// Exit status for a wrong command line, the same as clap's.
const USAGE: u8 = 2;

fn main() -> ExitCode {
    let given = match said::arguments(std::env::args_os()) {
        Ok(given) => given,
        Err(argument) => {
            return refuse(&format!(
                "error: the argument `{}` has control characters: rename the file, or write it without",
                shortened(&argument)
            ));
        }
    };
    files::named(&given);
    let arguments = match Arguments::try_parse_from(given) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version arrive here too; they go to standard output with status 0, and in colour to a
            // terminal.
            if !error.use_stderr() {
                let _ = error.print();
                return ExitCode::SUCCESS;
            }
            return refuse(error.to_string().trim_end());
        }
    };
    let command = arguments.command.unwrap_or(Command::Demo(demo::Demo::default()));
    // The command runs on a thread of the pool, as the computations do: input and results then share its
    // heap.
    let outcome = rayon::scope(|_| command.run());
    let said =
        |text: &str| if files::stdout_is_taken() { Ok(()) } else { said::answer(text).map_err(unwritten) };
    match outcome.and_then(|text| said(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // If this can't be written either, nothing more can be done.
            let _ = said(&failure.answer());
            said::message(&format!("error: {failure}\n"));
            ExitCode::from(failure.status())
        }
    }
}

/// Rejects the command line.
fn refuse(message: &str) -> ExitCode {
    said::message(&format!("{message}\n"));
    if failure::wants_json() {
        let _ = said::answer(&failure::document(message, USAGE));
    }
    ExitCode::from(USAGE)
}

fn unwritten(source: std::io::Error) -> Failure {
    Failure::Output { path: "standard output".into(), source }
}
