//! Measured rows on the command line: the files, the assignment of columns, and how they were read.

use bulge_effects::{Catalogue, Effect, known};
use bulge_inference::{Options, rows_to_exclude};
use bulge_measurements::{ColumnMap, Data, ReadOptions, Reading};
use bulge_model::read_options;
use bulge_muscles::Muscle;
use bulge_report::Call;
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::failure::Failure;
use crate::files;
use crate::text::table;

/// Most rejected rows and columns shown in text.
const MOST_SHOWN: usize = 3;
const MOST_COLUMNS: usize = 40;

/// What every command takes that reads measurements.
#[derive(Debug, Args)]
pub(crate) struct DataArguments {
    /// Measured rows, with columns of pressure, force, and length, contraction or displacement: CSV and other text, Excel (.xlsx), MATLAB (.mat) or
    /// Parquet; "-" is standard input; several files make one analysis
    #[arg(required = true, value_name = "DATA")]
    pub(crate) data: Vec<PathBuf>,
    /// Which column is which, where the headings don't say it: "force=Force_N [N], pressure=P1 [psi], length=-Weg" (a minus turns the sign); the
    /// table `[data.columns]` of the muscle file says the same
    #[arg(long, value_name = "QUANTITY=COLUMN,...")]
    pub(crate) columns: Option<String>,
    /// Rows to leave out, by their lines: "12,33-40", with several files "a.csv:12,b.csv:33-40"
    #[arg(long, value_name = "LINES")]
    pub(crate) exclude: Option<String>,
}

impl DataArguments {
    /// Rejects an output file that can't be written or would overwrite an input, before anything is computed.
    pub(crate) fn can_write(
        &self,
        written: files::Named<'_>,
        muscle: &str,
        effects: Option<&Path>,
    ) -> Result<(), Failure> {
        let read: Vec<files::Named<'_>> =
            self.read_with(effects).chain([("the muscle file", Path::new(muscle))]).collect();
        files::are_apart(&[written], &read)?;
        files::can_be_written(written.1)
    }

    /// The files that are read: measurements, and the user's own effects.
    pub(crate) fn read_with<'a>(
        &'a self,
        effects: Option<&'a Path>,
    ) -> impl Iterator<Item = files::Named<'a>> {
        let data = self.data.iter().map(|path| ("the data file", path.as_path()));
        data.chain(effects.map(|path| ("the file of --effects", path)))
    }

    /// Options of a comparison: these effects in addition to those in the muscle file, without the excluded
    /// rows.
    pub(crate) fn options(
        &self,
        data: &Data,
        muscle: &Muscle,
        catalogue: Catalogue,
        effects: Vec<Arc<dyn Effect>>,
    ) -> Result<Options, Failure> {
        let known = known(muscle, &catalogue)?;
        let options = Options { known, ..Options::new(catalogue, effects) };
        Ok(match &self.exclude {
            Some(lines) => options.excluding(lines, data)?,
            None => options,
        })
    }

    /// The excluded rows.
    pub(crate) fn excluded(&self, data: &Data) -> Result<Vec<usize>, Failure> {
        let rows = self.exclude.as_deref().map(|lines| rows_to_exclude(lines, data)).transpose()?;
        Ok(rows.unwrap_or_default())
    }

    /// Reads the files of measurements of a muscle.
    pub(crate) fn read(&self, muscle: &Muscle) -> Result<Data, Failure> {
        Ok(Data::read_with(&self.data, &self.reading_options(muscle)?)?)
    }

    /// As [`Self::read`], for files that may have no force.
    pub(crate) fn read_with_or_without_force(&self, muscle: &Muscle) -> Result<Data, Failure> {
        let options = ReadOptions { force_may_lack: true, ..self.reading_options(muscle)? };
        Ok(Data::read_with(&self.data, &options)?)
    }

    fn reading_options(&self, muscle: &Muscle) -> Result<ReadOptions, Failure> {
        let columns = self.columns.as_deref().map(str::parse::<ColumnMap>).transpose()?;
        Ok(read_options(muscle, columns.as_ref())?)
    }

    /// The arguments that a proposed next command reuses, with further files.
    pub(crate) fn call(&self, muscle: &str, with: &[String], effects: Option<&Path>, more: &[&str]) -> Call {
        Call {
            data: self.names().into_iter().chain(more.iter().map(|name| (*name).to_owned())).collect(),
            columns: self.columns.clone(),
            exclude: self.exclude.as_deref().map(|lines| self.lines_of(lines, !more.is_empty())),
            muscle: muscle.to_owned(),
            effects: effects.map(|path| path.display().to_string()),
            with: with.iter().map(|name| name.trim().to_owned()).collect(),
            restrictions: Vec::new(),
        }
    }

    /// The lines to exclude in the notation for several files: each with its file.
    fn lines_of(&self, lines: &str, beside_others: bool) -> String {
        let [only] = &self.data[..] else { return lines.to_owned() };
        let ranges = lines.split(',').map(str::trim).filter(|range| !range.is_empty());
        let named = |range: &str| {
            if range.contains(':') || !beside_others {
                range.to_owned()
            } else {
                format!("{}:{range}", only.display())
            }
        };
        ranges.map(named).collect::<Vec<_>>().join(",")
    }

    /// The names of the files, as given.
    pub(crate) fn names(&self) -> Vec<String> {
        self.data.iter().map(|path| path.display().to_string()).collect()
    }
}

