//! `bulge size`: from a load over a stroke to muscles, lengths and pressures.

use bulge_design::size::{
    Choice, Family, Given, Infeasible, Limits, LoadCase, LoadPoint, Requirements, Sizing, Weights,
    fluidic_muscles, size,
};
use bulge_effects::known;
use bulge_effects::law::Law;
use bulge_muscles::units::Quantity;
use bulge_muscles::{Force, Length, Muscle, PRESETS, Pressure, Ratio};
use bulge_report::sizing_svg;
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, catalogue, list, muscle, pretty, quantity};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_units};

/// Weight of a kilogram \[N\].
const GRAVITY: f64 = 9.806_65;
/// Muscles considered if none is named.
const MUSCLES: &str = "dmsp-10,dmsp-20,dmsp-40,ppam-2-r16";
/// Default step of the pressure \[Pa\], and the most steps.
const PRESSURE_STEP: f64 = 5e4;
const MOST_PRESSURES: u32 = 40;
/// Default limit of the length of a muscle, in strokes.
const LONG: f64 = 10.0;
/// Most isobars of the plot, and points of each.
const MOST_ISOBARS: u32 = 8;
const DRAWN: usize = 121;

/// From a load over a stroke to muscles, lengths and pressures.
///
/// A load stands for what the muscle must pull after a travel: `--force "500 N" --stroke "50 mm"`, or `--load "0 mm: 0 N, 20 mm: 300 N, 50 mm: 500 N"`. With pressures
/// given, the shortest length is sought; with lengths given, the lowest pressure; without either, all half bars and the best compromise. Choices are
/// ranked by the strain of the muscle's life, sqrt((p/p_max)^2/2 + (contraction/largest)^2/2): low pressure and low contraction make it last.
#[derive(Debug, Args)]
pub(crate) struct SizeCommand {
    /// Force that is needed after the stroke, such as "500 N" or "50 kg"
    #[arg(long, allow_hyphen_values = true, required_unless_present = "load", conflicts_with = "load")]
    force: Option<String>,
    /// Force that is needed before it
    #[arg(long, allow_hyphen_values = true, requires = "force")]
    at_rest: Option<String>,
    /// Travel with the load, such as "50 mm"
    #[arg(long, allow_hyphen_values = true, required_unless_present = "load", conflicts_with = "load")]
    stroke: Option<String>,
    /// Travels with the forces that are needed after them, such as "0 mm: 100 N, 50 mm: 500 N"
    #[arg(long, allow_hyphen_values = true)]
    load: Option<String>,
    /// Muscles to look through: dmsp-10, dmsp-20, dmsp-40 (force law of S4), shipped muscles and muscle files (equilibrium, with the effects they state)
    #[arg(long, value_name = "NAME,...", default_value = MUSCLES)]
    muscle: String,
    /// Force law of the papers in place of the muscles' equilibrium (`bulge effects` lists them)
    #[arg(long)]
    law: Option<String>,
    /// Numbers of the law, such as "DMSP-20-400N" [default: those of the nearest muscle]
    #[arg(long, requires = "law")]
    table: Option<String>,
    /// Operating gauge pressures, such as "4 bar,4.5 bar": the shortest length for each
    #[arg(long, allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Lengths without pressure, such as "200 mm,400 mm": the lowest pressure for each
    #[arg(long, allow_hyphen_values = true)]
    length: Option<String>,
    /// Contraction where the muscle begins [default: 0, pleated 5 %]
    #[arg(long, allow_hyphen_values = true)]
    start: Option<String>,
    /// Largest contraction [default: 25 %, pleated 35 %]
    #[arg(long, allow_hyphen_values = true)]
    max_contraction: Option<String>,
    /// Highest pressure [default: 6 bar, pleated 3 bar]
    #[arg(long, allow_hyphen_values = true)]
    max_pressure: Option<String>,
    /// Longest muscle that there is room for [default: ten strokes]
    #[arg(long, allow_hyphen_values = true)]
    max_length: Option<String>,
    /// Largest force that the muscle may carry [default: dmsp-20 1500 N, others by their cross-section; pleated 3 kN]
    #[arg(long, allow_hyphen_values = true)]
    max_force: Option<String>,
    /// Force in reserve over what is needed, such as "10 %"
    #[arg(long, default_value = "0 %", allow_hyphen_values = true)]
    margin: String,
    /// Lengths are rounded up to multiples of this
    #[arg(long, default_value = "1 mm", allow_hyphen_values = true)]
    step: String,
    /// Choices that are printed
    #[arg(long, default_value_t = 12)]
    top: usize,
    /// Draw the best choice: isobars with the way of the load
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Your own effects, where a muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl SizeCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let load = self.load()?;
        let families = self.families(&load)?;
        let sizing = self.sized(&families, &load)?;
        let answer = if self.json.wanted { document(&sizing)? } else { String::new() };
        let Some(best) = sizing.choices.first() else {
            return Err(Failure::NoneFound { answer, why: nothing(&sizing) });
        };
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            files::write(path, drawn(best, &families)?.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        if self.json.wanted {
            return Ok(answer);
        }
        Ok(self.text(&sizing) + &wrote)
    }

