//! `bulge membrane`: a finite-element membrane case, state after state.

use bulge_membrane::Effort;
use bulge_membrane::case::{CASE_EXAMPLE, Case, CaseError, CaseRun, Row};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::fmt::Write;
use std::io::{IsTerminal, stderr, stdout};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::files;
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
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
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
        let mut run = case.start().map_err(|error| refused(error, String::new()))?;
        files::folder(&self.out)?;
        let bar = self.bar(case.states());
        let clock = Instant::now();
        let mut rows: Vec<Row> = Vec::new();
        while let Some(next) = run.advance(|_, _| bar.tick()) {
            let (row, _, _) = match next {
                Ok(next) => next,
                Err(error) => {
                    bar.finish_and_clear();
                    let kept = self.kept(&rows);
                    return Err(refused(error, kept));
                }
            };
            bar.set_message(line(&row));
            bar.inc(1);
            rows.push(row);
            files::write(&self.out.join("states.csv"), csv(&rows).as_bytes())?;
        }
        bar.finish_and_clear();
        if self.json {
            return self.document(&case, &run, &rows);
        }
        Ok(self.text(&case, &run, &rows, clock.elapsed()))
    }

    fn bar(&self, states: usize) -> ProgressBar {
        if !stderr().is_terminal() || (self.json && !stdout().is_terminal()) {
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

    /// What stands of a run that ended early.
    fn kept(&self, rows: &[Row]) -> String {
        match rows.last() {
            Some(row) => format!(
                "\n  the {} states before stand in {}; the last is {}",
                rows.len(),
                self.out.display(),
                line(row)
            ),
            None => "\n  no state was found: begin with a smaller load".to_owned(),
        }
    }

    fn document(&self, case: &Case, run: &CaseRun<'_>, rows: &[Row]) -> Result<String, Failure> {
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
            "states": rows,
        });
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }

    fn text(&self, case: &Case, run: &CaseRun<'_>, rows: &[Row], time: Duration) -> String {
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
            "\n  {iterations} iterations, {factorisations} factorisations of {factors} numbers in {}: elements {}, factors {}, solving {}",
            seconds(time),
            seconds(assembling),
            seconds(factorising),
            seconds(solving)
        );
        let _ = writeln!(text, "  states.csv in {}", self.out.display());
        text
    }
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

/// The result table: columns that say nothing are left out.
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
