//! Files that appear whole or not at all.

use crate::VtkError;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes `bytes` under a temporary name in the same folder, forces them to the disk and renames; leaves nothing behind on failure.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), VtkError> {
    let failed =
        |action: &'static str| move |source| VtkError::File { path: path.to_path_buf(), action, source };
    if path.is_dir() {
        return Err(failed("write a file of this name")(io::ErrorKind::IsADirectory.into()));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let missing = io::Error::new(io::ErrorKind::NotFound, format!("no folder {}", folder.display()));
        return Err(failed("create the file")(missing));
    }
    publish(&temporary_name(path), path, bytes).map_err(failed("write the file"))
}

/// Writes to `temporary` and renames to `path`.
fn publish(temporary: &Path, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let published = fill(temporary, bytes).and_then(|()| fs::rename(temporary, path));
    if published.is_err() {
        // The first error is the one to report; a temporary file that was never created can't be removed either.
        let _ = fs::remove_file(temporary);
    }
    published
}

/// A hidden name beside `path`, unique among the processes and threads that write there.
fn temporary_name(path: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}-{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    path.with_file_name(name)
}

fn fill(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failed_rename_leaves_no_temporary_file() {
        let folder = std::env::temp_dir().join(format!("bulge-vtk-rename-{}", std::process::id()));
        let occupied = folder.join("occupied");
        fs::create_dir_all(&occupied).unwrap();
        let temporary = temporary_name(&occupied);
        assert_eq!(temporary.parent(), Some(folder.as_path()));
        assert!(publish(&temporary, &occupied, b"text").is_err());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "only the folder that was there");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn replaces_an_older_file_as_a_whole() {
        let path = std::env::temp_dir().join(format!("bulge-vtk-whole-{}", std::process::id()));
        write(&path, b"a longer text").unwrap();
        write(&path, b"short").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"short");
        fs::remove_file(&path).unwrap();
    }

    #[test]
    fn temporary_names_differ() {
        let path = Path::new("folder/a.vtp");
        assert_ne!(temporary_name(path), temporary_name(path));
    }
}
