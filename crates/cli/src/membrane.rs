//! `bulge membrane`: a finite-element membrane case, state by state.

use bulge_inference::{Fitting, Options};
use bulge_measurements::Data;
use bulge_membrane::case::{CASE_EXAMPLE, Case, CaseError, CaseRun, Row};
use bulge_membrane::{Effort, Fields, State};
use bulge_muscles::Muscle;
use bulge_report::Learnt;
use bulge_vtk::{MembranePicture, MembraneSeries, VtkError, Whole, write_vtu};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::fmt::Write;
use std::io::{IsTerminal, stderr, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::arguments::{self, Json, pretty};
use crate::failure::Failure;
use crate::files;
use crate::fit;
use crate::text::{shown, significant, table};

/// A finite-element membrane case: a mesh, what it is made of, what holds it, and loads in turn.
#[derive(Debug, Args)]
#[command(after_long_help = shown("A case file", CASE_EXAMPLE))]
pub(crate) struct MembraneCommand {
    /// The case: a TOML file (`bulge membrane --help` has an example with every key)
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Folder of the result: states.csv, a .vtu for each state and a .pvd that ParaView plays as a film
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Draw the whole muscle in every .vtu file, not only in that of the last state: sectors are repeated all round
    #[arg(long)]
    whole: bool,
    /// Write the muscle of the case with the effect `limited-unfolding` fitted to the states: what the cloth costs, for all other commands
    #[arg(long, value_name = "MODEL.toml")]
    as_effect: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl MembraneCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let case = Case::read(&self.case)?;
        let origin = self.case.display().to_string();
        let refused = |source: CaseError, kept: String| Failure::Membrane {
            origin: origin.clone(),
            source: Box::new(source),
            kept,
        };
        if let Some(path) = &self.as_effect {
            learns(&case)?;
            files::can_be_written(path)?;
        }
        let mut run = case.start().map_err(|error| refused(error, String::new()))?;
        files::folder(&self.out)?;
        let stem = stem(&case.name);
        let mut output = Output::new(self, &case, &stem)?;
        let bar = self.bar(case.states());
        let clock = Instant::now();
        while let Some(next) = run.advance(|_, _| bar.tick()) {
            match next {
                Ok((row, state, fields)) => {
                    bar.set_message(line(&row));
                    bar.inc(1);
                    output.take(row, &state, &fields)?;
                }
                Err(error) => {
                    bar.finish_and_clear();
                    let rescued = run.rescued();
                    let is_rescued = rescued.is_some();
                    if let Some((row, state, fields)) = rescued {
                        output.take(row, &state, &fields)?;
                    }
                    output.finish(&mut run)?;
                    return Err(refused(error, output.kept(is_rescued)));
                }
            }
        }
        bar.finish_and_clear();
        output.finish(&mut run)?;
        let time = clock.elapsed();
        let learnt = self.as_effect.as_ref().map(|path| self.learn(&case, &output, path)).transpose()?;
        if self.json.wanted {
            return self.document(&case, &run, &output, learnt.as_ref());
        }
        let mut text = describe(&case, &run, &output, time);
        let _ = writeln!(
            text,
            "  wrote {} and states.csv{}",
            output.series.path().display(),
            if output.has_forces { ", forces.csv (for `bulge compare`, `diagnose` and `fit`)" } else { "" }
        );
        text.extend(output.note.iter().map(|note| format!("  {note}\n")));
        if let (Some(fitted), Some(path)) = (&learnt, &self.as_effect) {
            let _ = writeln!(
                text,
                "\nthe effect of the cloth, fitted to these states\n\n{}\n  wrote {}",
                fit::lines(fitted).trim_end(),
                path.display()
            );
        }
        Ok(text)
    }

    fn bar(&self, states: usize) -> ProgressBar {
        if !stderr().is_terminal() || (self.json.wanted && !stdout().is_terminal()) {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::with_draw_target(Some(states as u64), ProgressDrawTarget::stderr());
        let template = "  {spinner} [{bar:30}] {pos} of {len} states, {eta} left  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        bar
    }

    /// The muscle with the fitted effect of its cloth.
    fn learn(&self, case: &Case, output: &Output, path: &Path) -> Result<Learnt, Failure> {
        let muscle = learns(case)?;
        let Some(forces) = forces(&output.rows) else {
            let what = "no state has a pressure and a contraction: there is nothing to learn from".to_owned();
            return Err(Failure::Value { option: "--as-effect", what });
        };
        let catalogue = arguments::catalogue(None)?;
        let effects = arguments::effects(&catalogue, &["limited-unfolding".to_owned()])?;
        let data = Data::from_csv(&forces, &self.out.join("forces.csv").display().to_string())?;
        let fitted = fit::learn(&data, muscle, &Options::new(catalogue, effects))?;
        is_the_cloth(case, &fitted)?;
        files::write(path, fitted.model.as_bytes())?;
        Ok(fitted)
    }

    fn document(
        &self,
        case: &Case,
        run: &CaseRun<'_>,
        output: &Output,
        learnt: Option<&Learnt>,
    ) -> Result<String, Failure> {
        let [unknowns, matrix, factors] = run.sizes();
        let document = json!({
            "schema": "bulge.membrane/1",
            "name": case.name,
            "folder": self.out,
            "nodes": case.mesh.nodes.len(),
            "elements": run.elements(),
            "unknowns": unknowns,
            "matrix_entries": matrix,
            "factor_entries": factors,
            "effort": effort(&run.effort()),
            "writing_s": output.writing.as_secs_f64(),
            "pvd": output.series.path(),
            "effect": learnt.map(|fitted| json!({
                "before_rmse_n": fitted.fitting.before_rmse_n,
                "rmse_n": fitted.fitting.rmse_n,
                "fit": fitted.fitting.fit,
                "model": fitted.model,
            })),
            "states": output.rows,
        });
        pretty(&document)
    }
}

/// The files of a run in its folder.
struct Output {
    folder: PathBuf,
    stem: String,
    series: MembraneSeries,
    rows: Vec<Row>,
    /// What is drawn of each state, and of the last one.
    each: Whole,
    whole: Whole,
    has_forces: bool,
    writing: Duration,
    note: Option<String>,
}

impl Output {
    /// Clears the folder: files of an earlier run of this case would be taken for results of this one.
    fn new(command: &MembraneCommand, case: &Case, stem: &str) -> Result<Self, Failure> {
        let folder = command.out.clone();
        let whole = Whole::of(case);
        // A sector repeated all round makes the files a hundred times larger.
        let is_sector = matches!(whole, Whole::Sector { .. });
        let each = if is_sector && !command.whole { Whole::AsMeshed } else { whole };
        let series = MembraneSeries::new(&folder, stem)?;
        let last = format!("{stem}-whole.vtu");
        files::remove(&["states.csv", "forces.csv", &last].map(|name| folder.join(name)))?;
        Ok(Self {
            folder,
            stem: stem.to_owned(),
            series,
            rows: Vec::new(),
            each,
            whole,
            has_forces: false,
            writing: Duration::ZERO,
            note: None,
        })
    }

    fn take(&mut self, row: Row, state: &State, fields: &Fields) -> Result<(), Failure> {
        let clock = Instant::now();
        self.series.append(&MembranePicture { state, fields, whole: self.each, time: row.state as f64 })?;
        self.rows.push(row);
        files::write(&self.folder.join("states.csv"), csv(&self.rows).as_bytes())?;
        self.writing += clock.elapsed();
        Ok(())
    }

    /// Writes the whole muscle in its last state, and the forces for other commands.
    fn finish(&mut self, run: &mut CaseRun<'_>) -> Result<(), Failure> {
        let clock = Instant::now();
        if self.each != self.whole && !self.rows.is_empty() {
            let (state, fields) = run.last();
            let time = self.rows.len() as f64;
            let picture = MembranePicture { state, fields: &fields, whole: self.whole, time };
            match write_vtu(self.folder.join(format!("{}-whole.vtu", self.stem)), &picture) {
                Err(error @ VtkError::TooManyPoints { .. }) => {
                    self.note = Some(format!("the whole muscle isn't drawn: {error}"));
                }
                done => done?,
            }
        }
        if let Some(forces) = forces(&self.rows) {
            files::write(&self.folder.join("forces.csv"), forces.as_bytes())?;
            self.has_forces = true;
        }
        self.writing += clock.elapsed();
        Ok(())
    }

    /// What remains of a run that ended early, as text.
    fn kept(&self, is_rescued: bool) -> String {
        match self.rows.last() {
            Some(row) => format!(
                "\n  states.csv and {} hold what was found; the last is {}{}",
                self.series.path().display(),
                if is_rescued { "the last equilibrium on the way to " } else { "" },
                line(row)
            ),
            None => "\n  no state of the case was reached: begin with a smaller load, or in smaller steps"
                .to_owned(),
        }
    }
}

fn describe(case: &Case, run: &CaseRun<'_>, output: &Output, time: Duration) -> String {
    let rows = &output.rows;
    let [unknowns, _, factors] = run.sizes();
    let mut text = format!(
        "{}: {} nodes, {} elements, {unknowns} unknowns\n\n",
        case.name,
        case.mesh.nodes.len(),
        run.elements()
    );
    text.push_str(&table(&cells(rows)));
    let unstable: Vec<String> =
        rows.iter().filter(|row| row.unstable > 0).map(|row| row.state.to_string()).collect();
    if !unstable.is_empty() {
        // Writing to a String can't fail.
        let _ = writeln!(
            text,
            "\n  unstable equilibria: state {}; the membrane would leave them for another shape",
            unstable.join(", ")
        );
    }
    let Effort { iterations, factorisations, assembling, factorising, solving } = run.effort();
    let _ = writeln!(
        text,
        "\n  {iterations} iterations, {factorisations} factorisations of {factors} numbers in {}: elements {}, factors {}, solving {}, files {}",
        seconds(time),
        seconds(assembling),
        seconds(factorising),
        seconds(solving),
        seconds(output.writing)
    );
    text
}

/// The muscle whose effect of the cloth can be fitted to a case.
fn learns(case: &Case) -> Result<&Muscle, Failure> {
    let is_shortened = case
        .steps
        .iter()
        .any(|step| step.contraction.is_some() || step.fittings.iter().flatten().next().is_some());
    match &case.muscle {
        Some(muscle) if muscle.is_pleated() && is_shortened => Ok(muscle),
        _ => Err(Failure::Value {
            option: "--as-effect",
            what: "the case needs a pleated muscle (`muscle` in `[mesher]`) and steps with a `contraction`"
                .to_owned(),
        }),
    }
}

/// Largest relative difference between the fitted radius and the radius of the cloth without a fold: lobes
/// become taut a little before it.
const NEAR: f64 = 0.2;

/// Rejects a fit that describes something else: the cloth must be unfolded at the fitted radius.
fn is_the_cloth(case: &Case, fitted: &Learnt) -> Result<(), Failure> {
    let parameters = &fitted.fitting.fit.parameters;
    let radius = parameters.iter().find(|parameter| parameter.name == "unfolded_radius");
    let (Some(cloth), Some(radius)) = (case.unfolded_radius.map(|radius| 1e3 * radius), radius) else {
        return Ok(());
    };
    if (radius.value / cloth - 1.0).abs() <= NEAR {
        return Ok(());
    }
    let Fitting { before_rmse_n, rmse_n, .. } = &fitted.fitting;
    Err(Failure::Outside(format!(
        "--as-effect: nothing is written: fitted to these states (error {} N, before {} N), limited unfolding would act from {} mm on, but the cloth \
         has no fold left at {} mm only (forces.csv stands). What costs force before that are the lobes between the fibres: contract further, or compare forces.csv with a \
         muscle that states `[effects.lobes]`",
        significant(*rmse_n, 3),
        significant(*before_rmse_n, 3),
        significant(radius.value, 4),
        significant(cloth, 4),
    )))
}

/// Bytes of a file name without the number of the state; systems allow 255.
const LONGEST_STEM: usize = 80;

/// A file name derived from the name of a case.
fn stem(name: &str) -> String {
    let mut stem = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            stem.extend(c.to_lowercase());
        } else if !stem.is_empty() && !stem.ends_with('-') {
            stem.push('-');
        }
    }
    let mut end = stem.len().min(LONGEST_STEM);
    while !stem.is_char_boundary(end) {
        end -= 1;
    }
    let stem = stem[..end].trim_end_matches('-').to_owned();
    if stem.is_empty() { "membrane".to_owned() } else { stem }
}

