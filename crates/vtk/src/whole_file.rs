//! Files that appear whole or not at all, with the errors of this crate.

use crate::VtkError;
use bulge_muscles::output;
use std::io;
use std::path::Path;

/// Writes `bytes` to a file, or to the stream that the name stands for.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), VtkError> {
    let failed =
        |action: &'static str| move |source| VtkError::File { path: path.to_path_buf(), action, source };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let missing = io::Error::new(io::ErrorKind::NotFound, format!("no folder {}", folder.display()));
        return Err(failed("create the file")(missing));
    }
    output::write(path, bytes).map_err(failed("write the file"))
}
