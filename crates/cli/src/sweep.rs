//! `bulge sweep`: a family of muscles over its axes, into a data set and a table.

use bulge_sweep::{
    Built, Plan, Progress, RunOptions, SWEEP_EXAMPLE, Summary, TableDescription, run, table_text, tabulate,
};
use bulge_table::Table;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::io::{IsTerminal, stderr, stdout};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::arguments::{Json, pretty};
use crate::failure::Failure;
use crate::files;
use crate::table::errors;
use crate::text::shown;

/// Number of points from which a sweep must be confirmed.
const MANY: u128 = 1_000_000_000;
/// Points per second and core for the estimated duration: closed form.
const PER_SECOND: f64 = 1e6;

/// A parallel sweep over the axes of a family of muscles, into Parquet files and a certified table.
#[derive(Debug, Args)]
#[command(after_long_help = example())]
pub(crate) struct SweepCommand {
    /// What is swept: a TOML file (`bulge sweep --help` has an example with every key)
    #[arg(value_name = "SWEEP.toml")]
    sweep: PathBuf,
    /// Folder of the result: points/*.parquet, manifest.json, table.bulge
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Go on with what a stopped sweep has left in the folder
    #[arg(long)]
    resume: bool,
    /// These chunks only, such as 100..200: for several processes or machines that share the folder; `--resume` then completes it
    #[arg(long, value_name = "A..B", value_parser = range)]
    chunks: Option<Range<u64>>,
    /// Take the finished chunks of the same sweep over from another folder; what then is missing is computed, with `--resume` beside what is here
    #[arg(long, value_name = "DIR")]
    merge: Vec<PathBuf>,
    /// Write every chunk as CSV as well (csv/*.csv)
    #[arg(long)]
    csv: bool,
    /// Run a sweep of more than 10^9 points
    #[arg(long)]
    confirm: bool,
    #[command(flatten)]
    json: Json,
}

fn example() -> String {
    shown("A sweep file", SWEEP_EXAMPLE)
}

fn range(text: &str) -> Result<Range<u64>, String> {
    let numbers = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match numbers {
        Some((first, end)) if first < end => Ok(first..end),
        _ => Err("write the first chunk and the one after the last, such as 100..200".to_owned()),
    }
}

