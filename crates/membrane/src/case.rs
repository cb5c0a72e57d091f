//! Cases: a mesh, its materials, its supports, and a sequence of loads, from a TOML file.

mod document;
mod ends;
mod example;
mod materials;
mod nested;
mod parts;
mod read;
mod run;
mod source;
mod steps;
mod supports;

pub use document::{CaseDocument, Written, forces_csv, states_csv};
pub use ends::Ends;
pub use example::CASE_EXAMPLE;
pub use run::{CaseError, CaseRun, Row};

use crate::material::Sheet;
use crate::mesh::Mesh;
use crate::state::{Copies, Tolerance};
use crate::structure::{Fitting, Part, Support};
use bulge_muscles::Muscle;
use serde::Serialize;

/// The contents of a case file.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// The mesh, in m.
    pub mesh: Mesh,
    /// How the mesh was made, if a coarser one can be made in the same way.
    lattice: Option<nested::Lattice>,
    /// What the groups of the mesh are made of.
    pub parts: Vec<(String, Part)>,
    /// Supports of the groups.
    pub supports: Vec<(String, Support)>,
    /// Groups of supports whose plane of symmetry the cloth doesn't pass through.
    pub contacts: Vec<String>,
    /// Groups whose sheets resist bending, with their bending stiffness D \[N m\].
    pub bending: Vec<(String, f64)>,
    /// The end fittings with their names.
    pub fittings: Vec<(String, Fitting)>,
    /// The fittings between which a contraction is measured; `None` without fittings.
    pub ends: Option<Ends>,
    /// How often the mesh occurs in the whole structure.
    pub copies: Copies,
    /// Unpressurised length between the end fittings, m, if the case has a contraction.
    pub length: Option<f64>,
    /// The loads in sequence.
    pub steps: Vec<Step>,
    /// Convergence criteria of an equilibrium.
    pub tolerance: Tolerance,
    /// The muscle that the mesh was made for, with the fibres of the case.
    pub muscle: Option<Muscle>,
    /// Radius of a pleated cloth without any fold: its circumference over 2 pi, m.
    pub unfolded_radius: Option<f64>,
    /// The sheets by name.
    pub materials: Vec<(String, Sheet)>,
}

/// A load, reached from the one before.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// Whether it starts from the mesh at rest instead of the previous state.
    pub is_restart: bool,
    /// What fills the membrane.
    pub filling: Filling,
    /// Motions of the fittings at its end: positions relative to those in the mesh, m, or forces, N. `None`:
    /// unchanged.
    pub fittings: Vec<Option<f64>>,
    /// The contraction at its end, if the step prescribes one.
    pub contraction: Option<f64>,
    /// Number of states that are kept on the way, including the last one.
    pub states: usize,
}

/// What fills the membrane in a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Filling {
    /// A gauge pressure, Pa.
    Pressure(f64),
    /// A volume, m^3.
    Volume(f64),
    /// The gas enclosed at the beginning of the step stays: its exponent, and the ambient pressure, Pa.
    Closed {
        /// 1 at constant temperature, 1.4 without heat exchange.
        gamma: f64,
        /// Ambient pressure, Pa.
        ambient: f64,
    },
}