/// How files were read, as text: the assignment of columns if it was guessed, and the rows that can't be
/// used.
pub(crate) fn told(reading: &Reading) -> String {
    let mut out = String::new();
    if reading.is_guessed() {
        out.push_str(&columns(reading));
    }
    for note in &reading.notes {
        let _ = writeln!(out, "  {note}");
    }
    if let Some(first) = reading.set_apart.first() {
        let lines: Vec<String> = reading
            .set_apart
            .iter()
            .take(MOST_SHOWN)
            .map(|row| format!("line {}: {}", row.row, row.reason))
            .collect();
        let count = reading.set_apart_rows;
        let more =
            if count > lines.len() { format!("; and {} more", count - lines.len()) } else { String::new() };
        let plural = if count == 1 { "row" } else { "rows" };
        let _ = writeln!(out, "  set apart {count} {plural} of {}: {}{more}", first.file, lines.join("; "));
    }
    if !out.is_empty() {
        out.push('\n');
    }
    out
}

/// One table with column, quantity, unit and first values; the columns that aren't read are listed once.
fn columns(reading: &Reading) -> String {
    let mut rows = vec![["column", "taken for", "unit", "first values", ""].map(String::from).to_vec()];
    let is_read = |column: &&bulge_measurements::ColumnUse| column.quantity.is_some();
    for column in reading.columns.iter().filter(is_read).take(MOST_COLUMNS) {
        rows.push(vec![
            column.column.clone(),
            column.quantity.clone().unwrap_or_default(),
            column.unit.clone().unwrap_or_default(),
            column.first.join(" "),
            column.says.clone().unwrap_or_default(),
        ]);
    }
    let mut out = table(&rows);
    let ignored: Vec<String> = reading
        .columns
        .iter()
        .filter(|column| column.quantity.is_none())
        .map(|column| match column.says.as_deref().and_then(|says| says.strip_prefix("ignored: ")) {
            Some(why) => format!("{} ({why})", column.column),
            None => column.column.clone(),
        })
        .collect();
    if !ignored.is_empty() {
        let _ = writeln!(out, "  ignored: {}", ignored.join(", "));
    }
    out.push_str("  wrong? say which column is which: --columns \"force=Force_N [N], ...\"\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_another_file_lines_have_the_name_of_theirs() {
        let data = |exclude: &str| DataArguments {
            data: vec![PathBuf::from("a.csv")],
            columns: None,
            exclude: Some(exclude.to_owned()),
        };
        let exclude = |lines: &str, more: &[&str]| data(lines).call("m.toml", &[], None, more).exclude;
        assert_eq!(exclude("12, 33-40", &[]).as_deref(), Some("12,33-40"));
        assert_eq!(exclude("12,33-40", &["NEW.csv"]).as_deref(), Some("a.csv:12,a.csv:33-40"));
        assert_eq!(exclude("a.csv:12", &["NEW.csv"]).as_deref(), Some("a.csv:12"));
    }
}
