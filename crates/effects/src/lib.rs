//! The catalogue of physical effects of pneumatic muscles: equations, parameters, sources, signatures and laws.
//!
//! An effect is one file and one entry of the list of its group. Its [`Action`] is one of four: it changes the muscle whose equilibrium is
//! solved ([`ShapeEffect`]), what reaches that muscle ([`InputEffect`]), adds a force ([`LoadEffect`]) or changes what the load cell
//! reads ([`OutputEffect`]). Everything that a fit, a ranking, the help or a report says about it comes from its [`Card`].
//!
//! # A new effect
//!
//! 1. Write one file in the folder of its group (`geometry`, `material`, `load`, `rig`, `specimen`): a unit struct with `impl Effect` (its card and its
//!    numbers) and the one trait of what it does. A neighbour of the same action is the best start: `pleat_depth.rs` (shape), `pressure_gain.rs` (input),
//!    `coulomb_friction.rs` (load), `force_gain.rs` (output). Numbers are [`Jet`]s: computing with them gives the derivatives, so there are none to write.
//! 2. Add its line to the list in the `mod.rs` of the folder.
//! 3. Test it in the file: a force that is known otherwise, its limit, nothing at `off`. The tests of the whole catalogue find it by themselves: card, units,
//!    bounds, derivatives against differences, nothing changed where it is off.
//!
//! Help, muscle files, fits, rankings, sweeps, reports and Python know it then. An effect of the shape changes [`bulge_fibre::Parts`], from which the
//! equilibrium is solved with all derivatives; where a formula says all of it, a file of [`user`] effects needs no Rust.
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
