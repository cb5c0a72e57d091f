//! `bulge predict`: the force of a (fitted) muscle on new rows.

use bulge_inference::{Predicted, predict};
use bulge_measurements::written;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{self, Json};
use crate::data::{DataArguments, told};
use crate::failure::Failure;
use crate::files;
use crate::text::{counted, significant};

/// The force of new rows: the muscle with the effects that its file states (`bulge fit` writes one), with intervals, and with residuals where a force was measured.
#[derive(Debug, Args)]
pub(crate) struct PredictCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file, such as a learnt one, or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// File for all rows, CSV or Parquet by its ending; "-" is standard output
    #[arg(long, value_name = "FILE.csv|.parquet")]
    out: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl PredictCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        if let Some(out) = &self.out {
            self.data.can_write(("--out", out), &self.muscle, self.effects.as_deref())?;
        }
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let data = self.data.read_with_or_without_force(&muscle)?;
        let found = predict(&data, &muscle, &catalogue, &self.data.excluded(&data)?)?;
        let mut wrote = String::new();
        if let Some(path) = &self.out {
            files::write(path, &written(path, &found.written_columns())?)?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        self.json.or(&found, || format!("{}{}{wrote}", told(data.reading()), text(&found)))
    }
}

/// The prediction as text: summary figures, since the rows are in the file.
fn text(found: &Predicted) -> String {
    let three = |value: f64| significant(value, 3);
    let mut out = format!("{} predicted on {}\n\n", found.muscle, found.files.join(", "));
    let forces = found.columns.force_n.iter().filter(|force| force.is_finite());
    let [low, high] = forces.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], f| [l.min(*f), h.max(*f)]);
    let with = found.rows - found.without_state.as_ref().map_or(0, |left| left.rows);
    let range = if with > 0 { format!(", {} to {} N", three(low), three(high)) } else { String::new() };
    let _ = writeln!(out, "  {with} of {} rows have a state{range}", found.rows);
    if let Some(left) = &found.without_state {
        let _ = writeln!(
            out,
            "  without a state: {} (line {}): {}",
            counted(left.rows, "row"),
            left.lines,
            left.why
        );
    }
    if let Some(sd) = found.reading_sd_n {
        let _ = writeln!(
            out,
            "  95 % intervals of a reading: its scatter of {} N, and the doubt about",
            three(sd)
        );
    }
    let width = found.uncertain.iter().map(|n| n.effect.len() + n.name.len()).max().unwrap_or(0) + 1;
    for number in &found.uncertain {
        let unit = if number.unit == "1" { "" } else { &number.unit };
        let _ = writeln!(
            out,
            "    {:<width$}  {} +- {} {unit} ({}): {} N",
            format!("{} {}", number.effect, number.name),
            significant(number.value, 4),
            significant(number.sd, 2),
            number.from,
            three(number.moves_n)
        );
    }
    for left in &found.left_out {
        let _ = writeln!(
            out,
            "  not compared: {} (line {}): {}",
            counted(left.rows, "row"),
            left.lines,
            left.why
        );
    }
    match &found.against {
        Some(against) => {
            let coverage = against
                .coverage
                .map_or_else(String::new, |share| format!(", {:.1} % within their intervals", 100.0 * share));
            let _ = writeln!(
                out,
                "  against {} measured forces: RMS error {} N, mean {} N{coverage}",
                against.rows,
                three(against.rmse_n),
                three(against.bias_n)
            );
        }
        None if found.columns.measured_n.is_none() => {
            let _ = writeln!(out, "  the data have no force to compare with");
        }
        None => {}
    }
    for warning in &found.warnings {
        let _ = writeln!(out, "  ! {warning}");
    }
    out
}