    fn load(&self) -> Result<LoadCase, Failure> {
        if let Some(text) = &self.load {
            let points = text.split(',').map(|pair| {
                let Some((travel, needed)) = pair.split_once(':') else {
                    let what = format!(
                        "`{}` is no travel with its force: write such as \"50 mm: 500 N\"",
                        pair.trim()
                    );
                    return Err(Failure::Value { option: "--load", what });
                };
                let travel_m = quantity::<Length>("--load", travel.trim())?.si();
                Ok(LoadPoint { travel_m, force_n: force("--load", needed)? })
            });
            return Ok(LoadCase::new(points.collect::<Result<_, _>>()?)?);
        }
        let stroke = quantity::<Length>("--stroke", self.stroke.as_deref().unwrap_or_default())?.si();
        let after = force("--force", self.force.as_deref().unwrap_or_default())?;
        let before = self.at_rest.as_deref().map_or(Ok(0.0), |text| force("--at-rest", text))?;
        Ok(LoadCase::lift(stroke, before, after)?)
    }

    fn families(&self, load: &LoadCase) -> Result<Vec<Family>, Failure> {
        let law = self.law()?;
        let fluidic = fluidic_muscles()?;
        let mut families = Vec::new();
        for name in self.muscle.split(',').map(str::trim) {
            if name.is_empty() {
                let what = format!("`{}` names an empty muscle: write names between commas", self.muscle);
                return Err(Failure::Value { option: "--muscle", what });
            }
            let family = match (fluidic.iter().find(|family| family.name() == name), law) {
                (Some(family), None) => family.clone(),
                (Some(_), Some(_)) => {
                    let what = format!(
                        "{name} stands for the law of S4: with another law name shipped muscles ({}) or files by --muscle",
                        shipped()
                    );
                    return Err(Failure::Value { option: "--law", what });
                }
                (None, law) => self.family(name, law)?,
            };
            // Two files may have the same name: the argument distinguishes them.
            let is_taken = families.iter().any(|other: &Family| other.name() == family.name());
            let family =
                if is_taken { family.clone().named(&format!("{} ({name})", family.name())) } else { family };
            let limits = self.limits(family.limits(), load.stroke_m())?;
            families.push(family.with_limits(limits)?);
        }
        Ok(families)
    }

    /// A shipped muscle or a file.
    fn family(&self, name: &str, law: Option<&'static Law>) -> Result<Family, Failure> {
        let muscle: Muscle = muscle(name)?;
        let limits = Limits::of(muscle.kind());
        let Some(law) = law else {
            let known = known(&muscle, &catalogue(self.effects.as_deref())?)?;
            let family = Family::of_muscle(&muscle, known, limits)?;
            return Ok(if muscle.is_pleated() { family.similar() } else { family });
        };
        let wrong = |what: String| Err(Failure::Value { option: "--law", what });
        if !law.suits(muscle.kind()) {
            return wrong(format!(
                "{} is not for {name}: `bulge effects {}` says for what",
                law.name, law.name
            ));
        }
        if law.is_isobaric() {
            return wrong(format!("the numbers of {} hold at one pressure: choose another law", law.name));
        }
        let table = match &self.table {
            Some(wanted) => {
                let names = law.tables.iter().map(|table| table.name).collect::<Vec<_>>().join(", ");
                let Some(table) = law.table(wanted) else {
                    let what = format!("{} has no numbers called `{wanted}`: there are {names}", law.name);
                    return Err(Failure::Value { option: "--table", what });
                };
                Some(table)
            }
            None => law.table_for(muscle.name()).or_else(|| law.table_for(name)),
        };
        Ok(Family::of_law(muscle.name(), law, table, &muscle, limits)?)
    }

