//! `bulge simulate`: synthetic measurements of a muscle with chosen effects, noise and rig errors, and what is hidden in them.

use bulge_effects::{Effect, Group, ParameterCard, known};
use bulge_inference::{
    HiddenEffect, PROTOCOL_EXAMPLE, Protocol, Random, RigErrors, Simulation, Truth, simulate,
};
use bulge_model::Model;
use bulge_muscles::{Muscle, to_toml, units};
use clap::Args;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::arguments;
use crate::failure::Failure;
use crate::files;
use crate::text::significant;

const WITH: &str = "--with";
/// Names of the files written.
const FILES: [&str; 3] = ["data.csv", "muscle.toml", "truth.json"];
/// Stream of the random numbers with which specimens differ; those of the readings count upwards from 0.
const SPECIMENS: u64 = u64::MAX;

/// Synthetic measurements with chosen (hidden) effects, noise and rig errors: DIR/data.csv, DIR/muscle.toml, DIR/truth.json.
///
/// The muscle file written is the muscle as stated: it knows nothing of the effects, and its [instruments] have the noise. The same seed
/// gives the same bytes.
#[derive(Debug, Args)]
#[command(after_long_help = help())]
pub(crate) struct SimulateCommand {
    /// A muscle file or the name of a shipped muscle
    muscle: String,
    /// What the test bench does: a TOML file (an example is below)
    #[arg(long, value_name = "PROTOCOL.toml")]
    protocol: PathBuf,
    /// Effects to hide, with their numbers: `coulomb-friction=14 N,bladder-elasticity=0.3 MPa`. Further numbers follow in order
    /// (`presliding-hysteresis=12 N,1 %`) or by name (`presliding-hysteresis.distance=1 %`); what isn't stated is as usual. Of `specimen-spread`, the number is the standard
    /// deviation between specimens
    #[arg(long, value_delimiter = ',', value_name = "EFFECT=...")]
    with: Vec<String>,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Folder for the three files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// One JSON document on standard output: the truth
    #[arg(long)]
    json: bool,
}

/// An effect to hide, with the numbers that were stated \[SI\].
struct Stated {
    effect: Arc<dyn Effect>,
    numbers: Vec<Option<f64>>,
}

fn help() -> String {
    let indented = PROTOCOL_EXAMPLE.replace('\n', "\n    ");
    format!(
        "Example:\n  bulge simulate dmsp-20-250 --protocol protocol.toml --with \"coulomb-friction=14 N,end-taper\" --seed 7 --out trial\n  \
         bulge compare trial/data.csv --muscle trial/muscle.toml --with coulomb-friction,end-taper\n\nA protocol with every key:\n    {}",
        indented.trim_end()
    )
}

impl SimulateCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let protocol = Protocol::read(&self.protocol)?;
        let find = |name: &str| Ok(Arc::clone(catalogue.find(name)?));
        let stated = stated(&self.with, find, &muscle)?;
        let mut model = Model::new(&muscle).for_specimens(&protocol.specimens());
        for (effect, numbers) in known(&muscle, &catalogue)? {
            model = model.with(&effect, Some(&numbers))?;
        }
        for one in &stated {
            model = model.with(&one.effect, None)?;
        }
        let theta = numbers(&model, &stated, &muscle, self.seed)?;
        let found = simulate(&model, &theta, &protocol, self.seed)?;
        self.check_out()?;
        let document = serde_json::to_string_pretty(&found.truth)? + "\n";
        let paths = write(&self.out, &found, &document)?;
        if self.json { Ok(document) } else { Ok(text(&found, &paths)) }
    }
}

impl SimulateCommand {
    /// What the user wrote is not written over, nor is anything written where a file can't be.
    fn check_out(&self) -> Result<(), Failure> {
        let is = |path: &Path, own: &Path| {
            path.canonicalize().is_ok_and(|path| own.canonicalize().is_ok_and(|own| own == path))
        };
        let own = [Path::new(&self.muscle), &self.protocol];
        let all = FILES.map(|name| self.out.join(name));
        if let Some(path) = all.iter().find(|path| own.iter().any(|own| is(path, own))) {
            let what = format!("{} would be written over; give another folder", path.display());
            return Err(Failure::Value { option: "--out", what });
        }
        if let Some(path) = all.iter().find(|path| path.is_dir()) {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder; move it away");
            return Err(Failure::Output { path: path.clone(), source });
        }
        Ok(())
    }
}

