//! `bulge table`: looking values up in tables, and exporting tables.

mod export;

use bulge_muscles::units;
use bulge_sweep::TableDescription;
use bulge_table::Table;
use clap::{Args, Subcommand};
use serde_json::json;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use crate::arguments::{Json, pretty};
use crate::failure::Failure;
use crate::text::{significant, table as columns};

/// Larger files can't be tables of Bulge.
const MOST_BYTES: u64 = 1 << 30;

/// Look into a table, and take it elsewhere.
#[derive(Debug, Args)]
pub(crate) struct TableCommand {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Values and gradients at a point
    Eval(Eval),
    /// Axes, outputs, size and certified errors
    Info(Info),
    /// Rust source, a C header, CSV, JSON, or the papers' polynomials
    Export(export::Export),
    /// The table of a joint with two antagonistic muscles: torque and stiffness over angle and pressures
    Joint(export::JointCommand),
    /// The polynomials that S1 prints (Tables 1 and 2), beside what they were fitted to
    Papers(export::Papers),
}

#[derive(Debug, Args)]
struct Eval {
    /// A table, as `bulge sweep` writes it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The point: a value for every axis, such as "contraction=20 %,slenderness=6.875"
    #[arg(long, allow_hyphen_values = true)]
    at: String,
    #[command(flatten)]
    json: Json,
}

#[derive(Debug, Args)]
struct Info {
    /// A table, as `bulge sweep` writes it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    json: Json,
}

impl TableCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        match &self.what {
            What::Eval(eval) => eval.run(),
            What::Info(info) => info.run(),
            What::Export(export) => export.run(),
            What::Joint(joint) => joint.run(),
            What::Papers(papers) => papers.run(),
        }
    }
}

