//! Design tools for muscles.
//!
//! - [`size`] finds muscles, lengths and pressures for a load over a stroke (S4, "Sizing Fluidic Muscle Using
//!   Static Force Model").
//! - [`gas`] computes closed muscles, filling times and air consumption (S1, section 2.3; ISO 6358).
//! - [`sensing`] models a muscle that measures its own contraction by the resistance of a channel of liquid
//!   metal around it (S3, section 5).
//! - [`joint`] models two antagonistic muscles on a joint: torque, stiffness, and the pressures for both (S1,
//!   section 4).
//! - [`elements`] computes the shape of a muscle by membrane elements, as an alternative to its meridian.
//! - [`heat`] computes the temperature of a muscle under repeated charging and discharging, with and without
//!   an inner pipe (S3, section 4).
//!
//! S3 is "Study on Mechanical Behaviour of Pneumatic Artificial Muscle and Methods to Improve it".
//!
//! Each command's question and its JSON document are made here, in the files `question`, for all that ask: a
//! question is a struct of SI numbers, its answer serialises as the document.
//!
//! Deliberately absent: prices, and file formats other than that of a joint. Functions return values with
//! numbers; the command line reads files and prints.

pub mod elements;
pub mod gas;
pub mod heat;
pub mod joint;
mod question;
pub mod sensing;
pub mod size;

pub use question::{Lines, QuestionError};