/// The three files, each whole.
fn write(folder: &Path, found: &Simulation, document: &str) -> Result<[PathBuf; 3], Failure> {
    files::folder(folder)?;
    let paths = FILES.map(|name| folder.join(name));
    let muscle = to_toml(&found.muscle);
    for (path, content) in paths.iter().zip([found.csv.as_str(), &muscle, document]) {
        files::write(path, content.as_bytes())?;
    }
    Ok(paths)
}

fn wrong(what: String) -> Failure {
    Failure::Value { option: WITH, what }
}

/// `name`, `name=value`, `name.key=value`, or a further value of the effect before.
fn stated(
    items: &[String],
    find: impl Fn(&str) -> Result<Arc<dyn Effect>, Failure>,
    muscle: &Muscle,
) -> Result<Vec<Stated>, Failure> {
    let mut all: Vec<Stated> = Vec::new();
    for item in items {
        let item = item.trim();
        if item.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.' | '\u{2212}')) {
            let last = all.last_mut().ok_or_else(|| {
                wrong(format!("`{item}` belongs to no effect; write such as `coulomb-friction={item}`"))
            })?;
            last.next(item, muscle)?;
            continue;
        }
        let (left, value) =
            item.split_once('=').map_or((item, None), |(left, value)| (left, Some(value.trim())));
        let (name, key) = left.split_once('.').map_or((left, None), |(name, key)| (name, Some(key.trim())));
        let effect = find(name.trim())?;
        let is_it = |other: &Stated| other.effect.card().name == effect.card().name;
        let place = all.iter().position(is_it);
        if place.is_some() && key.is_none() {
            return Err(wrong(format!(
                "`{}` stands twice in the list of effects; once is enough",
                name.trim()
            )));
        }
        let place = place.unwrap_or_else(|| {
            let numbers = vec![None; effect.parameters().len()];
            all.push(Stated { effect, numbers });
            all.len() - 1
        });
        match (key, value) {
            (Some(key), Some(value)) => all[place].keyed(key, value, muscle)?,
            (Some(key), None) => {
                return Err(wrong(format!(
                    "`{item}` has no value; write such as {}",
                    all[place].example(Some(key), muscle)
                )));
            }
            (None, Some(value)) => all[place].next(value, muscle)?,
            (None, None) => {}
        }
    }
    Ok(all)
}

impl Stated {
    fn name(&self) -> String {
        self.effect.card().name.to_owned()
    }

