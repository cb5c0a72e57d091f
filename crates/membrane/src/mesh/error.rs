//! What can be wrong with a mesh.

use thiserror::Error;

/// A mesh that can't be used: what, where, and what to write instead.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{file}: {what}\n  instead: {instead}")]
pub struct MeshError {
    /// Name of the file, with `:line` where the reader knows it.
    pub file: String,
    /// What is wrong.
    pub what: String,
    /// What to do about it.
    pub instead: String,
}