/// The states in the format of measurements, if they have a contraction and a force.
fn forces(rows: &[Row]) -> Option<String> {
    let mut text = String::from("pressure [Pa],contraction,force [N],diameter [m],volume [m^3]\n");
    for row in rows.iter().filter(|row| row.pressure > 0.0) {
        let (contraction, force) = (row.contraction?, row.force?);
        let _ = writeln!(text, "{},{contraction},{force},{},{}", row.pressure, row.diameter, row.volume);
    }
    (text.lines().count() > 1).then_some(text)
}

fn seconds(time: Duration) -> String {
    format!("{} s", significant(time.as_secs_f64(), 3))
}

fn effort(effort: &Effort) -> serde_json::Value {
    json!({
        "iterations": effort.iterations,
        "factorisations": effort.factorisations,
        "elements_s": effort.assembling.as_secs_f64(),
        "factors_s": effort.factorising.as_secs_f64(),
        "solving_s": effort.solving.as_secs_f64(),
    })
}

/// A state in a few words.
fn line(row: &Row) -> String {
    let mut text = format!("state {}: {} bar", row.state, significant(row.pressure / 1e5, 4));
    if let Some(contraction) = row.contraction {
        let _ = write!(text, ", {} %", significant(100.0 * contraction, 4));
    }
    if let Some(force) = row.force {
        let _ = write!(text, ", {} N", significant(force, 5));
    }
    text
}

