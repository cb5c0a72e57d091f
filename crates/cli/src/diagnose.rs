//! `bulge diagnose`: which physical effect is missing.

pub(crate) mod paragraph;
pub(crate) mod progress;
pub(crate) mod text;
pub(crate) mod untested;

use bulge_inference::{DiagnoseOptions, Diagnosis, diagnose};
use bulge_muscles::{Force, Quantity};
use bulge_report::diagnosis::{html, plots};
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::{self, Json, pretty};
use crate::data::{DataArguments, told};
use crate::failure::Failure;
use crate::files;
use crate::restricted::RestrictedArguments;
use crate::said;
use progress::Bar;

/// Which physical effect is missing: compares, looks for what the model lacks, adds it, and says how sure that is.
#[derive(Debug, Args)]
pub(crate) struct DiagnoseCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects that the model has already: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    #[command(flatten)]
    restricted: RestrictedArguments,
    /// Looks for these effects only, such as those that a hypothesis is about: `--among creep,coulomb-friction`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    among: Vec<String>,
    /// Your own effects, as expressions in a TOML file: they are looked for too
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// RMS misfit that doesn't matter: `--tolerance "5 N"` [default: whatever stands out of the noise and of what the data sheets allow]
    #[arg(long, allow_hyphen_values = true, value_name = "FORCE")]
    tolerance: Option<String>,
    /// Seed of the random numbers: the same seed gives the same answer
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for report.html, the plots as SVG files, and diagnosis.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What each stage took, in seconds and fits, on standard error
    #[arg(long)]
    progress: bool,
    #[command(flatten)]
    json: Json,
}

impl DiagnoseCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let tolerance_n = self.tolerance.as_deref().map(tolerance).transpose()?;
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let among = arguments::among(&catalogue, &self.among)?;
        let data = self.data.read(&muscle)?;
        let base = self.data.options(&data, &muscle, catalogue, effects)?;
        // Parameters without a width in the file get the usual one, as in the diagnosis.
        let base = self.restricted.apply(base, &data, &muscle.clone().with_usual_widths().0)?;
        let bar = Bar::new(self.json.wanted);
        let progress = bar.progress();
        let options =
            DiagnoseOptions { among, tolerance_n, seed: self.seed, progress, ..DiagnoseOptions::new(base) };
        let found = diagnose(&data, &muscle, &options)?;
        let profile = bar.profile();
        drop(bar);
        if self.progress {
            said::message(&profile);
        }
        let document = pretty(&found)?;
        let mut wrote = String::new();
        if let Some(folder) = &self.out {
            for path in report(folder, &found, &document)? {
                let _ = writeln!(wrote, "  wrote {}", path.display());
            }
        }
        if self.json.wanted {
            Ok(document)
        } else {
            let mut call = self.data.call(&self.muscle, &self.with, self.effects.as_deref(), &[]);
            call.restrictions = self.restricted.stated();
            Ok(told(&found.data.reading) + &text::text(&found, &call) + &wrote)
        }
    }
}

/// A misfit that is tolerated \[N\].
fn tolerance(text: &str) -> Result<f64, Failure> {
    let tolerance_n = arguments::quantity::<Force>("--tolerance", text)?.si();
    if tolerance_n < 0.0 {
        let what =
            format!("{text} is less than nothing; give the RMS misfit that doesn't matter, such as `5 N`");
        return Err(Failure::Value { option: "--tolerance", what });
    }
    Ok(tolerance_n)
}

/// Writes the report: a page, its plots as single files, and the numbers. Returns the files to look at first.
pub(crate) fn report(folder: &Path, diagnosis: &Diagnosis, document: &str) -> Result<[PathBuf; 2], Failure> {
    // Everything is generated before anything is written.
    let page = html(diagnosis)?;
    let plots = plots(diagnosis)?;
    let [numbers, first] = [folder.join("diagnosis.json"), folder.join("report.html")];
    let mut contents = vec![(numbers.clone(), document), (first.clone(), page.as_str())];
    contents.extend(plots.iter().map(|plot| (folder.join(format!("{}.svg", plot.name)), plot.svg.as_str())));
    files::write_all(folder, &contents)?;
    Ok([first, numbers])
}
