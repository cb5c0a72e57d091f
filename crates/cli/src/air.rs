//! `bulge air`: the air in a muscle, shut in, flowing through a valve, and used in a cycle.

use bulge_design::Lines;
use bulge_design::gas::{
    CycleResult, FillQuestion, History, Moves, ShutAnswer, ShutQuestion, StrokeQuestion, Valve,
};
use bulge_model::MuscleWithEffects;
use bulge_muscles::units::Quantity;
use bulge_muscles::{Force, Length, Pressure, Ratio, Volume};
use bulge_report::lines_svg;
use clap::{Args, Subcommand};
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, TIME, extended, in_unit, pretty, quantity, range};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, table, with_units};

/// Units of a sonic conductance, l/(s bar) = 1e-8 m^3/(s Pa).
const CONDUCTANCE: [(&str, f64); 2] = [("l/(s bar)", 1e-8), ("m^3/(s Pa)", 1.0)];
/// Rows of the table.
const ROWS: usize = 11;
/// The air in a muscle: shut in, flowing through a valve, and used in a cycle.
#[derive(Debug, Args)]
pub(crate) struct AirCommand {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// The valve shut: pressure, force and stiffness against contraction
    Shut(Shut),
    /// Filling or venting over time, through an orifice after ISO 6358, against a load
    Fill(Fill),
    /// Air, energy and efficiency of a stroke
    Stroke(Cycle),
}

/// What all take.
#[derive(Debug, Args)]
struct Common {
    /// Muscle file, or name of a shipped muscle
    muscle: String,
    /// Dead volume of fittings and tubes
    #[arg(long, default_value = "0 ml", allow_hyphen_values = true)]
    dead_volume: String,
    /// Your own effects, where the muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

#[derive(Debug, Args)]
struct Shut {
    #[command(flatten)]
    common: Common,
    /// Gauge pressure when it is shut
    #[arg(long, allow_hyphen_values = true)]
    pressure: String,
    /// Contraction when it is shut
    #[arg(long, allow_hyphen_values = true)]
    contraction: String,
    /// Contractions to look at [default: 5 % about that]
    #[arg(long, allow_hyphen_values = true)]
    range: Option<String>,
    /// From 1 (slow: isothermal) to 1.4 (fast: adiabatic)
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true)]
    exponent: f64,
    /// Also the contraction under a force
    #[arg(long, allow_hyphen_values = true)]
    force: Option<String>,
    /// Draw the force with the valve shut and open
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct Fill {
    #[command(flatten)]
    common: Common,
    /// Gauge pressure of the supply; "0 bar" vents to the ambient
    #[arg(long, allow_hyphen_values = true)]
    supply: String,
    /// Volume of the supply's vessel, if it is none with a constant pressure
    #[arg(long, allow_hyphen_values = true)]
    vessel: Option<String>,
    /// Gauge pressure in the muscle at the start
    #[arg(long, default_value = "0 bar", allow_hyphen_values = true)]
    start: String,
    /// Sonic conductance of the valve, such as "2 l/(s bar)"
    #[arg(long, conflicts_with = "hole", required_unless_present = "hole", allow_hyphen_values = true)]
    conductance: Option<String>,
    /// Its critical pressure ratio
    #[arg(long, default_value_t = 0.3, conflicts_with = "hole", allow_hyphen_values = true)]
    critical_ratio: f64,
    /// A sharp hole of this diameter in place of a data sheet
    #[arg(long, allow_hyphen_values = true)]
    hole: Option<String>,
    /// The muscle is held at this contraction
    #[arg(long, allow_hyphen_values = true, required_unless_present = "load", conflicts_with = "load")]
    held: Option<String>,
    /// It lifts this force
    #[arg(long, allow_hyphen_values = true)]
    load: Option<String>,
    /// from a support at this contraction [default: 0 for a braid, none for a pleated muscle, which needs none]
    #[arg(long, allow_hyphen_values = true, requires = "load")]
    support: Option<String>,
    /// The gas keeps its heat; otherwise its temperature
    #[arg(long)]
    adiabatic: bool,
    /// The longest time
    #[arg(long, default_value = "60 s", allow_hyphen_values = true)]
    longest: String,
    /// Write all moments as CSV ("-": to standard output)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw pressure and contraction against time
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct Cycle {
    #[command(flatten)]
    common: Common,
    /// Load that is lifted
    #[arg(long, allow_hyphen_values = true)]
    load: String,
    /// From which contraction to which, such as "5 %..20 %"
    #[arg(long, allow_hyphen_values = true)]
    stroke: String,
    /// Gauge pressure of the supply
    #[arg(long, allow_hyphen_values = true)]
    supply: String,
    /// Filled to this gauge pressure while held, and moved at it; otherwise the pressure rises with the load
    #[arg(long, allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Draw the pressure on the way up
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
}

impl AirCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        match &self.what {
            What::Shut(shut) => shut.run(),
            What::Fill(fill) => fill.run(),
            What::Stroke(cycle) => cycle.run(),
        }
    }
}

