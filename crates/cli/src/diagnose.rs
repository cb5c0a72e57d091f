//! `bulge diagnose`: which physical effect is missing.

use bulge_effects::known;
use bulge_inference::{DiagnoseOptions, Options, diagnose};
use bulge_measurements::Data;
use clap::Args;
use std::path::PathBuf;

use crate::arguments;
use crate::failure::Failure;

/// Which physical effect is missing: compares, looks for what the model lacks, adds it, and says how sure that is.
#[derive(Debug, Args)]
pub(crate) struct DiagnoseCommand {
    /// Measured rows: CSV (or Parquet) with columns such as `pressure [bar]`, `contraction [%]`, `force [N]`; several files make one analysis
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects that the model has already: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    /// Your own effects, as expressions in a TOML file: they are looked for too
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

impl DiagnoseCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = Data::read(&self.data)?;
        let known = known(&muscle, &catalogue)?;
        let base = Options { known, ..Options::new(catalogue, effects) };
        let options = DiagnoseOptions { base, tolerance_n: None, seed: self.seed };
        let found = diagnose(&data, &muscle, &options)?;
        Ok(serde_json::to_string_pretty(&found)? + "\n")
    }
}
