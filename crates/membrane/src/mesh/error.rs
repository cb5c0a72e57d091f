//! Errors of meshes.

use thiserror::Error;

/// Why a mesh can't be used: what is wrong, where, and what to write instead.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{file}: {what}\n  instead: {instead}")]
pub struct MeshError {
    /// Name of the file, with `:line` if the reader knows it.
    pub file: String,
    /// What is wrong.
    pub what: String,
    /// What to do about it.
    pub instead: String,
}