impl Common {
    fn muscle(&self) -> Result<(String, MuscleWithEffects), Failure> {
        let (muscle, extended) = extended(&self.muscle, self.effects.as_deref(), None)?;
        Ok((muscle.name().to_owned(), extended))
    }

    fn dead(&self) -> Result<f64, Failure> {
        Ok(quantity::<Volume>("--dead-volume", &self.dead_volume)?.si())
    }
}

/// A drawing as an SVG document.
fn svg(drawing: &Lines) -> Result<String, Failure> {
    Ok(lines_svg(&drawing.title, drawing.axes, &drawing.lines)?)
}

impl Shut {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let question = self.question()?;
        let found = question.answer(&muscle)?;
        let wrote =
            files::wrote(self.plot.as_deref(), || svg(&found.drawing(&muscle, question.pressure_pa)?))?;
        if self.common.json.wanted {
            return pretty(&serde_json::to_value(&found)?);
        }
        Ok(shut(&name, &question, &found) + &wrote)
    }

    fn question(&self) -> Result<ShutQuestion, Failure> {
        let pressure_pa = quantity::<Pressure>("--pressure", &self.pressure)?.si();
        let contraction = quantity::<Ratio>("--contraction", &self.contraction)?.si();
        let dead_volume_m3 = self.common.dead()?;
        let force = self.force.as_deref().map(|text| quantity::<Force>("--force", text)).transpose()?;
        Ok(ShutQuestion {
            pressure_pa,
            contraction,
            range: self.range.as_deref().map(|text| range::<Ratio>("--range", text)).transpose()?,
            exponent: self.exponent,
            force_n: force.map(Quantity::si),
            dead_volume_m3,
        })
    }
}

fn shut(name: &str, question: &ShutQuestion, found: &ShutAnswer) -> String {
    let mut text = format!(
        "{name}, shut at {} % and {} bar with {} g of air, exponent {}\n\n",
        significant(100.0 * question.contraction, 4),
        significant(1e-5 * question.pressure_pa, 4),
        significant(1e3 * found.mass_kg, 4),
        significant(question.exponent, 3)
    );
    let heading = ["contraction", "pressure", "force", "volume", "stiffness", "of geometry", "of the gas"];
    let units = ["%", "bar", "N", "ml", "N/mm", "N/mm", "N/mm"];
    let rows = found.states.iter().map(|at| {
        let (state, split) = (&at.state, &at.stiffness);
        [
            significant(100.0 * state.contraction, 4),
            significant(1e-5 * state.pressure_pa, 4),
            significant(state.force_n, 4),
            significant(1e6 * state.response.volume_m3, 4),
            significant(1e-3 * split.total_n_per_m, 4),
            significant(1e-3 * split.geometry_n_per_m, 4),
            significant(1e-3 * split.gas_n_per_m, 4),
        ]
    });
    text.push_str(&with_units(heading, units, rows));
    if let Some(state) = &found.under_force {
        let _ = writeln!(
            text,
            "\n  under {} N it stands at {} % and {} bar",
            significant(state.force_n, 4),
            significant(100.0 * state.contraction, 4),
            significant(1e-5 * state.pressure_pa, 4)
        );
    }
    text
}

