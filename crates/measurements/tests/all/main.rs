//! Files of measurements, what is found in them, and what they survive: one program of tests, one module for each part.

mod files;
mod history;
mod robustness;
