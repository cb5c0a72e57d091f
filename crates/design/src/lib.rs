//! Design tools for muscles.
//!
//! - [`size`] goes from a load over a stroke to muscles, lengths and pressures (S4, "Sizing Fluidic Muscle
//!   Using Static Force Model"),
//! - [`gas`] computes a muscle with its valve shut, how fast a muscle fills, and its air consumption (S1,
//!   section 2.3; ISO 6358),
//! - [`sensing`] computes a muscle that senses its own contraction, by the resistance of a channel of liquid
//!   metal around it (S3, section 5),
//! - [`heat`] computes the temperature of a muscle under repeated charging and discharging, with and without
//!   an inner pipe (S3, section 4).
//!
//! S3 is "Study on Mechanical Behaviour of Pneumatic Artificial Muscle and Methods to Improve it".
//!
//! Deliberately absent: files, units and prices. The functions return numbers; the command line reads and
//! prints.

pub mod gas;
pub mod heat;
pub mod sensing;
pub mod size;
