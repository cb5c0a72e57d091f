//! Files that appear whole or not at all.

use bulge_muscles::output;
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, wants_json};

/// Names of standard output.
const STDOUT: [&str; 4] = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];

/// Whether a file was written to standard output: messages of the command would corrupt it.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// The files that the command line names, and that there were when the command began.
static NAMED: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Keeps in mind which files the command line names: none that it names twice is written, because it is read too.
pub(crate) fn named(arguments: &[OsString]) {
    let values = arguments.iter().skip(1).flat_map(|argument| {
        let value = argument.to_str().and_then(|text| text.split_once('='));
        [Some(PathBuf::from(argument)), value.map(|(_, value)| PathBuf::from(value))]
    });
    let files = values.flatten().filter(|path| path.is_file());
    let _ = NAMED.set(files.filter_map(|path| output::file_of(&path)).collect());
}

/// Refuses to write over a file that the command reads.
pub(crate) fn is_not_read(path: &Path) -> Result<(), Failure> {
    let (Some(named), Some(file)) = (NAMED.get(), output::file_of(path)) else { return Ok(()) };
    if named.iter().filter(|named| **named == file).count() < 2 {
        return Ok(());
    }
    let source =
        io::Error::new(io::ErrorKind::InvalidInput, "the command reads it; give the name of another file");
    Err(Failure::Output { path: path.to_path_buf(), source })
}

/// Writes a whole file that the command doesn't read, or writes into the target of a name that is no regular file; "-" is
/// standard output.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    is_not_read(path)?;
    replace(path, bytes)
}

/// The same for a file that may take the place of one that is read.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |source| Failure::Output { path: path.to_path_buf(), source };
    if is_stdout(path) {
        return take_stdout(bytes).map_err(failed);
    }
    can_be_written(path)?;
    output::write(path, bytes).map_err(failed)
}

/// Writes one file to standard output, which then takes nothing else.
fn take_stdout(bytes: &[u8]) -> io::Result<()> {
    let wants_json = wants_json();
    if wants_json || IS_TAKEN.swap(true, Ordering::Relaxed) {
        let what = if wants_json { "a file or JSON, not both" } else { "one file, not several" };
        let what = format!("standard output can take {what}; give the name of a file");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    print(bytes)
}

/// Writes to standard output and flushes it. A reader that closes early (`| head`) is no error.
pub(crate) fn print(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}

/// Whether standard output holds a file.
pub(crate) fn stdout_is_taken() -> bool {
    IS_TAKEN.load(Ordering::Relaxed)
}

/// The name of a picture; one that promises another format than SVG is refused.
pub(crate) fn picture(name: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    let format = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match format.as_deref() {
        Some("png" | "jpg" | "jpeg" | "gif" | "tif" | "tiff" | "pdf" | "eps" | "ps") => {
            let named = path.with_extension("svg");
            Err(format!("pictures are written as SVG: write `{}`, and convert it", named.display()))
        }
        _ => Ok(path),
    }
}

/// Writes a file if requested; returns the line that reports it.
pub(crate) fn wrote(
    path: Option<&Path>,
    content: impl FnOnce() -> Result<String, Failure>,
) -> Result<String, Failure> {
    let Some(path) = path else { return Ok(String::new()) };
    write(path, content()?.as_bytes())?;
    Ok(format!("  wrote {}\n", path.display()))
}

/// Whether the path is standard output (such as "-"), where the file replaces all other output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    STDOUT.iter().any(|name| path == Path::new(name))
}

/// Writes a table as CSV and its plot, if requested; returns the lines that report them.
pub(crate) fn wrote_both(
    [csv, plot]: [Option<&Path>; 2],
    table: impl FnOnce() -> String,
    picture: impl FnOnce() -> Result<String, Failure>,
) -> Result<String, Failure> {
    let table = wrote(csv, || Ok(table()))?;
    Ok(table + &wrote(plot, picture)?)
}

/// Writes files into a folder, which is created if needed. Nothing is written if one of the names is that of
/// a folder.
pub(crate) fn write_all(into: &Path, contents: &[(PathBuf, &str)]) -> Result<(), Failure> {
    folder(into)?;
    if let Some((path, _)) = contents.iter().find(|(path, _)| path.is_dir()) {
        let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder; move it away");
        return Err(Failure::Output { path: path.clone(), source });
    }
    contents.iter().try_for_each(|(path, content)| write(path, content.as_bytes()))
}

/// Creates a folder with its parents if it doesn't exist.
pub(crate) fn folder(path: &Path) -> Result<(), Failure> {
    can_be_folder(path)?;
    output::create_folder(path).map_err(|source| Failure::Output { path: path.to_path_buf(), source })
}

/// Refuses a name that is that of a file, or below one.
pub(crate) fn can_be_folder(path: &Path) -> Result<(), Failure> {
    let Some(file) = path.ancestors().find(|above| above.exists()).filter(|above| !above.is_dir()) else {
        return Ok(());
    };
    let what = format!("{} is a file; give the name of a folder", file.display());
    let source = io::Error::new(io::ErrorKind::NotADirectory, what);
    Err(Failure::Output { path: path.to_path_buf(), source })
}

/// A file that a command reads or writes, with its name on the command line.
pub(crate) type Named<'a> = (&'static str, &'a Path);

/// Rejects writing one file twice or over a file that is read, before anything is computed. It doesn't matter
/// whether a file exists already, and links are followed.
pub(crate) fn are_apart(written: &[Named<'_>], read: &[Named<'_>]) -> Result<(), Failure> {
    let is_same = |a: &Path, b: &Path| {
        is_stdout(a) && is_stdout(b)
            || output::file_of(a).is_some_and(|file| output::file_of(b) == Some(file))
    };
    for (place, (option, path)) in written.iter().enumerate() {
        let refuse = |what: String| {
            let what = format!("{} is {what}; give the name of another file", path.display());
            Err(Failure::Value { option, what })
        };
        if let Some((what, _)) = read.iter().find(|(_, read)| read.exists() && is_same(path, read)) {
            return refuse(format!("{what}, which is read"));
        }
        if let Some((other, _)) = written[..place].iter().find(|(_, other)| is_same(path, other)) {
            return refuse(format!("what {other} writes"));
        }
    }
    Ok(())
}

/// Rejects, before a long run, a file that could not be written at its end.
pub(crate) fn can_be_written(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let source = if is_stdout(path) {
        return Ok(());
    } else if path.is_dir() {
        io::Error::new(io::ErrorKind::IsADirectory, "it is a folder; give the name of a file")
    } else if !folder.is_dir() {
        let missing = format!("there is no folder {}; create it first", folder.display());
        io::Error::new(io::ErrorKind::NotFound, missing)
    } else {
        return Ok(());
    };
    Err(Failure::Output { path: path.to_path_buf(), source })
}
