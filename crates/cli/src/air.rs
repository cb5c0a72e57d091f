//! `bulge air`: the air in a muscle, shut in, flowing through a valve, and used in a cycle.

use bulge_design::gas::{
    AMBIENT_TEMPERATURE_K, Chamber, ClosedMuscle, ClosedState, CycleResult, Filling, GasModel, History, Lift,
    Load, Orifice, StiffnessSplit, Stroke, Supply,
};
use bulge_model::MuscleWithEffects;
use bulge_muscles::units::Quantity;
use bulge_muscles::{Force, Length, Muscle, Pressure, Ratio, Volume};
use bulge_report::lines_svg;
use clap::{Args, Subcommand};
use serde_json::json;
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
/// Points of the plot of a rising load.
const RISING: u32 = 40;
/// Output times of a filling.
const SAMPLES: usize = 200;

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
    #[arg(long, value_name = "FILE.svg")]
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
    #[arg(long, value_name = "FILE.svg")]
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
    #[arg(long, value_name = "FILE.svg")]
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

impl Shut {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let pressure = quantity::<Pressure>("--pressure", &self.pressure)?.si();
        let contraction = quantity::<Ratio>("--contraction", &self.contraction)?.si();
        let closed = ClosedMuscle::new(&muscle, pressure, contraction, self.exponent)?
            .with_dead_volume(self.common.dead()?)?;
        let [from, to] = match &self.range {
            Some(text) => range::<Ratio>("--range", text)?,
            None => [contraction - 0.05, contraction + 0.05],
        };
        let mut states: Vec<(ClosedState, StiffnessSplit)> = Vec::new();
        for k in 0..ROWS {
            let at = from + (to - from) * k as f64 / (ROWS - 1) as f64;
            match closed.at_contraction(at) {
                Ok(state) => states.push((state, closed.split(&state)?)),
                // Contractions of the default range may lie outside the range of the muscle.
                Err(_) if self.range.is_none() && k != ROWS / 2 => (),
                Err(error) => return Err(error.into()),
            }
        }
        let under = self.force.as_deref().map(|text| quantity::<Force>("--force", text)).transpose()?;
        let under = under.map(|force| closed.under_force(force.si())).transpose()?;
        let wrote = files::wrote(self.plot.as_deref(), || compared(&name, &muscle, pressure, &states))?;
        if self.common.json.wanted {
            let states: Vec<_> =
                states.iter().map(|(state, split)| json!({ "state": state, "stiffness": split })).collect();
            let document = json!({
                "schema": "bulge.air/1", "muscle": name, "mass_kg": closed.mass_kg(), "exponent": self.exponent,
                "states": states, "under_force": under,
            });
            return pretty(&document);
        }
        let mut text = format!(
            "{name}, shut at {} % and {} bar with {} g of air, exponent {}\n\n",
            significant(100.0 * contraction, 4),
            significant(1e-5 * pressure, 4),
            significant(1e3 * closed.mass_kg(), 4),
            significant(self.exponent, 3)
        );
        let heading =
            ["contraction", "pressure", "force", "volume", "stiffness", "of geometry", "of the gas"];
        let units = ["%", "bar", "N", "ml", "N/mm", "N/mm", "N/mm"];
        let rows = states.iter().map(|(state, split)| {
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
        if let Some(state) = under {
            let _ = writeln!(
                text,
                "\n  under {} N it stands at {} % and {} bar",
                significant(state.force_n, 4),
                significant(100.0 * state.contraction, 4),
                significant(1e-5 * state.pressure_pa, 4)
            );
        }
        Ok(text + &wrote)
    }
}

/// Plot of the force with the valve shut, and at the pressure of the filling.
fn compared(
    title: &str,
    muscle: &MuscleWithEffects,
    pressure: f64,
    states: &[(ClosedState, StiffnessSplit)],
) -> Result<String, Failure> {
    let shut = states.iter().map(|(state, _)| [100.0 * state.contraction, state.force_n]).collect();
    let mut open = Vec::new();
    for (state, _) in states {
        let given = bulge_fibre::Given::Contraction(state.contraction);
        let found = muscle.solve(Pressure::pa(pressure), given, bulge_fibre::Approach::Auto)?;
        open.push([100.0 * state.contraction, found.force_n]);
    }
    let lines = [("valve open".to_owned(), open), ("valve shut".to_owned(), shut)];
    Ok(lines_svg(title, ["contraction [%]", "force [N]"], &lines)?)
}

impl Fill {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let history = self.filling(&muscle)?.run()?;
        let wanted = [self.csv.as_deref(), self.plot.as_deref()];
        let wrote = files::wrote_both(wanted, || csv(&history), || drawn(&name, &history))?;
        if self.common.json.wanted {
            let document = json!({ "schema": "bulge.filling/1", "muscle": name, "filling": history });
            return pretty(&document);
        }
        let mut text = told(&name, &history);
        if let (Some(load), Some(last)) = (&self.load, history.samples.last()) {
            let load = quantity::<Force>("--load", load)?.si();
            if last.force_n < (1.0 - 1e-6) * load && last.pressure_pa > 0.0 {
                let _ = writeln!(
                    text,
                    "  the load isn't lifted: on its support the muscle pulls {} N in the end",
                    significant(last.force_n, 4)
                );
            }
        }
        Ok(text + &wrote)
    }

