//! Errors between a shape and a file on disk.

use std::path::{Path, PathBuf};

/// Why a VTK file wasn't written.
#[derive(Debug, thiserror::Error)]
pub enum VtkError {
    /// The shape, or how it is to be drawn: what is wrong, where, and what to do instead.
    #[error("{0}")]
    Drawing(String),
    /// More points than the limit for a file.
    #[error(
        "{copies} copies of {points} points are more than a file holds ({most}): draw fewer facets or copies"
    )]
    TooManyPoints {
        /// Number of copies of the mesh, or of facets.
        copies: usize,
        /// Points per copy.
        points: usize,
        /// Largest number of points.
        most: u32,
    },
    /// An operation of the file system failed.
    #[error("{}: can't {action}: {source}", path.display())]
    File {
        /// File or folder concerned.
        path: PathBuf,
        /// The operation.
        action: &'static str,
        /// Its error.
        source: std::io::Error,
    },
}

impl VtkError {
    /// A value of a shape as a whole that is infinite or not a number. `place` begins with " at", if it is
    /// needed.
    pub(crate) fn not_finite(quantity: &str, value: f64, place: &str) -> Self {
        Self::Drawing(format!("{quantity} is {value}{place}: only finite values can be written"))
    }

    /// Too few facets around the axis.
    pub(crate) fn facets(found: u32, least: u32) -> Self {
        Self::Drawing(format!(
            "{found} facets are too few to draw a round cross-section: use {least} or more"
        ))
    }
}

/// Checks the extension of a name, by which ParaView chooses its reader.
pub(crate) fn check_extension(path: &Path, wanted: &str) -> Result<(), VtkError> {
    if path.extension().is_some_and(|found| found.eq_ignore_ascii_case(wanted)) {
        return Ok(());
    }
    Err(VtkError::Drawing(format!("{}: the name of the file must end in .{wanted}", path.display())))
}