    fn law(&self) -> Result<Option<&'static Law>, Failure> {
        let Some(name) = &self.law else { return Ok(None) };
        let found = Law::find(name);
        if found.is_none() {
            let what = format!("there is no force law `{name}`: `bulge effects` lists them");
            return Err(Failure::Value { option: "--law", what });
        }
        Ok(found)
    }

    fn limits(&self, of: Limits, stroke_m: f64) -> Result<Limits, Failure> {
        let mut limits = of;
        if let Some(text) = &self.max_pressure {
            limits.pressure_pa = quantity::<Pressure>("--max-pressure", text)?.si();
        }
        if let Some(text) = &self.start {
            limits.contraction[0] = quantity::<Ratio>("--start", text)?.si();
        }
        if let Some(text) = &self.max_contraction {
            limits.contraction[1] = quantity::<Ratio>("--max-contraction", text)?.si();
        }
        let [shortest, longest] = &mut limits.length_m;
        if let Some(text) = &self.max_length {
            *longest = quantity::<Length>("--max-length", text)?.si();
        } else if self.length.is_none() {
            *longest = longest.min(LONG * stroke_m).max(*shortest);
        }
        if let Some(text) = &self.max_force {
            limits.force_n = force("--max-force", text)?;
        }
        Ok(limits)
    }

    /// Sizes each muscle separately: without a given pressure each goes up to its own limit.
    fn sized(&self, families: &[Family], load: &LoadCase) -> Result<Sizing, Failure> {
        let si = |pressures: Vec<Pressure>| pressures.into_iter().map(Quantity::si).collect::<Vec<_>>();
        let pressures = self.pressure.as_deref().map(|text| list("--pressure", text)).transpose()?.map(si);
        let lengths: Vec<Length> =
            self.length.as_deref().map(|text| list("--length", text)).transpose()?.unwrap_or_default();
        let is_open = pressures.is_none() && lengths.is_empty();
        let mut wish = Requirements {
            pressures_pa: pressures.clone().unwrap_or_default(),
            lengths_m: lengths.into_iter().map(Quantity::si).collect(),
            margin: quantity::<Ratio>("--margin", &self.margin)?.si(),
            step_m: quantity::<Length>("--step", &self.step)?.si(),
            weights: is_open.then(Weights::default),
        };
        let mut all = Sizing { load: load.clone(), choices: Vec::new(), infeasible: Vec::new() };
        for family in families {
            if is_open {
                let highest = family.limits().pressure_pa;
                let step = PRESSURE_STEP.max(highest / f64::from(MOST_PRESSURES));
                let pressures = (1..=MOST_PRESSURES).map(|k| step * f64::from(k));
                wish.pressures_pa =
                    pressures.filter(|p| *p > 0.9e5 && *p <= highest * (1.0 + 1e-9)).collect();
            }
            let found = size(std::slice::from_ref(family), load, &wish)?;
            all.choices.extend(found.choices);
            all.infeasible.extend(found.infeasible);
        }
        all.choices.sort_by(|a, b| a.strain.total_cmp(&b.strain));
        Ok(all)
    }

    fn text(&self, sizing: &Sizing) -> String {
        let needed = sizing.load.points().iter().map(|at| {
            format!("{} N after {} mm", significant(at.force_n, 4), significant(1e3 * at.travel_m, 4))
        });
        let mut text = format!("{}\n\n", needed.collect::<Vec<_>>().join(", "));
        let heading = [
            "muscle",
            "diameter",
            "length",
            "pressure",
            "contraction",
            "reserve",
            "strain of life",
            "sought",
        ];
        let units = ["", "mm", "mm", "bar", "%", "%", "0 to 1", ""];
        let shown = sizing.choices.iter().take(self.top.max(1));
        text.push_str(&with_units(heading, units, shown.map(row)));
        let more = sizing.choices.len().saturating_sub(self.top.max(1));
        if more > 0 {
            let _ = writeln!(text, "  and {more} more: --top {}", sizing.choices.len());
        }
        if let Some(best) = sizing.choices.first() {
            text.push_str(&way(best));
        }
        text.push_str(&refused(&sizing.infeasible));
        text.push_str(&bases(&sizing.choices));
        if self.max_pressure.is_some() || self.max_contraction.is_some() || self.max_force.is_some() {
            text.push_str("  the limits are yours: beyond 6 bar and 25 % the law of S4 was not measured, and a larger limit makes every choice look kinder\n");
        }
        text
    }
}

fn shipped() -> String {
    PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>().join(", ")
}

/// A force in newtons, or the weight of kilograms.
fn force(option: &'static str, text: &str) -> Result<f64, Failure> {
    let text = text.trim();
    let Some(number) = text.strip_suffix("kg") else { return Ok(quantity::<Force>(option, text)?.si()) };
    let mass: f64 = number.trim().parse().map_err(|_| {
        let what = format!("`{text}` is no mass: write such as \"50 kg\", or a force such as \"500 N\"");
        Failure::Value { option, what }
    })?;
    Ok(GRAVITY * mass)
}

fn row(choice: &Choice) -> [String; 8] {
    let sought = match choice.given {
        Given::Pressure { .. } => "shortest",
        Given::Length { .. } => "lowest pressure",
        Given::Compromise => "compromise",
    };
    [
        choice.family.clone(),
        significant(1e3 * choice.diameter_m, 3),
        significant(1e3 * choice.length_m, 4),
        significant(1e-5 * choice.pressure_pa, 3),
        significant(100.0 * choice.contraction[1], 3),
        if choice.force_margin.abs() < 5e-4 {
            "0".to_owned()
        } else {
            significant(100.0 * choice.force_margin, 2)
        },
        significant(choice.strain, 2),
        sought.to_owned(),
    ]
}

