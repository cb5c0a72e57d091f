//! `bulge heat`: temperature of a muscle under repeated charging and discharging, with and without an inner
//! pipe.

use bulge_design::heat::{HeatProblem, HeatSolution, Pipe, trend};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Length, Pressure, Ratio};
use bulge_report::lines_svg;
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, TIME, in_unit, quantity, range};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_units};

/// Most pipes in one call.
const MOST_PIPES: usize = 100;

/// How warm a muscle gets that is charged and discharged again and again, with and without an inner pipe.
///
/// A one-dimensional balance of air, wall and pipe along the muscle, to the periodic steady state (after S3, section 4). Trends can be trusted, absolute
/// temperatures only after a measurement has fixed the coefficients of heat transfer: the documentation of `bulge-design` has them all.
#[derive(Debug, Args)]
pub(crate) struct HeatCommand {
    /// Length of the muscle
    #[arg(long, default_value = "250 mm", allow_hyphen_values = true)]
    length: String,
    /// Its inner diameter
    #[arg(long, default_value = "20 mm", allow_hyphen_values = true)]
    diameter: String,
    /// Thickness of its wall
    #[arg(long, default_value = "1.5 mm", allow_hyphen_values = true)]
    wall: String,
    /// Diameter of the port through which it is charged without a pipe
    #[arg(long, default_value = "6 mm", allow_hyphen_values = true)]
    port: String,
    /// Gauge pressures between which it is charged and discharged
    #[arg(long, default_value = "0 bar..5 bar", allow_hyphen_values = true)]
    pressure: String,
    /// Duration of a cycle
    #[arg(long, default_value = "1 s", allow_hyphen_values = true)]
    period: String,
    /// Duration of charging, and of discharging
    #[arg(long, default_value = "0.2 s", allow_hyphen_values = true)]
    ramp: String,
    /// Part of the cycle from the start of charging to that of discharging
    #[arg(long, default_value = "50 %", allow_hyphen_values = true)]
    duty: String,
    /// Inner pipes of nylon to compare, length x inner diameter, and `none`
    #[arg(
        long,
        default_value = "none, 100 mm x 4 mm, 200 mm x 4 mm, 200 mm x 6 mm",
        allow_hyphen_values = true
    )]
    pipe: String,
    /// Cells along the muscle
    #[arg(long, default_value_t = 40)]
    cells: usize,
    /// Draw the mean temperature of the wall along the muscle
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl HeatCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let (problem, pipes) = (self.problem()?, self.pipes()?);
        let solved = trend(&problem, &pipes);
        if let (Some(Err(error)), true) = (solved.first(), solved.iter().all(Result::is_err)) {
            return Err(error.clone().into());
        }
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            files::write(path, drawn(&problem, &pipes, &solved)?.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        let cases = pipes.iter().zip(&solved).map(|(pipe, solved)| match solved {
            Ok(solution) => json!({ "pipe": pipe, "solution": solution }),
            Err(error) => json!({ "pipe": pipe, "why": error.to_string() }),
        });
        let document = json!({
            "schema": "bulge.heat/1",
            "problem": problem,
            "cases": cases.collect::<Vec<_>>(),
        });
        self.json.or(&document, || text(&problem, &pipes, &solved) + &wrote)
    }

    fn problem(&self) -> Result<HeatProblem, Failure> {
        let length = |option, text: &str| Ok::<_, Failure>(quantity::<Length>(option, text)?.si());
        let [low, high] = range::<Pressure>("--pressure", &self.pressure)?;
        let mut problem = HeatProblem::default();
        problem.tube.length_m = length("--length", &self.length)?;
        problem.tube.inner_diameter_m = length("--diameter", &self.diameter)?;
        problem.tube.wall_thickness_m = length("--wall", &self.wall)?;
        problem.tube.port_diameter_m = length("--port", &self.port)?;
        (problem.drive.low_pa, problem.drive.high_pa) = (low, high);
        problem.drive.period_s = in_unit("--period", &self.period, &TIME)?;
        problem.drive.ramp_s = in_unit("--ramp", &self.ramp, &TIME)?;
        problem.drive.duty = quantity::<Ratio>("--duty", &self.duty)?.si();
        problem.numerics.cells = self.cells;
        Ok(problem)
    }

    fn pipes(&self) -> Result<Vec<Option<Pipe>>, Failure> {
        let words: Vec<&str> = self.pipe.split(',').map(str::trim).collect();
        if words.len() > MOST_PIPES {
            let what = format!("{} pipes: at most {MOST_PIPES} in one call", words.len());
            return Err(Failure::Value { option: "--pipe", what });
        }
        words
            .into_iter()
            .map(|word| {
                if word == "none" {
                    return Ok(None);
                }
                let Some((length, diameter)) = word.split_once('x') else {
                    let what = format!("`{word}` is no pipe: write length x inner diameter, such as \"200 mm x 4 mm\", or none");
                    return Err(Failure::Value { option: "--pipe", what });
                };
                let one = |text: &str| Ok::<_, Failure>(quantity::<Length>("--pipe", text.trim())?.si());
                Ok(Some(Pipe::nylon(one(length)?, one(diameter)?)))
            })
            .collect()
    }
}

