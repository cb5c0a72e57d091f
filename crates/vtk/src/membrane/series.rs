//! States of a run as numbered `.vtu` files and one `.pvd` that ParaView plays as a film.

use super::{MembranePicture, write_vtu};
use crate::series::{check_stem, collection, create, member_name};
use crate::{VtkError, whole_file};
use std::path::{Path, PathBuf};

/// A series that grows by a state at a time: `stem_0000.vtu`, `stem_0001.vtu`, ... and `stem.pvd`, which names all of them after each state, so
/// that a run that is broken off leaves a series that can be opened. It holds no states.
#[derive(Debug, Clone, PartialEq)]
pub struct MembraneSeries {
    dir: PathBuf,
    stem: String,
    times: Vec<f64>,
}

impl MembraneSeries {
    /// An empty series in the folder `dir`, which is created if needed. The files of an earlier series of this name are removed: its states
    /// would pass for those of this one. Nothing is written before the first state.
    ///
    /// # Errors
    /// The stem is no file name, the folder can't be created, or a file of an earlier series can't be removed.
    pub fn new(dir: impl AsRef<Path>, stem: &str) -> Result<Self, VtkError> {
        check_stem(stem)?;
        create(dir.as_ref())?;
        let series = Self { dir: dir.as_ref().to_path_buf(), stem: stem.to_owned(), times: Vec::new() };
        remove(&series.path())?;
        // Numbered without a gap.
        let mut member = 0;
        while remove(&series.dir.join(member_name(stem, member, "vtu")))? {
            member += 1;
        }
        Ok(series)
    }

    /// Writes one more state, then the `.pvd` with the time of each; the path of the state's file. After an error the series is as before.
    ///
    /// # Errors
    /// As [`write_vtu`].
    pub fn append(&mut self, picture: &MembranePicture) -> Result<PathBuf, VtkError> {
        let path = self.dir.join(member_name(&self.stem, self.times.len(), "vtu"));
        write_vtu(&path, picture)?;
        let times = self.times.iter().copied().chain([picture.time]);
        whole_file::write(&self.path(), collection(&self.stem, "vtu", times).as_bytes())?;
        self.times.push(picture.time);
        Ok(path)
    }

    /// Path of the `.pvd`.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.dir.join(format!("{}.pvd", self.stem))
    }

    /// States written.
    #[must_use]
    pub fn states(&self) -> usize {
        self.times.len()
    }
}

/// Whether there was such a file.
fn remove(path: &Path) -> Result<bool, VtkError> {
    match std::fs::remove_file(path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(VtkError::File { path: path.to_path_buf(), action: "remove the earlier", source }),
    }
}
