//! `bulge compare`: model against measurement, and the error as effects are added.

use bulge_effects::Effect;
use bulge_inference::{Comparison, DataSummary, Fit, HeldNumber, Rows, compare_with_rows};
use bulge_measurements::written;
use bulge_report::comparison::{html, plots};
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::arguments::{self, Json, pretty};
use crate::data::{DataArguments, told};
use crate::failure::Failure;
use crate::files;
use crate::restricted::{LossArgument, RestrictedArguments};
use crate::text::{counted, significant, three, with_interval};

/// Model against measurement. Effects are fitted only if you name them with `--with`.
#[derive(Debug, Args)]
pub(crate) struct CompareCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects to add, in this order: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    #[command(flatten)]
    restricted: RestrictedArguments,
    #[command(flatten)]
    loss: LossArgument,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// A force law of the papers as the base instead of the equilibrium (`bulge effects --laws`)
    #[arg(long, value_name = "LAW")]
    law: Option<String>,
    /// Fit the coefficients of `--law` to the data
    #[arg(long, requires = "law")]
    fit_law: bool,
    /// Fit every force law of the papers to the same data, for comparison
    #[arg(long)]
    rivals: bool,
    /// Folder for report.html, the plots as SVG files, and compare.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// File for all rows, CSV or Parquet by its ending: what was read, the force of the base and of the last rung, and why a row doesn't count
    #[arg(long, value_name = "FILE.csv|.parquet")]
    rows: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl CompareCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = self.data.read(&muscle)?;
        let mut options = self.data.options(&data, &muscle, catalogue, effects)?;
        options.rivals = self.rivals;
        if let Some(name) = &self.law {
            options = options
                .with_law(name, &muscle, self.fit_law)
                .map_err(|what| Failure::Value { option: "--law", what })?;
        }
        let mut options = self.restricted.apply(options, &data, &muscle)?;
        options.loss = self.loss.loss();
        if let Some(path) = &self.rows {
            self.data.can_write(("--rows", path), &self.muscle, self.effects.as_deref())?;
        }
        let (comparison, rows) = compare_with_rows(&data, &muscle, &options)?;
        let document = pretty(&comparison)?;
        let mut wrote = String::new();
        if let Some(path) = &self.rows {
            files::write(path, &written(path, &rows.columns())?)?;
            let _ = writeln!(wrote, "  wrote {}", path.display());
        }
        if let Some(folder) = &self.out {
            for path in report(folder, &comparison, &rows, &document)? {
                let _ = writeln!(wrote, "  wrote {}", path.display());
            }
        }
        if self.json.wanted { Ok(document) } else { Ok(text(&comparison, &options.effects) + &wrote) }
    }
}

/// Writes the report: a page, its plots as single files, and the numbers. Returns the files to look at first.
pub(crate) fn report(
    folder: &Path,
    comparison: &Comparison,
    rows: &Rows,
    document: &str,
) -> Result<[PathBuf; 2], Failure> {
    // Everything is generated before anything is written.
    let page = html(comparison, Some(rows))?;
    let plots = plots(comparison)?;
    let [numbers, first] = [folder.join("compare.json"), folder.join("report.html")];
    let mut contents = vec![(numbers.clone(), document), (first.clone(), page.as_str())];
    contents.extend(plots.iter().map(|plot| (folder.join(format!("{}.svg", plot.name)), plot.svg.as_str())));
    files::write_all(folder, &contents)?;
    Ok([first, numbers])
}

/// From where to where the data reach.
pub(crate) fn spans(data: &DataSummary) -> String {
    let span = |ends: [f64; 2]| ends.map(three).join(" to ");
    let (bar, percent) = (data.pressure_pa.map(|p| p / 1e5), data.contraction.map(|e| 100.0 * e));
    format!("{} bar, contraction {} %, force {} N", span(bar), span(percent), span(data.force_n))
}

/// The comparison for people.
pub(crate) fn text(comparison: &Comparison, effects: &[Arc<dyn Effect>]) -> String {
    let mut out = String::new();
    let data = &comparison.data;
    let _ = writeln!(out, "{} against {}\n", comparison.muscle, data.files.join(", "));
    out.push_str(&told(&data.reading));
    let kind = if data.is_path { "along paths" } else { "in a static map" };
    let _ = writeln!(out, "  {} {kind}: {}", counted(data.rows, "row"), spans(data));
    for held in &comparison.isotonic {
        let _ = writeln!(
            out,
            "  sweep {} held {} N: contraction off by {} % with the base, {} % with all (RMS)",
            held.sweep,
            three(held.load_n),
            three(100.0 * held.rmse_contraction[0]),
            three(100.0 * held.rmse_contraction[1])
        );
    }
    for left in &data.left_out {
        let _ = writeln!(out, "  left out {} (line {}): {}", counted(left.rows, "row"), left.lines, left.why);
    }
    for finding in &comparison.quality {
        let _ = writeln!(out, "  {}", finding.says);
    }
    ladder(&mut out, comparison);
    if let Some(rung) = comparison.ladder.last() {
        match &rung.fit {
            Some(fit) => parameters(&mut out, fit, &rung.held),
            None => held(&mut out, &rung.held),
        }
    }
    rivals(&mut out, comparison);
    for warning in &comparison.warnings {
        let _ = writeln!(out, "  ! {warning}");
    }
    if effects.is_empty() {
        let _ = writeln!(
            out,
            "\n  Add effects with --with NAME,... (`bulge effects` lists them) and watch the error fall."
        );
    }
    out
}

