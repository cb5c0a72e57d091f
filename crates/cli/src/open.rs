//! `bulge open`: the workbench in a browser.

use bulge_muscles::{PRESETS, output};
use bulge_workbench::{Choices, ChosenEffect, DataFile, MuscleFile, Start, serve};
use clap::Args;
use serde_json::json;
use std::collections::BTreeMap;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::arguments;
use crate::demo;
use crate::failure::Failure;
use crate::files;
use crate::said::{answer, message};

/// Folder of the tour's files in a session.
const TOUR: &str = "tour";

/// A page in the browser: drop measurements, see where the model fails, switch an effect on, watch the error fall.
///
/// It is served on this machine alone, at an address that only this run knows; Ctrl-C ends it.
#[derive(Debug, Args)]
pub(crate) struct OpenCommand {
    /// Measured rows, as for `bulge compare`; without them and without a session, those of the tour
    #[arg(value_name = "DATA")]
    data: Vec<PathBuf>,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: Option<String>,
    /// Which column is which: "force=Force_N [N], pressure=P1 [psi], length=-Weg"
    #[arg(long, value_name = "QUANTITY=COLUMN,...")]
    columns: Option<String>,
    /// Effects to begin with: `--with end-taper,bladder-elasticity`
    #[arg(long, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Port to listen on [default: any that is free]
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Only print the address
    #[arg(long)]
    no_browser: bool,
    /// Folder that keeps the session: opened again, it goes on where it was
    #[arg(long, value_name = "DIR")]
    session: Option<PathBuf>,
    /// The address as a JSON document, in one line
    #[arg(long)]
    json: bool,
}

impl OpenCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let _lock = self.session.as_deref().map(lock).transpose()?;
        let is_stated = !self.data.is_empty() || self.muscle.is_some() || !self.with.is_empty();
        // The temporary files of the tour are removed when this value is dropped.
        let tour = tempfile::Builder::new()
            .prefix("bulge-tour-")
            .tempdir()
            .map_err(|source| Failure::Output { path: std::env::temp_dir(), source })?;
        let folder = self.session.as_deref().unwrap_or(tour.path()).join(TOUR);
        let choices = Choices {
            data: self.files(&folder)?,
            columns: self.columns.clone(),
            muscle: self.muscle_file()?,
            effects: self
                .with
                .iter()
                .map(|name| ChosenEffect { name: name.trim().to_owned(), hold: BTreeMap::new() })
                .collect(),
            own_effects: self.effects.as_deref().map(text_of).transpose()?,
            excluded: Vec::new(),
        };
        self.check(&choices)?;
        let start = Start { choices, is_stated, port: self.port, session: self.session.clone() };
        serve(start, |address| {
            let said = if self.json {
                json!({ "schema": "bulge.open/1", "address": address }).to_string()
            } else {
                address.to_owned()
            };
            let _ = answer(&(said + "\n"));
            message("Ctrl-C ends it.\n");
            if !self.no_browser && !browser(address) {
                message("Open the address in a browser.\n");
            }
        })?;
        Ok(String::new())
    }

    /// The data files; those of the tour if none are named.
    fn files(&self, folder: &Path) -> Result<Vec<DataFile>, Failure> {
        if self.data.is_empty() {
            let (name, text) = demo::DATA;
            let path = folder.join(name);
            files::folder(folder)?;
            files::write(&path, text.as_bytes())?;
            return Ok(vec![DataFile { name: name.to_owned(), path }]);
        }
        let one = |path: &PathBuf| {
            let found =
                std::path::absolute(path).map_err(|source| Failure::Output { path: path.clone(), source })?;
            Ok(DataFile { name: path.display().to_string(), path: found })
        };
        self.data.iter().map(one).collect()
    }

    /// The muscle named; that of the tour if none is.
    fn muscle_file(&self) -> Result<MuscleFile, Failure> {
        let Some(name) = &self.muscle else {
            let (_, toml) = demo::MUSCLE;
            return Ok(MuscleFile { toml: toml.to_owned(), origin: None });
        };
        // Read as by every command, so that errors have the same wording.
        arguments::muscle(name)?;
        let path = Path::new(name);
        let shipped = PRESETS.iter().find(|preset| preset.name == name && !path.exists());
        let toml = shipped.map_or_else(|| text_of(path), |preset| Ok(preset.text.to_owned()))?;
        Ok(MuscleFile { toml, origin: Some(name.clone()) })
    }

    /// Reports errors that would otherwise appear on the page: unknown effects, impossible columns.
    fn check(&self, choices: &Choices) -> Result<(), Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        arguments::effects(&catalogue, &self.with)?;
        if let Some(columns) = &choices.columns {
            columns.parse::<bulge_measurements::ColumnMap>()?;
        }
        for file in &choices.data {
            if !file.path.exists() {
                let what = format!("there is no file {}: check the name", file.name);
                return Err(Failure::Value { option: "DATA", what });
            }
        }
        Ok(())
    }
}

/// Locks the folder of a session for as long as the file is open: two workbenches would overwrite each other's
/// choices. The system releases the lock when a process ends, for whatever reason.
fn lock(session: &Path) -> Result<File, Failure> {
    files::folder(session)?;
    let path = session.join(".lock");
    let file = output::lock_file(&path).map_err(|source| Failure::Output { path, source })?;
    if let Err(TryLockError::WouldBlock) = file.try_lock() {
        let what = format!(
            "{} is open in another workbench: end that one, or give another folder",
            session.display()
        );
        return Err(Failure::Value { option: "--session", what });
    }
    // Where the file system has no locks, nothing can be told.
    Ok(file)
}

/// The content of a text file.
fn text_of(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|source| Failure::Value {
        option: "bulge open",
        what: format!("cannot read {}: {source}", path.display()),
    })
}

/// Opens an address as the desktop does; returns whether that could be tried.
fn browser(address: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}
