//! Shape, force and volume of pressurised fibre nets: one meridian equation for pleated and braided pneumatic
//! muscles.
mod both_ways;
mod branches;
pub mod closed_form;
mod continuation;
mod cylinder;
mod draw;
mod equator;
mod error;
mod follow;
mod formulas;
mod groups;
mod isobars;
#[cfg(test)]
mod kept;
mod linearised;
mod lobes;
mod meridian;
mod net;
mod outcome;
mod parts;
mod path;
mod problem;
mod quadrature;
mod search;
mod shape;
mod shooting;
mod solve;
mod start;
mod unknowns;
mod volume;
#[cfg(test)]
mod work;
pub use draw::PleatedNumbers;
pub use error::FibreError;
pub use formulas::{Formula, FormulaInput, MOST_GAPS, MOST_PARAMETERS};
pub use isobars::{Isobar, isobars};
pub use linearised::{Linear, Linearised, Repeated, Start};
pub use net::EVEN_POWERS;
pub use outcome::Approach;
pub use parts::{Jet, LANES, Parts, Rubber, TautCloth};
pub use problem::{
    BRAID_ANGLE, BRAIDED_SLENDERNESS, LOBED_FIBRES, LOBED_LENGTH, MOST_STRAIN, PLEATED_SLENDERNESS, Problem,
    WIDEST_FITTING,
};
pub use shape::{Convergence, MeridianPoint, Method, Response, Shape};
pub use solve::{ADIABATIC, AMBIENT_PRESSURE, Given, Gradient, RangeEnd};