type Solved = Result<HeatSolution, bulge_design::heat::HeatError>;

fn name(pipe: Option<&Pipe>) -> String {
    pipe.map_or("none".to_owned(), |pipe| {
        format!(
            "{} x {} mm",
            significant(1e3 * pipe.length_m, 3),
            significant(1e3 * pipe.inner_diameter_m, 2)
        )
    })
}

fn text(problem: &HeatProblem, pipes: &[Option<Pipe>], solved: &[Solved]) -> String {
    let (tube, drive) = (problem.tube, problem.drive);
    let mut text = format!(
        "a muscle of {} mm, {} mm wide, charged from {} to {} bar every {} s; mean wall temperatures above the ambient\n\n",
        significant(1e3 * tube.length_m, 4),
        significant(1e3 * tube.inner_diameter_m, 3),
        significant(1e-5 * drive.low_pa, 3),
        significant(1e-5 * drive.high_pa, 3),
        significant(drive.period_s, 3)
    );
    let heading = ["pipe", "closed end", "inlet", "hottest", "there", "90 % after", "ageing", "heat a cycle"];
    let units = ["", "K", "K", "K", "mm", "s", "times", "J"];
    let mut rows = Vec::new();
    let mut failed = String::new();
    for (pipe, solved) in pipes.iter().zip(solved) {
        let name = name(pipe.as_ref());
        match solved {
            Ok(found) => rows.push([
                name,
                significant(found.end_rise_k, 3),
                significant(found.inlet_rise_k, 3),
                significant(found.hottest_rise_k, 3),
                significant(1e3 * found.hottest_x_m, 3),
                significant(found.time_to_90_s, 3),
                significant(found.ageing_factor, 2),
                significant(found.heat_out_j, 3),
            ]),
            Err(error) => {
                let _ = writeln!(failed, "  {name}: {error}");
            }
        }
    }
    text.push_str(&with_units(heading, units, rows));
    text.push_str(&failed);
    text.push_str(
        "\n  First order in the cells: at 40 the end without pipe is some 10 % low, and the ageing there by a factor of two; --cells 160 takes seconds a pipe.\n  ageing: how many times faster the rubber ages at its worst place than at the ambient temperature; no life.\n  Compare designs with this; absolute temperatures hold only after a measurement has fixed the coefficients.\n",
    );
    text
}

fn drawn(problem: &HeatProblem, pipes: &[Option<Pipe>], solved: &[Solved]) -> Result<String, Failure> {
    let ambient = problem.surroundings.ambient_k;
    let mut lines = Vec::new();
    for (pipe, found) in
        pipes.iter().zip(solved).filter_map(|(pipe, found)| Some((pipe, found.as_ref().ok()?)))
    {
        let places = found.muscle.x_m.iter().zip(&found.muscle.wall_mean_k);
        let points = places.map(|(x, wall)| [1e3 * x, wall - ambient]).collect();
        lines.push((name(pipe.as_ref()), points));
    }
    Ok(lines_svg("wall above the ambient, by inner pipe", ["from the inlet [mm]", "rise [K]"], &lines)?)
}