impl Fill {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let question = self.question()?;
        let found = question.answer(&muscle)?;
        let wanted = [self.csv.as_deref(), self.plot.as_deref()];
        let wrote = files::wrote_both(wanted, || csv(&found.filling), || svg(&found.drawing()))?;
        if self.common.json.wanted {
            return pretty(&serde_json::to_value(&found)?);
        }
        let mut text = told(&name, &found.filling);
        if let (Moves::Lifts { force_n: load, .. }, Some(last)) =
            (question.moves, found.filling.samples.last())
            && last.force_n < (1.0 - 1e-6) * load
            && last.pressure_pa > 0.0
        {
            let _ = writeln!(
                text,
                "  the load isn't lifted: on its support the muscle pulls {} N in the end",
                significant(last.force_n, 4)
            );
        }
        Ok(text + &wrote)
    }

    fn question(&self) -> Result<FillQuestion, Failure> {
        let supply_pa = quantity::<Pressure>("--supply", &self.supply)?.si();
        let vessel = self.vessel.as_deref().map(|text| quantity::<Volume>("--vessel", text)).transpose()?;
        let valve = match (&self.hole, &self.conductance) {
            (Some(hole), _) => Valve::Hole(quantity::<Length>("--hole", hole)?.si()),
            (None, Some(text)) => Valve::Sheet {
                conductance: in_unit("--conductance", text, &CONDUCTANCE)?,
                critical_ratio: self.critical_ratio,
            },
            (None, None) => {
                return Err(missing("--conductance", "a valve is needed: give --conductance or --hole"));
            }
        };
        let moves = match (&self.held, &self.load) {
            (Some(held), _) => Moves::Held(quantity::<Ratio>("--held", held)?.si()),
            (None, Some(load)) => {
                let force_n = quantity::<Force>("--load", load)?.si();
                let support =
                    self.support.as_deref().map(|text| quantity::<Ratio>("--support", text)).transpose()?;
                Moves::Lifts { force_n, support: support.map(Quantity::si) }
            }
            (None, None) => return Err(missing("--load", "a load is needed: give --load or --held")),
        };
        Ok(FillQuestion {
            supply_pa,
            vessel_m3: vessel.map(Quantity::si),
            start_pa: quantity::<Pressure>("--start", &self.start)?.si(),
            valve,
            moves,
            is_adiabatic: self.adiabatic,
            longest_s: in_unit("--longest", &self.longest, &TIME)?,
            dead_volume_m3: self.common.dead()?,
        })
    }
}

fn missing(option: &'static str, what: &str) -> Failure {
    Failure::Value { option, what: what.to_owned() }
}

