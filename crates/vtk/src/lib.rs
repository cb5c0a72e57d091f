//! VTK files of bulging pneumatic muscles for ParaView.
//!
//! A [`Bulge`] describes how an equilibrium shape is drawn: as a surface of revolution, or with the cloth
//! folded into pleats between the fibres. [`write_vtp`] writes one shape. [`write_series`] writes many, and a
//! `.pvd` that ParaView plays as an animation. Lengths are in metres; the axis of the muscle is the x axis,
//! and the left fitting is at x = 0.
//!
//! Content of a file (`PolyData`: the cloth as quadrangles, each fibre as one polyline, outward normals):
//!
//! | where | arrays |
//! |---|---|
//! | points | `radius_m` (of the fibres), `cloth_radius_m` (of the point itself), `slope_rad`, `braid_angle_rad`, `fibre_tension_N`, `fibre_strain`, `membrane_force_N_per_m` |
//! | cells | `part` (0 cloth, 1 fibre), `area_m2` (0 for a fibre), `membrane_force_N_per_m` |
//! | field data | `pressure_Pa`, `force_N`, `length_m`, `contraction`, `volume_m3` |
//!
//! States of the membrane finite elements are written as unstructured grids in their own coordinates, with
//! the axis along z: [`MembranePicture`], [`write_vtu`], [`MembraneSeries`]; a run with its
//! tables in a [`CaseFolder`].
//!
//! This crate solves nothing and reads nothing: every file is a function of a [`bulge_fibre::Shape`], or of a
//! [`bulge_membrane::State`] and its fields.
#[cfg(test)]
mod analytic;
mod bulge;
mod error;
mod membrane;
mod mesh;
mod panel;
mod series;
mod vtp;
mod whole_file;
mod xml;

pub use bulge::{Bulge, Style};
pub use error::VtkError;
pub use membrane::{CaseFolder, MembranePicture, MembraneSeries, Whole, write_vtu};
pub use mesh::Mesh;
pub use series::write_series;
pub use vtp::{vtp_bytes, write_vtp};
