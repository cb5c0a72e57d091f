//! The reports through the public API: one program of tests, one module for each kind, and the samples of both.

mod comparison;
mod diagnosed;
mod diagnosis;
mod page;
mod sample;
