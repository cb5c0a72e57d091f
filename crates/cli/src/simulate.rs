//! `bulge simulate`: synthetic measurements of a muscle with chosen effects, noise and rig errors, and the
//! hidden truth.

use bulge_inference::{
    HiddenEffect, PROTOCOL_EXAMPLE, Protocol, RigErrors, Simulation, Truth, simulate_with,
};
use bulge_muscles::to_toml;
use clap::Args;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use crate::arguments::{self, pretty};
use crate::failure::Failure;
use crate::files;
use crate::text::{counted, significant};

/// Names of the files written.
const FILES: [&str; 3] = ["data.csv", "muscle.toml", "truth.json"];

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
        let found = simulate_with(&muscle, &catalogue, &protocol, &self.with, self.seed)?;
        self.check_out()?;
        let document = pretty(&found.truth)?;
        let paths = write(&self.out, &found, &document)?;
        if self.json { Ok(document) } else { Ok(text(&found, &paths)) }
    }
}

impl SimulateCommand {
    /// Rejects overwriting the user's files, and writing to a place where no file can be.
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
        // A simulation writes over another one, and over nothing else.
        let [data, _, truth] = &all;
        if data.exists() && !truth.exists() {
            let what = format!(
                "{} isn't of a simulation, which has a truth.json beside it; give another folder",
                data.display()
            );
            return Err(Failure::Value { option: "--out", what });
        }
        Ok(())
    }
}

/// Writes the three files, each whole. The truth comes first: by it the others are known as those of a simulation,
/// even if they were never finished.
fn write(folder: &Path, found: &Simulation, document: &str) -> Result<[PathBuf; 3], Failure> {
    files::folder(folder)?;
    let paths = FILES.map(|name| folder.join(name));
    let muscle = to_toml(&found.muscle);
    for (path, content) in paths.iter().zip([found.csv.as_str(), &muscle, document]).rev() {
        files::write(path, content.as_bytes())?;
    }
    Ok(paths)
}

/// The simulation as text.
fn text(found: &Simulation, [data, muscle, truth]: &[PathBuf; 3]) -> String {
    let hidden = &found.truth;
    let mut out = format!("{}, simulated with seed {}\n\n", hidden.muscle, hidden.seed);
    let kind = if found.data.is_path() {
        format!("in {}", counted(hidden.sweeps, "sweep"))
    } else {
        "of a static map".to_owned()
    };
    let force = found.data.force();
    let [low, high] =
        [force.iter().copied().fold(f64::INFINITY, f64::min), force.iter().copied().fold(0.0, f64::max)];
    let _ = writeln!(
        out,
        "  {} {kind}: force {} to {} N",
        counted(hidden.rows, "row"),
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
        let done = counted(ended.count, if is_path { "sweep" } else { "row" });
        if let Some(reached) = ended.pressure_reached_pa {
            let [low, high] = reached.map(|p| significant(p / 1e5, 4));
            let _ = writeln!(
                out,
                "  at {} % only {low} to {high} bar were done ({done}): at lower pressures the muscle would push or has no equilibrium",
                significant(100.0 * ended.planned[0], 4)
            );
            continue;
        }
        let _ = match (ended.reached, is_path) {
            (Some(reached), true) => writeln!(
                out,
                "  at {bar} bar {} of {planned} was done ({done}): beyond, the muscle would push or has no equilibrium",
                percent(reached)
            ),
            _ => writeln!(
                out,
                "  left out {done} at {bar} bar, {planned}: the muscle would push or has no equilibrium"
            ),
        };
    }
}
