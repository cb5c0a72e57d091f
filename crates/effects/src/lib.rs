//! The catalogue of physical effects of pneumatic muscles: equations, parameters, sources, signatures and laws.
//!
//! An effect is one file and one entry of the list of its group. Its [`Action`] is one of four: it changes the muscle whose equilibrium is
//! solved ([`ShapeEffect`]), what reaches that muscle ([`InputEffect`]), adds a force ([`LoadEffect`]) or changes what the load cell
//! reads ([`OutputEffect`]). Everything that a fit, a ranking, the help or a report says about it comes from its [`Card`].
//!
//! Deliberately absent: data. An effect sees one [`Moment`] after the other, never a data set.

mod card;
mod catalogue;
mod describe;
mod effect;
pub mod expression;
mod geometry;
pub mod law;
mod learnt;
mod load;
mod material;
mod mechanism;
#[cfg(test)]
mod probe;
mod rig;
mod specimen;
mod stated;
mod unit;
pub mod user;

pub use card::{
    BRAIDED, Card, Evidence, Group, Needs, PLEATED, ParameterCard, Parity, Signature, Stage, Twin,
};
pub use catalogue::{Catalogue, CatalogueError};
pub use describe::{CardDocument, ParameterDocument, SignatureDocument, TwinDocument, describe, overview};
pub use effect::{
    Action, Balance, Effect, Give, Input, InputEffect, Jet, LANES, LoadEffect, Moment, OutputEffect, Row,
    Setting, ShapeEffect,
};
pub use learnt::{Known, known, learnt};
pub use mechanism::{Form, Mechanism};
