//! `bulge curve`: isobaric characteristics.

use bulge_fibre::{Given, Isobar, Problem, Shape};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Muscle, Pressure, Ratio};
use bulge_vtk::write_series;
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::{Json, MethodArgument, about, about_extended, extended, list, pretty, range};
use crate::characteristics;
use crate::failure::Failure;
use crate::files;
use crate::shape::bulge;

/// Most points of all isobars together.
const MAX_POINTS: usize = 1_000_000;
/// Most members of a VTK series; each takes about a megabyte.
const MAX_FRAMES: usize = 1000;
/// Start of the default range, as a fraction of the way from straight fibres to the limit: 1 % for a pleated
/// muscle that contracts by 40 %.
const DRAWN_OUT: f64 = 0.025;
/// Distance between start and limit of the default range, for elastic fibres that pull only when stretched.
const FIRST_STRETCH: f64 = 0.05;

/// Isobaric characteristics: force and volume over the contraction.
#[derive(Debug, Args)]
pub(crate) struct CurveCommand {
    /// Muscle file, or name of a shipped muscle
    muscle: String,
    /// Gauge pressures, such as "1 bar,2 bar,3 bar"
    #[arg(long, allow_hyphen_values = true)]
    pressure: String,
    /// Range of contractions, such as "0 %..35 %" [default: from 1 % (pleated) or 0 to the limit]
    #[arg(long, allow_hyphen_values = true)]
    contraction: Option<String>,
    /// Number of contractions, both ends included
    #[arg(long, default_value_t = 101)]
    points: usize,
    #[arg(long, value_enum, default_value_t)]
    method: MethodArgument,
    /// Write all points as CSV ("-": to standard output)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw force and volume against contraction
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
    /// Write the bulging as a time series for ParaView (bulge.pvd), one folder per pressure
    #[arg(long, value_name = "DIR")]
    vtk: Option<PathBuf>,
    /// Number of frames of the time series
    #[arg(long, default_value_t = 41)]
    frames: usize,
    /// Specimen of the muscle file, where `[specimens.NAME]` gives it numbers of its own
    #[arg(long, value_name = "NAME")]
    specimen: Option<String>,
    /// Your own effects, where the muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl CurveCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        if self.method == MethodArgument::Membrane {
            let what = "characteristics come from the closed form and from shooting: write a case for `bulge membrane`".to_owned();
            return Err(Failure::Value { option: "--method", what });
        }
        let (_, extended) = extended(&self.muscle, self.effects.as_deref(), self.specimen.as_deref())?;
        let muscle = extended.muscle().clone();
        let pressures: Vec<Pressure> = list("--pressure", &self.pressure)?;
        self.check()?;
        if self.points.saturating_mul(pressures.len()) > MAX_POINTS {
            let what = format!(
                "{} points at {} pressures: at most {MAX_POINTS} in all",
                self.points,
                pressures.len()
            );
            return Err(Failure::Value { option: "--points", what });
        }
        if let Some((_, twice)) = pressures.iter().enumerate().find(|(i, p)| pressures[..*i].contains(p)) {
            return Err(Failure::Value {
                option: "--pressure",
                what: format!("{twice} stands twice in the list"),
            });
        }
        let isobars = self.isobars(&extended, &pressures)?;
        for isobar in &isobars {
            if let (true, Some((_, error))) = (isobar.points.is_empty(), isobar.without.first()) {
                return Err(about(&muscle, Pressure::pa(isobar.pressure_pa))(error.clone()));
            }
        }
        let wanted = [self.csv.as_deref(), self.plot.as_deref()];
        let mut wrote = files::wrote_both(
            wanted,
            || characteristics::csv(&isobars),
            || characteristics::svg(muscle.name(), &isobars),
        )?;
        if let Some(folder) = &self.vtk {
            for isobar in &isobars {
                let path = series(&extended, isobar, self, folder, isobars.len() > 1)?;
                let _ = writeln!(wrote, "  wrote {}", path.display());
            }
        }
        if self.json.wanted {
            return pretty(&document(&muscle, &isobars));
        }
        let mut heading = format!("{}\n\n", muscle.name());
        if extended.adds_force() {
            let _ = writeln!(heading, "  with the effects {}, at rest\n", extended.used().join(", "));
        }
        Ok(heading + &characteristics::summary(&isobars) + &left_out(&isobars) + &wrote)
    }

    fn check(&self) -> Result<(), Failure> {
        let within = |option, value: usize, low, high| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            Err(Failure::Value { option, what: format!("{value} is out of range: give {low} to {high}") })
        };
        if self.vtk.as_deref().is_some_and(files::is_stdout) {
            let what = "a time series is many files: give the name of a folder, or write one shape with `bulge shape --vtk -`";
            return Err(Failure::Value { option: "--vtk", what: what.to_owned() });
        }
        within("--points", self.points, 2, MAX_POINTS)?;
        within("--frames", self.frames, 2, MAX_FRAMES)
    }

    /// The characteristics. Without the option, each covers the range in which the muscle pulls at its
    /// pressure.
    fn isobars(&self, extended: &MuscleWithEffects, pressures: &[Pressure]) -> Result<Vec<Isobar>, Failure> {
        let mut found = Vec::with_capacity(pressures.len());
        let mut rest = pressures;
        while let Some(first) = rest.first() {
            let contractions = self.contractions(extended, *first)?;
            // Pressures with the same range are solved together: a shape that doesn't depend on the pressure
            // is then solved once.
            let mut same = 1;
            for pressure in &rest[1..] {
                if self.contractions(extended, *pressure)? != contractions {
                    break;
                }
                same += 1;
            }
            let isobars = extended.isobars(&rest[..same], &contractions, self.method.approach());
            found.extend(isobars.map_err(about_extended(extended.muscle(), *first))?);
            rest = &rest[same..];
        }
        Ok(found)
    }

    /// The contractions from the option, or over the range in which the muscle pulls at the pressure.
    fn contractions(&self, extended: &MuscleWithEffects, pressure: Pressure) -> Result<Vec<f64>, Failure> {
        let [low, high] = if let Some(text) = &self.contraction {
            range::<Ratio>("--contraction", text)?
        } else {
            let muscle = extended.muscle();
            let end = extended.range_end(pressure, self.method.approach());
            let limit = end.map_err(about_extended(muscle, pressure))?.contraction();
            let longest =
                Problem::new(extended.parts(), pressure).map_err(about(muscle, pressure))?.longest();
            match longest {
                // The force diverges as the fibres become straight.
                Some(longest) if longest >= 0.0 => [longest + DRAWN_OUT * (limit - longest), limit],
                // It pulls only when it is stretched.
                Some(longest) if limit <= 0.0 => [limit + 0.5 * (longest - limit), limit],
                None if limit <= 0.0 => [limit - FIRST_STRETCH, limit],
                _ => [0.0, limit],
            }
        };
        if low >= high {
            let what = format!(
                "the range {low}..{high} is empty: write the smaller contraction first, as in \"0 %..35 %\"; `bulge shape` has a single one"
            );
            return Err(Failure::Value { option: "--contraction", what });
        }
        let step = (high - low) / (self.points - 1) as f64;
        let last = self.points - 1;
        Ok((0..self.points).map(|i| if i == last { high } else { low + step * i as f64 }).collect())
    }
}