    /// A hole, which must fit into the end of the muscle.
    fn hole(muscle: &Muscle, text: &str) -> Result<Orifice, Failure> {
        let diameter = quantity::<Length>("--hole", text)?.si();
        let most = 2.0 * muscle.end_radius().si();
        if diameter > most {
            let what = format!(
                "a hole of {} mm is wider than the end of {}, {} mm: give its diameter, such as \"2 mm\"",
                significant(1e3 * diameter, 4),
                muscle.name(),
                significant(1e3 * most, 4)
            );
            return Err(Failure::Value { option: "--hole", what });
        }
        Ok(Orifice::hole(diameter)?)
    }

    fn filling<'a>(&self, muscle: &'a MuscleWithEffects) -> Result<Filling<'a>, Failure> {
        let pressure_pa = quantity::<Pressure>("--supply", &self.supply)?.si();
        let temperature_k = AMBIENT_TEMPERATURE_K;
        let vessel = self.vessel.as_deref().map(|text| quantity::<Volume>("--vessel", text)).transpose()?;
        let supply = match vessel {
            Some(volume) => Supply::Vessel { pressure_pa, temperature_k, volume_m3: volume.si() },
            None => Supply::Constant { pressure_pa, temperature_k },
        };
        let orifice = match (&self.hole, &self.conductance) {
            (Some(hole), _) => Self::hole(muscle.muscle(), hole)?,
            (None, Some(text)) => {
                Orifice::new(in_unit("--conductance", text, &CONDUCTANCE)?, self.critical_ratio)?
            }
            (None, None) => {
                return Err(missing("--conductance", "a valve is needed: give --conductance or --hole"));
            }
        };
        let load = match (&self.held, &self.load) {
            (Some(held), _) => Load::Held(quantity::<Ratio>("--held", held)?.si()),
            (None, Some(load)) => Load::Force(quantity::<Force>("--load", load)?.si()),
            (None, None) => return Err(missing("--load", "a load is needed: give --load or --held")),
        };
        let mut chamber = Chamber::muscle(muscle, load)?.with_dead_volume(self.common.dead()?)?;
        let support = self.support.as_deref().map(|text| quantity::<Ratio>("--support", text)).transpose()?;
        // A braid without pressure carries nothing: its load stands on a support where the muscle has its
        // rest length.
        let stands = !muscle.muscle().is_pleated() && self.load.is_some();
        if let Some(support) = support.map(Quantity::si).or(stands.then_some(0.0)) {
            chamber = chamber.on_support(support)?;
        }
        Ok(Filling {
            chamber,
            orifice,
            supply,
            gas: if self.adiabatic { GasModel::adiabatic() } else { GasModel::Isothermal },
            start_pressure_pa: quantity::<Pressure>("--start", &self.start)?.si(),
            start_temperature_k: temperature_k,
            longest_s: in_unit("--longest", &self.longest, &TIME)?,
            samples: SAMPLES,
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

/// Plot of the pressure in bar and the contraction in 10 % on one axis.
fn drawn(title: &str, history: &History) -> Result<String, Failure> {
    let line = |name: &str, read: &dyn Fn(&bulge_design::gas::Sample) -> f64| {
        (name.to_owned(), history.samples.iter().map(|at| [at.time_s, read(at)]).collect::<Vec<_>>())
    };
    let lines = [
        line("contraction [10 %]", &|at| 10.0 * at.contraction),
        line("pressure [bar]", &|at| 1e-5 * at.pressure_pa),
    ];
    Ok(lines_svg(title, ["time [s]", "pressure [bar], contraction [10 %]"], &lines)?)
}

impl Cycle {
    fn run(&self) -> Result<String, Failure> {
        let (name, muscle) = self.common.muscle()?;
        let load = quantity::<Force>("--load", &self.load)?.si();
        let lift = match &self.pressure {
            Some(text) => Lift::Isobaric { pressure_pa: quantity::<Pressure>("--pressure", text)?.si() },
            None => Lift::PressureRise,
        };
        let supply = quantity::<Pressure>("--supply", &self.supply)?.si();
        let way = range::<Ratio>("--stroke", &self.stroke)?;
        let mut stroke = Stroke::new(&muscle, load, way, lift, supply);
        stroke.dead_volume_m3 = self.common.dead()?;
        let found = stroke.cycle()?;
        let wrote = files::wrote(self.plot.as_deref(), || rising(&name, &stroke, &found))?;
        let document = json!({ "schema": "bulge.stroke/1", "muscle": name, "cycle": found });
        self.common.json.or(&document, || spent(&name, load, &found) + &wrote)
    }
}

/// Plot of the pressure as the load rises: the pressures at the end of strokes of increasing length.
fn rising(title: &str, stroke: &Stroke<'_>, found: &CycleResult) -> Result<String, Failure> {
    let mut points = vec![[100.0 * stroke.from, 1e-5 * found.start_pressure_pa]];
    for k in 1..=RISING {
        let to = stroke.from + (stroke.to - stroke.from) * f64::from(k) / f64::from(RISING);
        points.push([100.0 * to, 1e-5 * Stroke { to, ..*stroke }.cycle()?.end_pressure_pa]);
    }
    let lines = [("with the load".to_owned(), points)];
    Ok(lines_svg(title, ["contraction [%]", "pressure [bar]"], &lines)?)
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
