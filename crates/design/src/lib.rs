//! Design tools for muscles.
//!
//! - [`size`] goes from a load over a stroke to muscles, lengths and pressures (S4, "Sizing Fluidic Muscle Using Static Force Model"),
//! - [`gas`] is a muscle with its valve shut, how fast one fills and what air it uses (S1, section 2.3; ISO 6358),
//! - [`sensing`] is a muscle that feels its own contraction, by the resistance of a channel of liquid metal around it (S3, section 5),
//! - [`joint`] is two muscles against each other on a joint: torque, stiffness, and the pressures for both (S1, section 4),
//! - [`elements`] is the shape of a muscle by membrane elements, beside that of the meridian,
//! - [`heat`] is how warm a muscle gets that is charged and discharged again and again, with and without an inner pipe (S3, section 4).
//!
//! S3 is "Study on Mechanical Behaviour of Pneumatic Artificial Muscle and Methods to Improve it".
//!
//! Deliberately absent: prices, and files but that of a joint. An answer is a value with numbers in it; the command line reads and prints.

pub mod elements;
pub mod gas;
pub mod heat;
pub mod joint;
pub mod sensing;
pub mod size;
