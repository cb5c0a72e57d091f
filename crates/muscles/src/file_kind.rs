//! The names of settings files, and their text, which must be small and UTF-8.

use crate::file_error::FileError;
use crate::settings::nearest;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Most bytes of a settings file.
pub(crate) const MOST_BYTES: usize = 1 << 20;

/// The names of a kind of settings file in messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileKind {
    /// The kind of file, such as "protocol".
    pub name: &'static str,
    /// A typical file name, such as "protocol.toml".
    pub file: &'static str,
    /// A line of such a file with a unit, such as `period = "50 s"`.
    pub line: &'static str,
}

impl FileKind {
    /// The text of such a file.
    ///
    /// # Errors
    /// If the file can't be read, is a folder, is larger than 1 MiB or is not UTF-8. The message is complete.
    pub fn read(self, path: &Path) -> Result<String, FileError> {
        let origin = path.display().to_string();
        let failed = |what: &str, instead: String| FileError::whole(&origin, what, instead);
        if path.is_dir() {
            let instead = format!("name a file in it, such as `{}`", path.join(self.file).display());
            return Err(failed(&format!("this is a directory, not a {} file", self.name), instead));
        }
        let unreadable = |error: std::io::Error| match error.kind() {
            ErrorKind::NotFound => failed("there is no such file", similar_file(path)),
            ErrorKind::PermissionDenied => {
                failed("the file may not be read", "check its permissions, or copy it".to_owned())
            }
            _ => failed(
                &format!("the file cannot be read: {error}"),
                format!("name a {} file, such as `{}`", self.name, self.file),
            ),
        };
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        // The size is checked before the encoding: a file that is cut off may end within a character.
        if bytes.len() > MOST_BYTES {
            return Err(self.too_large(&origin));
        }
        String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            // The bytes are valid up to there, so the replacement character stands exactly there.
            let text = String::from_utf8_lossy(error.as_bytes());
            let what = format!("byte {at} is not UTF-8 text");
            let instead = "save the file as plain text with the encoding UTF-8";
            FileError::at(&origin, &text, at..at + 1, what, instead)
        })
    }

    pub(crate) fn too_large(self, origin: &str) -> FileError {
        let what = format!("the file is larger than 1 MiB, so it is no {} file", self.name);
        let instead =
            format!("name a {} file: some ten lines of TOML (measured data go into a CSV file)", self.name);
        FileError::whole(origin, what, instead)
    }
}

/// The TOML file in the same folder whose name is nearest to the missing one.
fn similar_file(path: &Path) -> String {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let listed = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let mut names: Vec<String> = listed.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| Path::new(name).extension().is_some_and(|extension| extension == "toml"));
    names.sort();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    match nearest(&wanted, names.iter().map(String::as_str)) {
        Some(name) => format!("did you mean `{}`?", directory.join(name).display()),
        None => "check the path and the working directory".to_owned(),
    }
}
