//! The question of a size: a load, the muscles to look through, and limits. Its answer is a JSON document.

use bulge_effects::Known;
use bulge_effects::law::Law;
use bulge_muscles::units::{self, Quantity, significant};
use bulge_muscles::{Force, Muscle, PRESETS};
use serde::Serialize;
use std::fmt::Write;

use super::{
    Choice, Family, Given, Infeasible, Limits, LoadCase, Requirements, SizeError, Sizing, Weights,
    fluidic_muscles, size,
};
use crate::question::QuestionError;

/// Weight of a kilogram \[N\].
const GRAVITY: f64 = 9.806_65;
/// Muscles considered if none is named.
pub const MUSCLES: &str = "dmsp-10,dmsp-20,dmsp-40,ppam-2-r16";
/// Default step of the pressure \[Pa\], and the most steps.
const PRESSURE_STEP: f64 = 5e4;
const MOST_PRESSURES: u32 = 40;
/// Default limit of the length of a muscle, in strokes.
const LONG: f64 = 10.0;
/// Most isobars of the plot, and points of each.
const MOST_ISOBARS: u32 = 8;
const DRAWN: usize = 121;

/// Isobars: gauge pressure \[Pa\], and points of contraction and force \[N\].
pub type Isobars = Vec<(f64, Vec<[f64; 2]>)>;

/// A force \[N\] from text: a force such as "500 N", or the weight of a mass such as "50 kg".
///
/// # Errors
/// The text is neither; the message says what to write.
pub fn force_or_weight(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let Some(number) = text.strip_suffix("kg") else {
        return units::parse::<Force>(text).map(Quantity::si).map_err(|error| error.to_string());
    };
    let mass: f64 = number
        .trim()
        .parse()
        .map_err(|_| format!("`{text}` is no mass: write such as \"50 kg\", or a force such as \"500 N\""))?;
    Ok(GRAVITY * mass)
}

/// Limits of the user's own, in place of those of the muscles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OwnLimits {
    /// Highest gauge pressure \[Pa\].
    pub pressure_pa: Option<f64>,
    /// Contraction where the muscle begins.
    pub start: Option<f64>,
    /// Largest contraction.
    pub contraction: Option<f64>,
    /// Longest muscle \[m\].
    pub length_m: Option<f64>,
    /// Largest force \[N\].
    pub force_n: Option<f64>,
}

/// The muscles to look through, with their limits.
#[derive(Debug, Clone)]
pub struct Candidates {
    law: Option<&'static Law>,
    table: Option<String>,
    own: OwnLimits,
    /// Longest muscle without a limit of the user's own, unless lengths are given \[m\].
    longest_m: Option<f64>,
    fluidic: Vec<Family>,
    families: Vec<Family>,
}

/// An error of a size, or of a part of its question.
type Refused = QuestionError<SizeError>;

impl Candidates {
    /// No muscles yet. With a `law` its forces replace the equilibrium of the muscles, with the numbers of a
    /// `table`, or with those of the nearest muscle. Where lengths are given, muscles may be longer than ten
    /// strokes of the load.
    ///
    /// # Errors
    /// There is no such law.
    pub fn new(
        load: &LoadCase,
        law: Option<&str>,
        table: Option<&str>,
        own: OwnLimits,
        are_lengths_given: bool,
    ) -> Result<Self, Refused> {
        let law = match law {
            None => None,
            Some(name) => match Law::find(name) {
                None => {
                    let what = format!("there is no force law `{name}`: `bulge effects` lists them");
                    return Refused::part("law", what);
                }
                found => found,
            },
        };
        let longest_m = (!are_lengths_given).then_some(LONG * load.stroke_m());
        let fluidic = fluidic_muscles()?;
        Ok(Self { law, table: table.map(str::to_owned), own, longest_m, fluidic, families: Vec::new() })
    }

    /// Whether a name stands for a muscle of S4, which needs no file.
    #[must_use]
    pub fn is_fluidic(&self, name: &str) -> bool {
        self.fluidic.iter().any(|family| family.name() == name)
    }

    /// Adds a muscle of S4.
    ///
    /// # Errors
    /// A law is given in place of S4's, or the limits are invalid.
    pub fn add_fluidic(&mut self, name: &str) -> Result<(), Refused> {
        if self.law.is_some() {
            let shipped = PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>().join(", ");
            let what = format!(
                "{name} stands for the law of S4: with another law name shipped muscles ({shipped}) or files by --muscle"
            );
            return Refused::part("law", what);
        }
        match self.fluidic.iter().find(|family| family.name() == name).cloned() {
            Some(family) => self.push(name, family),
            None => Ok(()),
        }
    }