/// The bytes of a table file, checked.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let failed = |what: String| Failure::TableFile { path: path.to_owned(), what };
    let metadata = fs::metadata(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
    if metadata.is_dir() {
        return Err(failed("is a folder; name a table, such as `table.bulge` in it".to_owned()));
    }
    if metadata.len() > MOST_BYTES {
        return Err(failed(format!("has {} bytes: too many for a table", metadata.len())));
    }
    let bytes = fs::read(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
    Table::from_bytes(&bytes).map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}

impl Info {
    fn run(&self) -> Result<String, Failure> {
        let bytes = read(&self.file)?;
        let description = TableDescription::of(&Table::from_bytes(&bytes)?)?;
        if self.json.wanted {
            return pretty(&description);
        }
        let d = &description;
        let mut out = format!("{}\n\n  {}, {} bytes\n\n", self.file.display(), d.form, d.bytes);
        let mut rows = vec![["axis", "unit", "from", "to", "coefficients"].map(str::to_owned).to_vec()];
        for axis in &d.axes {
            let high = significant(axis.high, 6);
            rows.push(vec![
                axis.name.clone(),
                axis.unit.clone(),
                significant(axis.low, 6),
                if axis.is_fitted { format!("{high} at most: follows the others") } else { high },
                axis.coefficients.to_string(),
            ]);
        }
        out.push_str(&columns(&rows));
        out.push('\n');
        out.push_str(&errors(d));
        if d.edge_error > 0.0 {
            let _ = writeln!(out, "  the upper end of `{}` is within {:.1e}", d.axes[0].name, d.edge_error);
        }
        for meaning in d.from["meaning"].as_array().into_iter().flatten().filter_map(|m| m.as_str()) {
            let _ = writeln!(out, "  {meaning}");
        }
        Ok(out)
    }
}

/// The certified errors of the outputs.
pub(crate) fn errors(description: &TableDescription) -> String {
    let heading = ["output", "unit", "error", "rms", "gradient", "rms", "bound"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for output in &description.outputs {
        let mut row = vec![output.name.clone(), output.unit.clone()];
        let errors =
            [output.error, output.error_rms, output.gradient_error, output.gradient_error_rms, output.bound];
        row.extend(errors.map(|error| format!("{error:.1e}")));
        rows.push(row);
    }
    let note = format!("  relative errors, measured at {} points off the grid\n", description.checks);
    columns(&rows) + &note
}

impl Eval {
    fn run(&self) -> Result<String, Failure> {
        let bytes = read(&self.file)?;
        let table = Table::from_bytes(&bytes)?;
        let description = TableDescription::of(&table)?;
        let point = self.point(&description)?;
        let (axes, outputs) = (point.len(), description.outputs.len());
        let (mut values, mut gradients) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
        if table.sample(&point, &mut values, &mut gradients).is_none() {
            return Err(outside(&table, &description, &point));
        }
        if self.json.wanted {
            let mut at = json!({});
            for (axis, x) in description.axes.iter().zip(&point) {
                at[axis.name.as_str()] = json!(x);
            }
            let mut document = json!({ "schema": "bulge.table-value/1", "at": at });
            for (o, output) in description.outputs.iter().enumerate() {
                let mut gradient = json!({});
                for (i, axis) in description.axes.iter().enumerate() {
                    gradient[axis.name.as_str()] = json!(gradients[o * axes + i]);
                }
                document["values"][output.name.as_str()] = json!({
                    "value": values[o], "unit": output.unit, "gradient": gradient, "error": output.error,
                });
            }
            return pretty(&document);
        }
        let mut heading = vec!["output".to_owned(), "unit".to_owned(), "value".to_owned()];
        heading.extend(description.axes.iter().map(|axis| format!("d/d({})", axis.name)));
        let mut rows = vec![heading];
        for (o, output) in description.outputs.iter().enumerate() {
            let mut row = vec![output.name.clone(), output.unit.clone(), significant(values[o], 7)];
            row.extend((0..axes).map(|i| significant(gradients[o * axes + i], 6)));
            rows.push(row);
        }
        Ok(columns(&rows))
    }

    /// The values of the axes, in the order of the table.
    fn point(&self, description: &TableDescription) -> Result<Vec<f64>, Failure> {
        let failed = |what: String| Failure::Value { option: "--at", what };
        let names: Vec<&str> = description.axes.iter().map(|axis| axis.name.as_str()).collect();
        let all = names.iter().map(|name| format!("{name}=...")).collect::<Vec<_>>().join(",");
        let mut point = vec![None; names.len()];
        for part in self.at.split(',') {
            let Some((name, text)) = part.split_once('=') else {
                return Err(failed(format!("`{}` is no `name=value`: write `{all}`", part.trim())));
            };
            let (name, text) = (name.trim(), text.trim());
            let Some(i) = names.iter().position(|known| *known == name) else {
                return Err(failed(format!("the table has no axis `{name}`: write `{all}`")));
            };
            if point[i].is_some() {
                return Err(failed(format!("`{name}` stands twice")));
            }
            let unit = description.axes[i].unit.as_str();
            point[i] = Some(value(text, unit).map_err(|what| failed(format!("{name}: {what}")))?);
        }
        let missing = names.iter().zip(&point).find(|(_, x)| x.is_none());
        if let Some((name, _)) = missing {
            return Err(failed(format!("no value for the axis `{name}`: write `{all}`")));
        }
        Ok(point.into_iter().flatten().collect())
    }
}

/// The reason why a point has no value.
fn outside(table: &Table<'_>, description: &TableDescription, point: &[f64]) -> Failure {
    for (i, (axis, x)) in description.axes.iter().zip(point).enumerate().rev() {
        let high = if i == 0 { table.upper_end(point).unwrap_or(axis.high) } else { axis.high };
        if !(axis.low..=high).contains(x) {
            let what = format!(
                "{} = {x} lies outside the table: it goes from {} to {}{}",
                axis.name,
                significant(axis.low, 6),
                significant(high, 9),
                if axis.is_fitted { " there" } else { "" }
            );
            return Failure::Outside(what);
        }
    }
    let axis = &description.axes[0];
    Failure::Outside(format!(
        "{} = {:e}: the table has no value at its lower end, where an output or its gradient is infinite; give more than {}",
        axis.name, point[0], axis.low
    ))
}

/// A value in SI: a number in the unit of the axis, or one with a unit of the same dimension.
fn value(text: &str, unit: &str) -> Result<f64, String> {
    if let Ok(number) = text.parse::<f64>() {
        return Ok(number);
    }
    let found = units::any(text).map_err(|error| error.to_string())?;
    let wanted = if unit == "1" { "1".to_owned() } else { format!("1 {unit}") };
    let wanted = units::any(&wanted).map_err(|error| error.to_string())?;
    if found.dimension == wanted.dimension {
        return Ok(found.si);
    }
    Err(format!("`{text}` is {}, but must be {}", found.dimension.describe(), wanted.dimension.describe()))
}