    /// The numbers of this muscle.
    fn with_cards<T>(&self, muscle: &Muscle, read: impl FnOnce(&[ParameterCard<'_>]) -> T) -> T {
        let cards: Vec<ParameterCard<'_>> =
            self.effect.parameters().into_iter().map(|card| card.of(muscle)).collect();
        read(&cards)
    }

    /// Puts a value to the first number that has none.
    fn next(&mut self, value: &str, muscle: &Muscle) -> Result<(), Failure> {
        let Some(place) = self.numbers.iter().position(Option::is_none) else {
            let count = self.numbers.len();
            let has = match count {
                0 => "no number: write its name alone".to_owned(),
                1 => "one number only".to_owned(),
                _ => format!("{count} numbers only"),
            };
            return Err(wrong(format!("`{value}` is too much for `{}`, which has {has}", self.name())));
        };
        self.put(place, value, muscle)
    }

    fn keyed(&mut self, key: &str, value: &str, muscle: &Muscle) -> Result<(), Failure> {
        let is_it =
            |cards: &[ParameterCard<'_>]| cards.iter().position(|card| card.key == key || card.name == key);
        if let Some(place) = self.with_cards(muscle, is_it) {
            return self.put(place, value, muscle);
        }
        let has = if self.numbers.is_empty() {
            "it has no numbers: write its name alone".to_owned()
        } else {
            format!("write such as {}", self.example(None, muscle))
        };
        Err(wrong(format!("the effect `{}` has no `{key}`; {has}", self.name())))
    }

    fn put(&mut self, place: usize, text: &str, muscle: &Muscle) -> Result<(), Failure> {
        let name = self.name();
        let value = self.with_cards(muscle, |cards| read(&name, &cards[place], text))?;
        self.numbers[place] = Some(value);
        Ok(())
    }

    /// How a number, or all of them, is written.
    fn example(&self, key: Option<&str>, muscle: &Muscle) -> String {
        let name = self.name();
        let one = |card: &ParameterCard<'_>| format!("`{name}.{}={}`", card.key, shown(usual(card), card));
        self.with_cards(muscle, |cards| {
            let fitting = cards.iter().filter(|card| key.is_none_or(|key| card.key == key));
            let list: Vec<String> = fitting.map(one).collect();
            if list.is_empty() { format!("`{name}`: it has no such number") } else { list.join(", ") }
        })
    }
}

/// A number within the bounds of its effect, in SI.
fn read(effect: &str, card: &ParameterCard<'_>, text: &str) -> Result<f64, Failure> {
    let example = format!("write such as `{effect}.{}={}`", card.key, shown(usual(card), card));
    let found = units::any(text).map_err(|error| wrong(format!("`{effect}`: {error}; {example}")))?;
    let dimension = units::unit(card.unit).map_or(found.dimension, |(_, dimension)| dimension);
    if found.dimension != dimension {
        let (is, must) = (found.dimension.describe(), dimension.describe());
        return Err(wrong(format!(
            "`{}` of `{effect}` is {must}, but `{text}` is {is}; {example}",
            card.key
        )));
    }
    // What a fit left on a bound may be off it by rounding.
    let slack = 1e-12 * (card.high - card.low).abs();
    if !(card.low - slack..=card.high + slack).contains(&found.si) {
        return Err(wrong(format!(
            "`{text}` is out of the bounds of `{effect}`: `{}` lies between {} and {}",
            card.key,
            shown(card.low, card),
            shown(card.high, card)
        )));
    }
    Ok(found.si.clamp(card.low, card.high))
}

/// A usual value at which the effect does something: that of the card, or one standard deviation of the literature beside it.
fn usual(card: &ParameterCard<'_>) -> f64 {
    let does_nothing = card.typical.total_cmp(&card.off).is_eq();
    let beside = card.prior.map(|(mean, sd)| (mean + sd).clamp(card.low, card.high));
    beside.filter(|_| does_nothing).unwrap_or(card.typical)
}

/// All numbers of the model: those stated, usual ones, and one draw for each specimen.
fn numbers(model: &Model, stated: &[Stated], muscle: &Muscle, seed: u64) -> Result<Vec<f64>, Failure> {
    let mut theta = model.start();
    let mut random = Random::new(seed, SPECIMENS);
    for one in stated {
        let name = one.name();
        let is_of_specimens = one.effect.card().group == Group::Specimen;
        if is_of_specimens
            && model.parameters().iter().filter(|p| p.effect == name).count() <= one.numbers.len()
        {
            return Err(wrong(format!(
                "`{name}` needs two specimens or more; write such as `specimens = 3` into a `[[block]]`"
            )));
        }
        let is_silent = one.numbers.iter().all(Option::is_none);
        let values = one.with_cards(muscle, |cards| -> Vec<f64> {
            let value = |(card, number): (&ParameterCard<'_>, &Option<f64>)| {
                number.unwrap_or(if is_silent { usual(card) } else { card.typical })
            };
            cards.iter().zip(&one.numbers).map(value).collect()
        });
        let does_nothing = one.with_cards(muscle, |cards| {
            !cards.is_empty()
                && cards.iter().zip(&values).all(|(card, value)| card.off.total_cmp(value).is_eq())
        });
        if does_nothing && is_silent {
            let example = one.example(None, muscle);
            return Err(wrong(format!(
                "`{name}` has no usual size; write its numbers, in the way of {example}"
            )));
        }
        let places = (0..theta.len()).filter(|i| model.parameters()[*i].effect == name);
        for (place, value) in places.zip(values.iter().cycle()) {
            let number = &model.parameters()[place];
            let drawn = if is_of_specimens { value * random.normal() } else { *value };
            theta[place] = drawn.clamp(number.low, number.high);
        }
    }
    Ok(theta)
}

/// A number in the unit of its card.
fn shown(si: f64, card: &ParameterCard<'_>) -> String {
    // Twelve digits hide the rounding of the change of units.
    format!("{} {}", units::rounded(si / card.factor, 12), card.unit).trim_end().to_owned()
}

/// The simulation for people.
fn text(found: &Simulation, [data, muscle, truth]: &[PathBuf; 3]) -> String {
    let hidden = &found.truth;
    let mut out = format!("{}, simulated with seed {}\n\n", hidden.muscle, hidden.seed);
    let kind = if found.data.is_path() {
        format!("in {} sweeps", hidden.sweeps)
    } else {
        "of a static map".to_owned()
    };
    let force = found.data.force();
    let [low, high] =
        [force.iter().copied().fold(f64::INFINITY, f64::min), force.iter().copied().fold(0.0, f64::max)];
    let _ = writeln!(
        out,
        "  {} rows {kind}: force {} to {} N",
        hidden.rows,
        significant(low, 3),
        significant(high, 3)
    );
    if hidden.effects.is_empty() {
        let _ = writeln!(out, "  no effect is hidden: the muscle is as stated");
    }
    for effect in &hidden.effects {
        let _ = writeln!(out, "  hidden: {}", effect_text(effect));
    }
    rig_text(&mut out, hidden);
    ended_text(&mut out, hidden, found.data.is_path());
    for path in [data, muscle, truth] {
        let _ = writeln!(out, "  wrote {}", path.display());
    }
    let _ = writeln!(out, "\n  bulge compare {} --muscle {}", data.display(), muscle.display());
    out
}

fn effect_text(effect: &HiddenEffect) -> String {
    let number = |n: &bulge_inference::HiddenNumber| {
        let unit = if n.unit == "1" { "" } else { &n.unit };
        let specimen = n.specimen.as_ref().map_or_else(String::new, |s| format!(" [{s}]"));
        format!("{}{specimen} {} {unit}", n.key, significant(n.value, 4)).trim_end().to_owned()
    };
    let numbers: Vec<String> = effect.numbers.iter().map(number).collect();
    format!("{} {}", effect.effect, numbers.join(", ")).trim_end().to_owned()
}

fn rig_text(out: &mut String, truth: &Truth) {
    if truth.protocol.rig == RigErrors::None {
        return;
    }
    let rig = &truth.rig;
    let _ = writeln!(
        out,
        "  rig errors: force {} N and {} %, pressure {} Pa and {} %, length {} mm and {} %",
        significant(rig.force_zero_n, 3),
        significant(100.0 * rig.force_gain, 3),
        significant(rig.pressure_zero_pa, 3),
        significant(100.0 * rig.pressure_gain, 3),
        significant(1e3 * rig.length_zero_m, 3),
        significant(100.0 * rig.length_gain, 3)
    );
}

fn ended_text(out: &mut String, truth: &Truth, is_path: bool) {
    for ended in &truth.ended {
        let bar = significant(ended.pressure_pa / 1e5, 4);
        let percent = |[low, high]: [f64; 2]| {
            format!("{} to {} %", significant(100.0 * low, 4), significant(100.0 * high, 4))
        };
        let planned = percent(ended.planned);
        let what = match (is_path, ended.count) {
            (true, 1) => "sweep",
            (true, _) => "sweeps",
            (false, 1) => "row",
            (false, _) => "rows",
        };
        let _ = match (ended.reached, is_path) {
            (Some(reached), true) => writeln!(
                out,
                "  at {bar} bar {} of {planned} was done ({} {what}): beyond, the muscle would push or has no equilibrium",
                percent(reached),
                ended.count
            ),
            _ => writeln!(
                out,
                "  left out {} {what} at {bar} bar, {planned}: the muscle would push or has no equilibrium",
                ended.count
            ),
        };
    }
}
