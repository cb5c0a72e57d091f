//! `bulge membrane`: a finite-element membrane case, state by state.

use bulge_membrane::Effort;
use bulge_membrane::case::{CASE_EXAMPLE, Case, CaseError, CaseRun, Row};
use bulge_report::cloth::{self, ClothDocument};
use bulge_vtk::CaseFolder;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write;
use std::io::{IsTerminal, stderr, stdout};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::arguments::{Json, pretty};
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
            cloth::muscle(&case)?;
            files::can_be_written(path)?;
        }
        let mut run = case.start().map_err(|error| refused(error, String::new()))?;
        files::folder(&self.out)?;
        let mut output = CaseFolder::new(&self.out, &case, self.whole)?;
        let bar = self.bar(case.states());
        let clock = Instant::now();
        while let Some(next) = run.advance(|_, _| bar.tick()) {
            match next {
                Ok((row, state, fields)) => {
                    bar.set_message(line(&row));
                    bar.inc(1);
                    output.take(row, state, fields)?;
                }
                Err(error) => {
                    bar.finish_and_clear();
                    let rescued = run.rescued();
                    let is_rescued = rescued.is_some();
                    if let Some((row, state, fields)) = rescued {
                        output.take(row, state, fields)?;
                    }
                    output.finish(&mut run)?;
                    return Err(refused(error, kept(&output, is_rescued)));
                }
            }
        }
        bar.finish_and_clear();
        output.finish(&mut run)?;
        let time = clock.elapsed();
        let learnt = match &self.as_effect {
            Some(path) => {
                let learnt = cloth::learn(&case, output.rows(), &output.forces().display().to_string())?;
                files::write(path, learnt.model.as_bytes())?;
                Some(learnt)
            }
            None => None,
        };
        if self.json.wanted {
            let effect = learnt.as_ref().map(ClothDocument::of);
            return pretty(&serde_json::to_value(run.document(output.rows(), output.written(), effect))?);
        }
        let mut text = describe(&case, &run, &output, time);
        let _ = writeln!(
            text,
            "  wrote {} and states.csv{}",
            output.pvd().display(),
            if output.has_forces() { ", forces.csv (for `bulge compare`, `diagnose` and `fit`)" } else { "" }
        );
        text.extend(output.note().iter().map(|note| format!("  {note}\n")));
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
}

/// What remains of a run that ended early, as text.
fn kept(output: &CaseFolder, is_rescued: bool) -> String {
    match output.rows().last() {
        Some(row) => format!(
            "\n  states.csv and {} hold what was found; the last is {}{}",
            output.pvd().display(),
            if is_rescued { "the last equilibrium on the way to " } else { "" },
            line(row)
        ),
        None => {
            "\n  no state of the case was reached: begin with a smaller load, in smaller steps, or with a `[[step]]` of pressure before one of volume".to_owned()
        }
    }
}

fn describe(case: &Case, run: &CaseRun<'_>, output: &CaseFolder, time: Duration) -> String {
    let rows = output.rows();
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
        seconds(output.writing())
    );
    text
}

fn seconds(time: Duration) -> String {
    format!("{} s", significant(time.as_secs_f64(), 3))
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
