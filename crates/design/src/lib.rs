//! Muscles put to use: which one lifts a load, at what length and pressure.
//!
//! [`size`] goes from a load over a stroke to muscles, lengths and pressures (S4, "Sizing Fluidic Muscle Using Static Force Model").
//!
//! Deliberately absent: files, units and prices. A choice is a value with numbers in it; the command line reads and prints.

pub mod size;
