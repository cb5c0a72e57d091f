//! `bulge heat`: temperature of a muscle under repeated charging and discharging, with and without an inner
//! pipe.

use bulge_design::heat::{HeatAnswer, HeatProblem, HeatQuestion, Pipe, pipe_name};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Length, Pressure, Ratio};
use bulge_report::lines_svg;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, TIME, in_unit, quantity, range};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_units};

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
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl HeatCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let found = HeatQuestion { problem: self.problem()?, pipes: self.pipes()? }.answer()?;
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            let drawing = found.drawing();
            let svg = lines_svg(&drawing.title, drawing.axes, &drawing.lines)?;
            files::write(path, svg.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        self.json.or(&serde_json::to_value(found.document())?, || text(&found) + &wrote)
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
        self.pipe
            .split(',')
            .map(str::trim)
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

fn text(found: &HeatAnswer) -> String {
    let (tube, drive) = (found.question.problem.tube, found.question.problem.drive);
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
    for (pipe, solved) in found.cases() {
        let name = pipe_name(pipe);
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
