//! Detects the format of a file by its first bytes.

use super::{Mesh, MeshError};

impl Mesh {
    /// Reads a mesh in any known format: MSH of Gmsh, or VTU of VTK. `origin` is the file's name in messages.
    ///
    /// # Errors
    ///
    /// Those of [`Self::from_msh`] and [`Self::from_vtu`], or an unknown format.
    pub fn from_bytes(bytes: &[u8], origin: &str) -> Result<Self, MeshError> {
        let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        match start.first() {
            Some(b'$') => Self::from_msh(bytes, origin),
            Some(b'<') => Self::from_vtu(bytes, origin),
            _ if start.starts_with(b"# vtk DataFile") => Self::from_vtu(bytes, origin),
            found => {
                let what = if found.is_some() {
                    "the file is no mesh that can be read"
                } else {
                    "the file is empty"
                };
                let instead =
                    "give a mesh of Gmsh (.msh, version 4.1 or 2.2) or an unstructured grid of VTK (.vtu)";
                Err(MeshError { file: origin.to_owned(), what: what.to_owned(), instead: instead.to_owned() })
            }
        }
    }
}