/// The table of results, without empty columns.
fn cells(rows: &[Row]) -> Vec<Vec<String>> {
    let has = |what: &dyn Fn(&Row) -> bool| rows.iter().any(what);
    let has_contraction = has(&|row| row.contraction.is_some());
    let has_force = has(&|row| row.force.is_some());
    let has_sheet = has(&|row| row.taut + row.wrinkled + row.slack > 0.0);
    let has_thread = has(&|row| row.threads[1] > 0.0);
    let mut heading = vec!["state".to_owned(), "p [bar]".to_owned()];
    let mut add = |is_there: bool, names: &[&str]| {
        if is_there {
            heading.extend(names.iter().map(|name| (*name).to_owned()));
        }
    };
    add(has_contraction, &["contraction [%]"]);
    add(has_force, &["force [N]"]);
    add(true, &["volume [ml]", "diameter [mm]"]);
    add(has_sheet, &["taut/wrinkled/slack [%]", "sheet [N/mm]"]);
    add(has_thread, &["fibre [N]"]);
    let mut all = vec![heading];
    for row in rows {
        let mut cells = vec![row.state.to_string(), significant(row.pressure / 1e5, 5)];
        if has_contraction {
            cells.push(row.contraction.map_or_else(String::new, |c| significant(100.0 * c, 4)));
        }
        if has_force {
            cells.push(row.force.map_or_else(String::new, |f| significant(f, 6)));
        }
        cells.extend([significant(1e6 * row.volume, 6), significant(1e3 * row.diameter, 5)]);
        if has_sheet {
            let share = |x: f64| format!("{:.0}", 100.0 * x);
            cells.push([row.taut, row.wrinkled, row.slack].map(share).join("/"));
            cells.push(row.forces.map(|n| significant(n / 1e3, 3)).join(" to "));
        }
        if has_thread {
            cells.push(row.threads.map(|n| significant(n, 4)).join(" to "));
        }
        all.push(cells);
    }
    all
}

/// All states with their units.
fn csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "state,step,pressure [Pa],contraction,force [N],volume [m^3],largest_diameter [m],taut,wrinkled,slack,\
         membrane_force_min [N/m],membrane_force_max [N/m],fibre_tension_min [N],fibre_tension_max [N],energy [J],unstable,\
         iterations,residual\n",
    );
    for row in rows {
        let maybe = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:e}",
            row.state,
            row.step,
            row.pressure,
            maybe(row.contraction),
            maybe(row.force),
            row.volume,
            row.diameter,
            row.taut,
            row.wrinkled,
            row.slack,
            row.forces[0],
            row.forces[1],
            row.threads[0],
            row.threads[1],
            row.energy,
            row.unstable,
            row.iterations,
            row.residual
        );
    }
    text
}