fn told(name: &str, history: &History) -> String {
    let mut text = format!("{name}\n\n");
    let heading = ["time", "pressure", "contraction", "force", "volume", "air", "temperature", "flow"];
    let units = ["s", "bar", "%", "N", "ml", "g", "K", "g/s"];
    let every = history.samples.len().saturating_sub(1).div_ceil(ROWS - 1).max(1);
    let mut kept: Vec<_> = history.samples.iter().step_by(every).collect();
    if let (Some(last), false) = (history.samples.last(), (history.samples.len() - 1).is_multiple_of(every)) {
        kept.push(last);
    }
    let rows = kept.into_iter().map(|at| {
        [
            significant(at.time_s, 4),
            // A tiny pressure at the start is rounding.
            if at.pressure_pa.abs() < 1e-6 { "0".to_owned() } else { significant(1e-5 * at.pressure_pa, 4) },
            significant(100.0 * at.contraction, 4),
            significant(at.force_n, 4),
            significant(1e6 * at.volume_m3, 4),
            significant(1e3 * at.mass_kg, 4),
            significant(at.temperature_k, 4),
            significant(1e3 * at.flow_kg_per_s, 3),
        ]
    });
    text.push_str(&with_units(heading, units, rows));
    let after = |time: Option<f64>| {
        time.map_or("not reached".to_owned(), |time| format!("after {} s", significant(time, 4)))
    };
    let _ = writeln!(
        text,
        "\n  90 % of the change of pressure {}, 99 % {}{}",
        after(history.time_90_s),
        after(history.time_99_s),
        if history.settled { "" } else { "; it has not settled" }
    );
    if history.samples.iter().any(|at| at.force_n < -1e-6) {
        text.push_str(
            "  where the force is negative the muscle pushes on what holds it, as far as it doesn't buckle\n",
        );
    }
    let litres = history.air_kg / bulge_design::gas::REFERENCE_DENSITY * 1e3;
    let _ = writeln!(
        text,
        "  {} g of air, {} litres (ANR)",
        significant(1e3 * history.air_kg, 4),
        significant(litres, 4)
    );
    text
}

fn csv(history: &History) -> String {
    let mut text = "time [s],pressure [Pa],contraction [-],force [N],volume [m^3],mass [kg],temperature [K],flow [kg/s]\n".to_owned();
    for at in &history.samples {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            at.time_s,
            at.pressure_pa,
            at.contraction,
            at.force_n,
            at.volume_m3,
            at.mass_kg,
            at.temperature_k,
            at.flow_kg_per_s
        );
    }
    text
}

impl Cycle {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let question = self.question()?;
        let found = question.answer(&muscle)?;
        let wrote = files::wrote(self.plot.as_deref(), || svg(&question.drawing(&muscle, &found)?))?;
        let text = || spent(&name, question.load_n, &found.cycle) + &wrote;
        self.common.json.or(&serde_json::to_value(&found)?, text)
    }

    fn question(&self) -> Result<StrokeQuestion, Failure> {
        let load_n = quantity::<Force>("--load", &self.load)?.si();
        let pressure =
            self.pressure.as_deref().map(|text| quantity::<Pressure>("--pressure", text)).transpose()?;
        Ok(StrokeQuestion {
            load_n,
            pressure_pa: pressure.map(Quantity::si),
            supply_pa: quantity::<Pressure>("--supply", &self.supply)?.si(),
            stroke: range::<Ratio>("--stroke", &self.stroke)?,
            dead_volume_m3: self.common.dead()?,
        })
    }
}

fn spent(name: &str, load: f64, found: &CycleResult) -> String {
    let part = |energy: f64| {
        vec![
            format!("{} J", significant(energy, 4)),
            format!("{} %", significant(100.0 * energy / found.exergy_j, 3)),
        ]
    };
    let mut text = format!(
        "{name} lifts {} N by {} mm, from {} to {} bar, with {} litres of air (ANR), {} g\n\n",
        significant(load, 4),
        significant(1e3 * found.stroke_m, 4),
        significant(1e-5 * found.start_pressure_pa, 4),
        significant(1e-5 * found.end_pressure_pa, 4),
        significant(found.air_litres_anr, 4),
        significant(1e3 * found.air_kg, 4)
    );
    let rows = [
        ("exergy of the air at the supply", found.exergy_j),
        ("work on the load: the efficiency", found.work_j),
        ("work of the gas that doesn't reach it", found.not_passed_on_j),
        ("lost between supply and muscle", found.throttled_j),
        ("let out with the air", found.vented_j),
    ];
    let rows: Vec<Vec<String>> =
        rows.iter().map(|(name, energy)| [vec![(*name).to_owned()], part(*energy)].concat()).collect();
    text.push_str(&table(&rows));
    text.push_str("\n  (isothermal; the work against the atmosphere comes back and is in none of them)\n");
    text
}