    /// Adds a muscle with its known effects; `name` is what the user calls it.
    ///
    /// # Errors
    /// The law or its numbers don't suit the muscle, or the limits are invalid.
    pub fn add(&mut self, name: &str, muscle: &Muscle, known: Vec<Known>) -> Result<(), Refused> {
        let limits = Limits::of(muscle.kind());
        let family = if let Some(law) = self.law {
            self.by_law(name, muscle, law, limits)?
        } else {
            let family = Family::of_muscle(muscle, known, limits)?;
            if muscle.is_pleated() { family.similar() } else { family }
        };
        self.push(name, family)
    }

    fn by_law(
        &self,
        name: &str,
        muscle: &Muscle,
        law: &'static Law,
        limits: Limits,
    ) -> Result<Family, Refused> {
        if !law.suits(muscle.kind()) {
            let what = format!("{} is not for {name}: `bulge effects {}` says for what", law.name, law.name);
            return Refused::part("law", what);
        }
        if law.is_isobaric() {
            let what = format!("the numbers of {} hold at one pressure: choose another law", law.name);
            return Refused::part("law", what);
        }
        let table = match &self.table {
            Some(wanted) => {
                let Some(table) = law.table(wanted) else {
                    let names = law.tables.iter().map(|table| table.name).collect::<Vec<_>>().join(", ");
                    let what = format!("{} has no numbers called `{wanted}`: there are {names}", law.name);
                    return Refused::part("table", what);
                };
                Some(table)
            }
            None => law.table_for(muscle.name()).or_else(|| law.table_for(name)),
        };
        Ok(Family::of_law(muscle.name(), law, table, muscle, limits)?)
    }

    fn push(&mut self, name: &str, family: Family) -> Result<(), Refused> {
        // Two files may have the same name: what the user calls them distinguishes them.
        let is_taken = self.families.iter().any(|other| other.name() == family.name());
        let family =
            if is_taken { family.clone().named(&format!("{} ({name})", family.name())) } else { family };
        let limits = self.limits(family.limits());
        self.families.push(family.with_limits(limits)?);
        Ok(())
    }

    fn limits(&self, mut limits: Limits) -> Limits {
        let own = &self.own;
        let [low, high] = limits.contraction;
        limits.pressure_pa = own.pressure_pa.unwrap_or(limits.pressure_pa);
        limits.contraction = [own.start.unwrap_or(low), own.contraction.unwrap_or(high)];
        let [shortest, longest] = &mut limits.length_m;
        if let Some(length) = own.length_m {
            *longest = length;
        } else if let Some(most) = self.longest_m {
            *longest = longest.min(most).max(*shortest);
        }
        limits.force_n = own.force_n.unwrap_or(limits.force_n);
        limits
    }

    /// The muscles.
    #[must_use]
    pub fn families(&self) -> &[Family] {
        &self.families
    }
}

/// Which muscle for a load.
#[derive(Debug, Clone)]
pub struct SizeQuestion {
    /// The load.
    pub load: LoadCase,
    /// The muscles to look through.
    pub families: Vec<Family>,
    /// Operating gauge pressures \[Pa\], if they are given. Without them and without lengths, all half bars
    /// up to the limit of each muscle, and the best compromise.
    pub pressures_pa: Option<Vec<f64>>,
    /// Lengths \[m\] that are given.
    pub lengths_m: Vec<f64>,
    /// Reserve of force, relative to the required force.
    pub margin: f64,
    /// Lengths are rounded up to multiples of this step \[m\]; 0 for exact lengths.
    pub step_m: f64,
}

