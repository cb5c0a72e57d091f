//! Membrane finite elements for pressurised fibre-reinforced membranes: from a mesh to converged equilibrium states.

mod assembly;
pub mod case;
mod dofs;
mod element;
mod error;
mod factor;
mod fields;
mod load;
mod material;
mod mesh;
pub mod mesher;
mod newton;
mod path;
mod set;
mod solver;
mod state;
mod structure;
mod surface;

pub use element::RingLayer;
pub use error::MembraneError;
pub use fields::{Fields, GroupFields, SheetField, Summary, ThreadField};
pub use load::{Gas, Inflation, Load};
pub use material::{Cloth, Law, Orthotropic, Sheet, Tension, Thread};
pub use mesh::{Block, CellKind, Mesh, MeshError};
pub use solver::Solver;
pub use state::{Copies, Effort, State, Tolerance};
pub use structure::{Fitting, Part, Structure, Support};