impl SweepCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let plan = Plan::read(&self.sweep)?;
        self.check_size(&plan)?;
        self.check_options(&plan)?;
        let summary = if plan.points() > 0 { Some(self.points(&plan)?) } else { None };
        let table = if self.chunks.is_none() { self.table(&plan)? } else { None };
        let mut document = json!({ "schema": "bulge.sweep/1", "name": plan.name, "folder": self.out });
        document["points"] = serde_json::to_value(&summary)?;
        document["table"] = table.as_ref().map_or(Value::Null, |(description, _)| json!(description));
        document["table_is_met"] = table.as_ref().map_or(Value::Null, |(_, is_met)| json!(is_met));
        self.json.or(&document, || self.text(&plan, summary.as_ref(), table.as_ref()))
    }

    /// Rejects options that make no sense if only a table is built.
    fn check_options(&self, plan: &Plan) -> Result<(), Failure> {
        let options =
            [("--chunks", self.chunks.is_some()), ("--merge", !self.merge.is_empty()), ("--csv", self.csv)];
        match options.into_iter().find(|(_, given)| *given && plan.points() == 0) {
            Some((option, _)) => {
                let what =
                    "this sweep has no points, only a table: leave the option out, or give the axes `points`";
                Err(Failure::Value { option, what: what.to_owned() })
            }
            None => Ok(()),
        }
    }

    fn check_size(&self, plan: &Plan) -> Result<(), Failure> {
        let asked = self.chunks.as_ref().map(|c| u128::from(c.end - c.start) * u128::from(plan.chunk));
        let points = asked.map_or(plan.points(), |asked| asked.min(plan.points()));
        if points <= MANY || self.confirm {
            return Ok(());
        }
        let columns = (plan.axes.len() + plan.outputs.len()) as f64;
        let bytes = points as f64 * 8.0 * columns;
        let cores = std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64);
        let hours = points as f64 / PER_SECOND / cores / 3600.0;
        let what = format!(
            "{points} points: about {:.0} GB in {} files, and at least {hours:.0} hours here; take fewer, or add `--confirm`",
            bytes / 1e9,
            points.div_ceil(plan.chunk.into()),
        );
        Err(Failure::Library { says: format!("{}: {what}", self.sweep.display()), status: 1 })
    }

    fn points(&self, plan: &Plan) -> Result<Summary, Failure> {
        files::can_be_folder(&self.out)?;
        let bar = Bar::new(self.json.wanted);
        let options = RunOptions {
            chunks: self.chunks.clone(),
            resume: self.resume,
            csv: self.csv,
            merge: self.merge.clone(),
        };
        Ok(run(plan, &self.out, &options, &|progress| bar.at(progress))?)
    }

    /// The table of the plan: built, or the existing one if it is the same.
    fn table(&self, plan: &Plan) -> Result<Option<(TableDescription, bool)>, Failure> {
        let Some(wish) = &plan.table else { return Ok(None) };
        files::folder(&self.out)?;
        let path = self.out.join("table.bulge");
        let text = table_text(plan, wish)?;
        if let Some(there) = same_table(&path, &text) {
            let is_met = there
                .outputs
                .iter()
                .all(|output| output.error <= wish.tolerance && output.gradient_error <= wish.gradient);
            self.describe(&there)?;
            return Ok(Some((there, is_met)));
        }
        let holds_points = self.out.join("plan.json").exists() && plan.points() == 0;
        let holds_another =
            !self.resume && fs::read(&path).is_ok_and(|there| Table::from_bytes(&there).is_ok());
        if holds_points || holds_another {
            let what = format!(
                "{} holds {}: take another folder{}",
                self.out.display(),
                if holds_points { "a sweep with points" } else { "another table" },
                if holds_points { "" } else { ", or add `--resume` to replace it" }
            );
            return Err(Failure::Value { option: "--out", what });
        }
        let bar = Bar::new(self.json.wanted);
        let Built { bytes, is_met, .. } = tabulate(plan, wish, &|what| bar.says(what))?;
        let description = TableDescription::of(&Table::from_bytes(&bytes)?)?;
        files::write(&path, &bytes)?;
        self.describe(&description)?;
        Ok(Some((description, is_met)))
    }

    /// Writes the description of the table beside it, also if a killed run has left only the table.
    fn describe(&self, description: &TableDescription) -> Result<(), Failure> {
        let json = pretty(description)?;
        let path = self.out.join("table.json");
        if fs::read(&path).is_ok_and(|there| there == json.as_bytes()) {
            return Ok(());
        }
        files::write(&path, json.as_bytes())
    }

    fn text(
        &self,
        plan: &Plan,
        summary: Option<&Summary>,
        table: Option<&(TableDescription, bool)>,
    ) -> String {
        let mut out = format!("{}\n\n", plan.name);
        if let Some(summary) = summary {
            let there = summary.chunks - summary.computed;
            let _ = writeln!(
                out,
                "  {} points in {} chunks ({} computed, {there} there already); {} without equilibrium",
                summary.points, summary.chunks, summary.computed, summary.infeasible
            );
            for damaged in &summary.damaged {
                let _ = writeln!(out, "  ! {damaged}: computed again");
            }
            let _ = writeln!(out, "  wrote {}", self.out.join("points").display());
            if !summary.is_complete {
                let _ = writeln!(out, "  not all chunks of the sweep: `--resume` completes it");
            }
        }
        if let Some((description, is_met)) = table {
            let _ = writeln!(out, "\n  table: {}, {} bytes", description.form, description.bytes);
            out.push_str(&errors(description));
            if !is_met {
                out.push_str("  ! the size limit came first: the tolerance is not met\n");
            }
            let _ = writeln!(out, "  wrote {}", self.out.join("table.bulge").display());
        }
        out
    }
}

/// The description of a table file, if the file is intact and its text is `text`.
fn same_table(path: &Path, text: &str) -> Option<TableDescription> {
    let bytes = fs::read(path).ok()?;
    let table = Table::from_bytes(&bytes).ok().filter(|table| table.text() == text)?;
    TableDescription::of(&table).ok()
}

/// A progress bar on standard error, for a user at a terminal: rate and time left.
struct Bar(ProgressBar);

impl Bar {
    fn new(json: bool) -> Self {
        if !stderr().is_terminal() || (json && !stdout().is_terminal()) {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }

    fn at(&self, progress: Progress) {
        // Rate and time left refer only to the points computed in this run.
        let all = progress.all.saturating_sub(progress.there);
        if self.0.length() != Some(all) {
            self.0.set_length(all);
            let template = "  {spinner} [{bar:30}] {human_pos} of {human_len} points, {per_sec}, {eta} left";
            if let Ok(style) = ProgressStyle::with_template(template) {
                self.0.set_style(style.progress_chars("=> "));
            }
        }
        self.0.set_position(progress.done.saturating_sub(progress.there));
    }

    fn says(&self, what: &str) {
        if let Ok(style) = ProgressStyle::with_template("  {spinner} {msg}") {
            self.0.set_style(style);
        }
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
