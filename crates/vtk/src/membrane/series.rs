//! States of a run as numbered `.vtu` files and one `.pvd` that ParaView plays as an animation.

use super::{MembranePicture, write_vtu};
use crate::series::{check_stem, collection, create, member_name};
use crate::{VtkError, whole_file};
use std::path::{Path, PathBuf};

/// A series written state by state: `stem_0000.vtu`, `stem_0001.vtu`, ... and `stem.pvd`, which is rewritten
/// after each state and lists all of them. So an interrupted run leaves a series that can be opened. The
/// states aren't kept in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct MembraneSeries {
    dir: PathBuf,
    stem: String,
    times: Vec<f64>,
}

impl MembraneSeries {
    /// An empty series in the folder `dir`, which is created if needed. The files of an earlier series of
    /// this name are removed, since its states would be taken for states of this one. Nothing is written
    /// before the first state.
    ///
    /// # Errors
    /// The stem can't be part of a file name, the folder can't be created, or a file of an earlier series
    /// can't be removed.
    pub fn new(dir: impl AsRef<Path>, stem: &str) -> Result<Self, VtkError> {
        check_stem(stem)?;
        create(dir.as_ref())?;
        let series = Self { dir: dir.as_ref().to_path_buf(), stem: stem.to_owned(), times: Vec::new() };
        remove(&series.path())?;
        // The members are numbered without a gap.
        let mut member = 0;
        while remove(&series.dir.join(member_name(stem, member, "vtu")))? {
            member += 1;
        }
        Ok(series)
    }

    /// Writes one more state, then the `.pvd` with the time of each, and returns the path of the state's
    /// file. After an error the series is unchanged.
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

/// Removes a file; returns whether it existed.
pub(super) fn remove(path: &Path) -> Result<bool, VtkError> {
    match bulge_muscles::output::remove(path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(VtkError::File { path: path.to_path_buf(), action: "remove the earlier", source }),
    }
}