/// The path of the best choice, as text.
fn way(best: &Choice) -> String {
    let text = format!(
        "\nthe kindest: {} of {} mm at {} bar\n\n",
        best.family,
        significant(1e3 * best.length_m, 4),
        significant(1e-5 * best.pressure_pa, 3)
    );
    let heading = ["travel", "contraction", "needed", "pulls", "held at"];
    let units = ["mm", "%", "N", "N", "bar"];
    let rows = best.points.iter().map(|at| {
        [
            significant(1e3 * at.travel_m, 4),
            significant(100.0 * at.contraction, 3),
            significant(at.force_n, 4),
            at.available_n.map_or("any".to_owned(), |force| significant(force, 4)),
            significant(1e-5 * at.holding_pressure_pa, 3),
        ]
    });
    text + &with_units(heading, units, rows)
}

/// The first reason for each muscle, and the number of further ones.
fn refused(infeasible: &[Infeasible]) -> String {
    let mut text = String::new();
    let mut seen: Vec<&str> = Vec::new();
    for not in infeasible {
        if seen.contains(&not.family.as_str()) {
            continue;
        }
        seen.push(&not.family);
        let many = infeasible.iter().filter(|other| other.family == not.family).count();
        let at = match not.given {
            Given::Pressure { pressure_pa } => format!(" at {} bar", significant(1e-5 * pressure_pa, 3)),
            Given::Length { length_m } => format!(" of {} mm", significant(1e3 * length_m, 4)),
            Given::Compromise => String::new(),
        };
        let more = if many > 1 { format!(" (and {} more)", many - 1) } else { String::new() };
        let _ = writeln!(text, "  {}{at}: {}{more}", not.family, not.why);
    }
    if text.is_empty() { text } else { format!("\nnot:\n\n{text}") }
}

/// The sources of the forces.
fn bases(choices: &[Choice]) -> String {
    let mut text = "\nforces:\n\n".to_owned();
    let mut seen: Vec<&str> = Vec::new();
    for choice in choices {
        if !seen.contains(&choice.family.as_str()) {
            seen.push(&choice.family);
            let _ = writeln!(text, "  {}: {}", choice.family, choice.basis);
        }
    }
    if choices.iter().any(|choice| choice.basis.contains("sarosi-6")) {
        text.push_str(
            "  sarosi-6 was measured while the muscle lengthens: while it lifts it pulls 30 to 80 N less; add a --margin\n",
        );
    }
    text
}

/// The JSON document, with or without choices.
fn document(sizing: &Sizing) -> Result<String, Failure> {
    let document = json!({
        "schema": "bulge.size/1",
        "load": sizing.load,
        "choices": sizing.choices,
        "infeasible": sizing.infeasible,
    });
    pretty(&document)
}

/// Text for the case that nothing carries the load.
fn nothing(sizing: &Sizing) -> String {
    format!(
        "none of these muscles carries {} N over {} mm\n{}",
        significant(sizing.load.largest_n(), 4),
        significant(1e3 * sizing.load.stroke_m(), 4),
        refused(&sizing.infeasible)
    )
}

/// Plot of the isobars of the best choice with the path of the load.
fn drawn(best: &Choice, families: &[Family]) -> Result<String, Failure> {
    let Some(family) = families.iter().find(|family| family.name() == best.family) else {
        return Ok(String::new());
    };
    let muscle = family.at(best.length_m)?;
    // Whole bars, and no more isobars than fit into a legend.
    let highest = family.limits().pressure_pa;
    let step = 1e5 * (highest / (1e5 * f64::from(MOST_ISOBARS))).ceil().max(1.0);
    let mut pressures: Vec<f64> =
        (1..=MOST_ISOBARS).map(|k| step * f64::from(k)).filter(|p| *p <= highest).collect();
    if pressures.iter().all(|p| (p - best.pressure_pa).abs() > 1e3) {
        pressures.push(best.pressure_pa);
        pressures.sort_by(f64::total_cmp);
    }
    let mut isobars = Vec::new();
    for pressure in pressures {
        let points = muscle.isobar(pressure, DRAWN)?;
        if points.len() > 1 {
            isobars.push((pressure, points));
        }
    }
    let load: Vec<[f64; 2]> = best.points.iter().map(|at| [at.contraction, at.force_n]).collect();
    let title = format!(
        "{} of {} mm at {} bar",
        best.family,
        significant(1e3 * best.length_m, 4),
        significant(1e-5 * best.pressure_pa, 3)
    );
    Ok(sizing_svg(&title, &isobars, &load)?)
}