impl SizeQuestion {
    /// Sizes each muscle separately: without a given pressure each goes up to its own limit.
    ///
    /// # Errors
    /// As [`size`].
    pub fn answer(&self) -> Result<Sizing, SizeError> {
        let is_open = self.pressures_pa.is_none() && self.lengths_m.is_empty();
        let mut wish = Requirements {
            pressures_pa: self.pressures_pa.clone().unwrap_or_default(),
            lengths_m: self.lengths_m.clone(),
            margin: self.margin,
            step_m: self.step_m,
            weights: is_open.then(Weights::default),
        };
        let mut all = Sizing { load: self.load.clone(), choices: Vec::new(), infeasible: Vec::new() };
        for family in &self.families {
            if is_open {
                let highest = family.limits().pressure_pa;
                let step = PRESSURE_STEP.max(highest / f64::from(MOST_PRESSURES));
                let pressures = (1..=MOST_PRESSURES).map(|k| step * f64::from(k));
                wish.pressures_pa =
                    pressures.filter(|p| *p > 0.9e5 && *p <= highest * (1.0 + 1e-9)).collect();
            }
            let found = size(std::slice::from_ref(family), &self.load, &wish)?;
            all.choices.extend(found.choices);
            all.infeasible.extend(found.infeasible);
        }
        all.choices.sort_by(|a, b| a.strain.total_cmp(&b.strain));
        Ok(all)
    }

    /// The isobars of a choice at whole bars, and at its own pressure. They are empty if the choice is of
    /// none of the muscles.
    ///
    /// # Errors
    /// As [`Family::at`].
    pub fn isobars(&self, choice: &Choice) -> Result<Isobars, SizeError> {
        let Some(family) = self.families.iter().find(|family| family.name() == choice.family) else {
            return Ok(Vec::new());
        };
        let muscle = family.at(choice.length_m)?;
        // Whole bars, and no more isobars than fit into a legend.
        let highest = family.limits().pressure_pa;
        let step = 1e5 * (highest / (1e5 * f64::from(MOST_ISOBARS))).ceil().max(1.0);
        let mut pressures: Vec<f64> =
            (1..=MOST_ISOBARS).map(|k| step * f64::from(k)).filter(|p| *p <= highest).collect();
        if pressures.iter().all(|p| (p - choice.pressure_pa).abs() > 1e3) {
            pressures.push(choice.pressure_pa);
            pressures.sort_by(f64::total_cmp);
        }
        let mut isobars = Vec::new();
        for pressure in pressures {
            let points = muscle.isobar(pressure, DRAWN)?;
            if points.len() > 1 {
                isobars.push((pressure, points));
            }
        }
        Ok(isobars)
    }
}

impl Choice {
    /// The choice in a few words.
    #[must_use]
    pub fn title(&self) -> String {
        format!(
            "{} of {} mm at {} bar",
            self.family,
            significant(1e3 * self.length_m, 4),
            significant(1e-5 * self.pressure_pa, 3)
        )
    }

    /// The way of the load: contraction and force \[N\].
    #[must_use]
    pub fn way(&self) -> Vec<[f64; 2]> {
        self.points.iter().map(|at| [at.contraction, at.force_n]).collect()
    }
}

/// The JSON document of a sizing, with or without choices.
#[derive(Debug, Serialize)]
pub struct SizeDocument<'a> {
    schema: &'static str,
    load: &'a LoadCase,
    choices: &'a [Choice],
    infeasible: &'a [Infeasible],
}

impl Sizing {
    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> SizeDocument<'_> {
        let Self { load, choices, infeasible } = self;
        SizeDocument { schema: "bulge.size/1", load, choices, infeasible }
    }

    /// Text for the case that nothing carries the load.
    #[must_use]
    pub fn nothing(&self) -> String {
        format!(
            "none of these muscles carries {} N over {} mm\n{}",
            significant(self.load.largest_n(), 4),
            significant(1e3 * self.load.stroke_m(), 4),
            self.refusals()
        )
    }

    /// The first reason for each muscle that doesn't carry the load, and the number of further ones.
    #[must_use]
    pub fn refusals(&self) -> String {
        let mut text = String::new();
        let mut seen: Vec<&str> = Vec::new();
        for not in &self.infeasible {
            if seen.contains(&not.family.as_str()) {
                continue;
            }
            seen.push(&not.family);
            let many = self.infeasible.iter().filter(|other| other.family == not.family).count();
            let at = match not.given {
                Given::Pressure { pressure_pa } => {
                    format!(" at {} bar", significant(1e-5 * pressure_pa, 3))
                }
                Given::Length { length_m } => format!(" of {} mm", significant(1e3 * length_m, 4)),
                Given::Compromise => String::new(),
            };
            let more = if many > 1 { format!(" (and {} more)", many - 1) } else { String::new() };
            // Writing to a String can't fail.
            let _ = writeln!(text, "  {}{at}: {}{more}", not.family, not.why);
        }
        if text.is_empty() { text } else { format!("\nnot:\n\n{text}") }
    }
}
