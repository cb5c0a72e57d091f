//! The folder of a run: states.csv, forces.csv, a `.vtu` for each state and the whole muscle in the last one.
//!
//! A state is written by a thread while the next one is sought.

use bulge_membrane::case::{Case, CaseRun, Row, Written, forces_csv, states_csv};
use bulge_membrane::{Fields, State};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::series::remove;
use super::writer::Writer;
use super::{MembranePicture, MembraneSeries, Whole, write_vtu};
use crate::{VtkError, whole_file};

/// Bytes of a file name without the number of the state; systems allow 255.
const LONGEST_STEM: usize = 80;

/// The files of a run in its folder.
#[derive(Debug)]
pub struct CaseFolder {
    folder: PathBuf,
    stem: String,
    series: PathBuf,
    states: Writer,
    rows: Vec<Row>,
    /// What is drawn of each state, and of the last one.
    each: Whole,
    whole: Whole,
    has_forces: bool,
    writing: Duration,
    note: Option<String>,
}

impl CaseFolder {
    /// Clears the folder: files of an earlier run of this case would be taken for results of this one. Unless
    /// `is_whole`, sectors are drawn as meshed in all states but the last.
    ///
    /// # Errors
    /// The folder can't be created, or an earlier file can't be removed.
    pub fn new(folder: &Path, case: &Case, is_whole: bool) -> Result<Self, VtkError> {
        let whole = Whole::of(case);
        // A sector repeated all round makes the files a hundred times larger.
        let is_sector = matches!(whole, Whole::Sector { .. });
        let each = if is_sector && !is_whole { Whole::AsMeshed } else { whole };
        let stem = stem(&case.name);
        let states = MembraneSeries::new(folder, &stem)?;
        for name in ["states.csv", "forces.csv", &format!("{stem}-whole.vtu")] {
            remove(&folder.join(name))?;
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            stem,
            series: states.path(),
            states: Writer::new(states),
            rows: Vec::new(),
            each,
            whole,
            has_forces: false,
            writing: Duration::ZERO,
            note: None,
        })
    }

    /// Takes one more state, which is written beside what follows.
    ///
    /// # Errors
    /// A file of the state before can't be written.
    pub fn take(&mut self, row: Row, state: State, fields: Fields) -> Result<(), VtkError> {
        let clock = Instant::now();
        let (whole, time) = (self.each, row.state as f64);
        self.states.rest()?;
        self.rows.push(row);
        let (path, csv) = (self.folder.join("states.csv"), states_csv(&self.rows));
        self.states.begin(move |series| {
            series.append(&MembranePicture { state: &state, fields: &fields, whole, time })?;
            whole_file::write(&path, csv.as_bytes())
        })?;
        self.writing += clock.elapsed();
        Ok(())
    }

    /// Waits for the files of the states, then writes the whole muscle in its last state, and the forces for other
    /// commands.
    ///
    /// # Errors
    /// A file can't be written. A whole muscle that is too large for a file is told of by [`Self::note`].
    pub fn finish(&mut self, run: &mut CaseRun<'_>) -> Result<(), VtkError> {
        let clock = Instant::now();
        self.states.rest()?;
        if self.each != self.whole && !self.rows.is_empty() {
            let (state, fields) = run.last();
            let time = self.rows.len() as f64;
            let picture = MembranePicture { state, fields: &fields, whole: self.whole, time };
            match write_vtu(self.folder.join(format!("{}-whole.vtu", self.stem)), &picture) {
                Err(error @ VtkError::TooManyPoints { .. }) => {
                    self.note = Some(format!("the whole muscle isn't drawn: {error}"));
                }
                done => done?,
            }
        }
        if let Some(forces) = forces_csv(&self.rows) {
            whole_file::write(&self.forces(), forces.as_bytes())?;
            self.has_forces = true;
        }
        self.writing += clock.elapsed();
        Ok(())
    }

    /// The states so far.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Path of the file that lists the states.
    #[must_use]
    pub fn pvd(&self) -> &Path {
        &self.series
    }

    /// Path of the forces for other commands.
    #[must_use]
    pub fn forces(&self) -> PathBuf {
        self.folder.join("forces.csv")
    }

    /// Whether forces were written.
    #[must_use]
    pub const fn has_forces(&self) -> bool {
        self.has_forces
    }

    /// Time spent waiting for files.
    #[must_use]
    pub const fn writing(&self) -> Duration {
        self.writing
    }

    /// What is noteworthy about the files.
    #[must_use]
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// What was written, for the document.
    #[must_use]
    pub fn written(&self) -> Written<'_> {
        let seconds = self.writing.as_secs_f64();
        Written { folder: Some(&self.folder), pvd: Some(&self.series), seconds }
    }
}

/// A file name derived from the name of a case.
fn stem(name: &str) -> String {
    let mut stem = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            stem.extend(c.to_lowercase());
        } else if !stem.is_empty() && !stem.ends_with('-') {
            stem.push('-');
        }
    }
    let mut end = stem.len().min(LONGEST_STEM);
    while !stem.is_char_boundary(end) {
        end -= 1;
    }
    let stem = stem[..end].trim_end_matches('-').to_owned();
    if stem.is_empty() { "membrane".to_owned() } else { stem }
}
