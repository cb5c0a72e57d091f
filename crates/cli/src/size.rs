//! `bulge size`: from a load over a stroke to muscles, lengths and pressures.

use bulge_design::size::{
    Candidates, Choice, Given, LoadCase, LoadPoint, MUSCLES, OwnLimits, SizeQuestion, Sizing, force_or_weight,
};
use bulge_effects::known;
use bulge_muscles::units::Quantity;
use bulge_muscles::{Length, Pressure, Ratio};
use bulge_report::sizing_svg;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, catalogue, list, muscle, pretty, quantity};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_units};

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
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
    /// Your own effects, where a muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl SizeCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let question = self.question()?;
        let sizing = question.answer()?;
        let answer =
            if self.json.wanted { pretty(&serde_json::to_value(sizing.document())?)? } else { String::new() };
        let Some(best) = sizing.choices.first() else {
            return Err(Failure::NoneFound { answer, why: sizing.nothing() });
        };
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            let isobars = question.isobars(best)?;
            files::write(path, sizing_svg(&best.title(), &isobars, &best.way())?.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        if self.json.wanted {
            return Ok(answer);
        }
        Ok(self.text(&sizing) + &wrote)
    }

    fn question(&self) -> Result<SizeQuestion, Failure> {
        let load = self.load()?;
        let families = self.candidates(&load)?.families().to_vec();
        let si = |pressures: Vec<Pressure>| pressures.into_iter().map(Quantity::si).collect::<Vec<_>>();
        let lengths: Vec<Length> =
            self.length.as_deref().map(|text| list("--length", text)).transpose()?.unwrap_or_default();
        Ok(SizeQuestion {
            load,
            families,
            pressures_pa: self.pressure.as_deref().map(|text| list("--pressure", text)).transpose()?.map(si),
            lengths_m: lengths.into_iter().map(Quantity::si).collect(),
            margin: quantity::<Ratio>("--margin", &self.margin)?.si(),
            step_m: quantity::<Length>("--step", &self.step)?.si(),
        })
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

    fn candidates(&self, load: &LoadCase) -> Result<Candidates, Failure> {
        let (law, table) = (self.law.as_deref(), self.table.as_deref());
        let mut all = Candidates::new(load, law, table, self.limits()?, self.length.is_some())?;
        for name in self.muscle.split(',').map(str::trim) {
            if name.is_empty() {
                let what = format!("`{}` names an empty muscle: write names between commas", self.muscle);
                return Err(Failure::Value { option: "--muscle", what });
            }
            if all.is_fluidic(name) {
                all.add_fluidic(name)?;
                continue;
            }
            let muscle = muscle(name)?;
            // A law takes the place of the effects.
            let known = match law {
                Some(_) => Vec::new(),
                None => known(&muscle, &catalogue(self.effects.as_deref())?)?,
            };
            all.add(name, &muscle, known)?;
        }
        Ok(all)
    }

    fn limits(&self) -> Result<OwnLimits, Failure> {
        let ratio = |option, text: &Option<String>| -> Result<Option<f64>, Failure> {
            text.as_deref().map(|text| Ok(quantity::<Ratio>(option, text)?.si())).transpose()
        };
        let pressure = self.max_pressure.as_deref().map(|text| quantity::<Pressure>("--max-pressure", text));
        let length = self.max_length.as_deref().map(|text| quantity::<Length>("--max-length", text));
        Ok(OwnLimits {
            pressure_pa: pressure.transpose()?.map(Quantity::si),
            start: ratio("--start", &self.start)?,
            contraction: ratio("--max-contraction", &self.max_contraction)?,
            length_m: length.transpose()?.map(Quantity::si),
            force_n: self.max_force.as_deref().map(|text| force("--max-force", text)).transpose()?,
        })
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
        text.push_str(&sizing.refusals());
        text.push_str(&bases(&sizing.choices));
        if self.max_pressure.is_some() || self.max_contraction.is_some() || self.max_force.is_some() {
            text.push_str("  the limits are yours: beyond 6 bar and 25 % the law of S4 was not measured, and a larger limit makes every choice look kinder\n");
        }
        text
    }
}

/// A force in newtons, or the weight of kilograms.
fn force(option: &'static str, text: &str) -> Result<f64, Failure> {
    force_or_weight(text).map_err(|what| Failure::Value { option, what })
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
