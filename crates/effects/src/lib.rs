//! The catalogue of physical effects of pneumatic muscles (equations, parameters, sources, signatures), and
//! the force laws.
//!
//! An effect is one file and one entry in the list of its group. Its [`Action`] is one of four. It changes
//! the muscle whose equilibrium is solved ([`ShapeEffect`]) or the input of that muscle ([`InputEffect`]),
//! adds a force ([`LoadEffect`]), or changes the reading of the load cell ([`OutputEffect`]). Fits, rankings,
//! help and reports take everything that they say about an effect from its [`Card`].
//!
//! # A new effect
//!
//! 1. Write one file in the folder of its group (`geometry`, `material`, `load`, `rig`, `specimen`). It
//!    contains a unit struct with `impl Effect` (its card and its parameters) and with the one trait of its
//!    action. Start from a neighbour with the same action: `pleat_depth.rs` (shape), `pressure_gain.rs`
//!    (input), `coulomb_friction.rs` (load), `force_gain.rs` (output). Numbers are [`Jet`]s, which compute
//!    their own derivatives (with [`bulge_numerics::Real`]), so there are none to write. At `off` their
//!    values stay, bit for bit. An early return there would lose their derivatives too, which no test of this
//!    crate sees, and a diagnosis would take the effect for one that is even in its parameter.
//! 2. Add two lines to the `mod.rs` of the folder: the `mod` of the file, and its entry in the list.
//! 3. Test it in the file: a force that is known otherwise, its limit, no change at `off`, its derivative
//!    there. Helpers are in `geometry/bench.rs` (shape) and `probe.rs` (the others).
//! 4. Run `cargo test -p bulge-effects`. Its tests of the whole catalogue include the effect automatically.
//!    They check the card (each twin is a name in the catalogue, and need not name the effect in return), the
//!    units, the bounds, the derivatives within the bounds against differences, and no change at `off`.
//!
//! Help, muscle files, fits, rankings, sweeps, reports and Python then know the effect. A shape effect
//! changes [`bulge_fibre::Parts`], from which the equilibrium is solved with all derivatives; it sees neither
//! pressure nor contraction. If a formula describes the whole effect, a file of [`user`] effects needs no
//! Rust.
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
