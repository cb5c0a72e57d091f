//! Materials: energies per unit area of a stress-free membrane, and per unit length of a thread, with their
//! derivatives.

mod law;
mod orthotropic;
mod sheet;
mod tension_field;
mod thread;

pub use law::Law;
pub use orthotropic::Orthotropic;
pub use sheet::{Cloth, Sheet};
pub use tension_field::Tension;
pub use thread::Thread;

pub(crate) use sheet::Plane;
pub(crate) use tension_field::Principal;
pub(crate) use thread::pull;
