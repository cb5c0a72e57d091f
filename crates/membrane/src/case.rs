//! Cases: a mesh, what it is made of, what holds it, and the loads in turn, from a TOML file.

mod ends;
mod example;
mod materials;
mod parts;
mod read;
mod run;
mod source;
mod steps;
mod supports;

pub use ends::Ends;
pub use example::CASE_EXAMPLE;
pub use run::{CaseError, CaseRun, Row};

use crate::material::Sheet;
use crate::mesh::Mesh;
use crate::state::{Copies, Tolerance};
use crate::structure::{Fitting, Part, Support};
use bulge_muscles::Muscle;
use serde::Serialize;

/// Everything that a case file says.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// The mesh, in m.
    pub mesh: Mesh,
    /// What the groups of the mesh are.
    pub parts: Vec<(String, Part)>,
    /// What holds the groups.
    pub supports: Vec<(String, Support)>,
    /// The end fittings with their names.
    pub fittings: Vec<(String, Fitting)>,
    /// The fittings between which a contraction is measured; `None` without fittings.
    pub ends: Option<Ends>,
    /// How often the mesh stands in the whole.
    pub copies: Copies,
    /// Unpressurised length between the end fittings, m, if the case has a contraction.
    pub length: Option<f64>,
    /// The loads in turn.
    pub steps: Vec<Step>,
    /// When an equilibrium is good enough.
    pub tolerance: Tolerance,
    /// The muscle that the mesh was made for, with the fibres of the case.
    pub muscle: Option<Muscle>,
    /// Radius of a pleated cloth without any fold: its circumference over 2 pi, m.
    pub unfolded_radius: Option<f64>,
    /// The sheets by name.
    pub materials: Vec<(String, Sheet)>,
}

/// A load to be reached from the one before.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// Whether it begins with the mesh at rest, not with the state before.
    pub is_restart: bool,
    /// What fills the membrane.
    pub filling: Filling,
    /// What the fittings do at its end: places from those in the mesh, m, or forces, N. `None`: as before.
    pub fittings: Vec<Option<f64>>,
    /// The contraction at its end, if the step prescribes one.
    pub contraction: Option<f64>,
    /// States that are kept on the way, the last one included.
    pub states: usize,
}

/// What fills the membrane in a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Filling {
    /// A gauge pressure, Pa.
    Pressure(f64),
    /// A volume, m^3.
    Volume(f64),
    /// The gas that is in it when the step begins stays: its exponent, and the pressure around, Pa.
    Closed {
        /// 1 at constant temperature, 1.4 without exchange of heat.
        gamma: f64,
        /// Pa.
        ambient: f64,
    },
}