pub(crate) fn ladder(out: &mut String, comparison: &Comparison) {
    let width = comparison
        .ladder
        .iter()
        .map(|r| r.added.as_deref().unwrap_or(&comparison.base).len())
        .max()
        .unwrap_or(0)
        .max(14);
    let _ = writeln!(
        out,
        "\n    {:<width$}  {:>9}  {:>10}  {:>9}  {:>8}  fitted",
        "model", "error", "full scale", "held out", "R^2"
    );
    for (i, rung) in comparison.ladder.iter().enumerate() {
        let sign = if i == 0 { " " } else { "+" };
        let held = rung.held_out_rmse_n.map_or_else(|| "-".to_owned(), |v| format!("{} N", three(v)));
        let _ = writeln!(
            out,
            "  {sign} {:<width$}  {:>7} N  {:>8.2} %  {held:>9}  {:>8.5}  {:>6}",
            rung.added.as_deref().unwrap_or(&comparison.base),
            three(rung.rmse_n),
            rung.rmse_percent,
            rung.r_squared,
            rung.fitted
        );
    }
    if let Some(floor) = &comparison.noise_floor {
        let percent = 100.0 * floor.sd_n / comparison.data.full_scale_n;
        let _ = writeln!(
            out,
            "    {:<width$}  {:>7} N  {percent:>8.2} %  ({})",
            "noise floor",
            three(floor.sd_n),
            floor.source
        );
    }
}

/// Parameters that were fixed at a value or tied to another one.
fn held(out: &mut String, numbers: &[HeldNumber]) {
    if numbers.is_empty() {
        return;
    }
    let label = |number: &HeldNumber| match &number.specimen {
        Some(specimen) => format!("{} {} [{specimen}]", number.effect, number.name),
        None => format!("{} {}", number.effect, number.name),
    };
    let _ = writeln!(out, "\n  numbers that were not fitted");
    let width = numbers.iter().map(|number| label(number).len()).max().unwrap_or(0);
    for number in numbers {
        let unit = if number.unit == "1" { "" } else { &number.unit };
        let how = number.to.as_ref().map_or_else(|| number.how.to_owned(), |to| format!("tied to {to}"));
        let _ = writeln!(
            out,
            "    {:<width$}  {:>9} {unit:<6} {how}",
            label(number),
            significant(number.value, 4)
        );
    }
}

/// The fitted parameters with their intervals, and the fixed ones.
pub(crate) fn parameters(out: &mut String, fit: &Fit, held_numbers: &[HeldNumber]) {
    fitted(out, fit);
    held(out, held_numbers);
}

fn fitted(out: &mut String, fit: &Fit) {
    if fit.parameters.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "\n  fitted numbers with 95 % intervals ({} rows count as independent)",
        fit.effective_rows.round()
    );
    let label = |p: &bulge_inference::Fitted| match &p.specimen {
        Some(specimen) => format!("{} {} [{specimen}]", p.effect, p.name),
        None => format!("{} {}", p.effect, p.name),
    };
    let width = fit.parameters.iter().map(|p| label(p).len()).max().unwrap_or(0);
    for p in &fit.parameters {
        let mut notes = Vec::new();
        if p.nuisance {
            let where_it_is = if p.plausible { "within" } else { "BEYOND" };
            notes.push(format!("nuisance, {where_it_is} its stated width"));
        }
        if !p.plausible && !p.nuisance {
            notes.push("IMPLAUSIBLE".to_owned());
        }
        if let Some(side) = p.at_bound {
            notes.push(format!("at its {side} bound"));
        }
        if !p.determined {
            notes.push("not determined".to_owned());
        }
        if let Some((name, value, unit)) = &p.also {
            notes.push(format!("{name} {} {unit}", three(*value)));
        }
        let [value, low, high] = with_interval(p.value, p.low, p.high);
        let line = format!(
            "    {:<width$}  {value:>9} {:<6} {low} to {high}  {}",
            label(p),
            if p.unit == "1" { "" } else { &p.unit },
            notes.join(", ")
        );
        let _ = writeln!(out, "{}", line.trim_end());
    }
}

fn rivals(out: &mut String, comparison: &Comparison) {
    if comparison.rivals.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n  force laws of the papers on the same data");
    let width = comparison.rivals.iter().map(|rival| rival.law.len()).max().unwrap_or(0);
    for rival in &comparison.rivals {
        if let Some(failed) = &rival.failed {
            let _ = writeln!(out, "    {:<width$}  {failed}", rival.law);
            continue;
        }
        let printed =
            rival.printed_rmse_n.map_or_else(String::new, |v| format!(", as printed {} N", three(v)));
        let held = rival.held_out_rmse_n.map_or_else(String::new, |v| format!(", held out {} N", three(v)));
        let _ = writeln!(
            out,
            "    {:<width$}  {:>7} N  {:.2} %  with {} numbers{printed}{held}",
            rival.law,
            three(rival.rmse_n),
            rival.rmse_percent,
            rival.fitted
        );
    }
}