/// A time series over the contractions of an isobar; its "time" is the contraction in per cent.
fn series(
    extended: &MuscleWithEffects,
    isobar: &Isobar,
    command: &CurveCommand,
    folder: &Path,
    several: bool,
) -> Result<PathBuf, Failure> {
    let muscle = extended.muscle();
    let pressure = Pressure::pa(isobar.pressure_pa);
    let about = about(muscle, pressure);
    let problem = Problem::new(extended.parts(), pressure).map_err(&about)?;
    let count = command.frames.min(isobar.points.len());
    let last = isobar.points.len() - 1;
    let shapes: Vec<(f64, Shape)> = (0..count)
        .map(|i| {
            let contraction = isobar.points[if count > 1 { i * last / (count - 1) } else { 0 }].contraction;
            let shape = {
                let given = extended.given(Given::Contraction(contraction));
                problem.shape(given, command.method.approach(), 101)?
            };
            Ok((contraction, shape))
        })
        .collect::<Result<_, _>>()
        .map_err(&about)?;
    let frames: Vec<_> = shapes
        .iter()
        .map(|(contraction, shape)| (100.0 * contraction, bulge(muscle, shape, None, None)))
        .collect();
    let folder =
        if several { folder.join(format!("{}-Pa", isobar.pressure_pa)) } else { folder.to_path_buf() };
    Ok(write_series(folder, "bulge", &frames)?)
}

/// Requested states that don't exist, with one reason for each end of the range.
fn left_out(isobars: &[Isobar]) -> String {
    let mut text = String::new();
    for isobar in isobars {
        let (beyond, before): (Vec<_>, Vec<_>) = isobar
            .without
            .iter()
            .partition(|(contraction, _)| isobar.contraction_limit.is_some_and(|limit| *contraction > limit));
        for part in [before, beyond] {
            if let Some((_, why)) = part.first() {
                let pressure = Pressure::pa(isobar.pressure_pa);
                let plural = if part.len() == 1 { "contraction is" } else { "contractions are" };
                let _ = writeln!(text, "  at {pressure}, {} {plural} left out: {why}", part.len());
            }
        }
    }
    text
}

fn document(muscle: &Muscle, isobars: &[Isobar]) -> serde_json::Value {
    let curves: Vec<_> = isobars
        .iter()
        .map(|isobar| {
            let without: Vec<_> = isobar
                .without
                .iter()
                .map(|(contraction, why)| json!({"contraction": contraction, "why": why.to_string()}))
                .collect();
            json!({
                "pressure_pa": isobar.pressure_pa,
                "contraction_limit": isobar.contraction_limit,
                "ends_slack": isobar.ends_slack,
                "points": isobar.points,
                "without_equilibrium": without,
            })
        })
        .collect();
    json!({"schema": "bulge.curve/1", "muscle": muscle.name(), "curves": curves})
}
